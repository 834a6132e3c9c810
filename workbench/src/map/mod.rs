//! `stickslip map`: kinds of motion over one or two parameters, from thousands of runs.

mod arguments;
mod grid;
mod journal;
mod picture;
mod point;
pub(crate) mod result;
pub(crate) mod settings;
mod span;
mod watch;
mod work;

pub use arguments::MapArguments;
pub use grid::{Finished, run_rows};
pub use journal::Journal;
pub use point::{MOST_EXTREMA, Point, run_point};
pub use settings::{Quantity, Settings, SettingsError, Varied};
pub use span::Span;
pub use watch::Watch;
pub use work::Work;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};

use crate::analysis::motion::Motion;
use crate::cli::Outcome;

/// Set by the first interrupt; the rows at work are then given up and the finished ones kept.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Runs the subcommand: writes `map.csv`, `map.svg` and `map.png`, for one parameter `extrema.csv` too.
///
/// # Errors
/// Whatever is wrong with the arguments or the model.
pub fn command(arguments: &MapArguments) -> anyhow::Result<Outcome> {
    let settings = arguments.settings()?;
    let work = Work::open(&settings, &arguments.out)?;
    let (rows_kept, journal) = (work.kept().len(), work.journal());
    ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed))
        .context("interrupts cannot be caught")?;
    let bar = ProgressBar::new(settings.points() as u64)
        .with_position((rows_kept * settings.columns()) as u64);
    if let Ok(style) =
        ProgressStyle::with_template("{wide_bar} {pos}/{len} runs, {per_sec}, {eta} left")
    {
        bar.set_style(style);
    }
    let begun = Instant::now();
    let finished = work.run(&INTERRUPTED, arguments.threads, &|| bar.inc(1))?;
    let wall_time = begun.elapsed().as_secs_f64();
    bar.finish_and_clear();
    let Finished::Complete(rows) = finished else {
        eprintln!(
            "interrupted; the finished rows are kept in {}: the same command goes on from there",
            journal.display()
        );
        return Ok(Outcome::Interrupted);
    };
    let runs = settings.points() - rows_kept * settings.columns();
    println!(
        "{runs} runs of {} s in {wall_time:.2} s, {rows_kept} rows kept from before",
        settings.duration
    );
    for motion in Motion::ALL {
        let count = rows
            .iter()
            .flatten()
            .filter(|point| point.motion == Some(motion))
            .count();
        println!("{:12} {count}", motion.name());
    }
    println!(
        "written      {} and map.svg, map.png",
        arguments.out.join("map.csv").display()
    );
    let failed = rows
        .iter()
        .flatten()
        .filter(|point| point.motion.is_none())
        .count();
    if failed > 0 {
        eprintln!(
            "{failed} runs failed; in map.csv their motion is `failed`. The first: {}",
            settings.first_failure(&rows)
        );
        return Ok(Outcome::CheckFailed);
    }
    Ok(Outcome::Done)
}
