//! A case: the analyst's model, the records to learn from, the record to judge on, and the sensors.

use std::path::PathBuf;

use inference::data::Data;
use inference::instruments::{Series, contradictions, estimate, load_noise};
use inference::problem::{Catalogue, Problem};
use inference::record::{CHANNELS, Instruments, RawRecord};
use inference::units::PlantUnits;
use inference::window::Begin;
use stickslip::parameter::ParameterError;
use stickslip::plant::{ModelFile, ModelFileError, Supposition};
use thiserror::Error;

use super::catalogue::CATALOGUE;
use super::input_check::{note_on_inputs, same};
use super::load_cell::denoise;
use super::material::Material;
use super::record_check::{COLUMNS, Checked, INPUTS, RecordProblem, check, natural_period};
use super::record_part::PartError;
use super::rig_columns::{ColumnsError, RigColumns, about};
use super::sensors::{SensorError, Sensors, in_the_middle, in_words};
use super::supposed;
use super::uncertainty::{UncertaintyError, uncertainties};
use crate::component::closest;
use crate::files::record::Record;

/// Least length of all records to learn from together, in natural periods of the disc on its shaft.
const SHORTEST: f64 = 3.0;

/// A case, read and checked.
#[derive(Debug, Clone)]
pub struct Case {
    /// What messages and the report call it.
    pub name: String,
    /// The analyst's model.
    pub model: ModelFile,
    /// Text of the analyst's model file.
    pub model_text: String,
    /// Relative standard deviations of the model's parameters by dotted name.
    pub uncertainties: Vec<(String, f64)>,
    /// The instruments, SI units.
    pub instruments: Instruments,
    /// Stretches of records to learn from, SI units.
    pub records: Vec<RawRecord>,
    /// Stretches of the record to judge on, SI units.
    pub held_out: Vec<RawRecord>,
    /// Effects that files describe, and those taken out of the catalogue.
    pub catalogue: Catalogue,
    /// What has to be said about the records.
    pub notes: Vec<String>,
}

/// Why a case cannot be used.
#[derive(Debug, Error)]
pub enum CaseError {
    /// An FMU without its ports.
    #[error(
        "{path}: an FMU needs --ports, a file that says which columns and variables belong together; `stickslip ports {path}` \
             writes a first one"
    )]
    NoPorts {
        /// The FMU.
        path: PathBuf,
    },
    /// A file cannot be read.
    #[error("{path}: cannot be read: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// The directory has no records to learn from.
    #[error("{path}: has no record run-*.csv, .parquet or .xlsx to learn from")]
    NoRecords {
        /// The directory.
        path: PathBuf,
    },
    /// The directory has no effects.
    #[error("{path}: has no file *.toml with effects, sections [[effect]]")]
    NoEffects {
        /// The directory.
        path: PathBuf,
    },
    /// The model file, or a file with effects, is wrong.
    #[error(transparent)]
    Model(#[from] ModelFileError),
    /// An effect of a file cannot be tried on the model.
    #[error("{file}: {source}")]
    Effect {
        /// The file.
        file: String,
        /// What is wrong.
        source: ParameterError,
    },
    /// Two files describe an effect of one name.
    #[error("{file}: the effect {name} is in {earlier} too; give one of them another name")]
    SameEffect {
        /// The later file.
        file: String,
        /// Name of the effect.
        name: String,
        /// The earlier file.
        earlier: String,
    },
    /// The model file states an uncertainty that cannot be one.
    #[error(transparent)]
    Uncertainty(#[from] UncertaintyError),
    /// The sensor file is wrong.
    #[error(transparent)]
    Sensors(#[from] SensorError),
    /// A record cannot be read, or its columns are not those of a rig.
    #[error(transparent)]
    Columns(#[from] ColumnsError),
    /// A part of a file is none.
    #[error(transparent)]
    Part(#[from] PartError),
    /// A record cannot be used.
    #[error(transparent)]
    Problem(#[from] RecordProblem),
    /// A file of effects that is none.
    #[error("{file}: needs sections [[effect]], each with a name: {reason}")]
    NoEffectFile {
        /// The file.
        file: String,
        /// What the parser says.
        reason: String,
    },
    /// A name that the catalogue does not have.
    #[error("{name}: the catalogue has no such effect{hint}; it has {known}")]
    UnknownEffect {
        /// The name.
        name: String,
        /// The name that is probably meant, as a question; empty where none is near.
        hint: String,
        /// All names.
        known: String,
    },
    /// Too little to learn from.
    #[error(
        "the records to learn from have {seconds:.3} s together; at least {SHORTEST} periods of the disc on its shaft, {needed:.3} s, are needed, and 20 for small effects"
    )]
    TooShort {
        /// Length of what can be used [s].
        seconds: f64,
        /// Length that is needed [s].
        needed: f64,
    },
    /// Two records to learn from are one measurement.
    #[error(
        "{record}: is the same measurement as {earlier}, or a part of it; counted twice it would make every interval too narrow. Give it once"
    )]
    Twice {
        /// File of the later record.
        record: String,
        /// File of the earlier one.
        earlier: String,
    },
    /// The record to judge on was learned from.
    #[error(
        "{held_out}: is the same measurement as {record}, or a part of it; judge on a record that the model has not seen"
    )]
    SameRecord {
        /// File of the record to judge on.
        held_out: String,
        /// File of the record to learn from.
        record: String,
    },
}

impl Material {
    /// Reads the records and checks the case.
    ///
    /// # Errors
    /// [`CaseError`], naming the file and what would be right.
    pub fn load(&self) -> Result<Case, CaseError> {
        prepare_threads();
        let supposed = supposed::read(&self.effects)?;
        let catalogue = Catalogue {
            without: self.without.clone(),
            supposed: supposed.iter().map(|(_, effect)| *effect).collect(),
        };
        for name in &self.without {
            check_effect(name, &catalogue)?;
        }
        let (mut parts, mut held_out_part) = (self.records.clone(), self.held_out.clone());
        let model_name = &self.model_name;
        let (columns, model_text) = RigColumns::split_off(&self.model_text, model_name)?;
        let model = ModelFile::parse(&model_text, model_name)?;
        let (uncertainties, assumed) = uncertainties(&model, model_name)?;
        let mut notes: Vec<String> = assumed.into_iter().collect();
        let mut said = Vec::new();
        let mut read_records = Vec::new();
        let mut runs = Vec::new();
        if held_out_part.is_none() && parts.len() > 1 {
            held_out_part = parts.pop();
            if let Some(part) = &held_out_part {
                notes.push(format!(
                    "no record to judge on is given: the last one is held out, {}",
                    part.path.display()
                ));
            }
        }
        for part in &parts {
            let (record, what) = columns.read(part)?;
            said.push((record.source().to_owned(), what));
            if let Some(earlier) = read_records.iter().find(|earlier| same(earlier, &record)) {
                return Err(CaseError::Twice {
                    record: record.source().to_owned(),
                    earlier: earlier.source().to_owned(),
                });
            }
            read_records.push(record);
        }
        let held_out_record = match &held_out_part {
            Some(part) => {
                let (record, what) = columns.read(part)?;
                said.push((record.source().to_owned(), what));
                record
            }
            None => {
                let (learned, held_out, note) = last_quarter(&read_records[0]);
                notes.push(note);
                read_records = vec![learned];
                held_out
            }
        };
        notes.extend(about(&said));
        let stated = self.sensors()?;
        let checked = |record: &Record| -> Result<Checked, CaseError> {
            let checked = check(record, &model.rig)?;
            if let Some((sensors, file)) = &stated {
                sensors.check_for(file, &checked.name, checked.has())?;
            }
            Ok(checked)
        };
        for record in &read_records {
            let checked = checked(record)?;
            runs.extend(stretches(&checked));
            notes.extend(checked.notes);
        }
        let seconds: f64 = runs.iter().map(duration).sum();
        let needed = SHORTEST * natural_period(&model.rig);
        if seconds < needed {
            return Err(CaseError::TooShort { seconds, needed });
        }
        if let Some(record) = read_records
            .iter()
            .find(|record| same(record, &held_out_record))
        {
            return Err(CaseError::SameRecord {
                held_out: held_out_record.source().to_owned(),
                record: record.source().to_owned(),
            });
        }
        let checked = checked(&held_out_record)?;
        let mut held_out = stretches(&checked);
        notes.extend(checked.notes);
        let estimated = estimate(&runs);
        let instruments = match &stated {
            Some((sensors, file)) => {
                let told = sensors.completed(&estimated);
                notes.extend(
                    contradictions(&told, &estimated)
                        .iter()
                        .map(|contradiction| format!("{file}: {contradiction}; the file counts")),
                );
                told
            }
            None => {
                notes.push(format!(
                    "no sensors.toml: the instruments are estimated from the records: {}",
                    in_words(&estimated)
                ));
                estimated
            }
        };
        let load_noise = stated.and_then(|(sensors, _)| sensors.load_cell_noise);
        notes.extend(clean(&instruments, load_noise, &mut runs, &mut held_out));
        notes.extend(note_on_inputs(&runs));
        let case = Case {
            name: self.name.clone(),
            model,
            model_text,
            uncertainties,
            instruments,
            records: runs,
            held_out,
            catalogue,
            notes,
        };
        case.check_supposed(&supposed)?;
        Ok(case)
    }

    /// What the sensor file states, with its name; `None` where there is none.
    fn sensors(&self) -> Result<Option<(Sensors, &str)>, SensorError> {
        self.sensors
            .as_ref()
            .map(|(file, text)| Ok((Sensors::parse(text, file)?, file.as_str())))
            .transpose()
    }
}

/// The record to judge on, cut into windows.
#[derive(Debug, Clone)]
pub struct Judging {
    /// The plant's units, in which `data` is.
    pub units: PlantUnits,
    /// The windows.
    pub data: Data,
    /// The same stretches in SI units, readings in the middle of their steps.
    pub records: Vec<RawRecord>,
    /// Standard deviations of the channels, SI units.
    pub deviations: [f64; CHANNELS],
}

impl Case {
    /// The problem that the records to learn from pose.
    ///
    /// # Errors
    /// A number of the model leaves its range in the plant's units.
    pub fn problem(&self) -> Result<Problem, ParameterError> {
        self.problem_of(&self.records)
    }

    /// The record to judge on, cut into windows that start as `begin` wants it.
    ///
    /// # Errors
    /// As for [`Self::problem`].
    pub fn judging(&self, begin: Begin) -> Result<Judging, ParameterError> {
        let problem = self.problem_of(&self.held_out)?;
        let runs = std::sync::Arc::clone(&problem.long.runs);
        let data = problem.windows_of(runs, begin);
        Ok(Judging {
            units: problem.units,
            data,
            records: in_the_middle(&self.held_out, &self.instruments),
            deviations: self.instruments.deviations(),
        })
    }

    /// Refuses effects that cannot be tried on the model, and names their file.
    fn check_supposed(&self, supposed: &[(&str, Supposition)]) -> Result<(), CaseError> {
        if supposed.is_empty() {
            return Ok(());
        }
        self.problem().map(|_| ()).map_err(|source| {
            let of = |effect: &Supposition| format!("effect {}", effect.definition.name());
            let file = supposed.iter().find(|(_, effect)| {
                matches!(&source, ParameterError::Inconsistent { section, .. } if *section == of(effect))
            });
            CaseError::Effect {
                file: file.map_or_else(|| self.name.clone(), |(file, _)| (*file).to_owned()),
                source,
            }
        })
    }

    fn problem_of(&self, records: &[RawRecord]) -> Result<Problem, ParameterError> {
        Problem::new(
            &self.model.rig,
            self.uncertainties.clone(),
            records,
            &self.instruments,
            &self.catalogue,
        )
    }
}

/// Refuses names that the catalogue does not have.
///
/// # Errors
/// [`CaseError::UnknownEffect`] with all names.
pub fn check_effect(name: &str, catalogue: &Catalogue) -> Result<(), CaseError> {
    let supposed = &catalogue.supposed;
    let known: Vec<&str> = CATALOGUE
        .iter()
        .map(|entry| entry.name)
        .chain(supposed.iter().map(|effect| effect.definition.name()))
        .collect();
    if known.contains(&name) {
        return Ok(());
    }
    let hint = closest(name, known.iter().copied())
        .map(|near| format!(" (is `{near}` meant?)"))
        .unwrap_or_default();
    Err(CaseError::UnknownEffect {
        name: name.to_owned(),
        hint,
        known: known.join(", "),
    })
}

/// Stack of the engine's threads [bytes]: a model with thirty derivatives of every number needs more than the usual 2 MiB.
pub(crate) const STACK: usize = 64 << 20;

/// Gives the engine's threads their stack. Every work of the engine begins with reading a case.
pub(crate) fn prepare_threads() {
    // A second call finds the threads made already, as it should.
    let _ = rayon::ThreadPoolBuilder::new()
        .stack_size(STACK)
        .build_global();
}

/// A record but for its last quarter, that quarter, and what is said about it.
fn last_quarter(record: &Record) -> (Record, Record, String) {
    let time = record.time();
    let (first, last) = (time[0], time[time.len() - 1]);
    let cut = first + 0.75 * (last - first);
    let note = format!(
        "no record to judge on is given: the last quarter of {} is held out, from {cut:.3} s on",
        record.source()
    );
    let (learned, held_out) = (record.window(first, cut), record.window(cut, f64::INFINITY));
    (learned, held_out, note)
}

/// Takes out of records what never changes, which was not measured, and the noise of the load cells; `known_noise` is what the sensor
/// file states of that [N]. Notes on what was taken out.
pub(crate) fn clean(
    instruments: &Instruments,
    known_noise: Option<f64>,
    learned: &mut [RawRecord],
    held_out: &mut [RawRecord],
) -> Vec<String> {
    let mut notes = Vec::new();
    for (channel, name) in COLUMNS[INPUTS..INPUTS + CHANNELS].iter().enumerate() {
        let is_there = learned.iter().any(|run| !run.readings[channel].is_empty());
        if is_there && instruments.deviations()[channel] == 0.0 {
            notes.push(format!("column not used: {name}, which never changes"));
            for record in learned.iter_mut().chain(&mut *held_out) {
                record.readings[channel].clear();
            }
        }
    }
    let noise_of = |force: fn(&RawRecord) -> &Vec<f64>| {
        let forces = learned.iter();
        let forces: Vec<Series> = forces
            .map(|run| (run.time.as_slice(), force(run).as_slice()))
            .collect();
        known_noise.unwrap_or_else(|| load_noise(&forces))
    };
    let noise = [
        noise_of(|run| &run.normal_force),
        noise_of(|run| &run.normal_force_1),
    ];
    for record in learned.iter_mut().chain(held_out) {
        record.normal_force = denoise(&record.normal_force, noise[0]);
        record.normal_force_1 = denoise(&record.normal_force_1, noise[1]);
        record.load_deviations = noise;
    }
    notes
}

/// A record's stretches without holes.
pub(crate) fn stretches(checked: &Checked) -> Vec<RawRecord> {
    checked
        .stretches
        .iter()
        .map(|stretch| {
            let [voltage, normal_force, readings @ .., normal_force_1] = &stretch.columns;
            RawRecord {
                name: checked.name.clone(),
                time: stretch.time.clone(),
                voltage: voltage.clone(),
                normal_force: normal_force.clone(),
                normal_force_1: normal_force_1.clone(),
                readings: readings.clone(),
                ..RawRecord::default()
            }
        })
        .collect()
}

/// Length of a record [s].
fn duration(record: &RawRecord) -> f64 {
    match (record.time.first(), record.time.last()) {
        (Some(first), Some(last)) => last - first,
        _ => 0.0,
    }
}
