//! The C interface of FMI 2.0.5.

mod common;
mod cosimulation;
mod model_exchange;
mod types;

pub use common::*;
pub use cosimulation::*;
pub use model_exchange::*;
pub use types::*;
