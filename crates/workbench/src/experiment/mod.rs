//! The dissertation's computations, each with the published number beside ours.
//!
//! One file for each section of a chapter; an experiment is a function from nothing to [`Findings`].

mod chapter3;
mod chapter4;
mod chapter5;
mod chapter6;
pub mod command;
mod document;
mod finding;
pub mod virtual_rig;

pub use finding::{ExperimentError, Findings, Picture, Row, Table, Verdict, short};

/// One thing that the dissertation computes or measures.
#[derive(Clone, Copy)]
pub struct Experiment {
    /// Chapter and figure or table, as the command line takes it.
    pub id: &'static str,
    /// What it is.
    pub title: &'static str,
    /// Runs it.
    pub run: fn() -> Result<Findings, ExperimentError>,
}

/// All experiments, in the dissertation's order.
#[must_use]
pub fn all() -> Vec<Experiment> {
    [
        chapter3::EXPERIMENTS,
        chapter4::EXPERIMENTS,
        chapter5::EXPERIMENTS,
        chapter6::EXPERIMENTS,
    ]
    .concat()
}
