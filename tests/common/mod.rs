//! Rigs, runs and tolerances that several tests share.
#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail by panicking, like the tests"
)]
#![allow(dead_code, reason = "every test file uses its own part")]

pub mod energy;
pub mod grazing;
pub mod solver;

use stickslip::integrator::{IntegrationError, Options, Simulation};
use stickslip::plant::{Rig, RigInputs, RigState, STATES};
use stickslip::series::Scalar;

/// The reduced rig of the dissertation.
pub const REDUCED_RIG: &str = include_str!("../../modelDescription/reduced-rig.toml");
/// The full rig of the dissertation.
pub const FULL_RIG: &str = include_str!("../../modelDescription/full-rig.toml");

/// Every friction law, as the lines that follow `radius` in `[contact]`.
pub const LAWS: [(&str, &str); 8] = [
    ("coulomb", "mu_c = 0.15"),
    ("coulomb_stiction", "mu_c = 0.12\nmu_s = 0.2"),
    ("stribeck", "mu_c = 0.12\nmu_s = 0.2\nomega_s = 1.2"),
    (
        "karnopp",
        "mu_c = 0.12\nmu_s = 0.2\nomega_s = 1.2\nomega_tolerance = 0.01",
    ),
    (
        "switch",
        "mu_c = 0.12\nmu_s = 0.2\nomega_s = 1.2\nomega_tolerance = 0.01\ndecay_rate = 50.0",
    ),
    (
        "wojewoda",
        "mu_c = 0.15\nmu_s = 0.2\nomega_s = 1.2\nstochastic_amplitude = 0.0\ncorrelation_angle = 0.3\nseed = 3",
    ),
    (
        "two_gaussian_torque",
        "a1 = 0.8\nb1 = -3.07246\nc1 = 1.28946\na2 = 0.55\nb2 = 0.4796\nc2 = 2.62303\nomega_centre = 7.15956\nacceleration_semi_axis = 58.2873",
    ),
    (
        "two_gaussian_mu",
        "a1 = 0.27115\nb1 = -3.07246\nc1 = 1.28946\na2 = 0.18567\nb2 = 0.4796\nc2 = 2.62303\nomega_centre = 7.15956\nacceleration_semi_axis = 58.2873",
    ),
];

const PARTS: &str = "[disc]\ninertia = 0.0149\n[shaft]\nstiffness = 0.3482\ndamping = 0.0022\n\
[gearbox]\nratio = 8.0\n[motor]\ninertia = 5.18e-5\nresistance = 0.33\ninductance = 8.437e-4\n\
torque_constant = 0.126\nback_emf_constant = 0.0602\ncoulomb_torque = 0.1196\nviscous_damping = 1.784e-4\n";

const DISC1_PARTS: &str =
    "[disc1]\ninertia = 0.0288\n[shaft1]\nstiffness = 2.905\ndamping = 0.0214\n";

/// Text of a rig with this law on its pins (on both for the full rig) and these extra sections.
pub fn rig_text(full: bool, law: (&str, &str), extra: &str) -> String {
    let mut text = format!(
        "{PARTS}[contact]\nradius = 0.075\nlaw = \"{}\"\n{}\n",
        law.0, law.1
    );
    if full {
        text += &format!(
            "{DISC1_PARTS}[contact1]\nradius = 0.089\nlaw = \"{}\"\n{}\n",
            law.0, law.1
        );
    }
    text + extra
}

/// The rig of [`rig_text`].
pub fn rig(full: bool, law: (&str, &str), extra: &str) -> Rig<f64> {
    Rig::from_toml(&rig_text(full, law, extra), law.0).unwrap()
}

/// The law called `name`.
pub fn law(name: &str) -> (&'static str, &'static str) {
    *LAWS.iter().find(|law| law.0 == name).unwrap()
}

/// Options with another tolerance.
pub fn options(tolerance: f64) -> Options {
    Options {
        tolerance,
        ..Options::default()
    }
}

/// A run from `state` at time 0.
pub fn start<S: Scalar>(
    rig: &Rig<S>,
    tolerance: f64,
    state: RigState<S>,
    inputs: RigInputs<S>,
) -> Result<Simulation<S, Rig<S>>, IntegrationError> {
    Simulation::new(*rig, options(tolerance), 0.0, state, inputs)
}

/// The state at `time` of a run with held inputs from `state`.
pub fn state_after(
    rig: &Rig<f64>,
    state: [f64; STATES],
    inputs: RigInputs<f64>,
    time: f64,
) -> [f64; STATES] {
    let mut run = start(rig, 1e-12, state, inputs).unwrap();
    run.advance_to(time).unwrap();
    run.state_at(time)
}

/// A pseudo-random sequence in \[0, 1), the same in every run.
pub struct Uniform(pub u64);

impl Uniform {
    /// The next number.
    pub fn next(&mut self) -> f64 {
        // xorshift64* (Vigna 2016).
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number between two bounds.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// A number between two positive bounds, uniform in its logarithm.
    pub fn decades(&mut self, low: f64, high: f64) -> f64 {
        (self.between(low.ln(), high.ln())).exp()
    }
}
