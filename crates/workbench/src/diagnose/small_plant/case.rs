//! A small plant's case: model, records to learn from, record to judge on.

use std::path::{Path as FilePath, PathBuf};

use thiserror::Error;

use super::fmu::missing::{Chased, MissingError, Recorded};
use super::fmu::places::at_each;
use super::fmu::plant::Plant;
use super::model_file::{SmallModel, SmallModelError};
use super::reading::read;
use super::showing::balance;
use crate::diagnose::material::Material;
use crate::diagnose::record_part::Part;
use crate::files::record::RecordError;
use inference::body::catalogue::CATALOGUE;
use inference::body::effect_file::{effect, of_user};
use inference::body::known::Known;
use inference::body::model::Model;
use inference::body::motion::{Motion, Scales, root_mean_square};
use inference::body::problem::Problem;
use inference::body::start;
use inference::body::term::Entry;
use stickslip::body::{FileError, Kind, read_effects};

/// Least length of all records to learn from together, in periods of the motion.
const SHORTEST: f64 = 5.0;

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
    /// The same record at the further ports of an FMU.
    pub held_out_further: Vec<Motion>,
    /// Whether the record to judge on goes on where the last one to learn from ends.
    pub goes_on: bool,
    /// Usual sizes in the records to learn from.
    pub scales: Scales,
    /// The model's numbers that are known before, with the deviations that its file states.
    pub known: Vec<Known>,
    /// Share of a sampling interval by which force or voltage is read later than it stands in the records.
    pub driven_later: f64,
    /// What a residual at each port of an FMU counts: the noise at the first over that there.
    pub weights: Vec<f64>,
    /// The FMU and its records as they were measured; none of the other kinds.
    pub chased: Option<Chased>,
    /// Effects that files of the user's describe, which are tried beside those of the catalogue.
    pub supposed: Vec<&'static Entry>,
    /// Effects taken out of the catalogue.
    pub without: Vec<String>,
    /// What has to be said about the records.
    pub notes: Vec<String>,
}

/// How a note begins that tells why there is no FMU.
pub const NO_FMU: &str = "no FMU was built";

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
    /// A file of effects.
    #[error(transparent)]
    Effects(#[from] FileError),
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
    let supposed = at_ports(supposed(material, &model)?, &model);
    for name in &material.without {
        check_effect(name, &[&supposed[..], &model.of_ports[..]].concat())
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
    let mut of_parts = Vec::new();
    let mut notes = Vec::new();
    for part in parts {
        let stretches = read(part, &model, &columns, &mut notes)?;
        of_parts.extend(vec![part; stretches.len()]);
        all.extend(stretches);
    }
    let stretches = read(held_out_part, &model, &columns, &mut notes)?;
    if stretches.len() > 1 {
        notes.push(format!(
            "{}: its longest stretch without a hole is the one to judge on",
            held_out_part.path.display()
        ));
    }
    let seconds = |own: &Recorded| own.motions.first().map_or(0.0, Motion::seconds);
    let longest = stretches
        .into_iter()
        .max_by(|a, b| seconds(a).total_cmp(&seconds(b)));
    all.extend(longest);
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
    let first = |mut own: Recorded| own.motions.swap_remove(0);
    let mut records: Vec<Motion> = all.into_iter().map(first).collect();
    let Some(mut held_out) = records.pop() else {
        return Err(SmallCaseError::Usage("the case has no record".to_owned()));
    };
    for (part, record) in of_parts.into_iter().zip(&records) {
        check_apart(part, record, held_out_part, &held_out)?;
    }
    let goes_on = parts
        .last()
        .is_some_and(|last| continues(last, held_out_part));
    relate_load(&model, &mut records, &mut held_out)?;
    let mut held_out_further = Vec::new();
    if let Some(chased) = &chased {
        (records, held_out, held_out_further) =
            chased_motions(chased, &model.model, held_out, progress)?;
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
    let Model { kind, path, .. } = model.model;
    for entry in &supposed {
        if start::values(entry, kind, path, &scales).is_none() {
            return Err(SmallCaseError::Usage(format!(
                "effect {}: no value of a parameter makes the equation vanish, so that the records cannot be asked whether they need \
                 it; multiply the equation by a parameter",
                entry.name
            )));
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
    let why = model.model.kind.stands_still().filter(|_| chased.is_none());
    let without_fmu =
        why.map(|why| format!("{NO_FMU}: {why}; model.amended.toml is the amended model"));
    let mut case = SmallCase {
        known: model.known(),
        driven_later: 0.0,
        weights: Vec::new(),
        name: material.name.clone(),
        model,
        records,
        held_out,
        held_out_further,
        goes_on,
        scales,
        supposed,
        without: material.without.clone(),
        notes: notes
            .into_iter()
            .chain(chased.iter().flat_map(|chased| chased.plant.notes.clone()))
            .chain(without_fmu)
            .collect(),
        chased,
    };
    let model = case.model.model.clone();
    case.weigh_ports(&model);
    Ok(case)
}

/// The records to learn from and the one to judge on, with the force that the FMU lacks: the latter at the first port and at the others.
fn chased_motions(
    chased: &Chased,
    model: &Model,
    held_out: Motion,
    progress: &mut dyn FnMut(&str),
) -> Result<(Vec<Motion>, Motion, Vec<Motion>), MissingError> {
    let ports = chased.plant.places.len();
    let parameters = &model.terms()[0].values;
    let mut records = chased.missing(parameters, &model.delays(ports), progress)?;
    let mut last = records
        .split_off(records.len().saturating_sub(ports))
        .into_iter();
    let first = last.next().unwrap_or(held_out);
    Ok((records, first, last.collect()))
}

/// Effects of the user's at each of an FMU's ports, where it has several.
fn at_ports(all: Vec<&'static Entry>, model: &SmallModel) -> Vec<&'static Entry> {
    let ports = model.ports.iter().flat_map(|ports| &ports.ports);
    let names: Vec<&str> = ports.filter_map(|port| port.name.as_deref()).collect();
    if names.len() < 2 {
        return all;
    }
    all.into_iter()
        .flat_map(|entry| at_each(entry, &names))
        .collect()
}

/// The effects that files of the user's describe, on the plant of `model`.
///
/// # Errors
/// A file is wrong, or such a plant cannot have its effect.
pub fn supposed(
    material: &Material,
    model: &SmallModel,
) -> Result<Vec<&'static Entry>, SmallCaseError> {
    let Model { kind, path, .. } = model.model;
    let mut all: Vec<(&str, &'static Entry)> = Vec::new();
    for (file, text) in &material.effects {
        for described in read_effects(text, file)? {
            let entry = of_user(effect(&described, file, kind, path)?, kind, path);
            let earlier = all.iter().find(|(_, other)| other.name == entry.name);
            let taken = match earlier {
                Some((earlier, _)) => Some(format!("{earlier} has an effect of this name; give one of them another")),
                None if !entry.fits(kind, path, model.has_load()) => {
                    Some("it depends on the load, and the model has none; add a line for load to [columns], of an FMU to [port]".to_owned())
                }
                None if model.model.has(entry.name) => {
                    Some("the model has an effect of this name already; give it another".to_owned())
                }
                None => CATALOGUE
                    .iter()
                    .any(|own| own.name == entry.name)
                    .then(|| "the catalogue has an effect of this name; give it another".to_owned()),
            };
            if let Some(taken) = taken {
                return Err(SmallCaseError::Usage(format!(
                    "{file}: effect {}: {taken}",
                    entry.name
                )));
            }
            // An entry lives as long as the program, as those of the catalogue do.
            all.push((file, Box::leak(Box::new(entry))));
        }
    }
    Ok(all.into_iter().map(|(_, entry)| entry).collect())
}

/// Refuses names that neither the effects `further` of the user's or of an FMU's own places nor the small plants' catalogue have.
///
/// # Errors
/// What would be right.
pub fn check_effect(name: &str, further: &[&'static Entry]) -> Result<&'static Entry, String> {
    let all = || further.iter().copied().chain(CATALOGUE.iter());
    all().find(|entry| entry.name == name).ok_or_else(|| {
        let known: Vec<&str> = all().map(|entry| entry.name).collect();
        format!(
            "the catalogue of small plants has no such effect; it has {}",
            known.join(", ")
        )
    })
}

/// Load over its mean on the records learned from.
fn relate_load(
    model: &SmallModel,
    records: &mut [Motion],
    held_out: &mut Motion,
) -> Result<(), SmallCaseError> {
    if model.model.kind != Kind::Contact || !model.has_load() {
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
            let held_out = self.held_out.clone();
            (self.records, self.held_out, self.held_out_further) =
                chased_motions(chased, model, held_out, progress)?;
            self.weigh_ports(model);
        }
        Ok(())
    }

    /// Weighs the ports of an FMU against each other by what `model` leaves at them.
    fn weigh_ports(&mut self, model: &Model) {
        let ports = self.chased.as_ref().map_or(1, |own| own.plant.places.len());
        if ports > 1 {
            let all = balance(self).weighing(&[]);
            let noise = (0..ports)
                .map(|port| root_mean_square(&all.at_port(port).residuals(model).concat()));
            let noise: Vec<f64> = noise.collect();
            self.weights = noise.iter().map(|own| noise[0] / own).collect();
        }
    }

    /// The effect of this name.
    ///
    /// # Errors
    /// What would be right.
    pub fn effect(&self, name: &str) -> Result<&'static Entry, String> {
        check_effect(
            name,
            &[&self.supposed[..], &self.model.of_ports[..]].concat(),
        )
    }

    /// The effects that the plant can have and its model has not.
    #[must_use]
    pub fn possible(&self) -> Vec<&'static Entry> {
        self.model.possible(&self.supposed)
    }

    /// Those of them that were not taken out of the catalogue.
    #[must_use]
    pub fn candidates(&self) -> Vec<&'static Entry> {
        let is_in = |entry: &&Entry| !self.without.iter().any(|name| name == entry.name);
        self.possible().into_iter().filter(is_in).collect()
    }

    /// What the plant is.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.model.model.kind
    }
}
