//! Runs that follow the hand: a model with the numbers of the sliders, through a record or under held inputs.

use std::collections::BTreeMap;
use std::time::Instant;

use axum::body::Bytes;
use inference::record::CHANNELS;
use serde::Deserialize;
use serde_json::{Value, json};
use stickslip::plant::ModelFile;

use super::binary::Curves;
use super::error::StudioError;
use super::seen::{Seen, channels};
use super::session::Session;
use crate::component::{Component, Native};
use crate::diagnose::restart::{Starts, WindowCourse, best_starts, course, window_courses};
use crate::diagnose::show::{delay, first_state, root_mean_square};
use crate::files::record::Record;
use crate::simulate::{Drive, Schedule, Setting, Summary, apply_settings, simulate};

/// A run that the page asks for.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Order {
    /// Name of the model.
    model: String,
    /// Numbers set by hand, by dotted name.
    #[serde(default)]
    settings: BTreeMap<String, f64>,
    /// What the run goes through.
    drive: Driven,
}

/// What a run goes through.
#[derive(Debug, Deserialize)]
#[serde(tag = "by", rename_all = "snake_case", deny_unknown_fields)]
enum Driven {
    /// A record's inputs, from the measured state.
    Record {
        record: String,
        /// Whether it starts anew in every window.
        #[serde(default)]
        windows: bool,
        /// Whether windows start where the model fits best; where it was measured otherwise.
        #[serde(default)]
        best: bool,
    },
    /// A record's inputs from rest, as `stickslip simulate --inputs` runs them.
    Rest { record: String, step: f64 },
    /// Held inputs from rest, as `stickslip simulate --speed-rpm` runs them.
    Held {
        speed_rpm: f64,
        normal_force: f64,
        #[serde(default)]
        normal_force_1: Option<f64>,
        duration: f64,
        step: f64,
    },
}

/// Longest run of held inputs [rows].
const MOST_ROWS: usize = 1_000_000;

impl Session {
    /// Runs what the page asks for.
    ///
    /// # Errors
    /// A number is out of its range, or the model cannot run; the message says what would be right.
    pub fn simulate(&self, order: &Order) -> Result<Bytes, StudioError> {
        let text = self.model_text(&order.model)?;
        let begun = Instant::now();
        let answer = match &order.drive {
            Driven::Record {
                record,
                windows,
                best,
            } => {
                let seen = self.seen(record)?;
                if *windows {
                    restarted(&seen, &text, order, *best)
                } else {
                    free(&seen, &text, order)
                }
            }
            Driven::Rest { record, step } => {
                let seen = self.seen(record)?;
                from_rest(&text, order, *step, |component| {
                    Ok(Drive::from_record(
                        component,
                        &inputs_of(&seen, component)?,
                    )?)
                })
            }
            Driven::Held {
                speed_rpm,
                normal_force,
                normal_force_1,
                duration,
                step,
            } => {
                if duration / step > MOST_ROWS as f64 {
                    return Err(StudioError::Input(format!(
                        "{duration} s in steps of {step} s: at most {MOST_ROWS} rows are shown"
                    )));
                }
                held(
                    &text,
                    order,
                    (*speed_rpm, *normal_force, *normal_force_1),
                    (*duration, *step),
                )
            }
        };
        let (curves, mut header) = answer?;
        header["milliseconds"] = json!(1e3 * begun.elapsed().as_secs_f64());
        Ok(curves.answer(header))
    }
}

/// The model with the numbers set by hand, as it runs and as the engine has it.
fn component(text: &str, order: &Order) -> anyhow::Result<Native> {
    let mut component = Native::from_text(text, &order.model)?;
    let settings: Vec<Setting> = order
        .settings
        .iter()
        .map(|(name, value)| Setting {
            name: name.clone(),
            value: *value,
        })
        .collect();
    apply_settings(&mut component, &settings)?;
    Ok(component)
}

fn rig(text: &str, order: &Order) -> anyhow::Result<stickslip::plant::Rig<f64>> {
    let mut rig = ModelFile::parse(text, &order.model)?.rig;
    for (name, value) in &order.settings {
        rig.set_parameter(name, *value)?;
    }
    rig.check()?;
    Ok(rig)
}

/// One run over each stretch, from the measured state and never corrected.
fn free(seen: &Seen, text: &str, order: &Order) -> anyhow::Result<(Curves, Value)> {
    let mut component = component(text, order)?;
    rig(text, order)?;
    let judging = &seen.judging;
    let mut values: [Vec<f64>; CHANNELS] = Default::default();
    let mut friction = Vec::new();
    for (number, run) in judging.records.iter().enumerate() {
        let begin = judging
            .units
            .state_to_si(&first_state(&judging.data, number));
        let last = run.time.len() - 1;
        let (own, torque) = course(&mut component, run, 0, last, &begin)?;
        for (all, own) in values.iter_mut().zip(own) {
            all.extend(own);
        }
        friction.extend(torque);
    }
    Ok((curves(seen, values, friction), json!({})))
}

/// A run through each window from its start.
fn restarted(
    seen: &Seen,
    text: &str,
    order: &Order,
    best: bool,
) -> anyhow::Result<(Curves, Value)> {
    let (mut component, rig) = (component(text, order)?, rig(text, order)?);
    let judging = &seen.judging;
    let plant = judging.units.to_plant(&rig)?;
    let starts = if best {
        best_starts(&judging.data, &plant)
    } else {
        Starts {
            states: judging.data.anchors(),
            grams: Vec::new(),
        }
    };
    let set = starts.to_set(&plant, &judging.units);
    let courses = window_courses(&mut component, judging, &set, delay(&rig))?;
    let rows = judging.records.iter().map(|run| run.time.len()).sum();
    let mut values: [Vec<f64>; CHANNELS] = std::array::from_fn(|_| vec![f64::NAN; rows]);
    let mut friction = vec![f64::NAN; rows];
    let begins = seen.begins();
    for (window, course) in judging.data.windows.iter().zip(&courses) {
        let (Some(course), Some(begin)) = (course, begins.get(window.run)) else {
            continue;
        };
        let first = begin + window.first;
        for (all, own) in values.iter_mut().zip(&course.values) {
            if !own.is_empty() {
                all[first..first + own.len()].copy_from_slice(own);
            }
        }
        friction[first..first + course.friction.len()].copy_from_slice(&course.friction);
    }
    let counts: Vec<bool> = courses.iter().map(Option::is_some).collect();
    let error = root_mean_square(&courses, &counts);
    let left: Vec<&WindowCourse> = courses.iter().flatten().collect();
    let header = json!({
        "window_error": error.is_finite().then_some(error),
        "windows": courses.len(),
        "windows_left_aside": courses.len() - left.len(),
    });
    Ok((curves(seen, values, friction), header))
}

/// A run's channels, with the record's times.
fn curves(seen: &Seen, values: [Vec<f64>; CHANNELS], friction: Vec<f64>) -> Curves {
    let mut curves = Curves::default();
    let times = seen.judging.records.iter().flat_map(|run| &run.time);
    curves.add("time", times.copied().collect());
    for ((_, name), own) in channels().zip(values) {
        // The reduced rig has no disc D1.
        if own.len() == friction.len() {
            curves.add(name, own);
        }
    }
    curves.add("T_f", friction);
    curves
}

/// A record's inputs; other columns may be nothing that the model knows.
fn inputs_of(seen: &Seen, component: &dyn Component) -> anyhow::Result<Record> {
    let record = &seen.record;
    let mut inputs = Record::new(record.source(), record.time().to_vec())?;
    for name in ["u", "N2", "N1"] {
        if crate::component::position(component, name).is_ok() {
            inputs.add_column(name, record.require(name)?.to_vec())?;
        }
    }
    Ok(inputs)
}

/// A run from rest under the inputs of `drive`, its rows every `step` [s].
fn from_rest(
    text: &str,
    order: &Order,
    step: f64,
    drive: impl FnOnce(&dyn Component) -> anyhow::Result<Drive>,
) -> anyhow::Result<(Curves, Value)> {
    let component = component(text, order)?;
    let drive = drive(&component)?;
    let schedule = Schedule::new(drive.start(), drive.duration().unwrap_or(60.0), step)?;
    run(component, &drive, &schedule)
}

fn held(
    text: &str,
    order: &Order,
    (speed_rpm, normal_force, normal_force_1): (f64, f64, Option<f64>),
    (duration, step): (f64, f64),
) -> anyhow::Result<(Curves, Value)> {
    anyhow::ensure!(
        normal_force >= 0.0 && normal_force_1.is_none_or(|force| force >= 0.0),
        "a normal force of 0 N or more is needed"
    );
    let component = component(text, order)?;
    let setting = |name: &str| order.settings.get(name).copied();
    let drive = Drive::from_speed(&component, setting, speed_rpm, normal_force, normal_force_1)?;
    let schedule = Schedule::new(drive.start(), duration, step)?;
    run(component, &drive, &schedule)
}

fn run(
    mut component: Native,
    drive: &Drive,
    schedule: &Schedule,
) -> anyhow::Result<(Curves, Value)> {
    let begun = Instant::now();
    let record = simulate(&mut component, drive, schedule)?;
    let summary = Summary::new(&record, component.switches(), begun.elapsed())?;
    let mut curves = Curves::default();
    curves.add("time", record.time().to_vec());
    for name in record.names() {
        curves.add(name, record.require(name)?.to_vec());
    }
    let header = json!({
        "motion": summary.motion.name(),
        "frequency": summary.cycle.map(|cycle| cycle.frequency()),
        "stick_fraction": summary.stick_fraction,
    });
    Ok((curves, header))
}
