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
    /// Lag of the acceleration that the two-Gaussian law sees [s]: it closes the algebraic loop. What it leaves out to first order is
    /// added again.
    pub acceleration_lag: f64,
    /// Speed below which a disc counts as resting [rad/s].
    pub resting: f64,
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
/// 7.9e-4 rad (gearbox output). Over 40 s of stick-slip under Eq. 6-2 the records are those of the exact model: softer bristles, or a
/// law that is slow to leave rest, move each breakaway by milliseconds, and records of many cycles show that.
pub const DISSERTATION: Numerics = Numerics {
    step: 5e-6,
    steps_per_sample: 2000,
    steps_per_draw: 40,
    disc: Bristles::DISSERTATION,
    motor: Bristles::DISSERTATION,
    acceleration_lag: 2.5e-5,
    resting: 1e-2,
};

impl Bristles {
    /// For the dissertation's rig.
    pub const DISSERTATION: Self = Self {
        deflection: 1e-7,
        elastic_share: 0.99998,
        damped_speed: 0.01,
        soft_damped_speed: 5.0,
    };
}
