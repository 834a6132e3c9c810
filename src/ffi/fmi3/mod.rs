//! The C interface of FMI 3.0.2.

mod common;
mod cosimulation;
mod model_exchange;
mod types;
mod unsupported;
mod values;

pub use common::*;
pub use cosimulation::*;
pub use model_exchange::*;
pub use types::*;
pub use unsupported::*;
pub use values::*;
