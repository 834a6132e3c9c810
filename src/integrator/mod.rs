//! The hybrid integrator: Taylor series of high order within a mode, exact switches between modes.

mod error;
mod simulation;
mod statistics;
mod step_size;
mod system;

pub use error::IntegrationError;
pub(crate) use simulation::SETTLED_SHARE;
pub use simulation::{Options, Segment, Simulation, Snapshot, SwitchEvent};
pub use statistics::Statistics;
pub(crate) use step_size::from_last_terms as step_from_last_terms;
pub use system::{Guard, HybridSystem};
