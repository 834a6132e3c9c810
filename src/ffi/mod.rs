//! The C interfaces of FMI 2.0.5 and FMI 3.0.2 for co-simulation and model exchange.
//!
//! The only unsafe code of the project. An exported function is one guarded line: the guard finds the
//! instance in the table of live handles, compares its phase with those in which the standard allows
//! the call, runs the body, stops panics and turns refusals into statuses and log lines.
//!
//! Statuses: *discard* for values, steps and communication points that cannot be accepted; the instance is then
//! as it was and goes on. *Error* for calls in the wrong state, unknown value references, NULL and
//! foreign states: the standards then allow reading, restoring a state, resetting and freeing only.

mod derivatives;
mod exchange;
pub mod fmi2;
pub mod fmi3;
mod guard;
mod handles;
mod instance;
mod instantiate;
mod log;
mod own_folder;
mod pointers;
mod resource;
mod saved;
mod states;
mod status;
#[cfg(test)]
mod tests;
mod values;

pub use log::{Fmi2Logger, Fmi3Logger};
pub use status::Status;
