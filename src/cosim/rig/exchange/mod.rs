//! A rig for model exchange.

mod run;
mod sensitivities;

pub(in crate::cosim) use run::Run;
