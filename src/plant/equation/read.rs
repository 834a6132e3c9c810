//! Sections `[[effect]]` of a model file, and what may be wrong with them.

use super::definition::{Draft, Points};
use super::{Definition, EquationEffects, Port};
use crate::expression::{self, Coordinate, Interpolation, MOST_PARAMETERS};
use crate::parameter::{ModelFileError, ParameterInfo, Provenance, Range, SectionReader, number};
use crate::plant::effect_infos;
use crate::plant::model_file::SECTIONS;
use std::collections::BTreeMap;
use std::convert::Infallible;
use toml::{Table, Value};

const KEYS: [&str; 7] = [
    "name",
    "title",
    "port",
    "equation",
    "source",
    "parameters",
    "tables",
];
const PARAMETER_KEYS: [&str; 4] = ["value", "unit", "range", "description"];
const TABLE_KEYS: [&str; 6] = ["x", "y", "x_unit", "y_unit", "interpolation", "period"];
/// Longest line of words, in characters: what a tool shows in one place.
const LONGEST: usize = 2000;

/// The effects of a model file, switched on.
pub(in crate::plant) fn read_effects(
    reader: &mut SectionReader<'_>,
) -> Result<EquationEffects<f64>, ModelFileError> {
    let mut effects = EquationEffects::default();
    for (place, table) in sections(reader)?.iter().enumerate() {
        read_effect(&Entry::new(reader.file, place, table), reader, &mut effects)?;
    }
    Ok(effects)
}

/// The sections `[[effect]]` of a file.
fn sections(reader: &mut SectionReader<'_>) -> Result<Vec<Table>, ModelFileError> {
    let list = match reader.table.remove("effect") {
        None => return Ok(Vec::new()),
        Some(Value::Array(list)) => list,
        Some(other) => {
            let expected = "a list: write [[effect]], once for each effect";
            return Err(reader.wrong_type("effect", "", &other, expected));
        }
    };
    let section = |value| match value {
        Value::Table(table) => Ok(table),
        other => Err(reader.wrong_type("effect", "", &other, "a section [[effect]]")),
    };
    list.into_iter().map(section).collect()
}

/// An effect that a model may lack, as a file describes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supposition {
    /// The effect.
    pub definition: &'static Definition,
    /// Values from which a search for its numbers may start, where the file has them.
    pub guesses: [Option<f64>; MOST_PARAMETERS],
}

impl Supposition {
    /// The effects of a file that has sections `[[effect]]` and nothing else; their parameters need no values there. `file` names
    /// it in messages.
    ///
    /// # Errors
    /// [`ModelFileError`] with the place and what would be right.
    pub fn read_all(text: &str, file: &str) -> Result<Vec<Self>, ModelFileError> {
        let mut reader = SectionReader::new(text, file)?;
        reader.check_sections(&["effect"])?;
        let mut all: Vec<Self> = Vec::new();
        for (place, table) in sections(&mut reader)?.iter().enumerate() {
            let entry = Entry::new(file, place, table);
            let supposition = entry.supposition()?;
            let name = supposition.definition.name();
            if all.iter().any(|other| other.definition.name() == name) {
                return Err(entry.name_is_taken(name));
            }
            all.push(supposition);
        }
        Ok(all)
    }
}

fn read_effect(
    entry: &Entry<'_>,
    reader: &mut SectionReader<'_>,
    effects: &mut EquationEffects<f64>,
) -> Result<(), ModelFileError> {
    let definition = entry.definition()?;
    let is_taken = effects
        .known()
        .any(|other| other.definition.name() == definition.name());
    if is_taken {
        return Err(entry.name_is_taken(definition.name()));
    }
    let mut values = BTreeMap::new();
    for (info, (_, parameter)) in definition.infos().iter().zip(entry.entries("parameters")?) {
        let mut numbers = parameter.table.clone();
        if !numbers.contains_key("value") {
            return Err(parameter.missing("value", info.description, info.unit));
        }
        numbers.remove("range");
        numbers.remove("description");
        let value = reader.number(definition.name(), info, &Value::Table(numbers))?;
        values.insert(info.key, value);
    }
    let wrong = |source| ModelFileError::Parameter {
        file: reader.file.to_owned(),
        source,
    };
    effects.add(definition).map_err(wrong)?;
    let value = |info: &'static ParameterInfo| {
        Ok::<f64, Infallible>(values.get(info.key).copied().unwrap_or_default())
    };
    effects.insert(definition.name(), value);
    Ok(())
}

/// A table of the file while it is read.
struct Entry<'a> {
    file: &'a str,
    section: String,
    /// What its keys begin with in messages.
    path: String,
    table: &'a Table,
}

impl<'a> Entry<'a> {
    fn new(file: &'a str, place: usize, table: &'a Table) -> Self {
        let name = table.get("name").and_then(Value::as_str);
        Self {
            file,
            section: match name {
                Some(name) => format!("effect {name}"),
                None => format!("effect {}", place + 1),
            },
            path: String::new(),
            table,
        }
    }

    fn name_is_taken(&self, name: &str) -> ModelFileError {
        self.wrong_words(
            "name",
            name,
            "another name: an effect before it has this one",
        )
    }

    fn supposition(&self) -> Result<Supposition, ModelFileError> {
        let definition = self.definition()?;
        let mut guesses = [None; MOST_PARAMETERS];
        for (place, (_, parameter)) in self.entries("parameters")?.iter().enumerate() {
            let Some(value) = parameter.table.get("value") else {
                continue;
            };
            let range = definition.infos()[place].range;
            let guess = number(value).filter(|guess| range.contains(*guess));
            if guess.is_none() {
                return Err(parameter.wrong("value", value, &range.to_string()));
            }
            guesses[place] = guess;
        }
        Ok(Supposition {
            definition,
            guesses,
        })
    }

    fn wrong(&self, key: &str, value: &Value, expected: &str) -> ModelFileError {
        ModelFileError::WrongType {
            file: self.file.to_owned(),
            section: self.section.clone(),
            key: format!("{}{key}", self.path),
            // A table of a million points is not repeated.
            value: value.to_string().chars().take(LONGEST).collect(),
            expected: expected.to_owned(),
        }
    }

    fn wrong_words(&self, key: &str, words: &str, expected: &str) -> ModelFileError {
        self.wrong(key, &Value::String(words.to_owned()), expected)
    }

    fn missing(&self, key: &str, description: &str, unit: &str) -> ModelFileError {
        ModelFileError::MissingKey {
            file: self.file.to_owned(),
            section: self.section.clone(),
            key: format!("{}{key}", self.path),
            description: description.to_owned(),
            unit: unit.to_owned(),
        }
    }

    fn check_keys(&self, known: &[&str]) -> Result<(), ModelFileError> {
        match self.table.keys().find(|key| !known.contains(&key.as_str())) {
            None => Ok(()),
            Some(key) => Err(ModelFileError::UnknownKey {
                file: self.file.to_owned(),
                section: self.section.clone(),
                key: format!("{}{key}", self.path),
                known: known.join(", "),
            }),
        }
    }

    fn words(&self, key: &str, expected: &str) -> Result<String, ModelFileError> {
        self.optional_words(key)?
            .ok_or_else(|| self.missing(key, expected, "text"))
    }

    fn optional_words(&self, key: &str) -> Result<Option<String>, ModelFileError> {
        let is_line = |words: &str| {
            !words.trim().is_empty()
                && words.chars().count() <= LONGEST
                && !words.chars().any(char::is_control)
        };
        match self.table.get(key) {
            None => Ok(None),
            Some(Value::String(words)) if is_line(words) => Ok(Some(words.clone())),
            Some(other) => {
                let expected = format!("one line of text with at most {LONGEST} characters");
                Err(self.wrong(key, other, &expected))
            }
        }
    }

    /// One of several words.
    fn choice<T: Copy>(&self, key: &str, known: &[(&str, T)]) -> Result<T, ModelFileError> {
        let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        let expected = format!("one of {}", names.join(", "));
        let word = self.words(key, &expected)?;
        let found = known.iter().find(|(name, _)| *name == word);
        found
            .map(|(_, meaning)| *meaning)
            .ok_or_else(|| self.wrong_words(key, &word, &expected))
    }

    fn numbers(&self, key: &str) -> Result<Vec<f64>, ModelFileError> {
        let expected = "a list of numbers";
        let value = self.table.get(key);
        let value = value.ok_or_else(|| self.missing(key, expected, "table"))?;
        let numbers = value
            .as_array()
            .and_then(|list| list.iter().map(number).collect());
        numbers.ok_or_else(|| self.wrong(key, value, expected))
    }

    /// The tables below `key`, by name.
    fn entries(&self, key: &str) -> Result<Vec<(&'a str, Entry<'a>)>, ModelFileError> {
        let expected = format!("sections [effect.{key}.NAME]");
        let tables = match self.table.get(key) {
            None => return Ok(Vec::new()),
            Some(Value::Table(tables)) => tables,
            Some(other) => return Err(self.wrong(key, other, &expected)),
        };
        let mut entries = Vec::new();
        for (name, value) in tables {
            let Value::Table(table) = value else {
                return Err(self.wrong(&format!("{key}.{name}"), value, &expected));
            };
            check_name(name).map_err(|expected| self.wrong_words(key, name, expected))?;
            entries.push((
                name.as_str(),
                Entry {
                    file: self.file,
                    section: self.section.clone(),
                    path: format!("{key}.{name}."),
                    table,
                },
            ));
        }
        Ok(entries)
    }

    fn definition(&self) -> Result<&'static Definition, ModelFileError> {
        self.check_keys(&KEYS)?;
        let name = self.words("name", "a name such as support_rumble")?;
        check_name(&name).map_err(|expected| self.wrong_words("name", &name, expected))?;
        if SECTIONS.contains(&name.as_str()) || effect_infos(&name).is_some() {
            let expected = "a name that no part and no effect has yet";
            return Err(self.wrong_words("name", &name, expected));
        }
        let port = self.choice("port", &Port::ALL.map(|port| (port.name(), port)))?;
        let mut parameters = Vec::new();
        for (key, parameter) in self.entries("parameters")? {
            parameters.push(parameter.parameter(key)?);
        }
        if parameters.is_empty() || parameters.len() > MOST_PARAMETERS {
            let count = Value::Integer(parameters.len() as i64);
            let expected = format!("from 1 to {MOST_PARAMETERS} sections [effect.parameters.NAME]");
            return Err(self.wrong("parameters", &count, &expected));
        }
        let mut tables = Vec::new();
        for (key, table) in self.entries("tables")? {
            tables.push(table.points(key)?);
        }
        let draft = Draft {
            name,
            title: self.words("title", "one line that says what the effect is")?,
            port,
            equation: self.words("equation", &format!("an equation for {}", port.unit()))?,
            source: self.optional_words("source")?,
            parameters,
            tables,
        };
        Definition::of(draft).map_err(|error| ModelFileError::Effect {
            file: self.file.to_owned(),
            section: self.section.clone(),
            message: error.to_string(),
        })
    }

    /// Key, unit, range and description of a parameter.
    fn parameter(&self, key: &str) -> Result<(String, String, Range, String), ModelFileError> {
        self.check_keys(&[&PARAMETER_KEYS[..], &Provenance::KEYS].concat())?;
        Ok((
            key.to_owned(),
            self.words("unit", "a unit such as N.m.s/rad, or 1")?,
            self.range()?,
            self.words("description", "one line that says what the number is")?,
        ))
    }

    fn range(&self) -> Result<Range, ModelFileError> {
        let Some(value) = self.table.get("range") else {
            return Ok(Range::Finite);
        };
        Range::read(value).ok_or_else(|| self.wrong("range", value, Range::WRITTEN))
    }

    fn points(&self, key: &str) -> Result<Points, ModelFileError> {
        self.check_keys(&TABLE_KEYS)?;
        let ways = [
            ("linear", Interpolation::Linear),
            ("spline", Interpolation::Spline),
        ];
        let period = match self.table.get("period") {
            None => None,
            Some(value) => {
                let wrong = || self.wrong("period", value, "a number in the unit of x");
                Some(number(value).ok_or_else(wrong)?)
            }
        };
        Ok(Points {
            name: key.to_owned(),
            x: self.numbers("x")?,
            y: self.numbers("y")?,
            units: [
                self.words("x_unit", "the unit of x")?,
                self.words("y_unit", "the unit of y")?,
            ],
            interpolation: self.choice("interpolation", &ways)?,
            period,
        })
    }
}

/// Whether equations of rigs and dotted names can carry a name; if not, what would be right.
fn check_name(name: &str) -> Result<(), &'static str> {
    expression::check_name(name, &Coordinate::ALL.map(Coordinate::name))
}
