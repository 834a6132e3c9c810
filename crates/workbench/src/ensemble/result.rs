//! The tables of an ensemble.

use std::path::Path;

use super::bands::{Bands, LEVELS, MEASURES};
use super::settings::Settings;
use crate::analysis::motion::Motion;
use crate::files::atomic::WriteError;
use crate::files::table::Table;
use crate::map::Point;
use crate::map::result::with_measures;

/// Writes the tables `ensemble`, a line for each place, `runs`, a line for each run, and `rigs`, a line for each rig.
pub(super) fn write(
    settings: &Settings,
    rows: &[Vec<Point>],
    bands: &[Bands],
    directory: &Path,
) -> Result<(), WriteError> {
    let format = settings.tables;
    rigs(settings).write(directory, "rigs", format)?;
    runs(settings, rows).write(directory, "runs", format)?;
    table(settings, bands).write(directory, "ensemble", format)
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

fn table(settings: &Settings, bands: &[Bands]) -> Table {
    let columns = columns(settings, bands).into_iter();
    columns.fold(Table::new(bands.len()), |table, (name, values)| {
        if [RUNS, FAILED].contains(&name.as_str()) {
            table.whole(name, values.into_iter().map(|count| count as i64))
        } else {
            table.numbers(name, values.into_iter())
        }
    })
}

fn runs(settings: &Settings, rows: &[Vec<Point>]) -> Table {
    let places = settings.places();
    let place = |run: usize| settings.place(run % places);
    let count = rows.len() * places;
    let table = Table::new(count)
        .whole("rig", (0..count).map(|run| (run / places + 1) as i64))
        .numbers("speed_rpm", (0..count).map(|run| place(run).0))
        .numbers("normal_force", (0..count).map(|run| place(run).1));
    with_measures(table, rows)
}

fn rigs(settings: &Settings) -> Table {
    let count = settings.runs();
    let numbered = Table::new(count).whole("rig", (0..count).map(|run| run as i64 + 1));
    let parameters = settings.parameters.iter().enumerate();
    parameters.fold(numbered, |table, (at, parameter)| {
        let values = (0..count).map(|run| settings.sample(run)[at]);
        table.numbers(parameter.name.clone(), values)
    })
}
