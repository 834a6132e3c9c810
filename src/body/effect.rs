//! Effects of small plants as files: sections `[[effect]]`, ours and the user's alike.

use std::collections::BTreeMap;

use super::coordinate::{DIRECTION, FRICTION, TIME, compile, quantities};
use super::{Dimension, FileError, Kind, Parameter, Path};
use crate::expression::{MOST_PARAMETERS, Program, check_name};
use crate::parameter::{Entry, ModelFileError, Provenance, Range, SectionReader};

const KEYS: [&str; 10] = [
    "name",
    "title",
    "port",
    "equation",
    "parameters",
    "signature",
    "confusable",
    "kinds",
    "path",
    "source",
];
const NUMBER_KEYS: [&str; 4] = ["value", "unit", "range", "description"];

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
#[derive(Debug, Clone, PartialEq)]
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
    parameters: BTreeMap<String, Number>,
    signature: String,
    confusable: Vec<String>,
    kinds: Option<Vec<String>>,
    path: Option<String>,
}

/// A number of an effect.
#[derive(Debug, Clone, PartialEq)]
struct Number {
    unit: String,
    range: Range,
    description: String,
    /// Its value; of an effect that is only supposed, where fits start.
    value: Option<f64>,
    provenance: Provenance,
}

impl Number {
    fn of(entry: &Entry<'_>) -> Result<Self, ModelFileError> {
        entry.check_keys(&[&NUMBER_KEYS[..], &Provenance::KEYS].concat())?;
        Ok(Self {
            unit: entry.words("unit", "a unit such as N.m.s/rad, force/speed, or 1")?,
            range: entry.range()?,
            description: entry.words("description", "one line that says what the number is")?,
            value: entry.optional_number("value")?,
            provenance: entry.provenance()?,
        })
    }
}

/// The effects that a text has, which consists of sections `[[effect]]`; `file` names it in messages.
///
/// # Errors
/// The text is no such file.
pub fn read(text: &str, file: &str) -> Result<Vec<Described>, FileError> {
    let reader = SectionReader::new(text, file)?;
    described(&reader.effects_alone()?)
}

/// The effects that these sections describe.
pub(super) fn described(sections: &[Entry<'_>]) -> Result<Vec<Described>, FileError> {
    let described = sections.iter().map(Described::of);
    Ok(described.collect::<Result<_, _>>()?)
}

impl Described {
    fn of(entry: &Entry<'_>) -> Result<Self, ModelFileError> {
        entry.check_keys(&KEYS)?;
        entry.optional_words("source")?;
        let mut parameters = BTreeMap::new();
        for (key, number) in entry.entries("parameters")? {
            parameters.insert(key.to_owned(), Number::of(&number)?);
        }
        Ok(Self {
            name: entry.words("name", "a name such as support_rumble")?,
            title: entry.words("title", "one line that says what the effect is")?,
            port: entry.words("port", "plant.force or plant.friction")?,
            equation: entry.words("equation", "an equation for a force")?,
            parameters,
            signature: entry.optional_words("signature")?.unwrap_or_default(),
            confusable: entry.list("confusable")?.unwrap_or_default(),
            kinds: entry.list("kinds")?,
            path: entry.optional_words("path")?,
        })
    }

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
    ) -> Result<Vec<(f64, Provenance)>, FileError> {
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
            Ok((value, number.provenance.clone()))
        });
        given.collect()
    }

    /// The same description without numbers.
    #[must_use]
    pub(super) fn without_numbers(&self) -> Self {
        let mut described = self.clone();
        for number in described.parameters.values_mut() {
            (number.value, number.provenance) = (None, Provenance::default());
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
        let range = number.range;
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

    #[cold]
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
