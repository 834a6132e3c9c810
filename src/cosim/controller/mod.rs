//! A controller as a component for co-simulation.

mod identity;
mod model;
mod state;
mod variables;

pub use model::ControllerModel;
