//! Kinds of motion over speed and normal force, without and with controllers.

use std::fmt::Write as _;
use std::fs;

use build_fmu::explain::explain;
use indicatif::{ProgressBar, ProgressStyle};

use super::arguments::ClosedLoopArguments;
use super::run::{Case, Conditions, run};
use super::{INTERRUPTED, picture};
use crate::analysis::motion::Motion;
use crate::cli::Outcome;
use crate::files::atomic;
use crate::map::{Finished, Journal, Point, run_rows};

/// Writes `map.csv`, `map.svg` and `map.png`.
pub(super) fn command(arguments: &ClosedLoopArguments) -> anyhow::Result<Outcome> {
    let (cases, speeds) = (arguments.cases(), arguments.speed_rpm.values());
    let forces = arguments.normal_force.values();
    let conditions = |row: usize, column: usize| Conditions {
        speed_rpm: speeds[column],
        normal_force: forces[row % forces.len()],
        normal_force_1: arguments.normal_force_1,
        step: arguments.communication_step[0],
        duration: arguments.duration,
    };
    let one = |row: usize, column: usize| {
        let case = &cases[row / forces.len()];
        run(&arguments.rig, case, &conditions(row, column), &INTERRUPTED)
    };
    // A first run of each case shows what is wrong with the files before the many begin.
    for case in &cases {
        let brief = Conditions {
            duration: arguments.communication_step[0],
            ..conditions(0, 0)
        };
        run(&arguments.rig, case, &brief, &INTERRUPTED)?;
    }
    let shape = (cases.len() * forces.len(), speeds.len());
    let (journal, kept) = Journal::open(
        &arguments.out.join("map.journal"),
        &identity(arguments)?,
        "a map with other settings",
        shape,
    )?;
    let bar = ProgressBar::new((shape.0 * shape.1) as u64)
        .with_position((kept.len() * speeds.len()) as u64);
    if let Ok(style) =
        ProgressStyle::with_template("{wide_bar} {pos}/{len} runs, {per_sec}, {eta} left")
    {
        bar.set_style(style);
    }
    let finished = run_rows(
        shape,
        &|row, column| one(row, column).map_or_else(|_| Point::failed(), |samples| samples.point()),
        kept,
        &journal,
        &INTERRUPTED,
        arguments.threads,
        &|| bar.inc(1),
    )?;
    bar.finish_and_clear();
    let Finished::Complete(rows) = finished else {
        eprintln!(
            "interrupted; the finished rows are kept in {}: the same command goes on from there",
            journal.path().display()
        );
        return Ok(Outcome::Interrupted);
    };
    let maps: Vec<&[Vec<Point>]> = rows.chunks(forces.len()).collect();
    let table = table(&cases, &speeds, &forces, &maps);
    atomic::write_file(&arguments.out.join("map.csv"), table.as_bytes())?;
    picture::maps(&cases, &speeds, &forces, &maps).write(&arguments.out.join("map"))?;
    journal.remove()?;
    for (case, map) in cases.iter().zip(&maps) {
        let counts: Vec<String> = Motion::ALL
            .into_iter()
            .map(|motion| {
                let points = map.iter().flatten();
                let count = points.filter(|point| point.motion == Some(motion)).count();
                format!("{} {count}", motion.name())
            })
            .collect();
        println!("{:20} {}", case.name(), counts.join(", "));
    }
    println!(
        "written              {}",
        arguments.out.join("map.csv").display()
    );
    let failed = rows
        .iter()
        .enumerate()
        .flat_map(|(row, points)| {
            points
                .iter()
                .enumerate()
                .map(move |(column, p)| (row, column, p))
        })
        .find(|(_, _, point)| point.motion.is_none());
    if let Some((row, column, _)) = failed {
        let reason = one(row, column).err().map(|error| explain(error.as_ref()));
        eprintln!(
            "runs failed; in map.csv their motion is `failed`. The first: {}",
            reason.unwrap_or_default()
        );
        return Ok(Outcome::CheckFailed);
    }
    Ok(Outcome::Done)
}

/// What makes two maps the same: all settings and the models.
fn identity(arguments: &ClosedLoopArguments) -> anyhow::Result<String> {
    let mut text = format!(
        "closed loop, version {}; {:?}; {:?}; {:?}; step {:?}; duration {:?}",
        env!("CARGO_PKG_VERSION"),
        arguments.speed_rpm,
        arguments.normal_force,
        arguments.normal_force_1,
        arguments.communication_step,
        arguments.duration
    );
    for path in std::iter::once(&arguments.rig).chain(&arguments.controller) {
        // An FMU's bytes are no text; its sum of bytes with its length tells it well enough apart.
        let bytes = fs::read(path)?;
        let sum = bytes.iter().fold(0_u64, |sum, byte| {
            (sum ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        let _ = write!(text, "; {} {} {sum:x}", path.display(), bytes.len());
    }
    Ok(text)
}

fn table(cases: &[Case], speeds: &[f64], forces: &[f64], maps: &[&[Vec<Point>]]) -> String {
    let mut text = String::from(
        "drive,speed_rpm,normal_force,motion,velocity_minimum,velocity_maximum,half_amplitude,stick_fraction\n",
    );
    for (case, map) in cases.iter().zip(maps) {
        for (points, force) in map.iter().zip(forces) {
            for (point, speed) in points.iter().zip(speeds) {
                let _ = writeln!(
                    text,
                    "{},{speed:?},{force:?},{},{:?},{:?},{:?},{:?}",
                    case.name(),
                    point.motion.map_or("failed", Motion::name),
                    point.minimum,
                    point.maximum,
                    point.half_amplitude(),
                    point.stick_fraction
                );
            }
        }
    }
    text
}
