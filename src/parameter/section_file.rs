//! Reading the sections of `model.toml`: numbers with where they come from, and what may be wrong with them.

use super::entry::Entry;
use super::{ParameterError, ParameterInfo, units};
use std::collections::BTreeMap;
use thiserror::Error;
use toml::Value;

/// What is wrong with a model file.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ModelFileError {
    /// The text is not TOML.
    #[error("{file}: not valid TOML: {message}")]
    Syntax {
        /// File name.
        file: String,
        /// What the parser says, with the line.
        message: String,
    },
    /// A section is missing.
    #[error("{file}: section [{section}] is missing; it needs {keys}")]
    MissingSection {
        /// File name.
        file: String,
        /// Section.
        section: String,
        /// What belongs into it.
        keys: String,
    },
    /// A section that nobody knows.
    #[error("{file}: there is no section [{section}]; known are {known}")]
    UnknownSection {
        /// File name.
        file: String,
        /// Section.
        section: String,
        /// The known ones.
        known: String,
    },
    /// A key is missing.
    #[error("{file}: [{section}] lacks {key} ({description}, {unit})")]
    MissingKey {
        /// File name.
        file: String,
        /// Section.
        section: String,
        /// Key.
        key: String,
        /// What it is.
        description: String,
        /// Its unit.
        unit: String,
    },
    /// A key that nobody knows.
    #[error("{file}: [{section}] has no key \"{key}\"; known are {known}")]
    UnknownKey {
        /// File name.
        file: String,
        /// Section.
        section: String,
        /// Key.
        key: String,
        /// The known ones.
        known: String,
    },
    /// A value of the wrong type.
    #[error("{file}: [{section}]{}{key} = {value} must be {expected}", if key.is_empty() { "" } else { " " })]
    WrongType {
        /// File name.
        file: String,
        /// Section.
        section: String,
        /// Key.
        key: String,
        /// What stands there.
        value: String,
        /// What would be right.
        expected: String,
    },
    /// The equation, a unit or a table of an effect.
    #[error("{file}: [{section}] {message}")]
    Effect {
        /// File name.
        file: String,
        /// Section.
        section: String,
        /// What is wrong, and where.
        message: String,
    },
    /// A value out of range, or two that contradict each other.
    #[error("{file}: {source}")]
    Parameter {
        /// File name.
        file: String,
        /// What is wrong.
        source: ParameterError,
    },
}

/// Where a number comes from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// Table, equation or record.
    pub source: Option<String>,
    /// `published`, `measured`, `corrected`, `calibrated`, `fitted` or `assumed`.
    pub status: Option<String>,
    /// Relative standard deviation with which the number is known.
    pub relative_uncertainty: Option<f64>,
    /// Interval that covers the number with 95 % probability.
    pub interval95: Option<[f64; 2]>,
}

impl Provenance {
    /// Keys by which a file states it.
    pub(crate) const KEYS: [&str; 4] = ["source", "status", "relative_uncertainty", "interval95"];
}

/// Allowed words for [`Provenance::status`].
pub(super) const STATUSES: [&str; 6] = [
    "published",
    "measured",
    "corrected",
    "calibrated",
    "fitted",
    "assumed",
];

/// The sections of one file, read one by one.
pub(crate) struct SectionReader<'a> {
    pub(crate) table: toml::Table,
    pub(crate) file: &'a str,
    pub(crate) provenance: BTreeMap<String, Provenance>,
}

impl<'a> SectionReader<'a> {
    /// Reads `text`; `file` names it in messages.
    pub(crate) fn new(text: &str, file: &'a str) -> Result<Self, ModelFileError> {
        let table: toml::Table =
            text.parse()
                .map_err(|error: toml::de::Error| ModelFileError::Syntax {
                    file: file.to_owned(),
                    message: error.to_string().trim_end().to_owned(),
                })?;
        Ok(Self {
            table,
            file,
            provenance: BTreeMap::new(),
        })
    }

    /// Refuses sections other than `known`.
    pub(crate) fn check_sections(&self, known: &[&str]) -> Result<(), ModelFileError> {
        for section in self.table.keys() {
            if !known.contains(&section.as_str()) {
                return Err(ModelFileError::UnknownSection {
                    file: self.file.to_owned(),
                    section: section.clone(),
                    known: known.join(", "),
                });
            }
        }
        Ok(())
    }

    /// The sections `[[effect]]` of a file that has nothing else.
    pub(crate) fn effects_alone(&self) -> Result<Vec<Entry<'_>>, ModelFileError> {
        self.check_sections(&["effect"])?;
        let effects = Entry::effects(self.table.get("effect"), self.file)?;
        if effects.is_empty() {
            return Err(ModelFileError::MissingSection {
                file: self.file.to_owned(),
                section: "[effect]".to_owned(),
                keys: "name, title, port, equation and parameters".to_owned(),
            });
        }
        Ok(effects)
    }

    /// A function that gives the value of each of `infos` in a section; refuses keys beyond these
    /// and `others`.
    pub(crate) fn values(
        &mut self,
        section: &str,
        infos: &[ParameterInfo],
        others: &[&str],
    ) -> Result<
        impl FnMut(&'static ParameterInfo) -> Result<f64, ModelFileError> + use<>,
        ModelFileError,
    > {
        let keys = || {
            infos
                .iter()
                .map(|info| info.key)
                .chain(others.iter().copied())
                .collect::<Vec<_>>()
        };
        let table = match self.table.get(section) {
            Some(Value::Table(table)) => table.clone(),
            Some(other) => {
                let expected = format!("a section with {}", keys().join(", "));
                return Err(self.wrong_type(section, "", other, &expected));
            }
            None => {
                return Err(ModelFileError::MissingSection {
                    file: self.file.to_owned(),
                    section: section.to_owned(),
                    keys: keys().join(", "),
                });
            }
        };
        for key in table.keys() {
            if !keys().contains(&key.as_str()) {
                return Err(ModelFileError::UnknownKey {
                    file: self.file.to_owned(),
                    section: section.to_owned(),
                    key: key.clone(),
                    known: keys().join(", "),
                });
            }
        }
        let mut numbers = BTreeMap::new();
        for info in infos {
            if let Some(value) = table.get(info.key) {
                let number = self.number(section, info, value)?;
                numbers.insert(info.key, number);
            }
        }
        let (file, section) = (self.file.to_owned(), section.to_owned());
        Ok(move |info: &'static ParameterInfo| {
            numbers
                .get(info.key)
                .copied()
                .ok_or_else(|| ModelFileError::MissingKey {
                    file: file.clone(),
                    section: section.clone(),
                    key: info.key.to_owned(),
                    description: info.description.trim().to_owned(),
                    unit: info.unit.to_owned(),
                })
        })
    }

    pub(crate) fn number(
        &mut self,
        section: &str,
        info: &ParameterInfo,
        value: &Value,
    ) -> Result<f64, ModelFileError> {
        let key = info.key;
        let expected = "a number or { value = …, unit = …, source = …, status = … }";
        match value {
            Value::Table(table) => {
                let Some(number) = table.get("value").and_then(number) else {
                    return Err(self.wrong_type(section, key, value, expected));
                };
                let provenance = self.read_provenance(section, info, table)?;
                self.provenance
                    .insert(format!("{section}.{key}"), provenance);
                Ok(number)
            }
            _ => number(value).ok_or_else(|| self.wrong_type(section, key, value, expected)),
        }
    }

    fn read_provenance(
        &self,
        section: &str,
        info: &ParameterInfo,
        table: &toml::Table,
    ) -> Result<Provenance, ModelFileError> {
        let entry = Entry {
            file: self.file,
            section: section.to_owned(),
            path: format!("{}.", info.key),
            table,
        };
        entry.check_keys(&[&["value", "unit"][..], &Provenance::KEYS].concat())?;
        match table.get("unit") {
            Some(Value::String(text)) if units::is_same(text, info.unit) => {}
            None => {}
            Some(other) => {
                let expected = format!("{:?}; convert the value", info.unit);
                return Err(entry.wrong("unit", other, &expected));
            }
        }
        entry.provenance()
    }

    #[cold]
    pub(crate) fn wrong_type(
        &self,
        section: &str,
        key: &str,
        value: &Value,
        expected: &str,
    ) -> ModelFileError {
        ModelFileError::WrongType {
            file: self.file.to_owned(),
            section: section.to_owned(),
            key: key.to_owned(),
            value: value.to_string(),
            expected: expected.to_owned(),
        }
    }
}

/// A number, whole or not.
pub(crate) fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(x) => Some(*x),
        Value::Integer(n) => Some(*n as f64),
        _ => None,
    }
}

/// Two numbers that do not fall.
pub(super) fn interval(value: &Value) -> Option<[f64; 2]> {
    let [low, high] = value.as_array()?.as_slice() else {
        return None;
    };
    let bounds = [number(low)?, number(high)?];
    (bounds[0] <= bounds[1]).then_some(bounds)
}
