//! The C interface of FMI 3.0.2.

mod common;
mod cosimulation;
mod do_step;
mod model_exchange;
mod types;
mod unsupported;
mod values;

pub use common::*;
pub use cosimulation::*;
pub(in crate::ffi) use do_step::IntermediateUpdate;
pub use do_step::fmi3DoStep;
pub use model_exchange::*;
pub use types::*;
pub use unsupported::*;
pub use values::*;
