//! One run of a rig.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, ensure};
use pyo3::prelude::*;
use stickslip::plant::{Rig as Plant, RigState, STATES};
use workbench::component::{Component, Event, position};
use workbench::files::record::Record;
use workbench::simulate::{
    Derivatives, Drive, Schedule, Summary, derivatives, simulate_variables, state_names,
    usual_variables,
};

use crate::arrays::{Table, bytes, columns};
use crate::errors::any_error;
use crate::job::{Job, Value, Watch, value};
use crate::rig::Rig;

/// What drives a run.
#[derive(FromPyObject)]
pub enum Driven {
    /// Speed at the gearbox output [rpm] of the undisturbed rig, normal forces N2 and N1 [N].
    #[pyo3(transparent)]
    Held((f64, f64, Option<f64>)),
    /// Inputs over time.
    #[pyo3(transparent)]
    Table(Py<Table>),
    /// The same in a file.
    #[pyo3(transparent)]
    File(PathBuf),
}

/// A run that was asked for.
struct Order {
    plant: Plant<f64>,
    component: Box<dyn Component + Send>,
    drive: Drive,
    schedule: Schedule,
    start: Vec<(String, f64)>,
    shown: Vec<usize>,
    by: Vec<String>,
}

/// Runs a rig. `times` are the end of the run and the time between rows [s]; `start` gives states that are not zero,
/// `variables` the columns, if not the usual ones, and `by` the parameters by which the states are differentiated.
#[pyfunction]
pub fn simulate(
    py: Python<'_>,
    rig: &Rig,
    driven: Driven,
    times: (Option<f64>, f64),
    start: Vec<(String, f64)>,
    variables: Option<Vec<String>>,
    by: Vec<String>,
) -> PyResult<Job> {
    let order = order(py, rig, driven, times, variables).map_err(|error| any_error(&error))?;
    Job::start(move |watch| Order { start, by, ..order }.run(watch))
}

fn order(
    py: Python<'_>,
    rig: &Rig,
    driven: Driven,
    (stop, step): (Option<f64>, f64),
    variables: Option<Vec<String>>,
) -> anyhow::Result<Order> {
    let component = rig.component()?;
    let drive = match driven {
        Driven::Held((speed_rpm, normal_force, normal_force_1)) => {
            for (name, value) in [
                ("normal_force", Some(normal_force)),
                ("normal_force_1", normal_force_1),
            ] {
                ensure!(
                    value.is_none_or(|value| value.is_finite() && value >= 0.0),
                    "{name} = {}: a force of 0 N or more is needed",
                    value.unwrap_or_default()
                );
            }
            ensure!(
                speed_rpm.is_finite(),
                "speed_rpm = {speed_rpm}: a finite number is needed"
            );
            Drive::from_speed(
                &component,
                |_| None,
                speed_rpm,
                normal_force,
                normal_force_1,
            )?
        }
        Driven::Table(table) => Drive::from_record(&component, &table.bind(py).get().record)?,
        Driven::File(path) => Drive::from_record(&component, &Record::read(&path)?)?,
    };
    let begin = drive.start();
    if let Some(stop) = stop {
        ensure!(
            stop.is_finite() && stop > begin,
            "stop = {stop}: a time after the start of the run, {begin} s, is needed"
        );
    }
    let duration = stop.map(|stop| stop - begin).or(drive.duration());
    let schedule = Schedule::new(begin, duration.unwrap_or(60.0), step)?;
    let shown = match variables {
        Some(names) => names
            .iter()
            .map(|name| Ok(position(&component, name)?))
            .collect::<anyhow::Result<_>>()?,
        None => usual_variables(&component),
    };
    Ok(Order {
        plant: rig.model.rig,
        component: Box::new(component),
        drive,
        schedule,
        start: Vec::new(),
        shown,
        by: Vec::new(),
    })
}

impl Order {
    fn run(mut self, watch: &Watch) -> anyhow::Result<Value> {
        let rows = self.schedule.rows();
        let runs = 1 + usize::from(!self.by.is_empty());
        watch.set_total(rows * runs);
        let start = self.start_state()?;
        let component = self.component.as_mut();
        for (name, value) in &self.start {
            let at = position(component, name)?;
            component
                .set(&[(at, *value)])
                .with_context(|| format!("start {name} = {value}"))?;
        }
        let begun = Instant::now();
        let record = simulate_variables(
            component,
            &self.drive,
            &self.schedule,
            &self.shown,
            &mut |done| {
                watch.set_done(done);
                !watch.is_stopped()
            },
        )?;
        let (events, switches) = (component.take_events(), component.switches());
        // Of a run that was stopped, or whose columns were chosen, there may be none.
        let summary = (record.len() == rows)
            .then(|| Summary::new(&record, switches, begun.elapsed()).ok())
            .flatten();
        let mut derived = None;
        if !self.by.is_empty() && !watch.is_stopped() {
            let work = (&self.drive, &self.schedule);
            let mut asked = 0;
            derived = derivatives(&self.plant, component, &self.by, &start, work, &mut || {
                asked += 1;
                watch.set_done(rows + asked.min(rows));
                !watch.is_stopped()
            })?;
        }
        let description = self.drive.describe().to_owned();
        Ok(course(description, record, events, summary, derived))
    }

    /// The states at the start that were given, the others zero.
    fn start_state(&self) -> anyhow::Result<RigState<f64>> {
        let mut state = [0.0; STATES];
        let names: Vec<_> = state_names(self.plant.kind()).collect();
        for (name, value) in &self.start {
            let known = names.iter().find(|(own, _)| own == name);
            let (_, at) = known.with_context(|| {
                let all: Vec<&str> = names.iter().map(|(own, _)| *own).collect();
                format!(
                    "start: `{name}` is no state; the states are {}",
                    all.join(", ")
                )
            })?;
            ensure!(
                value.is_finite(),
                "start {name} = {value}: a finite number is needed"
            );
            state[*at] = *value;
        }
        Ok(state)
    }
}

fn course(
    description: String,
    record: Record,
    events: Vec<Event>,
    summary: Option<Summary>,
    derived: Option<Derivatives>,
) -> Value {
    value(move |py| {
        let events: Vec<(f64, String)> = events
            .into_iter()
            .map(|event| (event.time, event.what))
            .collect();
        let derived = derived.map(|derived| {
            let columns: Vec<_> = derived
                .columns
                .iter()
                .map(|column| bytes(py, column))
                .collect();
            (derived.names, columns, derived.interrupted)
        });
        let summary = summary.map(|summary| {
            (
                summary.motion.name(),
                summary.cycle.map(|cycle| cycle.frequency()),
                summary.velocity,
                summary.stick_fraction,
                summary.judged,
                summary.switches,
            )
        });
        let all = (description, columns(py, &record), events, summary, derived);
        Ok(all.into_pyobject(py)?.into_any().unbind())
    })
}
