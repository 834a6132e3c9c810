//! Effects of small plants as files: sections `[[effect]]`, ours and the user's alike.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Value;

use super::coordinate::{DIRECTION, FRICTION, TIME, compile, quantities};
use super::{Dimension, FileError, Kind, Origin, Parameter, Path};
use crate::expression::{MOST_PARAMETERS, Program, check_name};
use crate::parameter::Range;

/// Where an effect acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Port {
    /// A force against the motion.
    Force,
    /// The same, and it counts as the friction that others depend on.
    Friction,
}

impl Port {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Force, Self::Friction];

    /// The port as files name it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Force => "plant.force",
            Self::Friction => "plant.friction",
        }
    }
}

/// An effect that a file describes, checked for plants of one kind and path.
#[derive(Debug, PartialEq)]
pub struct Effect {
    /// Name, and section in the model file.
    pub name: &'static str,
    /// What it is, in half a sentence.
    pub title: &'static str,
    /// What it looks like in records.
    pub signature: &'static str,
    /// Names that it is most easily confused with.
    pub confusable: &'static [&'static str],
    /// Where it acts.
    pub port: Port,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// Its equation as written.
    pub equation: &'static str,
    /// Its equation as evaluated.
    pub program: Program,
}

impl Effect {
    /// Whether it depends on the direction of motion: then it can hold the plant.
    #[must_use]
    pub fn is_frictional(&self) -> bool {
        self.port == Port::Friction || self.program.uses(DIRECTION) || self.program.uses(FRICTION)
    }
}

/// A section `[[effect]]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Described {
    /// Name in findings.
    pub name: String,
    /// What it is, in half a sentence.
    pub title: String,
    /// Where it acts.
    pub port: String,
    /// Its equation.
    pub equation: String,
    /// Its numbers by key.
    pub parameters: BTreeMap<String, Number>,
    #[serde(default)]
    signature: String,
    #[serde(default)]
    confusable: Vec<String>,
    kinds: Option<Vec<String>>,
    path: Option<String>,
    #[serde(rename = "source")]
    _source: Option<String>,
}

/// A number of an effect.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Number {
    unit: String,
    range: Option<Value>,
    description: String,
    /// Its value; of an effect that is only supposed, where fits start.
    pub value: Option<f64>,
    /// Where it comes from.
    pub source: Option<String>,
    #[serde(rename = "status")]
    _status: Option<String>,
    /// Relative standard deviation.
    pub relative_uncertainty: Option<f64>,
    /// Interval that covers it with 95 % probability.
    pub interval95: Option<[f64; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    effect: Vec<Described>,
}

/// The effects that a text has, which consists of sections `[[effect]]`; `file` names it in messages.
///
/// # Errors
/// The text is no such file.
pub fn read(text: &str, file: &str) -> Result<Vec<Described>, FileError> {
    let read: Result<File, _> = toml::from_str(text);
    read.map(|file| file.effect)
        .map_err(|error| FileError::Syntax {
            file: file.to_owned(),
            message: error.to_string().trim_end().to_owned(),
        })
}

impl Described {
    /// The effect on a plant of this kind and path.
    ///
    /// # Errors
    /// What is wrong with it, or why such a plant cannot have it.
    pub fn effect(&self, file: &str, kind: Kind, path: Path) -> Result<Effect, FileError> {
        let quantities = quantities(kind, path);
        let coordinates: Vec<&str> = quantities.iter().map(|own| own.name).collect();
        let check = |key: &str, name: &str| {
            let checked = check_name(name, &coordinates);
            checked.map_err(|expected| self.wrong(file, key, &format!("{name:?}"), expected))
        };
        check("name", &self.name)?;
        let Some(port) = Port::ALL.into_iter().find(|port| port.name() == self.port) else {
            let ports = Port::ALL.map(Port::name).join(" or ");
            let expected = format!("{ports} on a {}", kind.word());
            return Err(self.wrong(file, "port", &format!("{:?}", self.port), &expected));
        };
        let kinds = self.kinds(file)?;
        if !kinds.contains(&kind) {
            let kinds: Vec<&str> = kinds.iter().map(|kind| kind.word()).collect();
            let expected = format!("a list with \"{}\", of which this plant is", kind.word());
            return Err(self.wrong(file, "kinds", &kinds.join(", "), &expected));
        }
        if self.path(file)?.is_some_and(|own| own != path) {
            let expected = format!("{:?}, as this plant's", path.word());
            let found = format!("{:?}", self.path.as_deref().unwrap_or_default());
            return Err(self.wrong(file, "path", &found, &expected));
        }
        if self.parameters.is_empty() || self.parameters.len() > MOST_PARAMETERS {
            let count = self.parameters.len().to_string();
            let expected = format!("from 1 to {MOST_PARAMETERS} of them");
            return Err(self.wrong(file, "parameters", &count, &expected));
        }
        let mut parameters: Vec<Parameter> = Vec::new();
        for (key, number) in &self.parameters {
            check("parameters", key)?;
            parameters.push(self.parameter(file, key, number, path)?);
        }
        let program = compile(&self.equation, &parameters, kind, path).map_err(|error| {
            FileError::Syntax {
                file: file.to_owned(),
                message: format!(
                    "effect {}: equation = \"{}\", {error}",
                    self.name, self.equation
                ),
            }
        })?;
        let is_timed = program.uses(TIME);
        for parameter in &mut parameters {
            if is_timed && parameter.dimension.unit(kind, path) == "s" {
                parameter.dimension = Dimension::Duration;
            }
        }
        let confusable: Vec<&'static str> = self.confusable.iter().map(|name| leak(name)).collect();
        Ok(Effect {
            name: leak(&self.name),
            title: leak(&self.title),
            signature: leak(&self.signature),
            confusable: confusable.leak(),
            port,
            parameters: parameters.leak(),
            equation: leak(&self.equation),
            program,
        })
    }

    /// The numbers that the file gives, in the order of the effect's parameters.
    ///
    /// # Errors
    /// One of them has no value.
    pub fn numbers(
        &self,
        effect: &Effect,
        file: &str,
        kind: Kind,
        path: Path,
    ) -> Result<Vec<(f64, Origin)>, FileError> {
        let given = effect.parameters.iter().map(|parameter| {
            let number = &self.parameters[parameter.key];
            let value = number.value.ok_or_else(|| FileError::Missing {
                file: file.to_owned(),
                section: format!("effect {}", self.name),
                key: format!("parameters.{}.value", parameter.key),
                expected: format!(
                    "{} [{}]",
                    parameter.description,
                    parameter.dimension.unit(kind, path)
                ),
            })?;
            let origin = Origin {
                relative_uncertainty: number.relative_uncertainty,
                source: number.source.clone(),
                interval95: number.interval95,
            };
            Ok((value, origin))
        });
        given.collect()
    }

    /// The same description without numbers.
    #[must_use]
    pub(super) fn without_numbers(&self) -> Self {
        let mut described = self.clone();
        for number in described.parameters.values_mut() {
            (number.value, number.source) = (None, None);
            (number.relative_uncertainty, number.interval95) = (None, None);
        }
        described
    }

    fn parameter(
        &self,
        file: &str,
        key: &str,
        number: &Number,
        path: Path,
    ) -> Result<Parameter, FileError> {
        let key_of = |what: &str| format!("parameters.{key}.{what}");
        let unit = leak(&number.unit);
        let dimension = Dimension::of_words(unit, path).map_err(|error| {
            let found = format!("{:?}", number.unit);
            self.wrong(file, &key_of("unit"), &found, &format!("a unit: {error}"))
        })?;
        let range = match &number.range {
            None => Range::Finite,
            Some(value) => Range::read(value).ok_or_else(|| {
                self.wrong(file, &key_of("range"), &value.to_string(), Range::WRITTEN)
            })?,
        };
        if let Some(value) = number.value.filter(|value| !range.contains(*value)) {
            let expected = range.to_string();
            return Err(self.wrong(file, &key_of("value"), &value.to_string(), &expected));
        }
        Ok(Parameter {
            key: leak(key),
            dimension,
            range,
            description: leak(&number.description),
            guess: number.value,
        })
    }

    /// The kinds of plants that can have it: all where it names none.
    ///
    /// # Errors
    /// It names one that there is not.
    pub fn kinds(&self, file: &str) -> Result<Vec<Kind>, FileError> {
        let Some(words) = &self.kinds else {
            return Ok(Kind::ALL.to_vec());
        };
        let kind = |word: &String| {
            let known = Kind::ALL.into_iter().find(|kind| kind.word() == word);
            known.ok_or_else(|| {
                let words = Kind::ALL.map(Kind::word).join(", ");
                self.wrong(
                    file,
                    "kinds",
                    &format!("{word:?}"),
                    &format!("a list out of {words}"),
                )
            })
        };
        words.iter().map(kind).collect()
    }

    /// The path that it needs, if any.
    ///
    /// # Errors
    /// It names one that there is not.
    pub fn path(&self, file: &str) -> Result<Option<Path>, FileError> {
        let Some(word) = &self.path else {
            return Ok(None);
        };
        let mut paths = [Path::Line, Path::Turn].into_iter();
        let known = paths.find(|path| path.word() == word);
        known
            .map(Some)
            .ok_or_else(|| self.wrong(file, "path", &format!("{word:?}"), "\"line\" or \"turn\""))
    }

    fn wrong(&self, file: &str, key: &str, found: &str, expected: &str) -> FileError {
        FileError::Value {
            file: file.to_owned(),
            section: format!("effect {}", self.name),
            key: key.to_owned(),
            found: found.to_owned(),
            expected: expected.to_owned(),
        }
    }
}

/// Text that lives as long as the program, as that of the built-in effects does: a case has a few hundred bytes of it.
fn leak(text: &str) -> &'static str {
    text.to_owned().leak()
}
