//! The effects on the motion with the numbers that they are timed with.

/// Name and numbers of every effect that acts on the motion, as lines of `model.toml`.
pub const EFFECTS: [(&str, &str); 18] = [
    ("bearing_friction", "torque = 0.05"),
    ("normal_force_wobble", "amplitude = 0.2\nphase = 0.7"),
    ("position_friction", "amplitude = 0.15\nphase = 0.4"),
    ("unbalance", "torque = 0.1\nphase = 0.3"),
    ("viscous_drag", "coefficient = 0.01"),
    ("quadratic_drag", "coefficient = 0.002"),
    ("shaft_hardening", "cubic_stiffness = 0.02"),
    (
        "shaft_hysteresis",
        "stiffness = 0.1\nrelaxation_time = 0.15",
    ),
    ("backlash", "gap = 0.2"),
    ("gear_ripple", "torque = 0.02\norder = 2.0\nphase = 0.4"),
    ("motor_viscous", "coefficient = 2e-4"),
    ("supply_sag", "factor = 0.95"),
    ("resistance_drift", "rate_per_minute = 0.5"),
    ("load_cell_bias", "bias = 5.0"),
    ("friction_wear", "rate_per_minute = 0.8"),
    ("load_exponent", "exponent = 0.8"),
    ("presliding", "stiffness = 20.0\ndamping = 0.05"),
    (
        "stochastic_friction",
        "standard_deviation = 0.04\ncorrelation_time = 0.1\nseed = 5",
    ),
];
