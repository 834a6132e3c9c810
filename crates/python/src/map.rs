//! Kinds of motion over one or two quantities.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use anyhow::{Context, anyhow};
use pyo3::prelude::*;
use workbench::analysis::motion::Motion;
use workbench::map::{Finished, Point, Quantity, Settings, Span, Study, Work};

use crate::arrays::bytes;
use crate::errors::any_error;
use crate::job::{Job, Value, Watch, value};
use crate::rig::Rig;

/// The spans of a map as texts: speed, normal forces N2 and N1, and further parameters by name.
type Spans = (String, String, Option<String>, Vec<(String, String)>);

/// A number of a point.
type Number = fn(&Point) -> f64;

/// Makes the map in the directory `out`, or goes on with it; comes to the rows that are finished.
#[pyfunction]
pub fn map(
    rig: &Rig,
    spans: Spans,
    duration: f64,
    tolerance: f64,
    threads: Option<usize>,
    out: PathBuf,
) -> PyResult<Job> {
    let settings = settings(rig, &spans, duration, tolerance).map_err(|error| any_error(&error))?;
    let threads = threads.and_then(NonZeroUsize::new);
    Job::start(move |watch| run(&settings, &out, threads, watch))
}

fn settings(
    rig: &Rig,
    (speed_rpm, normal_force, normal_force_1, varied): &Spans,
    duration: f64,
    tolerance: f64,
) -> anyhow::Result<Settings> {
    let mut spans = vec![
        (Quantity::SpeedRpm, speed_rpm),
        (Quantity::NormalForce, normal_force),
    ];
    spans.extend(
        normal_force_1
            .iter()
            .map(|span| (Quantity::NormalForce1, span)),
    );
    let varied = varied.iter();
    spans.extend(varied.map(|(name, span)| (Quantity::Parameter(name.clone()), span)));
    let spans: Vec<(Quantity, Span)> = spans
        .into_iter()
        .map(|(quantity, text)| {
            let span = text.parse().map_err(|error: String| anyhow!(error));
            let span = span.with_context(|| quantity.name().to_owned())?;
            Ok((quantity, span))
        })
        .collect::<anyhow::Result<_>>()?;
    Ok(Settings::new(
        &rig.text, &rig.name, &spans, duration, tolerance,
    )?)
}

fn run(
    settings: &Settings,
    out: &std::path::Path,
    threads: Option<NonZeroUsize>,
    watch: &Watch,
) -> anyhow::Result<Value> {
    let work = Work::open(settings, out)?;
    watch.set_total(settings.points());
    watch.set_done(work.kept().len() * settings.columns());
    let finished = work.run(watch.stop_flag(), threads, &|| watch.add_done())?;
    let (is_complete, rows) = match finished {
        Finished::Complete(rows) => (true, rows.into_iter().enumerate().collect()),
        Finished::Interrupted => (false, Work::open(settings, out)?.kept().clone()),
    };
    let mut places = Vec::new();
    let mut points: Vec<Point> = Vec::new();
    for (row, finished) in rows {
        places.extend((0..finished.len()).map(|column| (row, column)));
        points.extend(finished);
    }
    let failure = (points.iter().any(|point| point.motion.is_none()) && is_complete)
        .then(|| first_failure(settings, &places, &points));
    let axes = [settings.column_axis(), Some(settings.row_axis())];
    let axes: Vec<(String, Vec<f64>)> = axes
        .into_iter()
        .flatten()
        .map(|axis| (axis.quantity.name().to_owned(), axis.values.clone()))
        .collect();
    Ok(rows_by_columns(axes, places, points, is_complete, failure))
}

/// Why the first of the failed runs failed.
fn first_failure(settings: &Settings, places: &[(usize, usize)], points: &[Point]) -> String {
    let mut rows = vec![Vec::new(); settings.rows()];
    for ((row, _), point) in places.iter().zip(points) {
        rows[*row].push(point.clone());
    }
    settings.first_failure(&rows)
}

fn rows_by_columns(
    axes: Vec<(String, Vec<f64>)>,
    places: Vec<(usize, usize)>,
    points: Vec<Point>,
    is_complete: bool,
    failure: Option<String>,
) -> Value {
    value(move |py| {
        let has_columns = axes.len() == 2;
        let mut columns = Vec::new();
        for (at, (name, values)) in axes.iter().enumerate() {
            let is_row = !has_columns || at == 1;
            let own: Vec<f64> = places
                .iter()
                .map(|(row, column)| values[if is_row { *row } else { *column }])
                .collect();
            columns.push((name.clone(), bytes(py, &own)));
        }
        let numbers: [(&str, Number); 6] = [
            ("velocity_minimum", |point| point.minimum),
            ("velocity_maximum", |point| point.maximum),
            ("half_amplitude", Point::half_amplitude),
            ("frequency", |point| point.frequency),
            ("stick_fraction", |point| point.stick_fraction),
            ("switches", |point| point.switches as f64),
        ];
        for (name, number) in numbers {
            let own: Vec<f64> = points.iter().map(number).collect();
            columns.push((name.to_owned(), bytes(py, &own)));
        }
        let motion: Vec<&str> = points
            .iter()
            .map(|point| point.motion.map_or("failed", Motion::name))
            .collect();
        let extrema: Vec<_> = points
            .iter()
            .map(|point| bytes(py, &point.extrema))
            .collect();
        let all = (columns, motion, extrema, is_complete, failure);
        Ok(all.into_pyobject(py)?.into_any().unbind())
    })
}
