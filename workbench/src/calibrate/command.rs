//! `stickslip calibrate`.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use stickslip::plant::{ModelFile, Provenance};

use super::search::{Calibration, search};
use super::target::Target;
use crate::cli::Outcome;
use crate::experiment::Table;
use crate::files::atomic::write_file;

/// Arguments of `calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateArguments {
    /// The model file whose parameters are sought.
    #[arg(long)]
    model: PathBuf,
    /// The target file: facts with their bars, parameters with their ranges.
    #[arg(long)]
    target: PathBuf,
    /// Directory for `model.toml` (the best set), `ensemble.csv` (all sets that meet the bars) and `calibration.json`.
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
    let settings = target.search;
    let bar = ProgressBar::new((settings.starts * settings.generations) as u64);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {bar:30} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    let calibration = search(&model.rig, &target, |start, _, met| {
        bar.inc(1);
        bar.set_message(format!(
            "start {}: {met} of {} sets meet every bar",
            start + 1,
            settings.population
        ));
    });
    bar.finish_and_clear();
    let place = arguments.target.display().to_string();
    write_results(arguments, &model, &target, &calibration, &place)?;
    print!("{}", summary(&target, &calibration));
    Ok(if calibration.ensemble.is_empty() {
        Outcome::CheckFailed
    } else {
        Outcome::Done
    })
}

fn write_results(
    arguments: &CalibrateArguments,
    model: &ModelFile,
    target: &Target,
    calibration: &Calibration,
    source: &str,
) -> anyhow::Result<()> {
    let mut amended = model.clone();
    let ranges = calibration.ranges();
    for (index, sought) in target.parameter.iter().enumerate() {
        amended
            .rig
            .set_parameter(&sought.name, calibration.best.values[index])?;
        let (low, high) = ranges[index];
        let range = if calibration.ensemble.is_empty() {
            "no set meets every bar".to_owned()
        } else {
            format!("equally good from {low:.4} to {high:.4}, together with the others")
        };
        amended.provenance.insert(
            sought.name.clone(),
            Provenance {
                source: Some(format!("calibrated to {source}: {range}")),
                status: Some("calibrated".to_owned()),
                ..Provenance::default()
            },
        );
    }
    let out = &arguments.out;
    write_file(&out.join("model.toml"), amended.to_toml().as_bytes())?;
    write_file(
        &out.join("ensemble.csv"),
        ensemble_table(target, calibration).to_csv().as_bytes(),
    )?;
    let cycles: Vec<_> = target
        .point
        .iter()
        .zip(&calibration.best.judgement.cycles)
        .map(|(point, cycle)| {
            json!({
                "speed_rpm": point.speed_rpm,
                "normal_force": point.normal_force,
                "frequency_hz": cycle.as_ref().and_then(|cycle| cycle.frequency),
                "minimum_velocity": cycle.as_ref().map(|cycle| cycle.minimum),
                "maximum_velocity": cycle.as_ref().map(|cycle| cycle.maximum),
                "stick_fraction": cycle.as_ref().map(|cycle| cycle.stick_fraction),
                "loop_margin": cycle.as_ref().map(|cycle| cycle.loop_margin),
                "branch_jumps": cycle.as_ref().map(|cycle| cycle.branch_jumps),
            })
        })
        .collect();
    let parameters: Vec<_> = target
        .parameter
        .iter()
        .enumerate()
        .map(|(index, sought)| {
            let range =
                (!calibration.ensemble.is_empty()).then(|| [ranges[index].0, ranges[index].1]);
            json!({ "name": sought.name, "best": calibration.best.values[index], "range": range })
        })
        .collect();
    let report = json!({
        "target": target,
        "parameters": parameters,
        "best_meets_every_bar": calibration.best.judgement.excess() == 0.0,
        "best_distance": calibration.best.judgement.distance(),
        "best_cycles": cycles,
        "sets_that_meet_every_bar": calibration.ensemble.len(),
        "evaluations": calibration.evaluations,
    });
    write_file(
        &out.join("calibration.json"),
        serde_json::to_string_pretty(&report)?.as_bytes(),
    )?;
    Ok(())
}

fn ensemble_table(target: &Target, calibration: &Calibration) -> Table {
    let mut columns: Vec<(String, Vec<f64>)> = target
        .parameter
        .iter()
        .enumerate()
        .map(|(index, sought)| {
            let values = calibration
                .ensemble
                .iter()
                .map(|solution| solution.values[index]);
            (sought.name.clone(), values.collect())
        })
        .collect();
    let margins = calibration
        .ensemble
        .iter()
        .map(|solution| solution.judgement.loop_margin());
    columns.push(("loop_margin".to_owned(), margins.collect()));
    for (index, point) in target.point.iter().enumerate() {
        let label = format!("{} rpm {} N", point.speed_rpm, point.normal_force);
        let cycles = || {
            calibration
                .ensemble
                .iter()
                .map(|solution| solution.judgement.cycles[index])
        };
        let column = |read: fn(&super::cycle::Cycle) -> f64| -> Vec<f64> {
            cycles()
                .map(|cycle| cycle.as_ref().map_or(f64::NAN, read))
                .collect()
        };
        columns.push((
            format!("{label}: frequency_hz"),
            column(|cycle| cycle.frequency.unwrap_or(f64::NAN)),
        ));
        columns.push((
            format!("{label}: minimum_velocity"),
            column(|cycle| cycle.minimum),
        ));
        columns.push((
            format!("{label}: maximum_velocity"),
            column(|cycle| cycle.maximum),
        ));
        columns.push((
            format!("{label}: stick_fraction"),
            column(|cycle| cycle.stick_fraction),
        ));
    }
    Table {
        name: "ensemble".to_owned(),
        columns,
    }
}

fn summary(target: &Target, calibration: &Calibration) -> String {
    let mut text = String::new();
    let count = calibration.ensemble.len();
    let _ = writeln!(
        text,
        "{count} parameter sets meet every bar ({} were tried)",
        calibration.evaluations
    );
    for (index, sought) in target.parameter.iter().enumerate() {
        let best = calibration.best.values[index];
        let _ = match calibration.ranges().get(index) {
            Some((low, high)) if count > 0 => {
                writeln!(
                    text,
                    "  {:<34} {best:>10.5}   equally good {low:.5} … {high:.5}",
                    sought.name
                )
            }
            _ => writeln!(text, "  {:<34} {best:>10.5}", sought.name),
        };
    }
    for (point, cycle) in target.point.iter().zip(&calibration.best.judgement.cycles) {
        let _ = write!(
            text,
            "  best at {} rpm, {} N: ",
            point.speed_rpm, point.normal_force
        );
        let _ = match cycle {
            Some(cycle) => writeln!(
                text,
                "{} Hz, {:.3} … {:.3} rad/s, sticks {:.1} % of the time, loop margin {:.3}",
                cycle
                    .frequency
                    .map_or("no".to_owned(), |f| format!("{f:.4}")),
                cycle.minimum,
                cycle.maximum,
                100.0 * cycle.stick_fraction,
                cycle.loop_margin
            ),
            None => writeln!(text, "the run cannot go on"),
        };
    }
    text
}
