//! `stickslip ensemble`: a rig whose parameters are drawn from their uncertainties, run at every speed and normal force.

mod arguments;
mod bands;
mod picture;
mod result;
mod settings;
mod uncertain;

pub use arguments::EnsembleArguments;
pub use bands::{Bands, LEVELS, MEASURES, at_places};
pub use result::{Column, columns};
pub use settings::{Conditions, EnsembleError, Settings};
pub use uncertain::Uncertain;

use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;

use crate::analysis::motion::Motion;
use crate::map::{Point, judge, make};
use crate::outcome::Outcome;

/// Set by the first interrupt; the rigs at work are then given up and the finished ones kept.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Runs the subcommand: writes the tables `ensemble`, `runs` and `rigs`, `ensemble.svg` and `ensemble.png`.
///
/// # Errors
/// Whatever is wrong with the arguments or the model.
pub fn command(arguments: &EnsembleArguments) -> anyhow::Result<Outcome> {
    let (settings, common) = (arguments.settings()?, &arguments.common);
    ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed))
        .context("interrupts cannot be caught")?;
    let made = make(&settings, &common.out, &INTERRUPTED, common.threads)?;
    let Some(made) = made else {
        return Ok(Outcome::Interrupted);
    };
    println!(
        "{} runs of {} s in {:.2} s, {} rigs kept from before",
        (settings.runs() - made.kept) * settings.places(),
        settings.duration(),
        made.wall_time,
        made.kept
    );
    say(&settings, &made.rows);
    let [first, runs, rigs] =
        ["ensemble", "runs", "rigs"].map(|stem| settings.tables.file_name(stem));
    println!(
        "written      {} and {runs}, {rigs}, ensemble.svg, ensemble.png",
        common.out.join(first).display()
    );
    Ok(judge(&settings, &made.rows))
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
