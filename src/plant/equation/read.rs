//! Sections `[[effect]]` of a model file, and what may be wrong with them.

use super::definition::{Draft, Points};
use super::{Definition, EquationEffects, Port};
use crate::expression::{self, Coordinate, Interpolation, MOST_PARAMETERS};
use crate::parameter::{
    Entry, ModelFileError, ParameterInfo, Provenance, Range, SectionReader, number,
};
use crate::plant::effect_infos;
use crate::plant::model_file::SECTIONS;
use std::collections::BTreeMap;
use std::convert::Infallible;
use toml::Value;

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

/// The effects of a model file, switched on.
pub(in crate::plant) fn read_effects(
    reader: &mut SectionReader<'_>,
) -> Result<EquationEffects<f64>, ModelFileError> {
    let mut effects = EquationEffects::default();
    let list = reader.table.remove("effect");
    for entry in &Entry::effects(list.as_ref(), reader.file)? {
        read_effect(entry, reader, &mut effects)?;
    }
    Ok(effects)
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
        let reader = SectionReader::new(text, file)?;
        let mut all: Vec<Self> = Vec::new();
        for entry in &reader.effects_alone()? {
            let supposition = Self::of(entry)?;
            let name = supposition.definition.name();
            if all.iter().any(|other| other.definition.name() == name) {
                return Err(name_is_taken(entry, name));
            }
            all.push(supposition);
        }
        Ok(all)
    }

    fn of(entry: &Entry<'_>) -> Result<Self, ModelFileError> {
        let definition = definition(entry)?;
        let mut guesses = [None; MOST_PARAMETERS];
        for (place, (_, parameter)) in named(entry, "parameters")?.iter().enumerate() {
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
        Ok(Self {
            definition,
            guesses,
        })
    }
}

fn read_effect(
    entry: &Entry<'_>,
    reader: &mut SectionReader<'_>,
    effects: &mut EquationEffects<f64>,
) -> Result<(), ModelFileError> {
    let definition = definition(entry)?;
    let is_taken = effects
        .known()
        .any(|other| other.definition.name() == definition.name());
    if is_taken {
        return Err(name_is_taken(entry, definition.name()));
    }
    let mut values = BTreeMap::new();
    for (info, (_, parameter)) in definition.infos().iter().zip(named(entry, "parameters")?) {
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

fn name_is_taken(entry: &Entry<'_>, name: &str) -> ModelFileError {
    let expected = "another name: an effect before it has this one";
    entry.wrong_words("name", name, expected)
}

fn definition(entry: &Entry<'_>) -> Result<&'static Definition, ModelFileError> {
    entry.check_keys(&KEYS)?;
    let name = entry.words("name", "a name such as support_rumble")?;
    check_name(&name).map_err(|expected| entry.wrong_words("name", &name, expected))?;
    if SECTIONS.contains(&name.as_str()) || effect_infos(&name).is_some() {
        let expected = "a name that no part and no effect has yet";
        return Err(entry.wrong_words("name", &name, expected));
    }
    let port = entry.choice("port", &Port::ALL.map(|port| (port.name(), port)))?;
    let mut parameters = Vec::new();
    for (key, parameter) in named(entry, "parameters")? {
        parameters.push(self::parameter(&parameter, key)?);
    }
    if parameters.is_empty() || parameters.len() > MOST_PARAMETERS {
        let count = Value::Integer(parameters.len() as i64);
        let expected = format!("from 1 to {MOST_PARAMETERS} sections [effect.parameters.NAME]");
        return Err(entry.wrong("parameters", &count, &expected));
    }
    let mut tables = Vec::new();
    for (key, table) in named(entry, "tables")? {
        tables.push(points(&table, key)?);
    }
    let draft = Draft {
        name,
        title: entry.words("title", "one line that says what the effect is")?,
        port,
        equation: entry.words("equation", &format!("an equation for {}", port.unit()))?,
        source: entry.optional_words("source")?,
        parameters,
        tables,
    };
    Definition::of(draft).map_err(|error| ModelFileError::Effect {
        file: entry.file.to_owned(),
        section: entry.section.clone(),
        message: error.to_string(),
    })
}

/// Key, unit, range and description of a parameter.
fn parameter(
    entry: &Entry<'_>,
    key: &str,
) -> Result<(String, String, Range, String), ModelFileError> {
    entry.check_keys(&[&PARAMETER_KEYS[..], &Provenance::KEYS].concat())?;
    Ok((
        key.to_owned(),
        entry.words("unit", "a unit such as N.m.s/rad, or 1")?,
        entry.range()?,
        entry.words("description", "one line that says what the number is")?,
    ))
}

fn points(entry: &Entry<'_>, key: &str) -> Result<Points, ModelFileError> {
    entry.check_keys(&TABLE_KEYS)?;
    let ways = [
        ("linear", Interpolation::Linear),
        ("spline", Interpolation::Spline),
    ];
    let period = match entry.table.get("period") {
        None => None,
        Some(value) => {
            let wrong = || entry.wrong("period", value, "a number in the unit of x");
            Some(number(value).ok_or_else(wrong)?)
        }
    };
    Ok(Points {
        name: key.to_owned(),
        x: entry.numbers("x")?,
        y: entry.numbers("y")?,
        units: [
            entry.words("x_unit", "the unit of x")?,
            entry.words("y_unit", "the unit of y")?,
        ],
        interpolation: entry.choice("interpolation", &ways)?,
        period,
    })
}

/// The tables below `key`, each under a name that equations can carry.
fn named<'a>(entry: &Entry<'a>, key: &str) -> Result<Vec<(&'a str, Entry<'a>)>, ModelFileError> {
    let entries = entry.entries(key)?;
    for (name, _) in &entries {
        check_name(name).map_err(|expected| entry.wrong_words(key, name, expected))?;
    }
    Ok(entries)
}

/// Whether equations of rigs and dotted names can carry a name; if not, what would be right.
fn check_name(name: &str) -> Result<(), &'static str> {
    expression::check_name(name, &Coordinate::ALL.map(Coordinate::name))
}
