//! Effects of small plants as files: sections `[[effect]]`, ours and the user's alike.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Deserialize;
use stickslip::expression::check_name;
use stickslip::parameter::Range;
use stickslip::plant::MOST_EFFECT_PARAMETERS;
use toml::Value;

use super::equation::{LOAD, TIME, compile, quantities, uses};
use super::model::Term;
use super::model_file::SmallModelError;
use super::term::{Entry, Formula, Parameter, Role};
use super::unit::{Dimension, Kind, Path};

/// Ports, and what an effect there is.
const PORTS: [(&str, Role); 2] = [
    ("plant.force", Role::Added),
    ("plant.friction", Role::Friction),
];

/// A section `[[effect]]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Described {
    /// Name in findings.
    pub name: String,
    title: String,
    port: String,
    equation: String,
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
pub fn read(text: &str, file: &str) -> Result<Vec<Described>, SmallModelError> {
    let read: Result<File, _> = toml::from_str(text);
    read.map(|file| file.effect)
        .map_err(|error| SmallModelError::Syntax {
            file: file.to_owned(),
            message: error.to_string().trim_end().to_owned(),
        })
}

/// The effects of a file of the program's own, which name the kinds that can have them.
///
/// # Errors
/// The file is wrong.
pub fn built_in(text: &str, file: &str) -> Result<Vec<Entry>, SmallModelError> {
    let described = read(text, file)?;
    described
        .iter()
        .map(|one| {
            let kinds = one.kinds(file)?;
            let path = one.path(file)?;
            let (kind, on) = (
                kinds.first().copied().unwrap_or(Kind::Drive),
                path.unwrap_or(Path::Turn),
            );
            Ok(Entry {
                kinds: kinds.leak(),
                path,
                own: false,
                ..one.entry(file, kind, on)?
            })
        })
        .collect()
}

impl Described {
    /// The effect on a plant of this kind and path, as one of the user's.
    ///
    /// # Errors
    /// What is wrong with it, or why such a plant cannot have it.
    pub fn entry(&self, file: &str, kind: Kind, path: Path) -> Result<Entry, SmallModelError> {
        let quantities = quantities(kind, path);
        let coordinates: Vec<&str> = quantities.iter().map(|own| own.name).collect();
        let check = |key: &str, name: &str| {
            let checked = check_name(name, &coordinates);
            checked.map_err(|expected| self.wrong(file, key, &format!("{name:?}"), expected))
        };
        check("name", &self.name)?;
        let Some((_, role)) = PORTS.into_iter().find(|(port, _)| *port == self.port) else {
            let ports = PORTS.map(|(port, _)| port).join(" or ");
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
        if self.parameters.is_empty() || self.parameters.len() > MOST_EFFECT_PARAMETERS {
            let count = self.parameters.len().to_string();
            let expected = format!("from 1 to {MOST_EFFECT_PARAMETERS} of them");
            return Err(self.wrong(file, "parameters", &count, &expected));
        }
        let mut parameters: Vec<Parameter> = Vec::new();
        for (key, number) in &self.parameters {
            check("parameters", key)?;
            parameters.push(self.parameter(file, key, number, path)?);
        }
        let operations = compile(&self.equation, &parameters, kind, path).map_err(|error| {
            SmallModelError::Syntax {
                file: file.to_owned(),
                message: format!(
                    "effect {}: equation = \"{}\", {error}",
                    self.name, self.equation
                ),
            }
        })?;
        let is_timed = uses(&operations, TIME);
        for parameter in &mut parameters {
            if is_timed && parameter.dimension.unit(kind, path) == "s" {
                parameter.dimension = Dimension::Duration;
            }
        }
        let confusable: Vec<&'static str> = self.confusable.iter().map(|name| leak(name)).collect();
        Ok(Entry {
            name: leak(&self.name),
            description: leak(&self.title),
            signature: leak(&self.signature),
            confusable: confusable.leak(),
            kinds: vec![kind].leak(),
            path: Some(path),
            needs_load: uses(&operations, LOAD),
            role,
            parameters: parameters.leak(),
            formula: Formula::Equation {
                text: leak(&self.equation),
                operations: operations.leak(),
            },
            own: true,
        })
    }

    fn parameter(
        &self,
        file: &str,
        key: &str,
        number: &Number,
        path: Path,
    ) -> Result<Parameter, SmallModelError> {
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

    fn kinds(&self, file: &str) -> Result<Vec<Kind>, SmallModelError> {
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

    fn path(&self, file: &str) -> Result<Option<Path>, SmallModelError> {
        let Some(word) = &self.path else {
            return Ok(None);
        };
        let mut paths = [Path::Line, Path::Turn].into_iter();
        let known = paths.find(|path| path.word() == word);
        known
            .map(Some)
            .ok_or_else(|| self.wrong(file, "path", &format!("{word:?}"), "\"line\" or \"turn\""))
    }

    fn wrong(&self, file: &str, key: &str, found: &str, expected: &str) -> SmallModelError {
        SmallModelError::Value {
            file: file.to_owned(),
            section: format!("effect {}", self.name),
            key: key.to_owned(),
            found: found.to_owned(),
            expected: expected.to_owned(),
        }
    }
}

/// The section `[[effect]]` of an effect with its numbers; `more` adds to each what is known of it.
#[must_use]
pub fn section(term: &Term, kind: Kind, path: Path, more: &dyn Fn(&str) -> String) -> String {
    let entry = term.entry;
    let port = PORTS.into_iter().find(|(_, role)| *role == entry.role);
    let mut text = format!(
        "\n[[effect]]\nname = {:?}\ntitle = {:?}\nport = {:?}\nequation = {:?}\n",
        entry.name,
        entry.description,
        port.map_or("", |(port, _)| port),
        entry.equation().unwrap_or_default()
    );
    for (own, value) in entry.parameters.iter().zip(&term.values) {
        let _ = writeln!(
            text,
            "parameters.{} = {{ value = {value:?}, unit = {:?}, range = {}, description = {:?}{} }}",
            own.key,
            own.dimension.unit(kind, path),
            own.range.written(),
            own.description,
            more(own.key)
        );
    }
    text
}

/// Text that lives as long as the program, as that of the built-in effects does: a case has a few hundred bytes of it.
fn leak(text: &str) -> &'static str {
    text.to_owned().leak()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::small_plant::catalogue::CATALOGUE;

    #[test]
    fn every_kind_that_an_effect_names_can_have_it() {
        let text = include_str!("../../../effects/small-plants.toml");
        for described in read(text, "effects").unwrap() {
            for kind in described.kinds("effects").unwrap() {
                let on = described.path("effects").unwrap().unwrap_or(Path::Turn);
                let entry = described.entry("effects", kind, on).unwrap();
                let shared = CATALOGUE.iter().find(|own| own.name == entry.name);
                let operations = |entry: &Entry| match entry.formula {
                    Formula::Equation { operations, .. } => operations,
                    Formula::Code { .. } => &[],
                };
                assert_eq!(shared.map(operations), Some(operations(&entry)));
            }
        }
    }
}
