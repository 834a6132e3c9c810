//! A rig for model exchange.

mod model;
mod run;
mod sensitivities;

pub(in crate::cosim) use model::RigExchange;
