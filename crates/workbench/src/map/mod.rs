//! `stickslip map`: kinds of motion over one or two parameters, from thousands of runs.

mod arguments;
mod grid;
mod journal;
mod picture;
mod point;
pub(crate) mod result;
pub(crate) mod settings;
mod span;
mod study;
mod watch;

pub use arguments::{MapArguments, RunArguments};
pub use grid::Finished;
pub use journal::Journal;
pub use point::{MOST_EXTREMA, Point, run_point};
pub use settings::{Quantity, Settings, SettingsError, Varied};
pub use span::Span;
pub use study::{Study, Work, judge, make};
pub use watch::Watch;

use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;

use crate::analysis::motion::Motion;
use crate::outcome::Outcome;

/// Set by the first interrupt; the rows at work are then given up and the finished ones kept.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Runs the subcommand: writes `map.csv`, `map.svg` and `map.png`, for one parameter `extrema.csv` too.
///
/// # Errors
/// Whatever is wrong with the arguments or the model.
pub fn command(arguments: &MapArguments) -> anyhow::Result<Outcome> {
    let (settings, runs) = (arguments.settings()?, &arguments.runs);
    ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed))
        .context("interrupts cannot be caught")?;
    let made = make(&settings, &runs.out, &INTERRUPTED, runs.threads)?;
    let Some(made) = made else {
        return Ok(Outcome::Interrupted);
    };
    println!(
        "{} runs of {} s in {:.2} s, {} rows kept from before",
        settings.points() - made.kept * settings.columns(),
        settings.duration,
        made.wall_time,
        made.kept
    );
    for motion in Motion::ALL {
        let points = made.rows.iter().flatten();
        let count = points.filter(|point| point.motion == Some(motion)).count();
        println!("{:12} {count}", motion.name());
    }
    println!(
        "written      {} and map.svg, map.png",
        runs.out.join("map.csv").display()
    );
    Ok(judge(&settings, &made.rows))
}
