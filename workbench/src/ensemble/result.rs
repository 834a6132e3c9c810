//! The tables of an ensemble.

use std::fmt::Write as _;
use std::path::Path;

use super::bands::{Bands, LEVELS, MEASURES};
use super::settings::Settings;
use crate::analysis::motion::Motion;
use crate::files::atomic::{self, WriteError};
use crate::map::Point;
use crate::map::result::{self, number};

/// Writes `ensemble.csv`, a line for each place, `runs.csv`, a line for each run, and `rigs.csv`, a line for each rig.
pub(super) fn write(
    settings: &Settings,
    rows: &[Vec<Point>],
    bands: &[Bands],
    directory: &Path,
) -> Result<(), WriteError> {
    let write = |name: &str, text: String| {
        atomic::write_file(&directory.join(name), text.as_bytes()).map(|_| ())
    };
    write("rigs.csv", rigs(settings))?;
    write("runs.csv", runs(settings, rows))?;
    write("ensemble.csv", table(settings, bands))
}

/// A column of the table of places, by name.
pub type Column = (String, Vec<f64>);

/// The columns of the table of places.
#[must_use]
pub fn columns(settings: &Settings, bands: &[Bands]) -> Vec<Column> {
    let mut columns: Vec<Column> = Vec::new();
    let mut add = |name: String, value: &dyn Fn(usize, &Bands) -> f64| {
        let values = bands.iter().enumerate();
        columns.push((name, values.map(|(place, one)| value(place, one)).collect()));
    };
    add("speed_rpm".to_owned(), &|place, _| settings.place(place).0);
    add("normal_force".to_owned(), &|place, _| {
        settings.place(place).1
    });
    add(RUNS.to_owned(), &|_, one| one.runs() as f64);
    add(FAILED.to_owned(), &|_, one| one.failed as f64);
    for motion in Motion::ALL {
        add(motion.name().to_owned(), &|_, one| {
            one.share(motion).value()
        });
    }
    for (end, name) in ["stick_slip_low", "stick_slip_high"]
        .into_iter()
        .enumerate()
    {
        add(name.to_owned(), &|_, one| {
            one.share(Motion::StickSlip).interval95()[end]
        });
    }
    for (measure, (name, _)) in MEASURES.into_iter().enumerate() {
        for (at, level) in LEVELS.into_iter().enumerate() {
            let percent = (100.0 * level).round();
            add(format!("{name}_p{percent:02}"), &|_, one| {
                one.band(measure)[at]
            });
        }
    }
    columns
}

/// Columns of whole numbers.
const RUNS: &str = "runs";
const FAILED: &str = "failed";

fn table(settings: &Settings, bands: &[Bands]) -> String {
    let columns = columns(settings, bands);
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    let mut text = format!("{}\n", names.join(","));
    for place in 0..bands.len() {
        let values: Vec<String> = columns
            .iter()
            .map(|(name, values)| match name.as_str() {
                RUNS | FAILED => format!("{}", values[place]),
                _ => number(values[place]),
            })
            .collect();
        let _ = writeln!(text, "{}", values.join(","));
    }
    text
}

fn runs(settings: &Settings, rows: &[Vec<Point>]) -> String {
    let mut text = format!("rig,speed_rpm,normal_force,{}\n", result::MEASURES);
    for (run, points) in rows.iter().enumerate() {
        for (place, point) in points.iter().enumerate() {
            let (speed, force) = settings.place(place);
            let _ = writeln!(
                text,
                "{},{speed:?},{force:?},{}",
                run + 1,
                result::measures(point)
            );
        }
    }
    text
}

fn rigs(settings: &Settings) -> String {
    let mut text = String::from("rig");
    for parameter in &settings.parameters {
        let _ = write!(text, ",{}", parameter.name);
    }
    text.push('\n');
    for run in 0..settings.runs() {
        let _ = write!(text, "{}", run + 1);
        for value in settings.sample(run) {
            let _ = write!(text, ",{value:?}");
        }
        text.push('\n');
    }
    text
}
