//! `model.toml`: a rig with its numbers, where they come from, and its effects.

use super::{ContactRadius, Disc, EFFECT_NAMES, Effects, Gearbox, Motor, Outer, Rig, Shaft};
use crate::friction::{LAW_NAMES, Law};
use crate::parameter::{ParameterError, ParameterInfo};
use std::collections::BTreeMap;
use std::fmt::Write;
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
    /// `published`, `corrected`, `calibrated`, `fitted` or `assumed`.
    pub status: Option<String>,
    /// Relative standard deviation with which the number is known.
    pub relative_uncertainty: Option<f64>,
    /// Interval that covers the number with 95 % probability.
    pub interval95: Option<[f64; 2]>,
}

/// Allowed words for [`Provenance::status`].
const STATUSES: [&str; 5] = ["published", "corrected", "calibrated", "fitted", "assumed"];

/// A rig as read from a file, with the provenance of its numbers by dotted name.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFile {
    /// The rig.
    pub rig: Rig<f64>,
    /// Provenance of those numbers that state any.
    pub provenance: BTreeMap<String, Provenance>,
}

const PARTS: [&str; 5] = ["disc", "shaft", "gearbox", "motor", "contact"];
const OUTER_PARTS: [&str; 3] = ["disc1", "shaft1", "contact1"];

impl ModelFile {
    /// Reads the text of a model file; `file` names it in messages.
    pub fn parse(text: &str, file: &str) -> Result<Self, ModelFileError> {
        let table: toml::Table =
            text.parse()
                .map_err(|error: toml::de::Error| ModelFileError::Syntax {
                    file: file.to_owned(),
                    message: error.to_string().trim_end().to_owned(),
                })?;
        let mut reader = Reader {
            table,
            file,
            provenance: BTreeMap::new(),
        };
        reader.check_sections()?;
        let rig = reader.rig()?;
        rig.check().map_err(|source| ModelFileError::Parameter {
            file: file.to_owned(),
            source,
        })?;
        Ok(Self {
            rig,
            provenance: reader.provenance,
        })
    }

    /// The file's text: every number with unit, description and provenance.
    pub fn to_toml(&self) -> String {
        let mut text = String::from(
            "# A stickslip model. SI units, shaft side of the gearbox unless named motor.\n",
        );
        let mut open = "";
        for (section, values) in self.rig.sections() {
            if section != open {
                let _ = writeln!(text, "\n[{section}]");
                open = section;
            } else if section.starts_with("contact") {
                let law = if section == "contact" {
                    self.rig.law.name()
                } else {
                    self.rig.outer.as_ref().map_or("", |outer| outer.law.name())
                };
                let _ = writeln!(text, "law = \"{law}\"");
            }
            for (j, info) in values.infos().iter().enumerate() {
                let name = format!("{section}.{}", info.key);
                let value = write_number(values.get(j));
                let _ = writeln!(
                    text,
                    "{} = {} # {}, {}",
                    info.key,
                    write_value(&value, self.provenance.get(&name)),
                    info.description.trim(),
                    info.unit
                );
            }
        }
        text
    }
}

impl Rig<f64> {
    /// The rig of a model file's text; `file` names it in messages.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, ModelFileError> {
        ModelFile::parse(text, file).map(|model| model.rig)
    }

    /// The text of a model file with this rig.
    pub fn to_toml(&self) -> String {
        ModelFile {
            rig: *self,
            provenance: BTreeMap::new(),
        }
        .to_toml()
    }
}

/// A number as TOML: always with a point or an exponent, exact on reading back.
fn write_number(value: f64) -> String {
    format!("{value:?}")
}

fn write_value(value: &str, provenance: Option<&Provenance>) -> String {
    let Some(provenance) = provenance else {
        return value.to_owned();
    };
    let mut text = format!("{{ value = {value}");
    if let Some(source) = &provenance.source {
        let _ = write!(text, ", source = {}", Value::String(source.clone()));
    }
    if let Some(status) = &provenance.status {
        let _ = write!(text, ", status = {}", Value::String(status.clone()));
    }
    if let Some(relative) = provenance.relative_uncertainty {
        let _ = write!(text, ", relative_uncertainty = {}", write_number(relative));
    }
    if let Some([low, high]) = provenance.interval95 {
        let _ = write!(
            text,
            ", interval95 = [{}, {}]",
            write_number(low),
            write_number(high)
        );
    }
    text.push_str(" }");
    text
}

struct Reader<'a> {
    table: toml::Table,
    file: &'a str,
    provenance: BTreeMap<String, Provenance>,
}

impl Reader<'_> {
    fn check_sections(&self) -> Result<(), ModelFileError> {
        for section in self.table.keys() {
            let known = PARTS.iter().chain(&OUTER_PARTS).chain(EFFECT_NAMES);
            if !known.clone().any(|name| name == section) {
                return Err(ModelFileError::UnknownSection {
                    file: self.file.to_owned(),
                    section: section.clone(),
                    known: known.copied().collect::<Vec<_>>().join(", "),
                });
            }
        }
        Ok(())
    }

    fn rig(&mut self) -> Result<Rig<f64>, ModelFileError> {
        let (contact, law) = self.contact("contact")?;
        let disc = Disc::from_values(self.values("disc", Disc::<f64>::INFOS, &[])?)?;
        let shaft = Shaft::from_values(self.values("shaft", Shaft::<f64>::INFOS, &[])?)?;
        let gearbox = Gearbox::from_values(self.values("gearbox", Gearbox::<f64>::INFOS, &[])?)?;
        let motor = Motor::from_values(self.values("motor", Motor::<f64>::INFOS, &[])?)?;
        let outer = if OUTER_PARTS
            .iter()
            .any(|part| self.table.contains_key(*part))
        {
            let (contact, law) = self.contact("contact1")?;
            Some(Outer {
                disc: Disc::from_values(self.values("disc1", Disc::<f64>::INFOS, &[])?)?,
                shaft: Shaft::from_values(self.values("shaft1", Shaft::<f64>::INFOS, &[])?)?,
                contact,
                law,
            })
        } else {
            None
        };
        let mut effects = Effects::default();
        for name in EFFECT_NAMES {
            if !self.table.contains_key(*name) {
                continue;
            }
            let infos = Effects::<f64>::infos(name).unwrap_or(&[]);
            let values = self.values(name, infos, &[])?;
            if let Some(result) = effects.insert(name, values) {
                result?;
            }
        }
        Ok(Rig {
            disc,
            shaft,
            gearbox,
            motor,
            contact,
            law,
            outer,
            effects,
        })
    }

    fn contact(&mut self, section: &str) -> Result<(ContactRadius<f64>, Law<f64>), ModelFileError> {
        let missing = || ModelFileError::MissingSection {
            file: self.file.to_owned(),
            section: section.to_owned(),
            keys: "radius, law and the law's parameters".to_owned(),
        };
        let table = self
            .table
            .get(section)
            .and_then(Value::as_table)
            .ok_or_else(missing)?;
        let expected = format!("one of {}", LAW_NAMES.join(", "));
        let name = match table.get("law") {
            Some(Value::String(name)) => name.clone(),
            Some(other) => return Err(self.wrong_type(section, "law", other, &expected)),
            None => {
                return Err(ModelFileError::MissingKey {
                    file: self.file.to_owned(),
                    section: section.to_owned(),
                    key: "law".to_owned(),
                    description: "friction law".to_owned(),
                    unit: expected,
                });
            }
        };
        let mut infos = ContactRadius::<f64>::INFOS.to_vec();
        let mut count = 0;
        // A first pass with zeros only asks the law which parameters it has.
        let shape = Law::<f64>::from_values(&name, |_| Ok::<_, ModelFileError>(0.0));
        let Some(Ok(shape)) = shape else {
            let value = Value::String(name);
            return Err(self.wrong_type(section, "law", &value, &expected));
        };
        for info in shape.section().infos() {
            infos.push(*info);
            count += 1;
        }
        debug_assert_eq!(infos.len(), count + ContactRadius::<f64>::INFOS.len());
        let mut values = self.values(section, &infos, &["law"])?;
        let radius = ContactRadius::from_values(&mut values)?;
        match Law::from_values(&name, values) {
            Some(law) => Ok((radius, law?)),
            None => Err(self.wrong_type(section, "law", &Value::String(name), &expected)),
        }
    }

    /// A function that gives the value of each of `infos` in a section; refuses keys beyond these
    /// and `others`.
    fn values(
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
                let number = self.number(section, info.key, value)?;
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

    fn number(&mut self, section: &str, key: &str, value: &Value) -> Result<f64, ModelFileError> {
        let expected = "a number or { value = …, unit = …, source = …, status = … }";
        match value {
            Value::Float(x) => Ok(*x),
            Value::Integer(n) => Ok(*n as f64),
            Value::Table(table) => {
                let number = match table.get("value") {
                    Some(Value::Float(x)) => *x,
                    Some(Value::Integer(n)) => *n as f64,
                    _ => return Err(self.wrong_type(section, key, value, expected)),
                };
                let provenance = self.read_provenance(section, key, table)?;
                self.provenance
                    .insert(format!("{section}.{key}"), provenance);
                Ok(number)
            }
            _ => Err(self.wrong_type(section, key, value, expected)),
        }
    }

    fn read_provenance(
        &self,
        section: &str,
        key: &str,
        table: &toml::Table,
    ) -> Result<Provenance, ModelFileError> {
        let mut provenance = Provenance::default();
        for (field, value) in table {
            let name = format!("{key}.{field}");
            match (field.as_str(), value) {
                ("value" | "unit", _) => {}
                ("source", Value::String(text)) => provenance.source = Some(text.clone()),
                ("status", Value::String(text)) if STATUSES.contains(&text.as_str()) => {
                    provenance.status = Some(text.clone());
                }
                ("status", _) => {
                    let expected = format!("one of {}", STATUSES.join(", "));
                    return Err(self.wrong_type(section, &name, value, &expected));
                }
                ("relative_uncertainty", Value::Float(x)) if *x >= 0.0 => {
                    provenance.relative_uncertainty = Some(*x);
                }
                ("interval95", Value::Array(bounds)) => {
                    let bounds: Vec<f64> = bounds.iter().filter_map(Value::as_float).collect();
                    let [low, high] = bounds[..] else {
                        return Err(self.wrong_type(section, &name, value, "two numbers"));
                    };
                    provenance.interval95 = Some([low, high]);
                }
                ("source", _) => return Err(self.wrong_type(section, &name, value, "a text")),
                _ => {
                    return Err(ModelFileError::UnknownKey {
                        file: self.file.to_owned(),
                        section: section.to_owned(),
                        key: name,
                        known: "value, unit, source, status, relative_uncertainty, interval95"
                            .to_owned(),
                    });
                }
            }
        }
        Ok(provenance)
    }

    fn wrong_type(
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
