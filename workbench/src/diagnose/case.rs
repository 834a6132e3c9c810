//! A case: the analyst's model, the records to learn from, the record to judge on, and the sensors.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use stickslip::plant::{ModelFile, ModelFileError, RigKind};
use thiserror::Error;

use super::catalogue::CATALOGUE;
use super::data::Data;
use super::record_check::{Checked, RecordProblem, check};
use super::run::Run;
use super::sensors::{SensorError, Sensors};
use super::window::{Begin, Cut};
use crate::component::closest;
use crate::files::record::{Missing, Record, RecordError};

/// Names of a case's files in its directory.
pub const MODEL_FILE: &str = "model.toml";
const HELD_OUT_FILE: &str = "held-out.csv";
const SENSORS_FILE: &str = "sensors.toml";
/// Least length of all records to learn from together [s].
const SHORTEST: f64 = 5.0;

/// Where a case's files are.
#[derive(Debug, Clone, Default, Args)]
pub struct CaseArguments {
    /// Directory with model.toml, run-*.csv, held-out.csv and, if need be, sensors.toml.
    #[arg(conflicts_with_all = ["model", "records", "held_out"], required_unless_present = "model")]
    pub case: Option<PathBuf>,
    /// The model that the analyst believes.
    #[arg(long, value_name = "FILE", requires_all = ["records", "held_out"])]
    pub model: Option<PathBuf>,
    /// Records to learn from.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub records: Vec<PathBuf>,
    /// Record to judge on; never fitted to.
    #[arg(long, value_name = "FILE")]
    pub held_out: Option<PathBuf>,
    /// Steps and noise of the instruments; without it those of the dissertation's rig.
    #[arg(long, value_name = "FILE")]
    pub sensors: Option<PathBuf>,
    /// Leave this effect out of the catalogue; may be given several times.
    #[arg(long, value_name = "NAME")]
    pub without: Vec<String>,
}

/// A case, read and checked.
#[derive(Debug, Clone)]
pub struct Case {
    /// What messages and the report call it.
    pub name: String,
    /// The analyst's model.
    pub model: ModelFile,
    /// Text of the analyst's model file.
    pub model_text: String,
    /// The instruments.
    pub sensors: Sensors,
    /// Stretches of records to learn from.
    pub runs: Vec<Run>,
    /// Stretches of the record to judge on.
    pub held_out: Vec<Run>,
    /// Effects taken out of the catalogue.
    pub without: Vec<String>,
    /// What has to be said about the records.
    pub notes: Vec<String>,
}

/// Why a case cannot be used.
#[derive(Debug, Error)]
pub enum CaseError {
    /// A file cannot be read.
    #[error("{path}: cannot be read: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// The directory has no records to learn from.
    #[error("{path}: has no record run-*.csv to learn from")]
    NoRecords {
        /// The directory.
        path: PathBuf,
    },
    /// The model file is wrong.
    #[error(transparent)]
    Model(#[from] ModelFileError),
    /// The model is of the full rig.
    #[error(
        "{file}: describes the full rig with disc D1; a diagnosis needs the reduced rig, without [disc1], [shaft1] and [contact1]"
    )]
    FullRig {
        /// The model file.
        file: String,
    },
    /// The sensor file is wrong.
    #[error(transparent)]
    Sensors(#[from] SensorError),
    /// A record is no record.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A record cannot be used.
    #[error(transparent)]
    Problem(#[from] RecordProblem),
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
        "the records to learn from have {seconds:.1} s together; at least {SHORTEST} s are needed, and 20 s for small effects"
    )]
    TooShort {
        /// Length of what can be used [s].
        seconds: f64,
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

impl CaseArguments {
    /// Reads and checks the case.
    ///
    /// # Errors
    /// [`CaseError`], naming the file and what would be right.
    pub fn load(&self) -> Result<Case, CaseError> {
        prepare_threads();
        for name in &self.without {
            check_effect(name)?;
        }
        let (model_path, record_paths, held_out_path) = self.paths()?;
        let model_text = read(&model_path)?;
        let model_name = model_path.display().to_string();
        let model = ModelFile::parse(&model_text, &model_name)?;
        if model.rig.kind() != RigKind::Reduced {
            return Err(CaseError::FullRig { file: model_name });
        }
        let sensors = self.sensors()?;
        let mut notes = Vec::new();
        let mut runs = Vec::new();
        let mut records = Vec::new();
        for path in &record_paths {
            let record = Record::read_with(path, Missing::KeepAsNan)?;
            if let Some(earlier) = records.iter().find(|earlier| same(earlier, &record)) {
                return Err(CaseError::Twice {
                    record: record.source().to_owned(),
                    earlier: earlier.source().to_owned(),
                });
            }
            let checked = check(&record, &model.rig, &sensors)?;
            runs.extend(stretches(&checked, &sensors));
            notes.extend(checked.notes);
            records.push(record);
        }
        let seconds: f64 = runs
            .iter()
            .map(|run| run.interval() * (run.len() - 1) as f64)
            .sum();
        if seconds < SHORTEST {
            return Err(CaseError::TooShort { seconds });
        }
        notes.extend(note_on_inputs(&runs));
        let held_out_record = Record::read_with(&held_out_path, Missing::KeepAsNan)?;
        if let Some(record) = records.iter().find(|record| same(record, &held_out_record)) {
            return Err(CaseError::SameRecord {
                held_out: held_out_record.source().to_owned(),
                record: record.source().to_owned(),
            });
        }
        let checked = check(&held_out_record, &model.rig, &sensors)?;
        let held_out = stretches(&checked, &sensors);
        notes.extend(checked.notes);
        let name = match &self.case {
            Some(directory) => file_name(directory),
            None => file_name(&model_path),
        };
        Ok(Case {
            name,
            model,
            model_text,
            sensors,
            runs,
            held_out,
            without: self.without.clone(),
            notes,
        })
    }

    fn paths(&self) -> Result<(PathBuf, Vec<PathBuf>, PathBuf), CaseError> {
        match (&self.case, &self.model, &self.held_out) {
            (None, Some(model), Some(held_out)) => {
                Ok((model.clone(), self.records.clone(), held_out.clone()))
            }
            (case, _, _) => {
                let directory = case.clone().unwrap_or_default();
                let entries = fs::read_dir(&directory).map_err(|source| CaseError::Read {
                    path: directory.clone(),
                    source,
                })?;
                let mut records: Vec<PathBuf> = entries
                    .flatten()
                    .map(|entry| entry.path())
                    .filter(|path| {
                        let name = file_name(path);
                        name.starts_with("run-") && name.ends_with(".csv")
                    })
                    .collect();
                records.sort();
                if records.is_empty() {
                    return Err(CaseError::NoRecords { path: directory });
                }
                Ok((
                    directory.join(MODEL_FILE),
                    records,
                    directory.join(HELD_OUT_FILE),
                ))
            }
        }
    }

    fn sensors(&self) -> Result<Sensors, CaseError> {
        let beside = self
            .case
            .as_ref()
            .map(|directory| directory.join(SENSORS_FILE))
            .filter(|path| path.is_file());
        match self.sensors.clone().or(beside) {
            Some(path) => Ok(Sensors::parse(&read(&path)?, &path.display().to_string())?),
            None => Ok(Sensors::default()),
        }
    }
}

impl Case {
    /// The records to learn from, cut into windows.
    #[must_use]
    pub fn training(&self) -> Data {
        self.data(&self.runs, Begin::Clear)
    }

    /// The record to judge on, cut into windows that start as `begin` wants it.
    #[must_use]
    pub fn judging(&self, begin: Begin) -> Data {
        self.data(&self.held_out, begin)
    }

    fn data(&self, runs: &[Run], begin: Begin) -> Data {
        Data::new(
            std::sync::Arc::new(runs.to_vec()),
            Cut::of(&self.model.rig, begin),
            self.sensors.deviations(),
        )
    }
}

/// Refuses names that the catalogue does not have.
///
/// # Errors
/// [`CaseError::UnknownEffect`] with all names.
pub fn check_effect(name: &str) -> Result<(), CaseError> {
    if CATALOGUE.iter().any(|entry| entry.name == name) {
        return Ok(());
    }
    let known: Vec<&str> = CATALOGUE.iter().map(|entry| entry.name).collect();
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
const STACK: usize = 64 << 20;

/// Gives the engine's threads their stack. Every work of the engine begins with reading a case.
fn prepare_threads() {
    // A second call finds the threads made already, as it should.
    let _ = rayon::ThreadPoolBuilder::new()
        .stack_size(STACK)
        .build_global();
}

fn read(path: &Path) -> Result<String, CaseError> {
    fs::read_to_string(path).map_err(|source| CaseError::Read {
        path: path.to_owned(),
        source,
    })
}

fn file_name(path: &Path) -> String {
    let full = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    full.file_name().map_or_else(
        || path.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    )
}

fn stretches(checked: &Checked, sensors: &Sensors) -> Vec<Run> {
    checked
        .stretches
        .iter()
        .map(|stretch| {
            let [voltage, force, theta, theta_dot, theta3, theta3_dot] = &stretch.columns;
            Run::new(
                checked.name.clone(),
                stretch.time.clone(),
                voltage.clone(),
                force,
                [theta, theta_dot, theta3, theta3_dot],
                sensors,
            )
        })
        .collect()
}

/// Share of readings in common from which on two records are one measurement.
const IN_COMMON: f64 = 0.2;

/// Whether two records are one measurement, or parts of one: readings of the same moment agree to the last digit, and
/// noise does not repeat. Rows at rest are left out, since without noise they are all alike.
fn same(left: &Record, right: &Record) -> bool {
    let (left, right) = (readings(left), readings(right));
    let (fewer, more) = if left.len() < right.len() {
        (left, right)
    } else {
        (right, left)
    };
    let common = fewer.intersection(&more).count();
    common as f64 > IN_COMMON * fewer.len() as f64
}

/// The different rows of readings with motion, bit by bit.
fn readings(record: &Record) -> BTreeSet<[u64; 4]> {
    let columns = ["theta", "theta_dot", "theta3", "theta3_dot"].map(|name| record.column(name));
    let [Some(theta), Some(theta_dot), Some(theta3), Some(theta3_dot)] = columns else {
        return BTreeSet::new();
    };
    (0..record.len())
        .filter(|&row| theta_dot[row] != 0.0 && theta[row] != 0.0)
        .map(|row| [theta[row], theta_dot[row], theta3[row], theta3_dot[row]].map(f64::to_bits))
        .collect()
}

fn note_on_inputs(runs: &[Run]) -> Option<String> {
    let constant = |series: fn(&Run) -> &[f64], tolerance: f64| {
        let values = || runs.iter().flat_map(|run| series(run).iter());
        let (low, high) = values().fold((f64::MAX, f64::MIN), |(low, high), v| {
            (low.min(*v), high.max(*v))
        });
        high - low <= tolerance
    };
    let what = match (
        constant(|run| &run.voltage, 0.02),
        constant(|run| &run.normal_force, 0.5),
    ) {
        (false, false) => return None,
        (true, false) => {
            "the voltage is the same throughout: effects of motor and supply cannot be told from each other"
        }
        (false, true) => {
            "the normal force is the same throughout: what grows with it cannot be told from what does not"
        }
        (true, true) => {
            "voltage and normal force are the same throughout: many effects cannot be told from each other"
        }
    };
    Some(format!("records to learn from: {what}"))
}
