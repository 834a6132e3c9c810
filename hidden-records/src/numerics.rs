//! Step and scales of a simulation: what must be small beside the rig and its instruments.

/// Numbers that belong to the scheme, not to the rig. All of them lie below what instruments show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Numerics {
    /// Time step [s].
    pub step: f64,
    /// Steps between two samples [-].
    pub steps_per_sample: usize,
    /// Steps after which the random friction factor is drawn anew [-].
    pub steps_per_draw: usize,
    /// Bristles of pins and disc bearings.
    pub disc: Bristles,
    /// Bristles of the motor, seen at the gearbox output.
    pub motor: Bristles,
    /// Lag of the acceleration that the two-Gaussian law sees [s]: it closes the algebraic loop.
    pub acceleration_lag: f64,
    /// Whether what this lag leaves out to first order is added again.
    pub lag_compensated: bool,
    /// Speed below which a disc counts as resting [rad/s].
    pub resting: f64,
    /// Slip speed below which a law with a separate breakaway level counts as "at rest" [rad/s].
    pub rest_speed: f64,
    /// Whether "at rest" is a state instead: from a change of the velocity's sign until the bristles have
    /// given way as far as they can.
    pub rest_is_a_state: bool,
}

/// Scales of a bristle contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bristles {
    /// Deflection at breakaway [rad].
    pub deflection: f64,
    /// Share of the steady deflection up to which it only bends [-]. Without it a stuck contact creeps
    /// under load and breaks away percents early.
    pub elastic_share: f64,
    /// Speed above which a stiff bristle no longer damps [rad/s].
    pub damped_speed: f64,
    /// The same of one that is soft enough to be seen: faster than it ever rings [rad/s].
    pub soft_damped_speed: f64,
}

/// For the dissertation's rig (about 0.8 Hz, motor 2 ms): encoder steps are 6.3e-3 rad (disc) and
/// 7.9e-4 rad (gearbox output).
pub const DISSERTATION: Numerics = Numerics {
    step: 1e-5,
    steps_per_sample: 1000,
    steps_per_draw: 20,
    disc: Bristles::DISSERTATION,
    motor: Bristles::DISSERTATION,
    acceleration_lag: 5e-5,
    lag_compensated: false,
    resting: 1e-2,
    rest_speed: 0.002,
    rest_is_a_state: false,
};

impl Bristles {
    /// For the dissertation's rig.
    pub const DISSERTATION: Self = Self {
        deflection: 4e-6,
        elastic_share: 0.998,
        damped_speed: 0.02,
        soft_damped_speed: 5.0,
    };
}
