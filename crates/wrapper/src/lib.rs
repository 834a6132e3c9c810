//! An FMU around an FMU: the original, as it is, with the forces of effects added at one of its inputs.
//!
//! The original lies among the resources, with [`operations::Settings`] beside it. Every call goes to an instance of the original;
//! variables that it does not have are kept here, and a step is cut into coupling steps, each with the force that [`operations::Coupling`] finds.

mod fmi2;
mod fmi3;
mod guard;
mod instance;
mod opening;
mod original;
mod own;
mod states;

pub use fmi2::*;
pub use fmi3::*;
