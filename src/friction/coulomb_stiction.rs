//! Coulomb's law with stiction (Eq. 2-2): breakaway needs more than sliding.

use crate::parameter::{Range, section};

section! {
    /// Coulomb friction with stiction: μ = μ_c in sliding, breakaway at μ_s ≥ μ_c.
    pub struct CoulombStiction {
        /// Sliding friction coefficient
        mu_c: "1", Range::NonNegative;
        /// Static friction coefficient, at which a stuck contact breaks away
        mu_s: "1", Range::NonNegative;
    }
}
