//! Rigs whose parameters are drawn from their uncertainties.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use pyo3::prelude::*;
use workbench::analysis::motion::Motion;
use workbench::ensemble::{Column, Conditions, Settings, Uncertain, at_places, columns};
use workbench::map::{Finished, Point, Span, Study, Work};

use crate::arrays::bytes;
use crate::errors::any_error;
use crate::job::{Job, Value, Watch, value};
use crate::rig::Rig;

/// Speed and normal force N2 as texts, and normal force N1.
type Spans = (String, String, Option<f64>);

/// Names to draw, and uncertainties by name.
type Drawn = (Vec<String>, Vec<(String, f64)>);

/// Makes the ensemble in the directory `out`, or goes on with it; comes to the rigs whose runs are finished. `number` is how many
/// rigs are drawn and the seed, `lengths` the length of each run [s] and the tolerance.
#[pyfunction]
pub fn ensemble(
    rig: &Rig,
    spans: Spans,
    number: (usize, u64),
    drawn: Drawn,
    lengths: (f64, f64),
    threads: Option<usize>,
    out: PathBuf,
) -> PyResult<Job> {
    let settings =
        settings(rig, &spans, number, drawn, lengths).map_err(|error| any_error(&error))?;
    let threads = threads.and_then(NonZeroUsize::new);
    Job::start(move |watch| run(&settings, &out, threads, watch))
}

fn settings(
    rig: &Rig,
    (speed_rpm, normal_force, normal_force_1): &Spans,
    number: (usize, u64),
    (draw, uncertain): Drawn,
    (duration, tolerance): (f64, f64),
) -> anyhow::Result<Settings> {
    let span = |name: &'static str, text: &str| -> anyhow::Result<Span> {
        let span = text.parse().map_err(|error: String| anyhow!(error));
        span.with_context(|| name)
    };
    let conditions = Conditions {
        speed_rpm: span("speed_rpm", speed_rpm)?,
        normal_force: span("normal_force", normal_force)?,
        normal_force_1: *normal_force_1,
        duration,
        tolerance,
    };
    let given: Vec<Uncertain> = uncertain
        .into_iter()
        .map(|(name, relative)| Uncertain { name, relative })
        .collect();
    let parameters = (&draw[..], &given[..]);
    Ok(Settings::new(
        &rig.text,
        &rig.name,
        &conditions,
        number,
        parameters,
    )?)
}

fn run(
    settings: &Settings,
    out: &Path,
    threads: Option<NonZeroUsize>,
    watch: &Watch,
) -> anyhow::Result<Value> {
    let work = Work::open(settings, out)?;
    let places = settings.places();
    watch.set_total(settings.runs() * places);
    watch.set_done(work.kept().len() * places);
    let finished = work.run(watch.stop_flag(), threads, &|| watch.add_done())?;
    let (is_complete, rows) = match finished {
        Finished::Complete(rows) => (true, rows.into_iter().enumerate().collect()),
        Finished::Interrupted => (false, Work::open(settings, out)?.kept().clone()),
    };
    let (rigs, rows): (Vec<usize>, Vec<Vec<Point>>) = rows.into_iter().unzip();
    let failure = (is_complete && rows.iter().flatten().any(|point| point.motion.is_none()))
        .then(|| settings.first_failure(&rows));
    let bands = columns(settings, &at_places(&rows, places));
    let motion: Vec<&str> = rows
        .iter()
        .flatten()
        .map(|point| point.motion.map_or("failed", Motion::name))
        .collect();
    let (runs, rigs) = (of_runs(settings, &rigs, &rows), of_rigs(settings, &rigs));
    Ok(value(move |py| {
        let tables = [bands, runs, rigs].map(|columns| {
            let columns = columns.into_iter();
            columns
                .map(|(name, values)| (name, bytes(py, &values)))
                .collect::<Vec<_>>()
        });
        let all = (tables.to_vec(), motion, is_complete, failure);
        Ok(all.into_pyobject(py)?.into_any().unbind())
    }))
}

/// The numbers of every run.
fn of_runs(settings: &Settings, rigs: &[usize], rows: &[Vec<Point>]) -> Vec<Column> {
    let mut columns: Vec<Column> = Vec::new();
    let mut add = |name: &str, number: &dyn Fn(usize, usize, &Point) -> f64| {
        let mut values = Vec::new();
        for (rig, points) in rigs.iter().zip(rows) {
            let points = points.iter().enumerate();
            values.extend(points.map(|(place, point)| number(*rig, place, point)));
        }
        columns.push((name.to_owned(), values));
    };
    add("rig", &|rig, _, _| (rig + 1) as f64);
    add("speed_rpm", &|_, place, _| settings.place(place).0);
    add("normal_force", &|_, place, _| settings.place(place).1);
    add("velocity_minimum", &|_, _, point| point.minimum);
    add("velocity_maximum", &|_, _, point| point.maximum);
    add("half_amplitude", &|_, _, point| point.half_amplitude());
    add("frequency", &|_, _, point| point.frequency);
    add("stick_fraction", &|_, _, point| point.stick_fraction);
    add("switches", &|_, _, point| point.switches as f64);
    columns
}

/// The parameters of every rig.
fn of_rigs(settings: &Settings, rigs: &[usize]) -> Vec<Column> {
    let number = rigs.iter().map(|rig| (rig + 1) as f64).collect();
    let mut columns: Vec<Column> = vec![("rig".to_owned(), number)];
    for (at, parameter) in settings.parameters.iter().enumerate() {
        let values = rigs.iter().map(|rig| settings.sample(*rig)[at]).collect();
        columns.push((parameter.name.clone(), values));
    }
    columns
}
