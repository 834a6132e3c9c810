//! `stickslip simulate`: one run of a model or an FMU, as CSV, pictures and a summary of one screen.

mod arguments;
mod derivatives;
mod drive;
mod picture;
mod run;
mod summary;

pub use arguments::{Setting, SimulateArguments, apply_settings};
pub use derivatives::{DerivativeError, Derivatives, derivatives, state_names};
pub use drive::{Drive, DriveError};
pub use picture::picture;
pub use run::{Schedule, simulate, simulate_variables, usual_variables};
pub use summary::Summary;

use std::time::Instant;

use anyhow::Context;

use crate::component;
use crate::outcome::Outcome;

/// Runs the subcommand: writes `result.csv`, `result.svg` and `result.png` and prints the summary.
///
/// # Errors
/// Whatever is wrong with the arguments, the model or the inputs.
pub fn command(arguments: &SimulateArguments) -> anyhow::Result<Outcome> {
    let mut component = component::open(&arguments.model)?;
    component::position(component.as_ref(), "theta_dot").context(
        "a rig is needed, whose disc is looked at; controllers run in stickslip closed-loop",
    )?;
    apply_settings(component.as_mut(), &arguments.set)?;
    let drive = arguments.drive(component.as_ref())?;
    let schedule = Schedule::new(
        drive.start(),
        arguments.duration.or(drive.duration()).unwrap_or(60.0),
        arguments.step,
    )?;
    let begun = Instant::now();
    let record = simulate(component.as_mut(), &drive, &schedule)?;
    let wall_time = begun.elapsed();
    let summary = Summary::new(&record, component.switches(), wall_time)?;
    let csv = arguments.out.join("result.csv");
    record.write(&csv)?;
    let title = format!("{}: {}", component.title(), drive.describe());
    picture(&record, &title)?
        .write(&arguments.out.join("result"))
        .with_context(|| {
            format!(
                "the numbers are in {}, the picture is missing",
                csv.display()
            )
        })?;
    print!("{title}\n{summary}");
    println!("written         {}, result.svg, result.png", csv.display());
    Ok(Outcome::Done)
}
