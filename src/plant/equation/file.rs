//! Effects by equation in files: sections `[[effect]]` of `model.toml`, and files of a catalogue.

use super::definition::{Draft, Points};
use super::{Definition, EquationEffect, EquationEffects, MOST_PARAMETERS, Port};
use crate::expression::{Coordinate, Interpolation};
use crate::parameter::{ModelFileError, ParameterInfo, Provenance, Range, Section, SectionReader};
use crate::plant::model_file::{SECTIONS, write_number};
use std::collections::BTreeMap;
use std::fmt::Write;
use toml::{Table, Value};

const KEYS: [&str; 9] = [
    "name",
    "title",
    "port",
    "equation",
    "source",
    "signature",
    "confused_with",
    "parameters",
    "tables",
];
const PARAMETER_KEYS: [&str; 3] = ["unit", "range", "description"];
const TABLE_KEYS: [&str; 6] = ["x", "y", "x_unit", "y_unit", "interpolation", "period"];
/// Longest line of words in a description, in characters.
const LONGEST: usize = 2000;

/// What an equation could not tell from a name of its own.
const RESERVED: [&str; 12] = [
    "sin", "cos", "exp", "log", "sqrt", "abs", "sign", "pow", "tanh", "min", "max", "pi",
];

/// The definition in a file of a catalogue; `file` names it in messages.
///
/// # Errors
/// What is wrong with the file, by key.
pub fn definition_from_toml(text: &str, file: &str) -> Result<&'static Definition, ModelFileError> {
    let reader = SectionReader::new(text, file)?;
    let description = Description {
        file,
        section: "effect".to_owned(),
        table: &reader.table,
    };
    let definition = description.read()?;
    for (key, parameter) in description.parameters()? {
        if let Some(value) = parameter.get("value") {
            let expected = "no value: the diagnosis finds it".to_owned();
            return Err(description.wrong(&format!("parameters.{key}.value"), value, &expected));
        }
    }
    Ok(definition)
}

/// The effects of a model file, switched on.
pub(in crate::plant) fn read_effects(
    reader: &mut SectionReader<'_>,
) -> Result<EquationEffects<f64>, ModelFileError> {
    let mut effects = EquationEffects::default();
    let list = match reader.table.remove("effect") {
        None => return Ok(effects),
        Some(Value::Array(list)) => list,
        Some(other) => {
            let expected = "a list: write [[effect]], once for each effect";
            return Err(reader.wrong_type("effect", "", &other, expected));
        }
    };
    for (place, entry) in list.iter().enumerate() {
        let Value::Table(table) = entry else {
            return Err(reader.wrong_type("effect", "", entry, "a section [[effect]]"));
        };
        let mut description = Description {
            file: reader.file,
            section: format!("effect {}", place + 1),
            table,
        };
        if let Some(Value::String(name)) = table.get("name") {
            description.section = format!("effect {name}");
        }
        let definition = description.read()?;
        if effects
            .known()
            .any(|other| other.definition.name() == definition.name())
        {
            let name = Value::String(definition.name().to_owned());
            let expected = "another name: an effect before it has this one";
            return Err(description.wrong("name", &name, expected));
        }
        let mut values = BTreeMap::new();
        for (key, parameter) in description.parameters()? {
            let info = definition.infos().iter().find(|info| info.key == key);
            let Some(info) = info else { continue };
            let mut numbers = parameter.clone();
            numbers.retain(|key, _| !PARAMETER_KEYS[1..].contains(&key));
            if !numbers.contains_key("value") {
                return Err(ModelFileError::MissingKey {
                    file: reader.file.to_owned(),
                    section: description.section.clone(),
                    key: format!("parameters.{key}.value"),
                    description: info.description.to_owned(),
                    unit: info.unit.to_owned(),
                });
            }
            let value = reader.number(definition.name(), info, &Value::Table(numbers))?;
            values.insert(info.key, value);
        }
        let wrong = |source| ModelFileError::Parameter {
            file: reader.file.to_owned(),
            source,
        };
        effects.add(definition).map_err(wrong)?;
        let value = |info: &'static ParameterInfo| {
            Ok::<f64, std::convert::Infallible>(values.get(info.key).copied().unwrap_or_default())
        };
        effects.insert(definition.name(), value);
    }
    Ok(effects)
}

/// Appends the section of an effect to the text of a model file.
pub(in crate::plant) fn write_effect(
    text: &mut String,
    effect: &EquationEffect<f64>,
    provenance: &BTreeMap<String, Provenance>,
) {
    let draft = effect.definition.draft();
    let quoted = |words: &str| Value::String(words.to_owned());
    let _ = writeln!(text, "\n[[effect]]");
    let _ = writeln!(text, "name = {}", quoted(&draft.name));
    let _ = writeln!(text, "title = {}", quoted(&draft.title));
    let _ = writeln!(text, "port = {}", quoted(draft.port.name()));
    let _ = writeln!(text, "equation = {}", quoted(&draft.equation));
    for (key, words) in [("source", &draft.source), ("signature", &draft.signature)] {
        if let Some(words) = words {
            let _ = writeln!(text, "{key} = {}", quoted(words));
        }
    }
    if !draft.confused_with.is_empty() {
        let names: Vec<Value> = draft
            .confused_with
            .iter()
            .map(|name| quoted(name))
            .collect();
        let _ = writeln!(text, "confused_with = {}", Value::Array(names));
    }
    for (place, (key, unit, range, description)) in draft.parameters.iter().enumerate() {
        let _ = writeln!(text, "[effect.parameters.{key}]");
        let _ = writeln!(text, "value = {}", write_number(effect.get(place)));
        let _ = writeln!(text, "unit = {}", quoted(unit));
        let _ = writeln!(text, "range = {}", write_range(*range));
        let _ = writeln!(text, "description = {}", quoted(description));
        if let Some(known) = provenance.get(&format!("{}.{key}", draft.name)) {
            for (key, words) in [("source", &known.source), ("status", &known.status)] {
                if let Some(words) = words {
                    let _ = writeln!(text, "{key} = {}", quoted(words));
                }
            }
            if let Some(relative) = known.relative_uncertainty {
                let _ = writeln!(text, "relative_uncertainty = {}", write_number(relative));
            }
            if let Some([low, high]) = known.interval95 {
                let (low, high) = (write_number(low), write_number(high));
                let _ = writeln!(text, "interval95 = [{low}, {high}]");
            }
        }
    }
    for points in &draft.tables {
        let list = |numbers: &[f64]| {
            let texts: Vec<String> = numbers.iter().map(|x| write_number(*x)).collect();
            texts.join(", ")
        };
        let _ = writeln!(text, "[effect.tables.{}]", points.name);
        let _ = writeln!(text, "x = [{}]", list(&points.x));
        let _ = writeln!(text, "y = [{}]", list(&points.y));
        let _ = writeln!(text, "x_unit = {}", quoted(&points.units[0]));
        let _ = writeln!(text, "y_unit = {}", quoted(&points.units[1]));
        let word = match points.interpolation {
            Interpolation::Linear => "linear",
            Interpolation::Spline => "spline",
        };
        let _ = writeln!(text, "interpolation = {}", quoted(word));
        if let Some(period) = points.period {
            let _ = writeln!(text, "period = {}", write_number(period));
        }
    }
}

fn write_range(range: Range) -> String {
    match range {
        Range::Positive => "\"positive\"".to_owned(),
        Range::NonNegative => "\"non-negative\"".to_owned(),
        Range::Finite => "\"any\"".to_owned(),
        Range::Between(low, high) => format!("[{}, {}]", write_number(low), write_number(high)),
    }
}

/// One description while it is read.
struct Description<'a> {
    file: &'a str,
    section: String,
    table: &'a Table,
}

impl Description<'_> {
    fn wrong(&self, key: &str, value: &Value, expected: &str) -> ModelFileError {
        ModelFileError::WrongType {
            file: self.file.to_owned(),
            section: self.section.clone(),
            key: key.to_owned(),
            value: value.to_string(),
            expected: expected.to_owned(),
        }
    }

    fn read(&self) -> Result<&'static Definition, ModelFileError> {
        self.check_keys("", self.table, &KEYS)?;
        let name = self.name(
            "name",
            &self.words("name", "a name such as support_rumble")?,
        )?;
        if SECTIONS.contains(&name.as_str()) || crate::plant::effect_infos(&name).is_some() {
            let value = Value::String(name);
            return Err(self.wrong("name", &value, "a name that no part and no effect has yet"));
        }
        let port = self.words("port", &ports())?;
        let port = Port::ALL
            .into_iter()
            .find(|known| known.name() == port)
            .ok_or_else(|| {
                self.wrong("port", &Value::String(port), &format!("one of {}", ports()))
            })?;
        let mut parameters = Vec::new();
        for (key, table) in self.parameters()? {
            parameters.push(self.parameter(&key, &table)?);
        }
        if parameters.is_empty() || parameters.len() > MOST_PARAMETERS {
            let value = Value::Integer(parameters.len() as i64);
            let expected = format!("from 1 to {MOST_PARAMETERS} sections [effect.parameters.NAME]");
            return Err(self.wrong("parameters", &value, &expected));
        }
        let mut tables = Vec::new();
        for (key, table) in self.subtables("tables")? {
            tables.push(self.points(&key, &table)?);
        }
        let draft = Draft {
            name,
            title: self.words("title", "one line that says what the effect is")?,
            port,
            equation: self.words("equation", &format!("an equation for {}", port.unit()))?,
            source: self.optional_words("source")?,
            signature: self.optional_words("signature")?,
            confused_with: self.names("confused_with")?,
            parameters,
            tables,
        };
        Definition::of(draft).map_err(|error| ModelFileError::Effect {
            file: self.file.to_owned(),
            section: self.section.clone(),
            message: error.to_string(),
        })
    }

    fn check_keys(&self, of: &str, table: &Table, known: &[&str]) -> Result<(), ModelFileError> {
        match table.keys().find(|key| !known.contains(&key.as_str())) {
            None => Ok(()),
            Some(key) => Err(ModelFileError::UnknownKey {
                file: self.file.to_owned(),
                section: self.section.clone(),
                key: format!("{of}{key}"),
                known: known.join(", "),
            }),
        }
    }

    fn words(&self, key: &str, expected: &str) -> Result<String, ModelFileError> {
        self.optional_words(key)?
            .ok_or_else(|| ModelFileError::MissingKey {
                file: self.file.to_owned(),
                section: self.section.clone(),
                key: key.to_owned(),
                description: expected.to_owned(),
                unit: "text".to_owned(),
            })
    }

    fn optional_words(&self, key: &str) -> Result<Option<String>, ModelFileError> {
        match self.table.get(key) {
            None => Ok(None),
            Some(Value::String(words))
                if !words.trim().is_empty()
                    && words.chars().count() <= LONGEST
                    && !words.chars().any(char::is_control) =>
            {
                Ok(Some(words.clone()))
            }
            Some(other) => {
                let expected = format!("one line of text with at most {LONGEST} characters");
                Err(self.wrong(key, other, &expected))
            }
        }
    }

    /// A name that equations and dotted names can carry.
    fn name(&self, key: &str, name: &str) -> Result<String, ModelFileError> {
        let mut letters = name.chars();
        let good = letters.next().is_some_and(|c| c.is_ascii_lowercase())
            && letters.all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
            && name.len() <= 40;
        let taken = RESERVED.contains(&name)
            || Coordinate::ALL
                .iter()
                .any(|coordinate| coordinate.name() == name);
        if good && !taken {
            return Ok(name.to_owned());
        }
        let expected = if taken {
            "another name: equations mean something else by this one"
        } else {
            "small letters, digits and _, a letter first, 40 at most"
        };
        Err(self.wrong(key, &Value::String(name.to_owned()), expected))
    }

    fn names(&self, key: &str) -> Result<Vec<String>, ModelFileError> {
        let Some(value) = self.table.get(key) else {
            return Ok(Vec::new());
        };
        let list = value.as_array().map(|list| {
            let names = list.iter().map(|name| name.as_str().map(str::to_owned));
            names.collect::<Option<Vec<String>>>()
        });
        list.flatten()
            .ok_or_else(|| self.wrong(key, value, "a list of names of effects"))
    }

    fn subtables(&self, key: &str) -> Result<Vec<(String, Table)>, ModelFileError> {
        let expected = format!("sections [effect.{key}.NAME]");
        match self.table.get(key) {
            None => Ok(Vec::new()),
            Some(Value::Table(tables)) => tables
                .iter()
                .map(|(name, value)| match value {
                    Value::Table(table) => Ok((name.clone(), table.clone())),
                    other => Err(self.wrong(&format!("{key}.{name}"), other, &expected)),
                })
                .collect(),
            Some(other) => Err(self.wrong(key, other, &expected)),
        }
    }

    fn parameters(&self) -> Result<Vec<(String, Table)>, ModelFileError> {
        self.subtables("parameters")
    }

    fn parameter(
        &self,
        key: &str,
        table: &Table,
    ) -> Result<(String, String, Range, String), ModelFileError> {
        let at = format!("parameters.{key}");
        let known = [&PARAMETER_KEYS[..], &["value"], &Provenance::KEYS].concat();
        self.check_keys(&format!("{at}."), table, &known)?;
        let text = |field: &str, expected: &str| match table.get(field) {
            Some(Value::String(words)) if !words.chars().any(char::is_control) => Ok(words.clone()),
            Some(other) => Err(self.wrong(&format!("{at}.{field}"), other, expected)),
            None => Err(ModelFileError::MissingKey {
                file: self.file.to_owned(),
                section: self.section.clone(),
                key: format!("{at}.{field}"),
                description: expected.to_owned(),
                unit: "text".to_owned(),
            }),
        };
        let number = |value: &Value| match value {
            Value::Float(x) => Some(*x),
            Value::Integer(n) => Some(*n as f64),
            _ => None,
        };
        let expected = "\"any\", \"positive\", \"non-negative\" or [lowest, highest]";
        let range = match table.get("range") {
            None => Range::Finite,
            Some(Value::String(word)) if word == "any" => Range::Finite,
            Some(Value::String(word)) if word == "positive" => Range::Positive,
            Some(Value::String(word)) if word == "non-negative" => Range::NonNegative,
            Some(value) => {
                let bounds = value.as_array().and_then(|list| match list.as_slice() {
                    [low, high] => Some((number(low)?, number(high)?)),
                    _ => None,
                });
                let bounds =
                    bounds.filter(|(low, high)| low.is_finite() && high.is_finite() && low < high);
                let (low, high) =
                    bounds.ok_or_else(|| self.wrong(&format!("{at}.range"), value, expected))?;
                Range::Between(low, high)
            }
        };
        Ok((
            self.name(&at, key)?,
            text("unit", "a unit such as N.m.s/rad, or 1")?,
            range,
            text("description", "one line that says what the number is")?,
        ))
    }

    fn points(&self, key: &str, table: &Table) -> Result<Points, ModelFileError> {
        let at = format!("tables.{key}");
        self.check_keys(&format!("{at}."), table, &TABLE_KEYS)?;
        let missing = |field: &str, expected: &str| ModelFileError::MissingKey {
            file: self.file.to_owned(),
            section: self.section.clone(),
            key: format!("{at}.{field}"),
            description: expected.to_owned(),
            unit: "table".to_owned(),
        };
        let number = |value: &Value| match value {
            Value::Float(x) => Some(*x),
            Value::Integer(n) => Some(*n as f64),
            _ => None,
        };
        let numbers = |field: &str| {
            let expected = "a list of numbers";
            let value = table.get(field).ok_or_else(|| missing(field, expected))?;
            let list = value
                .as_array()
                .map(|list| list.iter().map(number).collect());
            let list: Option<Option<Vec<f64>>> = list;
            list.flatten().ok_or_else(|| {
                let short = Value::String(value.to_string().chars().take(60).collect());
                self.wrong(&format!("{at}.{field}"), &short, expected)
            })
        };
        let text = |field: &str, expected: &str| match table.get(field) {
            Some(Value::String(words)) => Ok(words.clone()),
            Some(other) => Err(self.wrong(&format!("{at}.{field}"), other, expected)),
            None => Err(missing(field, expected)),
        };
        let word = text("interpolation", "\"linear\" or \"spline\"")?;
        let interpolation = match word.as_str() {
            "linear" => Interpolation::Linear,
            "spline" => Interpolation::Spline,
            _ => {
                let value = Value::String(word);
                return Err(self.wrong(
                    &format!("{at}.interpolation"),
                    &value,
                    "\"linear\" or \"spline\"",
                ));
            }
        };
        let period = match table.get("period") {
            None => None,
            Some(value) => {
                let wrong =
                    || self.wrong(&format!("{at}.period"), value, "a number in the unit of x");
                Some(number(value).ok_or_else(wrong)?)
            }
        };
        Ok(Points {
            name: self.name(&at, key)?,
            x: numbers("x")?,
            y: numbers("y")?,
            units: [
                text("x_unit", "the unit of x")?,
                text("y_unit", "the unit of y")?,
            ],
            interpolation,
            period,
        })
    }
}

fn ports() -> String {
    let names: Vec<&str> = Port::ALL.into_iter().map(Port::name).collect();
    names.join(", ")
}
