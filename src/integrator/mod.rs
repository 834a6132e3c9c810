//! The hybrid integrator: Taylor series of high order within a mode, exact switches between modes.

mod error;
mod options;
mod piece;
mod segment_end;
mod simulation;
mod statistics;
mod step_size;
mod system;

pub use error::IntegrationError;
pub use options::Options;
pub use piece::{Segment, Snapshot, SwitchEvent};
pub(crate) use segment_end::SETTLED_SHARE;
pub use simulation::Simulation;
pub use statistics::Statistics;
pub(crate) use step_size::from_last_terms as step_from_last_terms;
pub use system::{Fold, Guard, HybridSystem};
