//! The friction laws with the numbers that they are timed with.

/// Name and numbers of every law, as lines of `model.toml`. Without noise, of which there are no derivatives.
pub const LAWS: [(&str, &str); 8] = [
    ("coulomb", "mu_c = 0.12"),
    ("coulomb_stiction", "mu_c = 0.12\nmu_s = 0.2"),
    ("stribeck", "mu_c = 0.12\nmu_s = 0.2\nomega_s = 1.2"),
    (
        "karnopp",
        "mu_c = 0.12\nmu_s = 0.2\nomega_s = 1.2\nomega_tolerance = 1e-3",
    ),
    (
        "switch",
        "mu_c = 0.12\nmu_s = 0.2\nomega_s = 1.2\nomega_tolerance = 1e-3\ndecay_rate = 50.0",
    ),
    (
        "wojewoda",
        "mu_c = 0.12\nmu_s = 0.2\nomega_s = 1.2\nstochastic_amplitude = 0.0\ncorrelation_angle = 0.1\nseed = 1",
    ),
    (
        "two_gaussian_torque",
        "a1 = 0.8\nb1 = -3.07246\nc1 = 1.28946\na2 = 0.55\nb2 = 0.4796\nc2 = 2.62303\n\
         omega_centre = 7.15956\nacceleration_semi_axis = 58.2873",
    ),
    (
        "two_gaussian_mu",
        "a1 = 0.27115\nb1 = -3.07246\nc1 = 1.28946\na2 = 0.18567\nb2 = 0.4796\nc2 = 2.62303\n\
         omega_centre = 7.15956\nacceleration_semi_axis = 58.2873",
    ),
];
