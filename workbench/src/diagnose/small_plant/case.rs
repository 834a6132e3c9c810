//! A small plant's case: model, records to learn from, record to judge on.

use std::fs;
use std::path::{Path as FilePath, PathBuf};

use thiserror::Error;

use super::catalogue::{CATALOGUE, entry};
use super::columns::Quantity;
use super::evidence::unit;
use super::fmu::missing::{Chased, MissingError, Recorded};
use super::fmu::plant::Plant;
use super::model::Model;
use super::model_file::{SmallModel, SmallModelError};
use super::motion::{Measured, Motion, Scales, root_mean_square};
use super::problem::Problem;
use super::showing::balance;
use super::unit::Kind;
use crate::diagnose::material::Material;
use crate::diagnose::record_part::Part;
use crate::files::record::{Missing, Record, RecordError};

/// Least length of all records to learn from together, in periods of the motion.
const SHORTEST: f64 = 5.0;
/// Most by which a sampling step may differ from the median one, relative to it, before the record is read off again at even times.
const JITTER: f64 = 0.02;
/// Where fewer than one in so many steps are off, the clock is even and these steps are wrong.
const RARE: usize = 100;
/// Longest sampling step over the mean one that is no hole.
const HOLE: f64 = 3.0;

/// A case, read and checked.
#[derive(Debug, Clone)]
pub struct SmallCase {
    /// What messages and the report call it.
    pub name: String,
    /// The analyst's model.
    pub model: SmallModel,
    /// Records to learn from.
    pub records: Vec<Motion>,
    /// Record to judge on.
    pub held_out: Motion,
    /// Whether the record to judge on goes on where the last one to learn from ends.
    pub goes_on: bool,
    /// Usual sizes in the records to learn from.
    pub scales: Scales,
    /// Residual that weighs as much as one standard deviation of an FMU's parameter.
    pub known: f64,
    /// The FMU and its records as they were measured; none of the other kinds.
    pub chased: Option<Chased>,
    /// Effects taken out of the catalogue.
    pub without: Vec<String>,
    /// What has to be said about the records.
    pub notes: Vec<String>,
}

/// Why a small plant's case cannot be used.
#[derive(Debug, Error)]
pub enum SmallCaseError {
    /// A file cannot be read.
    #[error("{path}: cannot be read: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// The model file is wrong.
    #[error(transparent)]
    Model(#[from] SmallModelError),
    /// A record is no record.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A column that the model file names is not there.
    #[error(
        "{file}: has no column `{column}`, which the model's [columns] names as {quantity}; it has {known}"
    )]
    NoColumn {
        /// The record.
        file: String,
        /// The column.
        column: String,
        /// What it should be.
        quantity: &'static str,
        /// The columns that are there.
        known: String,
    },
    /// The force that an FMU lacks is not known.
    #[error(transparent)]
    Fmu(#[from] MissingError),
    /// A record that cannot be used.
    #[error("{file}: {what}")]
    Unusable {
        /// The record.
        file: String,
        /// What is wrong and what would be right.
        what: String,
    },
    /// The command line.
    #[error("{0}")]
    Usage(String),
}

/// Reads and checks a case whose model is that of a small plant.
///
/// # Errors
/// [`SmallCaseError`], naming the file and what would be right.
pub fn load(
    material: &Material,
    progress: &mut dyn FnMut(&str),
) -> Result<SmallCase, SmallCaseError> {
    if let Some((sensors, _)) = &material.sensors {
        return Err(SmallCaseError::Usage(format!(
            "{sensors}: a small plant's instruments stand in its model file, [columns] and [measurement]; leave the sensors out"
        )));
    }
    if let Some((file, _)) = material.effects.first() {
        return Err(SmallCaseError::Usage(format!(
            "{file}: effects from files are tried on rigs so far, not on small plants; leave --catalogue out"
        )));
    }
    let mut model = SmallModel::parse(&material.model_text, &material.model_name)?;
    if let Some(fmu) = &material.fmu {
        let Some(ports) = &mut model.ports else {
            return Err(SmallCaseError::Usage(format!(
                "{}: is no ports file: its [plant] kind is \"{}\" and not \"fmu\"",
                material.model_name,
                model.model.kind.word()
            )));
        };
        ports.fmu = std::path::absolute(fmu).ok();
    }
    for name in &material.without {
        check_effect(name)
            .map_err(|what| SmallCaseError::Usage(format!("--without {name}: {what}")))?;
    }
    let parts = &material.records;
    let Some(held_out_part) = &material.held_out else {
        return Err(SmallCaseError::Usage(
            "a small plant's case needs a record to judge on: held-out.csv in its directory, or --held-out FILE"
                .to_owned(),
        ));
    };
    let plant = match &model.ports {
        Some(ports) => {
            let named = Plant::find(&model, ports, &material.model_name, &material.directory);
            Some(named.map_err(MissingError::from)?)
        }
        None => None,
    };
    if let (Some(ports), Some(plant)) = (&mut model.ports, &plant) {
        // The amended model stands in another directory.
        ports.fmu = std::path::absolute(&plant.file).ok();
    }
    let columns: Vec<&str> = plant.iter().flat_map(Plant::columns).collect();
    let mut all = Vec::new();
    let mut notes = Vec::new();
    for part in parts.iter().chain([held_out_part]) {
        all.push(read(part, &model, &columns, &mut notes)?);
    }
    let chased = match plant {
        Some(plant) => {
            let Some(cut_off) = model.measurement.compare_low_pass else {
                return Err(SmallCaseError::Usage(format!(
                    "{}: [measurement] lacks compare_low_pass; the force that an FMU lacks is known below a frequency alone",
                    material.model_name
                )));
            };
            Some(Chased {
                plant,
                records: all.clone(),
                cut_off,
                standstill: model.measurement.standstill_speed,
            })
        }
        None => None,
    };
    let mut records: Vec<Motion> = all.into_iter().map(|own| own.motion).collect();
    let Some(mut held_out) = records.pop() else {
        return Err(SmallCaseError::Usage("the case has no record".to_owned()));
    };
    for (part, record) in parts.iter().zip(&records) {
        check_apart(part, record, held_out_part, &held_out)?;
    }
    let goes_on = parts
        .last()
        .is_some_and(|last| continues(last, held_out_part));
    relate_load(&model, &mut records, &mut held_out)?;
    if let Some(chased) = &chased {
        let nominal = &model.model.terms()[0].values;
        records = chased.missing(nominal, model.model.delay(), progress)?;
        if let Some(last) = records.pop() {
            held_out = last;
        }
    }
    let scales = Scales::of(&records);
    for (size, what) in [
        (scales.speed, "does not move"),
        (scales.force, "has no force that changes"),
    ] {
        if size <= 0.0 || !size.is_finite() {
            return Err(SmallCaseError::Unusable {
                file: records[0].name.clone(),
                what: format!("{what}; nothing can be learned from it"),
            });
        }
    }
    let seconds: f64 = records.iter().map(Motion::seconds).sum();
    let needed = SHORTEST * scales.period;
    if seconds < needed {
        return Err(SmallCaseError::Usage(format!(
            "the records to learn from have {seconds:.3} s together; at least {needed:.3} s are needed, {SHORTEST} periods of the \
             motion that they show"
        )));
    }
    let mut case = SmallCase {
        known: 0.0,
        name: material.name.clone(),
        model,
        records,
        held_out,
        goes_on,
        scales,
        without: material.without.clone(),
        notes: notes
            .into_iter()
            .chain(chased.iter().flat_map(|chased| chased.plant.notes.clone()))
            .chain(chased.is_none().then(|| {
                "no FMU was built: the library's rigs do not include such a plant; model.amended.toml is the amended model"
                    .to_owned()
            }))
            .collect(),
        chased,
    };
    let model = case.model.model.clone();
    case.weigh_knowledge(&model);
    Ok(case)
}

/// Refuses names that the small plants' catalogue does not have.
///
/// # Errors
/// What would be right.
pub fn check_effect(name: &str) -> Result<(), String> {
    if entry(name).is_some() {
        return Ok(());
    }
    let known: Vec<&str> = CATALOGUE.iter().map(|entry| entry.name).collect();
    Err(format!(
        "the catalogue of small plants has no such effect; it has {}",
        known.join(", ")
    ))
}

fn read(
    part: &Part,
    model: &SmallModel,
    driven: &[&str],
    notes: &mut Vec<String>,
) -> Result<Recorded, SmallCaseError> {
    let file = part.path.display().to_string();
    let unusable = |what: String| SmallCaseError::Unusable {
        file: file.clone(),
        what,
    };
    let time_name = &model.columns.time.column;
    let text = match &part.table {
        // A table's time stands apart from its columns, and has the name that is asked for.
        Some(table) => table.to_csv().replacen("time", time_name, 1),
        None => fs::read_to_string(&part.path).map_err(|source| SmallCaseError::Read {
            path: part.path.clone(),
            source,
        })?,
    };
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let (header, rows) = text.split_once('\n').unwrap_or((text, ""));
    let names: Vec<&str> = header
        .split(',')
        .map(|name| name.trim().trim_matches('"'))
        .collect();
    if names.first() != Some(&time_name.as_str()) {
        return Err(unusable(format!(
            "the first column is `{}`; the model's [columns] names `{time_name}` as time, which must come first",
            names.first().unwrap_or(&"")
        )));
    }
    let known = names.join(", ");
    let renamed = std::iter::once("time").chain(names.into_iter().skip(1));
    let text = format!("{}\n{rows}", renamed.collect::<Vec<_>>().join(","));
    let record = Record::parse(&text, &file, Missing::Refuse)?;
    let path = model.model.path;
    let factor = |quantity: Quantity| -> f64 {
        let column = model.columns.given().find(|(given, _)| *given == quantity);
        column
            .and_then(|(_, column)| column.factor(quantity, path).ok())
            .unwrap_or(1.0)
    };
    let to_seconds = factor(Quantity::Time);
    let record = match part.span {
        Some((from, to)) => record.window(from / to_seconds, to / to_seconds),
        None => record,
    };
    let count = record.len();
    let interval = record.median_step() * to_seconds;
    if count < 100 || !interval.is_finite() {
        return Err(unusable(format!(
            "{count} samples are too few; at least 100 are needed"
        )));
    }
    let steps = || {
        record
            .time()
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) * to_seconds)
    };
    let is_off = |step: &f64| (step / interval - 1.0).abs() > JITTER;
    let off = steps().filter(is_off).count();
    let even = if off == 0 {
        None
    } else {
        let mean = (record.time()[count - 1] - record.time()[0]) * to_seconds / (count - 1) as f64;
        // A clock that is even but for a few steps has a hole or a wrong stamp there.
        let wrong = if off < count / RARE {
            steps().position(|step| is_off(&step))
        } else {
            steps().position(|step| step > HOLE * mean)
        };
        if let Some(at) = wrong {
            return Err(unusable(format!(
                "the step at {} s is {:.6} s where {interval:.6} s is usual; a stretch without holes can be given as {file}@FROM:TO",
                record.time()[at] * to_seconds,
                (record.time()[at + 1] - record.time()[at]) * to_seconds
            )));
        }
        notes.push(format!(
            "{file}: steps of time from {:.6} to {:.6} s; its columns were read off every {mean:.6} s, straight between samples",
            steps().fold(f64::INFINITY, f64::min),
            steps().fold(0.0, f64::max)
        ));
        Some(mean / to_seconds)
    };
    let interval = even.map_or(interval, |step| step * to_seconds);
    let rate = 1.0 / interval;
    let measurement = &model.measurement;
    for (key, cut_off) in [
        ("motion_low_pass", Some(measurement.motion_low_pass)),
        ("compare_low_pass", measurement.compare_low_pass),
    ] {
        if cut_off.is_some_and(|cut_off| cut_off >= 0.45 * rate) {
            return Err(unusable(format!(
                "is sampled at {rate:.1} Hz; the model's [measurement] {key} must be below {:.1} Hz",
                0.45 * rate
            )));
        }
    }
    if measurement.compare_rate > 1.001 * rate {
        return Err(unusable(format!(
            "is sampled at {rate:.1} Hz; the model's [measurement] compare_rate must not be above that"
        )));
    }
    let series = |quantity: Quantity| -> Result<Option<Vec<f64>>, SmallCaseError> {
        let Some((_, column)) = model.columns.given().find(|(given, _)| *given == quantity) else {
            return Ok(None);
        };
        let values = record
            .column(&column.column)
            .ok_or_else(|| SmallCaseError::NoColumn {
                file: file.clone(),
                column: column.column.clone(),
                quantity: quantity.word(),
                known: known.clone(),
            })?;
        let factor = factor(quantity);
        let values = match even {
            Some(step) => at_even_times(record.time(), values, step),
            None => values.to_vec(),
        };
        Ok(Some(values.iter().map(|value| value * factor).collect()))
    };
    let measured = match (series(Quantity::Position)?, series(Quantity::Velocity)?) {
        (Some(position), Some(velocity)) => {
            check_velocity(&position, &velocity, interval).map_err(unusable)?;
            Measured::Both(position, velocity)
        }
        (Some(position), None) => Measured::Position(position),
        (None, Some(velocity)) => Measured::Velocity(velocity),
        (None, None) => {
            return Err(unusable(
                "neither position nor velocity is named in [columns]".to_owned(),
            ));
        }
    };
    let begin = record.time()[0] * to_seconds;
    let name = part.span.map_or_else(
        || file_name(&part.path),
        |(from, to)| format!("{} {from}–{to} s", file_name(&part.path)),
    );
    let mut motion = Motion::new(
        name,
        begin,
        interval,
        measured,
        measurement.motion_low_pass,
        measurement.standstill_speed,
    );
    if let Some(force) = series(Quantity::Force)? {
        motion.force = force;
    }
    if let Some(load) = series(Quantity::Load)? {
        motion.load = load;
    }
    if let Some(predicted) = series(Quantity::Predicted)? {
        motion.predicted = predicted;
    }
    if model.model.kind == Kind::Joint {
        motion.voltage = match (series(Quantity::Voltage)?, series(Quantity::Duty)?) {
            (Some(voltage), _) => voltage,
            (None, duty) => {
                let supply = series(Quantity::Supply)?.unwrap_or_default();
                let duty = duty.unwrap_or_default().into_iter();
                duty.zip(supply)
                    .map(|(share, volts)| share * volts)
                    .collect()
            }
        };
        motion.connected = series(Quantity::Connected)?.unwrap_or(vec![1.0; motion.len()]);
        let cut_off = measurement
            .compare_low_pass
            .unwrap_or(0.5 * measurement.compare_rate);
        motion.leave_rests_out(measurement.standstill_speed, cut_off);
    }
    let driven = driven.iter().map(|name| {
        let values = record
            .column(name)
            .ok_or_else(|| SmallCaseError::NoColumn {
                file: file.clone(),
                column: (*name).to_owned(),
                quantity: "what drives an input",
                known: known.clone(),
            })?;
        Ok(match even {
            Some(step) => at_even_times(record.time(), values, step),
            None => values.to_vec(),
        })
    });
    let driven = driven.collect::<Result<Vec<_>, SmallCaseError>>()?;
    Ok(Recorded { motion, driven })
}

/// A column at even steps of time from its first sample on, straight between samples.
fn at_even_times(time: &[f64], values: &[f64], step: f64) -> Vec<f64> {
    let mut low = 0;
    (0..time.len())
        .map(|at| {
            let wanted = time[0] + at as f64 * step;
            while low + 2 < time.len() && time[low + 1] < wanted {
                low += 1;
            }
            let part = ((wanted - time[low]) / (time[low + 1] - time[low])).clamp(0.0, 1.0);
            values[low] + part * (values[low + 1] - values[low])
        })
        .collect()
}

/// Refuses a velocity that is not the position's, such as one in rpm called rad/s.
fn check_velocity(position: &[f64], velocity: &[f64], interval: f64) -> Result<(), String> {
    // Over some samples, so that the noise of single readings does not count.
    let wide = 20.min(position.len() / 4).max(1);
    let (mut product, mut square) = (0.0, 0.0);
    for at in 0..position.len() - wide {
        let moved = position[at + wide] - position[at];
        let summed = velocity[at..at + wide].iter().sum::<f64>() * interval;
        product += moved * summed;
        square += summed * summed;
    }
    let ratio = product / square;
    if (0.9..1.1).contains(&ratio) {
        Ok(())
    } else {
        Err(format!(
            "the position changes {ratio:.4} times as fast as the velocity says; check the units in [columns] (rpm to rad/s is 0.1047, deg to rad 0.01745)"
        ))
    }
}

/// Load over its mean on the records learned from.
fn relate_load(
    model: &SmallModel,
    records: &mut [Motion],
    held_out: &mut Motion,
) -> Result<(), SmallCaseError> {
    if model.columns.load.is_none() {
        return Ok(());
    }
    let all: Vec<f64> = records
        .iter()
        .flat_map(|record| record.load.iter().copied())
        .collect();
    let mean = all.iter().sum::<f64>() / all.len().max(1) as f64;
    if mean <= 0.0 || mean.is_nan() {
        return Err(SmallCaseError::Unusable {
            file: records[0].name.clone(),
            what: format!(
                "the load is {mean} on average; a contact is pressed together by a positive load"
            ),
        });
    }
    for load in records
        .iter_mut()
        .chain([held_out])
        .flat_map(|record| &mut record.load)
    {
        *load /= mean;
    }
    Ok(())
}

fn same_file(left: &FilePath, right: &FilePath) -> bool {
    match (left.canonicalize(), right.canonicalize()) {
        (Ok(left), Ok(right)) => left == right,
        _ => left == right,
    }
}

/// Refuses a record to judge on that was learned from.
fn check_apart(
    part: &Part,
    record: &Motion,
    held_out_part: &Part,
    held_out: &Motion,
) -> Result<(), SmallCaseError> {
    let overlap = match (part.span, held_out_part.span) {
        (Some((from, to)), Some((held_from, held_to))) => from < held_to && held_from < to,
        _ => true,
    };
    let count = record.len().min(held_out.len());
    let equal = (0..count)
        .filter(|&at| {
            record.reading[at] == held_out.reading[at] && record.force[at] == held_out.force[at]
        })
        .count();
    let same_values = 2 * equal > count && root_mean_square(&record.velocity) > 0.0;
    if same_file(&part.path, &held_out_part.path) && overlap || same_values {
        return Err(SmallCaseError::Unusable {
            file: held_out.name.clone(),
            what: format!(
                "is the same measurement as {}; judge on a record that the model has not seen, or on another part of it: FILE@FROM:TO",
                record.name
            ),
        });
    }
    Ok(())
}

fn continues(last: &Part, held_out: &Part) -> bool {
    match (last.span, held_out.span) {
        (Some((_, to)), Some((from, _))) => same_file(&last.path, &held_out.path) && to == from,
        _ => false,
    }
}

/// Last part of a path.
fn file_name(path: &FilePath) -> String {
    path.file_name().map_or_else(
        || path.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    )
}

impl SmallCase {
    /// Finds the force that an FMU lacks anew, with its parameters and the delay as `model` has them.
    ///
    /// # Errors
    /// [`SmallCaseError::Fmu`].
    pub fn pursue(
        &mut self,
        model: &Model,
        progress: &mut dyn FnMut(&str),
    ) -> Result<(), SmallCaseError> {
        if let Some(chased) = &self.chased {
            let parameters = &model.terms()[0].values;
            self.records = chased.missing(parameters, model.delay(), progress)?;
            if let Some(last) = self.records.pop() {
                self.held_out = last;
            }
            self.weigh_knowledge(model);
        }
        Ok(())
    }

    /// Weighs what is known of an FMU's parameters against residuals as large as `model` leaves.
    fn weigh_knowledge(&mut self, model: &Model) {
        if self.kind() == Kind::Fmu {
            self.known = unit(&balance(self).residuals(model)).sqrt();
        }
    }

    /// What the plant is.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.model.model.kind
    }
}
