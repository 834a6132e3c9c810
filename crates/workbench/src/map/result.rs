//! The tables of a map.

use std::path::Path;

use super::point::Point;
use super::settings::Settings;
use crate::analysis::motion::Motion;
use crate::files::atomic::WriteError;
use crate::files::table::{Table, TableFormat};

/// Writes `map.csv`, one line per run, and for one parameter `extrema.csv`, one line per local extremum.
pub(super) fn write(
    settings: &Settings,
    rows: &[Vec<Point>],
    directory: &Path,
) -> Result<(), WriteError> {
    table(settings, rows).write(directory, "map", TableFormat::Csv)?;
    if settings.column_axis().is_none() {
        extrema(settings, rows).write(directory, "extrema", TableFormat::Csv)?;
    }
    Ok(())
}

fn table(settings: &Settings, rows: &[Vec<Point>]) -> Table {
    let (row, columns) = (settings.row_axis(), settings.columns());
    let count = rows.len() * columns;
    let mut table = Table::new(count);
    if let Some(axis) = settings.column_axis() {
        let across = (0..count).map(|run| axis.values[run % columns]);
        table = table.numbers(axis.quantity.name(), across);
    }
    let upward = (0..count).map(|run| row.values[run / columns]);
    with_measures(table.numbers(row.quantity.name(), upward), rows)
}

/// The table with the columns of what a run shows, for the runs of all rows one after the other.
pub(crate) fn with_measures(table: Table, rows: &[Vec<Point>]) -> Table {
    let of = |measure: fn(&Point) -> f64| rows.iter().flatten().map(measure);
    let points = || rows.iter().flatten();
    let motion = |point: &Point| point.motion.map_or("failed", Motion::name);
    table
        .words("motion", points().map(motion))
        .numbers("velocity_minimum", of(|point| point.minimum))
        .numbers("velocity_maximum", of(|point| point.maximum))
        .numbers("half_amplitude", of(Point::half_amplitude))
        .numbers("frequency", of(|point| point.frequency))
        .numbers("stick_fraction", of(|point| point.stick_fraction))
        .whole("switches", points().map(|point| point.switches as i64))
}

fn extrema(settings: &Settings, rows: &[Vec<Point>]) -> Table {
    let axis = settings.row_axis();
    let each = || {
        let rows = rows.iter().zip(&axis.values);
        rows.flat_map(|(points, value)| points.iter().map(move |point| (*value, point)))
            .flat_map(|(value, point)| point.extrema.iter().map(move |extremum| (value, *extremum)))
    };
    Table::new(each().count())
        .numbers(axis.quantity.name(), each().map(|(value, _)| value))
        .numbers("velocity_extremum", each().map(|(_, extremum)| extremum))
}
