//! An FMU of either version, run through its binary.

use std::error::Error;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crate::binary_header;
use libloading::Library;

use super::archive::Archive;
use super::description::{Description, FmiVersion};
use super::fmu2::Fmi2;
use super::fmu3::Fmi3;
use super::variable::{Kind, Variable};
use super::{Component, ComponentError};

const DESCRIPTION: &str = "modelDescription.xml";
/// Largest description that is read [bytes]: some 50,000 variables.
const LARGEST_DESCRIPTION: u64 = 16 << 20;
/// Largest binary whose headers are looked at [bytes]: it is held in memory meanwhile.
const LARGEST_BINARY: u64 = 128 << 20;

/// What FMUs wrote to their log, oldest first.
pub(super) type Log = Arc<Mutex<Vec<String>>>;

/// Adds a line to the log.
pub(super) fn write_log(log: &Mutex<Vec<String>>, line: String) {
    log.lock()
        .unwrap_or_else(PoisonError::into_inner)
        .push(line);
}

/// What went wrong in a call: the function and the status it returned.
pub(super) struct Failed {
    pub(super) function: &'static str,
    pub(super) status: i32,
}

/// One instance of an FMU, whatever its version.
pub(super) trait Instance {
    fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Result<(), Failed>;
    fn reals(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Failed>;
    fn boolean(&mut self, reference: u32) -> Result<bool, Failed>;
    fn initialise(&mut self, start: f64, stop: f64, tolerance: Option<f64>) -> Result<(), Failed>;
    fn step(&mut self, from: f64, length: f64) -> Result<(), Failed>;
    fn reset(&mut self) -> Result<(), Failed>;
}

/// An FMU, unpacked, loaded and instantiated.
pub struct Fmu {
    path: PathBuf,
    description: Description,
    log: Log,
    time: f64,
    tolerance: Option<f64>,
    // Dropped in this order: the instance while its binary is loaded, the binary while its file is there.
    instance: Box<dyn Instance>,
    _archive: Archive,
}

impl Fmu {
    /// Unpacks, loads and instantiates the FMU `path`.
    ///
    /// Its binary is run: that is what an FMU is for. The archive and the description are checked before.
    ///
    /// # Errors
    /// [`ComponentError`], saying which of these it was and why.
    pub fn open(path: &Path) -> Result<Self, ComponentError> {
        let (archive, description) = Self::unpack(path)?;
        let binary = |reason: String| ComponentError::Binary {
            path: path.to_owned(),
            reason,
        };
        let file = binary_file(&archive, &description).map_err(binary)?;
        let content =
            read_up_to(&file, LARGEST_BINARY).map_err(|error| binary(error.to_string()))?;
        binary_header::check(&content).map_err(|error| binary(error.to_string()))?;
        drop(content);
        // SAFETY: loading runs the library's initialisers, as the user asks for by naming the FMU.
        let library = unsafe { Library::new(&file) }
            .map_err(|error| binary(with_python(with_causes(&error))))?;
        let log = Log::default();
        let resources = archive.directory().join("resources");
        let instance: Result<Box<dyn Instance>, String> = match description.version {
            FmiVersion::Two => Fmi2::new(library, &description, &resources, log.clone())
                .map(|fmu| Box::new(fmu) as _),
            FmiVersion::Three => Fmi3::new(library, &description, &resources, log.clone())
                .map(|fmu| Box::new(fmu) as _),
        };
        let instance = instance.map_err(|reason| binary(reason + &taken(&log)))?;
        Ok(Self {
            path: path.to_owned(),
            description,
            log,
            time: 0.0,
            tolerance: None,
            instance,
            _archive: archive,
        })
    }

    /// What the FMU `path` says of itself, without loading its binary.
    ///
    /// # Errors
    /// [`ComponentError`] where the archive or the description is refused.
    pub fn describe(path: &Path) -> Result<Description, ComponentError> {
        Self::unpack(path).map(|(_, description)| description)
    }

    /// Relative tolerance for the runs to come; without it the FMU takes its own.
    pub fn set_tolerance(&mut self, tolerance: Option<f64>) {
        self.tolerance = tolerance;
    }

    /// Whether it takes communication steps of any length.
    #[must_use]
    pub fn takes_any_step(&self) -> bool {
        self.description.takes_any_step
    }

    fn unpack(path: &Path) -> Result<(Archive, Description), ComponentError> {
        let archive = Archive::unpack(path)?;
        let text = description_text(&archive.directory().join(DESCRIPTION)).map_err(|source| {
            ComponentError::Read {
                path: path.join(DESCRIPTION),
                source,
            }
        })?;
        let description = Description::parse(&text, path)?;
        Ok((archive, description))
    }

    fn check<T>(&self, result: Result<T, Failed>) -> Result<T, ComponentError> {
        result.map_err(|failed| ComponentError::Call {
            function: failed.function,
            time: self.time,
            status: status_name(failed.status),
            log: taken(&self.log),
        })
    }
}

fn status_name(status: i32) -> String {
    match status {
        2 => "discard".to_owned(),
        3 => "error".to_owned(),
        4 => "fatal".to_owned(),
        other => format!("status {other}"),
    }
}

/// An error with what caused it: the loader's own words are in the cause.
fn with_causes(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        text += &format!(": {inner}");
        cause = inner.source();
    }
    text
}

/// The text of a description, if it is of a size that can be read in no time.
fn description_text(file: &Path) -> io::Result<String> {
    let bytes = read_up_to(file, LARGEST_DESCRIPTION)?;
    String::from_utf8(bytes).map_err(io::Error::other)
}

/// The content of a file of at most so many bytes.
fn read_up_to(file: &Path, largest: u64) -> io::Result<Vec<u8>> {
    let size = fs::metadata(file)?.len();
    if size > largest {
        return Err(io::Error::other(format!(
            "it has {size} bytes; more than {largest} are not read"
        )));
    }
    fs::read(file)
}

/// Empties the log into the end of a message.
fn taken(log: &Log) -> String {
    let lines = std::mem::take(&mut *log.lock().unwrap_or_else(PoisonError::into_inner));
    if lines.is_empty() {
        String::new()
    } else {
        format!(": {}", lines.join("; "))
    }
}

/// What a failure to load an FMU says, with what helps where the FMU wants an interpreter that the program does not have.
fn with_python(reason: String) -> String {
    if reason.contains("symbol: Py") || reason.contains("symbol: _Py") {
        reason
            + "; the FMU runs in Python: start the program with LD_PRELOAD=libpython3.11.so, the library of the Python that made it"
    } else {
        reason
    }
}

/// The binary for this machine inside the archive.
fn binary_file(archive: &Archive, description: &Description) -> Result<PathBuf, String> {
    let (system_2, system_3) = match std::env::consts::OS {
        "linux" => ("linux", "linux"),
        "macos" => ("darwin", "darwin"),
        "windows" => ("win", "windows"),
        other => return Err(format!("FMUs are not known to run on {other}")),
    };
    let folder = match description.version {
        FmiVersion::Two => format!("{system_2}{}", usize::BITS),
        FmiVersion::Three => format!("{}-{system_3}", std::env::consts::ARCH),
    };
    let binaries = archive.directory().join("binaries");
    let file = binaries
        .join(&folder)
        .join(&description.model_identifier)
        .with_extension(std::env::consts::DLL_EXTENSION);
    if file.is_file() {
        return Ok(file);
    }
    let mut there: Vec<String> = fs::read_dir(&binaries)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    there.sort();
    Err(format!(
        "there is none for {folder}; it has binaries for {}",
        if there.is_empty() {
            "nothing".to_owned()
        } else {
            there.join(", ")
        }
    ))
}

impl Component for Fmu {
    fn title(&self) -> String {
        self.path.display().to_string()
    }

    fn variables(&self) -> &[Variable] {
        &self.description.variables
    }

    fn set(&mut self, values: &[(usize, f64)]) -> Result<(), ComponentError> {
        let references: Vec<u32> = values
            .iter()
            .map(|(position, _)| self.description.variables[*position].reference)
            .collect();
        let numbers: Vec<f64> = values.iter().map(|(_, value)| *value).collect();
        if references.is_empty() {
            return Ok(());
        }
        let result = self.instance.set_reals(&references, &numbers);
        self.check(result)
    }

    fn initialise(&mut self, start: f64, stop: f64) -> Result<(), ComponentError> {
        self.time = start;
        let result = self.instance.initialise(start, stop, self.tolerance);
        self.check(result)
    }

    fn reset(&mut self) -> Result<(), ComponentError> {
        let result = self.instance.reset();
        self.check(result)
    }

    fn get(&mut self, positions: &[usize], values: &mut [f64]) -> Result<(), ComponentError> {
        let variables = &self.description.variables;
        let reals: Vec<usize> = (0..positions.len())
            .filter(|&at| variables[positions[at]].kind == Kind::Real)
            .collect();
        let references: Vec<u32> = reals
            .iter()
            .map(|&at| variables[positions[at]].reference)
            .collect();
        let mut numbers = vec![0.0; reals.len()];
        let result = self.instance.reals(&references, &mut numbers);
        self.check(result)?;
        for (at, number) in reals.into_iter().zip(numbers) {
            values[at] = number;
        }
        for (at, position) in positions.iter().enumerate() {
            let variable = &self.description.variables[*position];
            if variable.kind == Kind::Boolean {
                let result = self.instance.boolean(variable.reference);
                values[at] = f64::from(self.check(result)?);
            }
        }
        Ok(())
    }

    fn step(&mut self, from: f64, to: f64) -> Result<(), ComponentError> {
        self.time = from;
        let result = self.instance.step(from, to - from);
        self.check(result)?;
        self.time = to;
        Ok(())
    }

    fn switches(&self) -> Option<u64> {
        None
    }
}
