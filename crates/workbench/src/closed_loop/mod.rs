//! `stickslip closed-loop`: a rig with controllers, over speed and normal force or over the communication step.

mod arguments;
mod circuit;
mod map;
mod picture;
mod run;
mod steps;

pub use arguments::ClosedLoopArguments;
pub use circuit::{Circuit, CircuitError};
pub use run::{Conditions, Samples, run};

use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;

use crate::outcome::Outcome;

/// Set by the first interrupt; the runs at work are then given up and the finished ones kept.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Runs the subcommand: a map over speed and force, or a table over communication steps.
///
/// # Errors
/// Whatever is wrong with the arguments, the models or their connections.
pub fn command(arguments: &ClosedLoopArguments) -> anyhow::Result<Outcome> {
    arguments.check()?;
    ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed))
        .context("interrupts cannot be caught")?;
    if arguments.communication_step.len() > 1 {
        steps::command(arguments)
    } else {
        map::command(arguments)
    }
}
