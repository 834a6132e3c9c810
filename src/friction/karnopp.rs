//! Karnopp's law (Eq. 2-4; Karnopp 1985): a band of velocities counts as standing still.

use crate::parameter::{Range, section};

section! {
    /// Karnopp's law: within |ω| ≤ `omega_tolerance` the contact takes whatever torque keeps the
    /// velocity constant, up to μ_s; outside it follows Stribeck's curve.
    pub struct Karnopp {
        /// Sliding friction coefficient at high slip velocity
        mu_c: "1", Range::NonNegative;
        /// Static friction coefficient, at which a stuck contact breaks away
        mu_s: "1", Range::NonNegative;
        /// Stribeck velocity of the sliding branch
        omega_s: "rad/s", Range::Positive;
        /// Half width of the velocity band that counts as zero
        omega_tolerance: "rad/s", Range::Positive;
    }
}
