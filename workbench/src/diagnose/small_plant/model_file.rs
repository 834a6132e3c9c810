//! `model.toml` of a small plant: what it is, its columns, how it is measured, its numbers and effects.

use std::collections::BTreeMap;

use serde::Deserialize;
use thiserror::Error;

use super::columns::{ColumnError, Columns};
use super::fmu::ports::Ports;
use super::model::Model;
use super::model_reader::Reader;
use super::term::Entry;

/// What is wrong with a small plant's model file.
#[derive(Debug, Error)]
pub enum SmallModelError {
    /// Not TOML, or a key of a fixed section is missing, unknown or of the wrong type.
    #[error("{file}: {message}")]
    Syntax {
        /// File.
        file: String,
        /// What the parser says.
        message: String,
    },
    /// A wrong word or number.
    #[error("{file}: [{section}] {key} = {found} must be {expected}")]
    Value {
        /// File.
        file: String,
        /// Section.
        section: String,
        /// Key.
        key: String,
        /// What stands there.
        found: String,
        /// What would be right.
        expected: String,
    },
    /// A section or key is missing.
    #[error("{file}: [{section}] is missing or lacks {key}; it needs {expected}")]
    Missing {
        /// File.
        file: String,
        /// Section.
        section: String,
        /// Key.
        key: String,
        /// What belongs there.
        expected: String,
    },
    /// A section or key that nobody knows.
    #[error("{file}: there is no {what}; known are {known}")]
    Unknown {
        /// File.
        file: String,
        /// The section or key.
        what: String,
        /// The known ones.
        known: String,
    },
    /// A column is wrong.
    #[error("{file}: {source}")]
    Column {
        /// File.
        file: String,
        /// What is wrong.
        source: ColumnError,
    },
}

/// How force and motion are made comparable.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measurement {
    /// Cut-off of the low-pass that the motion goes through before it is differentiated [Hz].
    pub motion_low_pass: f64,
    /// Cut-off of the low-pass that the measured and the model's force go through alike [Hz]; none where it is left out.
    pub compare_low_pass: Option<f64>,
    /// Rate at which they are compared [Hz]; of a pendulum, rate of its simulation.
    pub compare_rate: f64,
    /// Time at both ends of a record that is left aside, because filters are not settled there [s].
    #[serde(default)]
    pub edge: f64,
    /// Speed below which readings say nothing about the direction of motion [m/s or rad/s]: friction keeps that before.
    #[serde(default)]
    pub standstill_speed: f64,
}

/// A number's uncertainty and origin, as far as the file tells.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Origin {
    /// Relative standard deviation; a number without one counts as unknown.
    pub relative_uncertainty: Option<f64>,
    /// Where it comes from.
    pub source: Option<String>,
    /// Interval that covers it with 95 % probability.
    pub interval95: Option<[f64; 2]>,
}

/// A small plant's model file.
#[derive(Debug, Clone)]
pub struct SmallModel {
    /// The model.
    pub model: Model,
    /// The records' columns.
    pub columns: Columns,
    /// How they are compared.
    pub measurement: Measurement,
    /// How an FMU meets the records; none of the other kinds.
    pub ports: Option<Ports>,
    /// Origins by dotted name.
    pub origins: BTreeMap<String, Origin>,
}

/// Whether a model file's text describes a small plant.
#[must_use]
pub fn is_small_plant(text: &str) -> bool {
    text.parse::<toml::Table>()
        .is_ok_and(|table| table.contains_key("plant"))
}

impl SmallModel {
    /// Reads the text of a model file; `file` names it in messages.
    ///
    /// # Errors
    /// [`SmallModelError`], naming section and key and what would be right.
    pub fn parse(text: &str, file: &str) -> Result<Self, SmallModelError> {
        let table: toml::Table =
            text.parse()
                .map_err(|error: toml::de::Error| SmallModelError::Syntax {
                    file: file.to_owned(),
                    message: format!("not valid TOML: {}", error.to_string().trim_end()),
                })?;
        Reader { table, file }.read()
    }
}

/// A number's name: section and key.
#[must_use]
pub fn dotted(entry: &Entry, key: &str) -> String {
    format!("{}.{key}", entry.name)
}
