//! `stickslip calibrate`.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use stickslip::plant::ModelFile;

use super::journal::Journal;
use super::search::{planned, search};
use super::target::Target;
use super::{picture, report};
use crate::outcome::Outcome;

/// Set by an interrupt; the generation at work is then given up.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Arguments of `calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateArguments {
    /// The model file whose parameters are sought.
    #[arg(long)]
    model: PathBuf,
    /// The target file: facts with their bars, parameters with their ranges.
    #[arg(long)]
    target: PathBuf,
    /// Directory for `model.toml` (the best set), `ensemble.csv` and its picture (all sets that meet the bars) and
    /// `calibration.json`. An interrupted search goes on from there with the same command.
    #[arg(long)]
    out: PathBuf,
}

/// Runs the subcommand; [`Outcome::CheckFailed`] where no parameter set meets all bars.
///
/// # Errors
/// Files that cannot be read or written.
pub fn run(arguments: &CalibrateArguments) -> anyhow::Result<Outcome> {
    let file = arguments.model.display().to_string();
    let text =
        std::fs::read_to_string(&arguments.model).with_context(|| format!("cannot read {file}"))?;
    let model = ModelFile::parse(&text, &file)?;
    let target = Target::read(&arguments.target, &model.rig)?;
    let identity = format!("{text}\n{}", serde_json::to_string(&target)?);
    let path = arguments.out.join("calibration.journal");
    let mut journal = Journal::open(&path, &identity)?;
    ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed))
        .context("interrupts cannot be caught")?;
    let kept = journal.kept();
    if kept > 0 {
        eprintln!(
            "{kept} sets judged before are taken from {}",
            path.display()
        );
    }
    let bar = ProgressBar::new(planned(&target) as u64);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {wide_bar} {pos}/{len} sets, {msg}")
    {
        bar.set_style(style);
    }
    let settings = target.search;
    let found = search(
        &model.rig,
        &target,
        &mut journal,
        &INTERRUPTED,
        |progress| {
            bar.set_position(progress.judged as u64);
            bar.set_message(format!(
                "start {} of {}: {} of {} meet every bar",
                progress.start + 1,
                settings.starts,
                progress.met,
                settings.population
            ));
        },
    )?;
    bar.finish_and_clear();
    let place = arguments.target.display().to_string();
    report::write(&arguments.out, &model, &target, &found, &place)?;
    picture::ensemble(&target, &found).write(&arguments.out.join("ensemble"))?;
    print!("{}", report::summary(&target, &found));
    if !found.complete {
        eprintln!(
            "interrupted; what was found by then is in {}: the same command goes on from there",
            arguments.out.display()
        );
        return Ok(Outcome::Interrupted);
    }
    journal.remove()?;
    Ok(if found.ensemble.is_empty() {
        Outcome::CheckFailed
    } else {
        Outcome::Done
    })
}
