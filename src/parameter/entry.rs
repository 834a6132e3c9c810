//! A table of a file while it is read key by key: words, numbers, tables below it, and what may be wrong with them.

use super::section_file::{STATUSES, interval, number};
use super::{ModelFileError, Provenance, Range};
use toml::{Table, Value};

/// Longest line of words, in characters: what a tool shows in one place.
const LONGEST: usize = 2000;

/// A table of a file.
pub(crate) struct Entry<'a> {
    pub(crate) file: &'a str,
    pub(crate) section: String,
    /// What its keys begin with in messages.
    pub(crate) path: String,
    pub(crate) table: &'a Table,
}

impl<'a> Entry<'a> {
    /// The sections `[[effect]]` of a file, in their order, of which `list` is what the file has under that name.
    ///
    /// # Errors
    /// They are no list of tables.
    pub(crate) fn effects(
        list: Option<&'a Value>,
        file: &'a str,
    ) -> Result<Vec<Self>, ModelFileError> {
        let wrong = |value: &Value, expected: &str| ModelFileError::WrongType {
            file: file.to_owned(),
            section: "effect".to_owned(),
            key: String::new(),
            value: shortened(value),
            expected: expected.to_owned(),
        };
        let list = match list {
            None => return Ok(Vec::new()),
            Some(Value::Array(list)) => list,
            Some(other) => {
                let expected = "a list: write [[effect]], once for each effect";
                return Err(wrong(other, expected));
            }
        };
        let section = |(place, value): (usize, &'a Value)| match value {
            Value::Table(table) => Ok(Self::effect(file, place, table)),
            other => Err(wrong(other, "a section [[effect]]")),
        };
        list.iter().enumerate().map(section).collect()
    }

    fn effect(file: &'a str, place: usize, table: &'a Table) -> Self {
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

    #[cold]
    pub(crate) fn wrong(&self, key: &str, value: &Value, expected: &str) -> ModelFileError {
        ModelFileError::WrongType {
            file: self.file.to_owned(),
            section: self.section.clone(),
            key: format!("{}{key}", self.path),
            value: shortened(value),
            expected: expected.to_owned(),
        }
    }

    #[cold]
    pub(crate) fn wrong_words(&self, key: &str, words: &str, expected: &str) -> ModelFileError {
        self.wrong(key, &Value::String(words.to_owned()), expected)
    }

    #[cold]
    pub(crate) fn missing(&self, key: &str, description: &str, unit: &str) -> ModelFileError {
        ModelFileError::MissingKey {
            file: self.file.to_owned(),
            section: self.section.clone(),
            key: format!("{}{key}", self.path),
            description: description.to_owned(),
            unit: unit.to_owned(),
        }
    }

    pub(crate) fn check_keys(&self, known: &[&str]) -> Result<(), ModelFileError> {
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

    pub(crate) fn words(&self, key: &str, expected: &str) -> Result<String, ModelFileError> {
        self.optional_words(key)?
            .ok_or_else(|| self.missing(key, expected, "text"))
    }

    pub(crate) fn optional_words(&self, key: &str) -> Result<Option<String>, ModelFileError> {
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
    pub(crate) fn choice<T: Copy>(
        &self,
        key: &str,
        known: &[(&str, T)],
    ) -> Result<T, ModelFileError> {
        let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        let expected = format!("one of {}", names.join(", "));
        let word = self.words(key, &expected)?;
        let found = known.iter().find(|(name, _)| *name == word);
        found
            .map(|(_, meaning)| *meaning)
            .ok_or_else(|| self.wrong_words(key, &word, &expected))
    }

    /// A list of words, if there is one.
    pub(crate) fn list(&self, key: &str) -> Result<Option<Vec<String>>, ModelFileError> {
        let Some(value) = self.table.get(key) else {
            return Ok(None);
        };
        let word = |value: &Value| value.as_str().map(str::to_owned);
        let words = value
            .as_array()
            .and_then(|list| list.iter().map(word).collect());
        match words {
            Some(words) => Ok(Some(words)),
            None => Err(self.wrong(key, value, "a list of words")),
        }
    }

    /// A number, if there is one.
    pub(crate) fn optional_number(&self, key: &str) -> Result<Option<f64>, ModelFileError> {
        let Some(value) = self.table.get(key) else {
            return Ok(None);
        };
        match number(value) {
            Some(number) => Ok(Some(number)),
            None => Err(self.wrong(key, value, "a number")),
        }
    }

    pub(crate) fn numbers(&self, key: &str) -> Result<Vec<f64>, ModelFileError> {
        let expected = "a list of numbers";
        let value = self.table.get(key);
        let value = value.ok_or_else(|| self.missing(key, expected, "table"))?;
        let numbers = value
            .as_array()
            .and_then(|list| list.iter().map(number).collect());
        numbers.ok_or_else(|| self.wrong(key, value, expected))
    }

    /// The range of a number; any finite one where none is given.
    pub(crate) fn range(&self) -> Result<Range, ModelFileError> {
        let Some(value) = self.table.get("range") else {
            return Ok(Range::Finite);
        };
        Range::read(value).ok_or_else(|| self.wrong("range", value, Range::WRITTEN))
    }

    /// The tables below `key`, by name.
    pub(crate) fn entries(&self, key: &str) -> Result<Vec<(&'a str, Entry<'a>)>, ModelFileError> {
        let expected = format!("sections [effect.{key}.NAME]");
        let tables = match self.table.get(key) {
            None => return Ok(Vec::new()),
            Some(Value::Table(tables)) => tables,
            Some(other) => return Err(self.wrong(key, other, &expected)),
        };
        let entry = |(name, value): (&'a String, &'a Value)| match value {
            Value::Table(table) => {
                let below = Entry {
                    file: self.file,
                    section: self.section.clone(),
                    path: format!("{key}.{name}."),
                    table,
                };
                Ok((name.as_str(), below))
            }
            other => Err(self.wrong(&format!("{key}.{name}"), other, &expected)),
        };
        tables.iter().map(entry).collect()
    }

    /// Where the number that this table gives comes from.
    pub(crate) fn provenance(&self) -> Result<Provenance, ModelFileError> {
        let mut provenance = Provenance::default();
        for (key, value) in self.table {
            let wrong = |expected: &str| Err(self.wrong(key, value, expected));
            match (key.as_str(), value) {
                ("source", Value::String(text)) => provenance.source = Some(text.clone()),
                ("source", _) => return wrong("a text"),
                ("status", Value::String(text)) if STATUSES.contains(&text.as_str()) => {
                    provenance.status = Some(text.clone());
                }
                ("status", _) => return wrong(&format!("one of {}", STATUSES.join(", "))),
                ("relative_uncertainty", _) => {
                    let known = number(value).filter(|x| x.is_finite() && *x >= 0.0);
                    if known.is_none() {
                        return wrong("one standard deviation over the value, 0 or above");
                    }
                    provenance.relative_uncertainty = known;
                }
                ("interval95", _) => {
                    let Some(bounds) = interval(value) else {
                        return wrong("two numbers, the lower one first");
                    };
                    provenance.interval95 = Some(bounds);
                }
                _ => {}
            }
        }
        Ok(provenance)
    }
}

/// What stands there; a table of a million points is not repeated.
fn shortened(value: &Value) -> String {
    value.to_string().chars().take(LONGEST).collect()
}
