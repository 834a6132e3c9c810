//! The engine of the dissertation's rig, which stays until the crate `inference` is as good on that rig.
//!
//! Its windows, ranges and thresholds were settled on that rig, so that it is asked about no other ([`answer::is_asked`]).

pub mod answer;
pub mod breakaway;
pub mod bristle_start;
pub mod catalogue;
pub mod certainty;
pub mod close_up;
pub mod companions;
pub mod data;
pub mod decide;
pub mod fit;
pub mod gain;
pub mod gram;
pub mod hypothesis;
pub mod law_fits;
pub mod law_starts;
pub mod left;
pub mod losses;
pub mod marginal;
pub mod rehearsal;
pub mod restated;
pub mod rivals;
pub mod robust;
pub mod rounds;
pub mod run;
pub mod search;
pub mod structure;
pub mod superfluous;
pub mod window;
