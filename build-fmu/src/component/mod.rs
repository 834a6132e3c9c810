//! Components that can be stepped: the native model of a `model.toml`, and FMUs of both versions, seen alike.

mod archive;
mod description;
mod fmu;
mod fmu2;
mod fmu3;
mod native;
mod variable;

use std::path::{Path, PathBuf};

use thiserror::Error;

pub use archive::{Archive, ArchiveError};
pub(crate) use description::document;
pub use description::{Description, DescriptionError, FmiVersion};
pub use fmu::Fmu;
pub use native::Native;
pub use variable::{Kind, Role, Variable, closest};

/// Why a component could not be opened or run.
#[derive(Debug, Error)]
pub enum ComponentError {
    /// The file could not be read.
    #[error("{path}: cannot be read: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// The file's name says neither that it is a model nor that it is an FMU.
    #[error("{path}: is neither a model (.toml) nor an FMU (.fmu)")]
    UnknownFile {
        /// The file.
        path: PathBuf,
    },
    /// The model file is wrong, or the model refused something.
    #[error("{0}")]
    Model(String),
    /// The FMU's archive was refused.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// The FMU's description was refused.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// The FMU's binary could not be loaded.
    #[error("{path}: the binary cannot be used: {reason}")]
    Binary {
        /// The FMU.
        path: PathBuf,
        /// What went wrong.
        reason: String,
    },
    /// A call into the FMU failed.
    #[error("the FMU answered {function} at t = {time} s with {status}{log}")]
    Call {
        /// Function of the standard.
        function: &'static str,
        /// Time of the call [s].
        time: f64,
        /// The status it returned.
        status: String,
        /// What it wrote to its log, with a colon before it; empty where it wrote nothing.
        log: String,
    },
    /// There is no variable of that name.
    #[error("{component} has no variable `{name}`{hint}")]
    UnknownVariable {
        /// Name of the component's file.
        component: String,
        /// The name that was asked for.
        name: String,
        /// The nearest name, as half a sentence; may be empty.
        hint: String,
    },
}

/// Something that happened at an instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// When [s].
    pub time: f64,
    /// What, in words.
    pub what: String,
}

/// A component that can be stepped.
///
/// Order of calls: [`set`](Component::set) parameters and first inputs, [`initialise`](Component::initialise), then `set`
/// inputs, [`get`](Component::get) and [`step`](Component::step) in turn.
pub trait Component {
    /// What it is, in a few words: name of the model and how it runs.
    fn title(&self) -> String;

    /// All its variables.
    fn variables(&self) -> &[Variable];

    /// Sets real variables, given as positions in [`variables`](Component::variables) with values in their units.
    ///
    /// # Errors
    /// The component refuses a value.
    fn set(&mut self, values: &[(usize, f64)]) -> Result<(), ComponentError>;

    /// Ends the set-up: the run begins at `start` [s] and will not go beyond `stop` [s].
    ///
    /// # Errors
    /// The component refuses its parameters.
    fn initialise(&mut self, start: f64, stop: f64) -> Result<(), ComponentError>;

    /// Goes back to before the set-up, with the start values of the component's file.
    ///
    /// # Errors
    /// The component cannot go back.
    fn reset(&mut self) -> Result<(), ComponentError>;

    /// Values now of the variables at the given positions; Booleans as 0 and 1.
    ///
    /// # Errors
    /// The component cannot give a value.
    fn get(&mut self, positions: &[usize], values: &mut [f64]) -> Result<(), ComponentError>;

    /// Advances from `from` to `to` [s].
    ///
    /// # Errors
    /// The component cannot go on.
    fn step(&mut self, from: f64, to: f64) -> Result<(), ComponentError>;

    /// Number of switches between sticking and slipping so far, where the component tells.
    fn switches(&self) -> Option<u64>;

    /// Hands on, and forgets, what happened since it was last asked or reset; empty where the component does not tell.
    fn take_events(&mut self) -> Vec<Event> {
        Vec::new()
    }
}

/// Opens a `model.toml` natively or an `.fmu` through its binary, by the file's extension.
///
/// # Errors
/// [`ComponentError`], naming the file and what is wrong with it.
pub fn open(path: &Path) -> Result<Box<dyn Component>, ComponentError> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("toml") => Ok(Box::new(Native::open(path)?)),
        Some("fmu") => Ok(Box::new(Fmu::open(path)?)),
        _ => Err(ComponentError::UnknownFile {
            path: path.to_owned(),
        }),
    }
}

/// Position of the variable with this name.
///
/// # Errors
/// [`ComponentError::UnknownVariable`], with the nearest name there is.
pub fn position(component: &dyn Component, name: &str) -> Result<usize, ComponentError> {
    let variables = component.variables();
    variables
        .iter()
        .position(|variable| variable.name == name)
        .ok_or_else(|| {
            let names = variables.iter().map(|variable| variable.name.as_str());
            ComponentError::UnknownVariable {
                component: component.title(),
                name: name.to_owned(),
                hint: closest(name, names)
                    .map(|near| format!("; did you mean `{near}`?"))
                    .or_else(|| absent_section(component, name))
                    .unwrap_or_default(),
            }
        })
}

/// What to do about a number of a section that the component does not have.
fn absent_section(component: &dyn Component, name: &str) -> Option<String> {
    let (section, _) = name.split_once('.')?;
    let prefix = format!("{section}.");
    let variables = component.variables();
    let is_there = variables
        .iter()
        .any(|variable| variable.name.starts_with(&prefix));
    (!is_there).then(|| format!("; its model file has no section [{section}]: add it there first"))
}
