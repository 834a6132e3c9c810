//! `stickslip ensemble`: a rig whose parameters are drawn from their uncertainties, run at every speed and normal force.

mod arguments;
mod bands;
mod picture;
mod result;
mod settings;
mod uncertain;
mod work;

pub use arguments::EnsembleArguments;
pub use bands::{Bands, LEVELS, MEASURES, at_places};
pub use result::{Column, columns};
pub use settings::{Conditions, EnsembleError, Settings};
pub use uncertain::Uncertain;
pub use work::Work;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};

use crate::analysis::motion::Motion;
use crate::cli::Outcome;
use crate::map::{Finished, Point};

/// Set by the first interrupt; the rigs at work are then given up and the finished ones kept.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Runs the subcommand: writes `ensemble.csv`, `runs.csv`, `rigs.csv`, `ensemble.svg` and `ensemble.png`.
///
/// # Errors
/// Whatever is wrong with the arguments or the model.
pub fn command(arguments: &EnsembleArguments) -> anyhow::Result<Outcome> {
    let settings = arguments.settings()?;
    let work = Work::open(&settings, &arguments.out)?;
    let (kept, journal) = (work.kept().len(), work.journal());
    ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed))
        .context("interrupts cannot be caught")?;
    let places = settings.places();
    let bar =
        ProgressBar::new((settings.runs() * places) as u64).with_position((kept * places) as u64);
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
            "interrupted; the finished rigs are kept in {}: the same command goes on from there",
            journal.display()
        );
        return Ok(Outcome::Interrupted);
    };
    let runs = (settings.runs() - kept) * places;
    println!(
        "{runs} runs of {} s in {wall_time:.2} s, {kept} rigs kept from before",
        settings.duration()
    );
    say(&settings, &rows);
    println!(
        "written      {} and runs.csv, rigs.csv, ensemble.svg, ensemble.png",
        arguments.out.join("ensemble.csv").display()
    );
    let failed = rows.iter().flatten().filter(|point| point.motion.is_none());
    let failed = failed.count();
    if failed > 0 {
        eprintln!(
            "{failed} runs failed; they count for no probability. The first: {}",
            settings.first_failure(&rows)
        );
        return Ok(Outcome::CheckFailed);
    }
    Ok(Outcome::Done)
}

/// Says what was drawn and how often each kind of motion was met over all places.
fn say(settings: &Settings, rows: &[Vec<Point>]) {
    let drawn: Vec<String> = settings
        .parameters
        .iter()
        .map(|one| format!("{} {} %", one.name, 100.0 * one.relative))
        .collect();
    println!("drawn        {}", drawn.join(", "));
    if settings.refused > 0 {
        println!(
            "refused      {} rigs whose parameters contradict each other; others were drawn for them",
            settings.refused
        );
    }
    let count = rows.iter().flatten().count() as f64;
    for motion in Motion::ALL {
        let met = rows.iter().flatten();
        let met = met.filter(|point| point.motion == Some(motion)).count();
        println!("{:12} {:.1} %", motion.name(), 100.0 * met as f64 / count);
    }
}
