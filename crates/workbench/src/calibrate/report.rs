//! What a calibration leaves: the best set as a model file, all sets that fit, and a summary.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value, json};
use stickslip::plant::{ModelFile, Provenance};

use super::cycle::Cycle;
use super::search::Calibration;
use super::target::Target;
use crate::analysis::measures::pearson_correlation;
use crate::experiment::Table;
use crate::files::atomic::write_file;

/// Correlation from which two parameters count as tied to each other.
const TIED: f64 = 0.7;

/// Reads a number off a cycle.
type ReadCycle = fn(&Cycle) -> f64;

/// Writes `model.toml`, `ensemble.csv` and `calibration.json` into `out`; `source` names the target in the model file.
///
/// # Errors
/// A file that cannot be written.
pub fn write(
    out: &Path,
    model: &ModelFile,
    target: &Target,
    found: &Calibration,
    source: &str,
) -> anyhow::Result<()> {
    let mut amended = model.clone();
    let ranges = found.ranges();
    for (index, sought) in target.parameter.iter().enumerate() {
        amended
            .rig
            .set_parameter(&sought.name, found.best.values[index])?;
        let (low, high) = ranges[index];
        let range = if found.ensemble.is_empty() {
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
    write_file(&out.join("model.toml"), amended.to_toml().as_bytes())?;
    let table = ensemble_table(target, found).to_csv();
    write_file(&out.join("ensemble.csv"), table.as_bytes())?;
    let json = serde_json::to_string_pretty(&summary_json(target, found))?;
    write_file(&out.join("calibration.json"), json.as_bytes())?;
    Ok(())
}

fn summary_json(target: &Target, found: &Calibration) -> Value {
    let ranges = found.ranges();
    let cycles: Vec<Value> = target
        .point
        .iter()
        .zip(&found.best.judgement.cycles)
        .map(|(point, cycle)| {
            json!({
                "speed_rpm": point.speed_rpm,
                "normal_force": point.normal_force,
                "normal_force_1": point.normal_force_1,
                "disc": point.disc,
                "frequency_hz": cycle.as_ref().and_then(|cycle| cycle.frequency),
                "minimum_velocity": cycle.as_ref().map(|cycle| cycle.minimum),
                "maximum_velocity": cycle.as_ref().map(|cycle| cycle.maximum),
                "stick_fraction": cycle.as_ref().map(|cycle| cycle.stick_fraction),
                "loop_margin": cycle.as_ref().map(|cycle| cycle.loop_margin),
                "branch_jumps": cycle.as_ref().map(|cycle| cycle.branch_jumps),
            })
        })
        .collect();
    let parameters: Vec<Value> = target
        .parameter
        .iter()
        .enumerate()
        .map(|(index, sought)| {
            let range = (!found.ensemble.is_empty()).then(|| [ranges[index].0, ranges[index].1]);
            json!({ "name": sought.name, "best": found.best.values[index], "range": range })
        })
        .collect();
    let tied: Vec<Value> = tied_parameters(found)
        .into_iter()
        .map(|(first, second, correlation)| {
            json!({
                "parameters": [target.parameter[first].name, target.parameter[second].name],
                "correlation": correlation,
            })
        })
        .collect();
    json!({
        "complete": found.complete,
        "target": target,
        "parameters": parameters,
        "tied_parameters": tied,
        "best_meets_every_bar": found.best.judgement.excess() == 0.0,
        "best_distance": found.best.judgement.distance(),
        "best_cycles": cycles,
        "best_transitions": found.best.judgement.transitions,
        "sets_that_meet_every_bar": found.ensemble.len(),
        "evaluations": found.evaluations,
    })
}

fn ensemble_table(target: &Target, found: &Calibration) -> Table {
    let column = |name: String, read: &dyn Fn(&super::search::Solution) -> f64| {
        (name, found.ensemble.iter().map(read).collect())
    };
    let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
    for (index, sought) in target.parameter.iter().enumerate() {
        columns.push(column(sought.name.clone(), &|set| set.values[index]));
    }
    columns.push(column("loop_margin".to_owned(), &|set| {
        set.judgement.loop_margin()
    }));
    let seen: [(&str, ReadCycle); 4] = [
        ("frequency_hz", |cycle| cycle.frequency.unwrap_or(f64::NAN)),
        ("minimum_velocity", |cycle| cycle.minimum),
        ("maximum_velocity", |cycle| cycle.maximum),
        ("stick_fraction", |cycle| cycle.stick_fraction),
    ];
    for (index, point) in target.point.iter().enumerate() {
        // A comma would split the column's name.
        let label = point.label().replace(',', "");
        for (name, read) in seen {
            columns.push(column(format!("{label}: {name}"), &|set| {
                set.judgement.cycles[index].as_ref().map_or(f64::NAN, read)
            }));
        }
    }
    for (index, transition) in target.transition.iter().enumerate() {
        columns.push(column(transition.label(), &|set| {
            let seen = set.judgement.transitions.get(index);
            seen.and_then(|seen| seen.at).unwrap_or(f64::NAN)
        }));
    }
    Table {
        name: "ensemble".to_owned(),
        columns,
    }
}

/// Pairs of parameters (by index) whose values over the ensemble rise or fall together, with their correlation; strongest
/// first.
fn tied_parameters(found: &Calibration) -> Vec<(usize, usize, f64)> {
    let count = found.best.values.len();
    let series =
        |index: usize| -> Vec<f64> { found.ensemble.iter().map(|set| set.values[index]).collect() };
    let mut pairs = Vec::new();
    // Fewer sets than this tie everything to everything by chance.
    if found.ensemble.len() < 10 {
        return pairs;
    }
    for first in 0..count {
        for second in first + 1..count {
            let correlation = pearson_correlation(&series(first), &series(second));
            if correlation.abs() >= TIED {
                pairs.push((first, second, correlation));
            }
        }
    }
    pairs.sort_by(|left, right| right.2.abs().total_cmp(&left.2.abs()));
    pairs
}

/// The result on one screen.
#[must_use]
pub fn summary(target: &Target, found: &Calibration) -> String {
    let mut text = String::new();
    let count = found.ensemble.len();
    let _ = writeln!(
        text,
        "{count} parameter sets meet every bar ({} were tried)",
        found.evaluations
    );
    let ranges = found.ranges();
    for (index, sought) in target.parameter.iter().enumerate() {
        let _ = write!(
            text,
            "  {:<34} {:>10.5}",
            sought.name, found.best.values[index]
        );
        if count > 0 {
            let (low, high) = ranges[index];
            let _ = write!(text, "   equally good {low:.5} … {high:.5}");
        }
        text.push('\n');
    }
    for (first, second, correlation) in tied_parameters(found) {
        let _ = writeln!(
            text,
            "  {} and {} are tied to each other: correlation {correlation:+.2}",
            target.parameter[first].name, target.parameter[second].name
        );
    }
    for (point, cycle) in target.point.iter().zip(&found.best.judgement.cycles) {
        let _ = write!(text, "  best at {}: ", point.label());
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
    for (index, transition) in target.transition.iter().enumerate() {
        let places: Vec<f64> = found
            .ensemble
            .iter()
            .filter_map(|set| set.judgement.transitions.get(index)?.at)
            .collect();
        let best = found.best.judgement.transitions.get(index);
        let _ = write!(text, "  {}: ", transition.label());
        let _ = match best.and_then(|seen| seen.at) {
            Some(at) => write!(text, "at {at:.1}"),
            None => write!(text, "none"),
        };
        if let Some(low) = places.iter().copied().reduce(f64::min) {
            let high = places.iter().copied().fold(low, f64::max);
            let _ = write!(text, "; all sets {low:.1} … {high:.1}");
        }
        text.push('\n');
    }
    text
}
