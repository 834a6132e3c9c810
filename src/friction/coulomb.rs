//! Coulomb's law (Eq. 2-1; Coulomb 1785): the level does not depend on the slip velocity.

use crate::parameter::{Range, section};

section! {
    /// Coulomb friction: μ = μ_c in sliding, breakaway at μ_c.
    pub struct Coulomb {
        /// Sliding friction coefficient
        mu_c: "1", Range::NonNegative;
    }
}
