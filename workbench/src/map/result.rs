//! The tables of a map.

use std::fmt::Write as _;
use std::path::Path;

use super::point::Point;
use super::settings::Settings;
use crate::analysis::motion::Motion;
use crate::files::atomic::{self, WriteError};

/// Writes `map.csv`, one line per run, and for one parameter `extrema.csv`, one line per local extremum.
pub(super) fn write(
    settings: &Settings,
    rows: &[Vec<Point>],
    directory: &Path,
) -> Result<(), WriteError> {
    atomic::write_file(&directory.join("map.csv"), table(settings, rows).as_bytes())?;
    if settings.column_axis().is_none() {
        atomic::write_file(
            &directory.join("extrema.csv"),
            extrema(settings, rows).as_bytes(),
        )?;
    }
    Ok(())
}

fn table(settings: &Settings, rows: &[Vec<Point>]) -> String {
    let mut text = String::new();
    if let Some(axis) = settings.column_axis() {
        text.push_str(axis.quantity.name());
        text.push(',');
    }
    let _ = writeln!(text, "{},{MEASURES}", settings.row_axis().quantity.name());
    for (points, upward) in rows.iter().zip(&settings.row_axis().values) {
        for (column, point) in points.iter().enumerate() {
            if let Some(axis) = settings.column_axis() {
                let _ = write!(text, "{:?},", axis.values[column]);
            }
            let _ = writeln!(text, "{upward:?},{}", measures(point));
        }
    }
    text
}

/// Names of a run's columns.
pub(crate) const MEASURES: &str =
    "motion,velocity_minimum,velocity_maximum,half_amplitude,frequency,stick_fraction,switches";

/// A run's columns, named by [`MEASURES`].
pub(crate) fn measures(point: &Point) -> String {
    format!(
        "{},{},{},{},{},{},{}",
        motion_name(point),
        number(point.minimum),
        number(point.maximum),
        number(point.half_amplitude()),
        number(point.frequency),
        number(point.stick_fraction),
        point.switches
    )
}

/// Name of a run's motion.
pub(crate) fn motion_name(point: &Point) -> &'static str {
    point.motion.map_or("failed", Motion::name)
}

fn extrema(settings: &Settings, rows: &[Vec<Point>]) -> String {
    let mut text = format!(
        "{},velocity_extremum\n",
        settings.row_axis().quantity.name()
    );
    for (points, value) in rows.iter().zip(&settings.row_axis().values) {
        for extremum in points.iter().flat_map(|point| &point.extrema) {
            let _ = writeln!(text, "{value:?},{extremum:?}");
        }
    }
    text
}

/// A number, or nothing where there is none.
pub(crate) fn number(value: f64) -> String {
    if value.is_finite() {
        format!("{value:?}")
    } else {
        String::new()
    }
}
