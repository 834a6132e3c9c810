//! `model.toml` of a small plant: what it is, its columns, how it is measured, its numbers and effects.

use std::collections::BTreeMap;

use stickslip::body::{FileError, Reader};
use stickslip::parameter::Provenance;
use thiserror::Error;

use super::columns::{ColumnError, Columns};
use super::fmu::ports::Ports;
use super::model_reader::read;
use inference::body::catalogue::CATALOGUE;
use inference::body::known::Known;
use inference::body::model::Model;
use inference::body::motion::Measurement;
use inference::body::term::Entry;
use inference::policy::SURELY;

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

    /// Numbers that the file states with a standard deviation or an interval.
    #[must_use]
    pub fn known(&self) -> Vec<Known> {
        let terms = self.model.terms().iter().enumerate();
        let numbers = terms.flat_map(|(at, term)| {
            let values = term.entry.parameters.iter().zip(&term.values).enumerate();
            values.filter_map(move |(number, (parameter, &value))| {
                let origin = self.origins.get(&dotted(term.entry, parameter.key))?;
                let deviation = match (origin.relative_uncertainty, origin.interval95) {
                    (Some(share), _) => share * value.abs(),
                    (None, Some([low, high])) => 0.5 * (high - low) / SURELY,
                    (None, None) => 0.0,
                };
                (deviation > 0.0).then_some(Known {
                    term: at,
                    number,
                    value,
                    deviation,
                })
            })
        });
        numbers.collect()
    }

    /// Whether a load is measured, or an FMU's is named.
    #[must_use]
    pub fn has_load(&self) -> bool {
        has_load(&self.columns, self.ports.as_ref())
    }

    /// The effects of the catalogue and of `supposed` that the plant can have and its model has not.
    #[must_use]
    pub fn possible(&self, supposed: &[&'static Entry]) -> Vec<&'static Entry> {
        let model = &self.model;
        let shared = match self.port_names().len() {
            0 | 1 => &CATALOGUE[..],
            // Each effect stands among those of the ports, once for each.
            _ => &[],
        };
        let own = self.of_ports.iter().chain(supposed).copied();
        let all = shared.iter().chain(own);
        all.filter(|entry| entry.fits(model.kind, model.path, self.has_load()))
            .filter(|entry| !model.has(entry.name))
            .collect()
    }
}

/// A number's name: section and key.
#[must_use]
pub fn dotted(entry: &Entry, key: &str) -> String {
    format!("{}.{key}", entry.name)
}

/// Whether a model with these columns and, of an FMU, these ports has a load.
#[must_use]
pub fn has_load(columns: &Columns, ports: Option<&Ports>) -> bool {
    let mut ports = ports.into_iter().flat_map(|ports| &ports.ports);
    columns.load.is_some() || ports.any(|port| port.load.is_some())
}
