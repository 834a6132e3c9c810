//! Model files of small plants: sections, numbers, effects, and what may be wrong with them.

use std::path::PathBuf;
use std::sync::LazyLock;

use serde::de::DeserializeOwned;
use thiserror::Error;
use toml::Value;

use super::dimension::plain;
use super::effect::{Described, described, read};
use super::{Kind, Parameter, Path};
use crate::parameter::{Entry, ModelFileError, Provenance};

/// Name of the file of effects that the library brings, for messages.
pub const CATALOGUE_FILE: &str = "src/body/effects.toml";
/// Sections of effects that a model file itself describes.
pub const OWN_EFFECTS: &str = "effect";

/// The effects of the library's own file, each of which is a section of its name in model files.
///
/// # Errors
/// The file is wrong, which a test excludes.
pub fn catalogue() -> Result<&'static [Described], FileError> {
    static ALL: LazyLock<Result<Vec<Described>, FileError>> =
        LazyLock::new(|| read(include_str!("effects.toml"), CATALOGUE_FILE));
    ALL.as_deref().map_err(Clone::clone)
}

/// What is wrong with a model file of a small plant.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FileError {
    /// Not TOML, or a key of a fixed section is missing, unknown or of the wrong type.
    #[error("{file}: {message}")]
    Syntax {
        /// File.
        file: String,
        /// What the parser says.
        message: String,
    },
    /// A wrong word or number.
    #[error("{file}: [{section}] {key} = {found} must be {expected}")]
    Value {
        /// File.
        file: String,
        /// Section.
        section: String,
        /// Key.
        key: String,
        /// What stands there.
        found: String,
        /// What would be right.
        expected: String,
    },
    /// A section or key is missing.
    #[error("{file}: [{section}] is missing or lacks {key}; it needs {expected}")]
    Missing {
        /// File.
        file: String,
        /// Section.
        section: String,
        /// Key.
        key: String,
        /// What belongs there.
        expected: String,
    },
    /// A section or key that nobody knows.
    #[error("{file}: there is no {what}; known are {known}")]
    Unknown {
        /// File.
        file: String,
        /// The section or key.
        what: String,
        /// The known ones.
        known: String,
    },
    /// A key of a table is wrong.
    #[error(transparent)]
    Table(#[from] ModelFileError),
}

/// The section `[plant]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Plant {
    /// What it is.
    pub kind: Kind,
    /// Along what it moves.
    pub path: Path,
    /// The FMU that it is, if it is one.
    pub fmu: Option<PathBuf>,
}

/// Whether a model file's text describes a small plant.
#[must_use]
pub fn is_small_plant(text: &str) -> bool {
    text.parse::<toml::Table>()
        .is_ok_and(|table| table.contains_key("plant"))
}

/// A model file's sections, read one by one.
#[derive(Debug)]
pub struct Reader<'a> {
    /// The sections.
    pub table: toml::Table,
    /// The file's name in messages.
    pub file: &'a str,
}

impl<'a> Reader<'a> {
    /// Reads `text`; `file` names it in messages.
    ///
    /// # Errors
    /// It is not TOML.
    pub fn new(text: &str, file: &'a str) -> Result<Self, FileError> {
        let table = text.parse();
        let table = table.map_err(|error: toml::de::Error| FileError::Syntax {
            file: file.to_owned(),
            message: format!("not valid TOML: {}", error.to_string().trim_end()),
        })?;
        Ok(Self { table, file })
    }

    /// What the plant is.
    ///
    /// # Errors
    /// The section is missing or wrong.
    pub fn plant(&self) -> Result<Plant, FileError> {
        let expected = "kind = \"drive\", \"pendulum\", \"contact\", \"balance\", \"joint\" or \"fmu\" and path = \"line\" or \"turn\"";
        let table = self.table.get("plant").and_then(Value::as_table);
        let table = table.ok_or_else(|| FileError::Missing {
            file: self.file.to_owned(),
            section: "plant".to_owned(),
            key: "everything".to_owned(),
            expected: expected.to_owned(),
        })?;
        let entry = Entry {
            file: self.file,
            section: "plant".to_owned(),
            path: String::new(),
            table,
        };
        entry.check_keys(&["kind", "path", "fmu"])?;
        let kind = entry.choice("kind", &Kind::ALL.map(|kind| (kind.word(), kind)))?;
        let path = entry.choice(
            "path",
            &[Path::Line, Path::Turn].map(|path| (path.word(), path)),
        )?;
        let fmu = entry.optional_words("fmu")?.map(PathBuf::from);
        if kind.runs_alone() && path == Path::Line {
            let right = format!("\"turn\": a {} turns", kind.word());
            return Err(self.wrong("plant", "path", "\"line\"", &right));
        }
        if fmu.is_some() && kind != Kind::Fmu {
            return Err(FileError::Unknown {
                file: self.file.to_owned(),
                what: format!("key fmu in the model of a {}", kind.word()),
                known: "kind and path".to_owned(),
            });
        }
        Ok(Plant { kind, path, fmu })
    }

    /// The sections `[[effect]]`.
    ///
    /// # Errors
    /// One of them lacks something, or has too much.
    pub fn own_effects(&self) -> Result<Vec<Described>, FileError> {
        described(&Entry::effects(self.table.get(OWN_EFFECTS), self.file)?)
    }

    /// Refuses a description of an effect whose name is taken.
    ///
    /// # Errors
    /// It is.
    pub fn check_name(&self, name: &str, is_taken: bool) -> Result<(), FileError> {
        if is_taken {
            let section = format!("effect {name}");
            let found = format!("{name:?}");
            return Err(self.wrong(&section, "name", &found, "a name that no effect has yet"));
        }
        Ok(())
    }

    /// Refuses sections that are neither `known` nor one of the effects that are `possible`.
    ///
    /// # Errors
    /// The first of them.
    pub fn check_sections(
        &self,
        kind: Kind,
        known: &[&str],
        possible: &[&str],
    ) -> Result<(), FileError> {
        let known = || known.iter().chain(possible);
        match self.table.keys().find(|key| !known().any(|own| own == key)) {
            None => Ok(()),
            Some(section) => Err(FileError::Unknown {
                file: self.file.to_owned(),
                what: format!("section [{section}] in the model of a {}", kind.word()),
                known: known().copied().collect::<Vec<_>>().join(", "),
            }),
        }
    }

    /// A section, or nothing where there is none.
    ///
    /// # Errors
    /// A key is missing, unknown or of the wrong type; `expected` says what belongs there.
    pub fn optional<T: DeserializeOwned + Default>(
        &self,
        name: &str,
        expected: &str,
    ) -> Result<T, FileError> {
        if self.table.contains_key(name) {
            self.section(name, expected)
        } else {
            Ok(T::default())
        }
    }

    /// A section.
    ///
    /// # Errors
    /// It is missing, or a key is missing, unknown or of the wrong type; `expected` says what belongs there.
    pub fn section<T: DeserializeOwned>(&self, name: &str, expected: &str) -> Result<T, FileError> {
        let value = self.table.get(name).ok_or_else(|| FileError::Missing {
            file: self.file.to_owned(),
            section: name.to_owned(),
            key: "everything".to_owned(),
            expected: expected.to_owned(),
        })?;
        let read = value.clone().try_into();
        read.map_err(|error: toml::de::Error| FileError::Syntax {
            file: self.file.to_owned(),
            message: format!("[{name}]: {}; it needs {expected}", error.message()),
        })
    }

    /// The numbers of a base or an effect of the catalogue, in the order of its parameters.
    ///
    /// # Errors
    /// One of them is missing, of another unit or out of its range, or there are others.
    pub fn numbers(
        &self,
        section: &str,
        parameters: &[Parameter],
        kind: Kind,
        path: Path,
    ) -> Result<Vec<(f64, Provenance)>, FileError> {
        let expected = || {
            let parameters = parameters.iter();
            parameters
                .map(|p| {
                    let unit = p.dimension.unit(kind, path);
                    format!("{} [{unit}], {}", p.key, p.description)
                })
                .collect::<Vec<_>>()
                .join("; ")
        };
        let missing = |key: &str| FileError::Missing {
            file: self.file.to_owned(),
            section: section.to_owned(),
            key: key.to_owned(),
            expected: expected(),
        };
        let nothing = toml::Table::new();
        let table = match self.table.get(section).and_then(Value::as_table) {
            Some(table) => table,
            None if parameters.is_empty() => &nothing,
            None => return Err(missing("everything")),
        };
        if let Some(key) = table
            .keys()
            .find(|key| !parameters.iter().any(|p| p.key == **key))
        {
            return Err(FileError::Unknown {
                file: self.file.to_owned(),
                what: format!("key {key} in [{section}]"),
                known: expected(),
            });
        }
        let read = parameters.iter().map(|parameter| {
            let key = parameter.key;
            let value = table.get(key).ok_or_else(|| missing(key))?;
            let (number, origin) = match value {
                Value::Float(number) => (*number, Provenance::default()),
                Value::Integer(number) => (*number as f64, Provenance::default()),
                other => self.number(section, key, other, parameter.dimension.unit(kind, path))?,
            };
            if !parameter.range.contains(number) {
                let expected = parameter.range.to_string();
                return Err(self.wrong(section, key, &number.to_string(), &expected));
            }
            Ok((number, origin))
        });
        read.collect()
    }

    fn number(
        &self,
        section: &str,
        key: &str,
        value: &Value,
        unit: &str,
    ) -> Result<(f64, Provenance), FileError> {
        let expected = format!("a number or {{ value = …, unit = \"{unit}\", source = … }}");
        let wrong = || self.wrong(section, key, &value.to_string(), &expected);
        let entry = Entry {
            file: self.file,
            section: section.to_owned(),
            path: format!("{key}."),
            table: value.as_table().ok_or_else(wrong)?,
        };
        entry.check_keys(&[&["value", "unit"][..], &Provenance::KEYS].concat())?;
        let number = entry.optional_number("value")?.ok_or_else(wrong)?;
        if let Some(found) = entry.optional_words("unit")?
            && plain(&found) != plain(unit)
        {
            return Err(entry
                .wrong_words("unit", &found, &format!("\"{unit}\""))
                .into());
        }
        Ok((number, entry.provenance()?))
    }

    /// The refusal of a value.
    #[must_use]
    #[cold]
    pub fn wrong(&self, section: &str, key: &str, found: &str, expected: &str) -> FileError {
        FileError::Value {
            file: self.file.to_owned(),
            section: section.to_owned(),
            key: key.to_owned(),
            found: found.to_owned(),
            expected: expected.to_owned(),
        }
    }
}
