//! What a case is made of: files that the command line names, or a model and tables in memory.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::case::{Case, CaseError};
use super::record_part::{Part, PartError};
use super::supposed;
use crate::files::record::ENDINGS;
use stickslip::body::is_small_plant;

/// Names of a case's files in its directory.
const MODEL_FILE: &str = "model.toml";
/// Name of the record to judge on, before its ending.
const HELD_OUT: &str = "held-out";
/// What the names of the records to learn from begin with.
const LEARNED: &str = "run-";
const SENSORS_FILE: &str = "sensors.toml";
/// Directory of a case with effects of its own.
const EFFECTS_DIRECTORY: &str = "effects";

/// Where a case's files are.
#[derive(Debug, Clone, Default, Args)]
pub struct CaseArguments {
    /// Directory with model.toml, run-*.csv (or .parquet, .xlsx) and, if need be, held-out.csv, sensors.toml and effects/.
    #[arg(conflicts_with_all = ["model", "records", "held_out"], required_unless_present = "model")]
    pub case: Option<PathBuf>,
    /// The model that the analyst believes: a model.toml, or an FMU with --ports.
    #[arg(long, value_name = "FILE", requires = "records")]
    pub model: Option<PathBuf>,
    /// How the FMU of --model meets the records; `stickslip ports plant.fmu` writes a first one.
    #[arg(long, value_name = "FILE", requires = "model")]
    pub ports: Option<PathBuf>,
    /// Records to learn from, whole or from one time to another: FILE@FROM:TO, in seconds.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub records: Vec<PathBuf>,
    /// Record to judge on; never fitted to. Without it the last record is held out, or the last quarter of a single one.
    #[arg(long, value_name = "FILE")]
    pub held_out: Option<PathBuf>,
    /// Steps and noise of the instruments; without it they are estimated from the records.
    #[arg(long, value_name = "FILE")]
    pub sensors: Option<PathBuf>,
    /// Directory with effects of your own, files *.toml with sections [[effect]], which are tried beside those of the catalogue.
    /// Without it the directory effects/ of the case.
    #[arg(long, value_name = "DIR")]
    pub catalogue: Option<PathBuf>,
    /// Leave this effect out of the catalogue; may be given several times.
    #[arg(long, value_name = "NAME")]
    pub without: Vec<String>,
}

/// What a case is made of. The records that are files are still to be read.
#[derive(Debug, Clone, Default)]
pub struct Material {
    /// What messages and the report call the case.
    pub name: String,
    /// The model file, or what messages call the model.
    pub model_name: String,
    /// Text of the model file, with its `[columns]`.
    pub model_text: String,
    /// Where relative paths in the model file begin.
    pub directory: PathBuf,
    /// The FMU, where the model file does not name it.
    pub fmu: Option<PathBuf>,
    /// Records to learn from.
    pub records: Vec<Part>,
    /// Record to judge on; without it the last one to learn from is held out, or the last quarter of a single one.
    pub held_out: Option<Part>,
    /// Name and text of the sensor file; without it the instruments are estimated from the records.
    pub sensors: Option<(String, String)>,
    /// Names and texts of files with effects that are tried beside those of the catalogue.
    pub effects: Vec<(String, String)>,
    /// Effects taken out of the catalogue.
    pub without: Vec<String>,
    /// The command that was typed; `None` where another program calls.
    pub command: Option<String>,
}

impl Material {
    /// Whether the model is that of a small plant.
    #[must_use]
    pub fn is_of_small_plant(&self) -> bool {
        is_small_plant(&self.model_text)
    }
}

impl CaseArguments {
    /// Reads and checks the case.
    ///
    /// # Errors
    /// [`CaseError`], naming the file and what would be right.
    pub fn load(&self) -> Result<Case, CaseError> {
        self.material()?.load()
    }

    /// What the case is made of; its model and sensors are read.
    ///
    /// # Errors
    /// [`CaseError`] where a file cannot be read, or the directory has no record.
    pub fn material(&self) -> Result<Material, CaseError> {
        let (model_path, records, held_out) = self.paths()?;
        let sensors = self.sensors_path().map(|path| named_text(&path));
        let is_fmu = model_path.extension().is_some_and(|own| own == "fmu");
        let (fmu, model_path) = match &self.ports {
            Some(ports) => (Some(model_path), ports.clone()),
            None if is_fmu => return Err(CaseError::NoPorts { path: model_path }),
            None => (None, model_path),
        };
        let (model_name, model_text) = named_text(&model_path)?;
        let directory = model_path.parent().map(Path::to_owned).unwrap_or_default();
        Ok(Material {
            name: file_name(self.case.as_ref().unwrap_or(&model_path)),
            model_name,
            model_text,
            directory,
            fmu,
            records,
            held_out,
            sensors: sensors.transpose()?,
            effects: self.effects()?,
            without: self.without.clone(),
            command: None,
        })
    }

    /// The model file, the records to learn from, and the one to judge on where it is given.
    fn paths(&self) -> Result<(PathBuf, Vec<Part>, Option<Part>), CaseError> {
        match (&self.case, &self.model) {
            (None, Some(model)) => {
                let records: Result<Vec<Part>, PartError> =
                    self.records.iter().map(|path| Part::parse(path)).collect();
                let held_out = self.held_out.as_deref().map(Part::parse).transpose()?;
                Ok((model.clone(), records?, held_out))
            }
            (case, _) => {
                let directory = case.clone().unwrap_or_default();
                let entries = fs::read_dir(&directory).map_err(|source| CaseError::Read {
                    path: directory.clone(),
                    source,
                })?;
                let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
                files.retain(|path| {
                    ENDINGS
                        .iter()
                        .any(|end| path.extension().is_some_and(|own| own == *end))
                });
                files.sort();
                let is_held_out =
                    |path: &&PathBuf| path.file_stem().is_some_and(|own| own == HELD_OUT);
                let held_out = files.iter().find(is_held_out).cloned();
                let records: Vec<PathBuf> = files
                    .into_iter()
                    .filter(|path| file_name(path).starts_with(LEARNED))
                    .collect();
                if records.is_empty() {
                    return Err(CaseError::NoRecords { path: directory });
                }
                Ok((
                    directory.join(MODEL_FILE),
                    records.into_iter().map(Part::whole).collect(),
                    held_out.map(Part::whole),
                ))
            }
        }
    }

    /// The files with effects of one's own.
    fn effects(&self) -> Result<Vec<(String, String)>, CaseError> {
        let beside = self
            .case
            .as_ref()
            .map(|directory| directory.join(EFFECTS_DIRECTORY))
            .filter(|path| path.is_dir());
        let directory = self.catalogue.clone().or(beside);
        directory.map_or(Ok(Vec::new()), |directory| supposed::files(&directory))
    }

    /// The sensor file, where there is one.
    fn sensors_path(&self) -> Option<PathBuf> {
        let beside = self
            .case
            .as_ref()
            .map(|directory| directory.join(SENSORS_FILE))
            .filter(|path| path.is_file());
        self.sensors.clone().or(beside)
    }
}

/// A file's name and text.
pub(super) fn named_text(path: &Path) -> Result<(String, String), CaseError> {
    let text = fs::read_to_string(path).map_err(|source| CaseError::Read {
        path: path.to_owned(),
        source,
    })?;
    Ok((path.display().to_string(), text))
}

fn file_name(path: &Path) -> String {
    let full = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    full.file_name().map_or_else(
        || path.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    )
}
