//! The switch model (Leine, van Campen, de Kraker and van den Steen 1998).

use crate::parameter::{Range, section};

section! {
    /// The switch model: within |ω| ≤ `omega_tolerance` a stuck contact lets the velocity decay at
    /// `decay_rate` instead of holding it, which removes Karnopp's instability at the band's edge.
    pub struct Switch {
        /// Sliding friction coefficient at high slip velocity
        mu_c: "1", Range::NonNegative;
        /// Static friction coefficient, at which a stuck contact breaks away
        mu_s: "1", Range::NonNegative;
        /// Stribeck velocity of the sliding branch
        omega_s: "rad/s", Range::Positive;
        /// Half width of the velocity band that counts as zero
        omega_tolerance: "rad/s", Range::Positive;
        /// Rate at which the remaining slip velocity decays while stuck
        decay_rate: "1/s", Range::Positive;
    }
}
