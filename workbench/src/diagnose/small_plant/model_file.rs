//! `model.toml` of a small plant: what it is, its columns, how it is measured, its numbers and effects.

use std::collections::BTreeMap;

use serde::Deserialize;
use stickslip::body::{FileError, Reader};
use stickslip::parameter::Provenance;
use thiserror::Error;

use super::columns::{ColumnError, Columns};
use super::fmu::ports::Ports;
use super::model::Model;
use super::model_reader::read;
use super::term::Entry;

/// What is wrong with a small plant's model file.
#[derive(Debug, Error)]
pub enum SmallModelError {
    /// Whatever a model file of a small plant may have wrong.
    #[error(transparent)]
    File(#[from] FileError),
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
    /// Effects that an FMU can have at its ports beside those of the catalogue, or instead of them where it has several.
    pub of_ports: Vec<&'static Entry>,
    /// Origins by dotted name.
    pub origins: BTreeMap<String, Provenance>,
}

impl SmallModel {
    /// Reads the text of a model file; `file` names it in messages.
    ///
    /// # Errors
    /// [`SmallModelError`], naming section and key and what would be right.
    pub fn parse(text: &str, file: &str) -> Result<Self, SmallModelError> {
        read(&Reader::new(text, file)?)
    }

    /// Names of an FMU's ports; none where it has one without a name.
    #[must_use]
    pub fn port_names(&self) -> Vec<&str> {
        let ports = self.ports.iter().flat_map(|ports| &ports.ports);
        ports.filter_map(|port| port.name.as_deref()).collect()
    }
}

/// A number's name: section and key.
#[must_use]
pub fn dotted(entry: &Entry, key: &str) -> String {
    format!("{}.{key}", entry.name)
}
