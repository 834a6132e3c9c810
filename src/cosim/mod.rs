//! Co-simulation and model exchange: the variable table, the model interfaces and their implementations.
//!
//! Nothing here knows the C interfaces; [`crate::ffi`] stands on it.

mod body;
mod component;
mod controller;
mod exchange;
mod exchange_component;
mod identity;
mod input_signals;
mod model;
mod open;
mod part;
mod rig;
mod rows;
mod segments;
pub mod state;
#[cfg(test)]
pub(crate) mod test_model;
mod token;
mod variables;

pub use exchange::{EventOutcome, ModelExchange};
pub use identity::{
    DefaultExperiment, Identity, LOG_CATEGORIES, LogCategory, MAX_INPUT_DERIVATIVE_ORDER,
    MAX_OUTPUT_DERIVATIVE_ORDER,
};
pub use model::{CoSimulationModel, ModelError, Notice, StepEnd};
pub use open::{MODEL_FILE, open, open_for_exchange};
pub use state::{StateError, StateReader, StateWriter};
pub use token::Token;
pub use variables::{
    Causality, Initial, TableError, Variability, Variable, VariableTable, VariableType,
};
