//! The rig as a component for co-simulation.

mod course;
mod delay_line;
mod derivatives;
mod identity;
mod input_signals;
mod model;
mod notice;
mod state;
mod variables;

pub use model::RigModel;
