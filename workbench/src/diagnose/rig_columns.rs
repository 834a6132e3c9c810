//! Which column of a record is which variable of the rig, in which unit: as `[columns]` of the model file says, or as the
//! header itself does.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::Deserialize;
use thiserror::Error;

use super::console::number;
use super::record_part::Part;
use super::rig_variable::{TIME, units, variables};
use crate::component::closest;
use crate::files::record::{Missing, Record, RecordError, decode, with_commas};

/// The table of the model file.
const TABLE: &str = "columns";

/// A column as the model file names it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
enum Given {
    /// Its name, in SI units or in the unit that the header states.
    Name(String),
    /// Its name and unit.
    Full(Column),
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Column {
    column: String,
    unit: Option<String>,
    factor: Option<f64>,
}

/// The columns that a model file names, by variable.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigColumns {
    file: String,
    given: BTreeMap<String, Column>,
}

/// Why columns cannot be used.
#[derive(Debug, Error)]
pub enum ColumnsError {
    /// The table is no table of columns.
    #[error(
        "{file} [columns]: {problem}; a line such as theta = {{ column = \"angle\", unit = \"deg\" }} is right"
    )]
    Table {
        /// The model file.
        file: String,
        /// What is wrong.
        problem: String,
    },
    /// A variable that no record can have.
    #[error("{file} [columns]: `{key}` is no variable of a record{hint}; it may name {known}")]
    Variable {
        /// The model file.
        file: String,
        /// What stands there.
        key: String,
        /// The variable that is probably meant, as a question; empty where none is near.
        hint: String,
        /// All variables.
        known: String,
    },
    /// A unit that the variable does not have.
    #[error(
        "{file}: `{variable}` in \"{unit}\" cannot be converted; its unit may be {known}, or any other with factor = what one of it is in {first}, in the model's [columns]"
    )]
    Unit {
        /// The model file or the record.
        file: String,
        /// The variable.
        variable: String,
        /// What stands there.
        unit: String,
        /// The units that it may have.
        known: String,
        /// The SI unit.
        first: &'static str,
    },
    /// A factor that is no number to multiply with.
    #[error(
        "{file} [columns] {variable}: factor = {factor} must be a finite number other than 0, and above 0 for time"
    )]
    Factor {
        /// The model file.
        file: String,
        /// The variable.
        variable: String,
        /// What stands there.
        factor: f64,
    },
    /// A column that the model file names is not there.
    #[error(
        "{file}: has no column `{column}`, which the model's [columns] names as {variable}; it has {known}"
    )]
    Missing {
        /// The record.
        file: String,
        /// The column.
        column: String,
        /// The variable.
        variable: String,
        /// The columns that are there.
        known: String,
    },
    /// The file cannot be read.
    #[error("{path}: cannot be read: {source}")]
    Read {
        /// The file.
        path: String,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// The file holds no text.
    #[error("{file}: {problem}")]
    NoText {
        /// The file.
        file: String,
        /// What it is.
        problem: &'static str,
    },
    /// The table is no record.
    #[error(transparent)]
    Record(#[from] RecordError),
}

fn factor(file: &str, variable: &str, unit: &str) -> Result<f64, ColumnsError> {
    let known = units(variable);
    known
        .iter()
        .find(|(name, _)| *name == unit)
        .map(|(_, factor)| *factor)
        .ok_or_else(|| ColumnsError::Unit {
            file: file.to_owned(),
            variable: variable.to_owned(),
            unit: unit.to_owned(),
            known: known
                .iter()
                .map(|(name, _)| *name)
                .collect::<Vec<_>>()
                .join(", "),
            first: known[0].0,
        })
}

/// A header's name and the unit in brackets behind it.
fn name_and_unit(field: &str) -> (&str, Option<&str>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(inner) = field.strip_suffix(close)
            && let Some((name, unit)) = inner.split_once(open)
        {
            return (name.trim(), Some(unit.trim()));
        }
    }
    (field, None)
}

/// A field of a header, with the variable that it is taken as.
pub type Heading = (String, Option<&'static str>);

/// The text of the file `path`, which messages call `file`; whether it is UTF-16.
fn text_of(path: &Path, file: &str) -> Result<(String, bool), ColumnsError> {
    let bytes = fs::read(path).map_err(|source| ColumnsError::Read {
        path: path.display().to_string(),
        source,
    })?;
    let (mut text, is_wide) = decode(&bytes).map_err(|problem| ColumnsError::NoText {
        file: file.to_owned(),
        problem,
    })?;
    if text.starts_with('\u{feff}') {
        text.remove(0);
    }
    Ok((text, is_wide))
}

/// The fields of a table's header.
fn header(text: &str) -> Vec<&str> {
    let line = text.lines().find(|line| !line.trim().is_empty());
    line.unwrap_or("")
        .split(',')
        .map(|field| field.trim().trim_matches('"').trim())
        .collect()
}

/// One column of a file, found.
struct Found {
    name: String,
    factor: f64,
    said: Option<String>,
}

impl RigColumns {
    /// The text of the table `[columns]` in a model file's text, and what is left.
    #[must_use]
    pub fn split(text: &str) -> (String, String) {
        let mut is_own = false;
        let (mut own, mut rest) = (String::new(), String::new());
        for line in text.split_inclusive('\n') {
            if let Some(header) = line.trim_start().strip_prefix('[') {
                let name = header.split([']', '.']).next().unwrap_or("").trim();
                is_own = name == TABLE;
            }
            if is_own { &mut own } else { &mut rest }.push_str(line);
        }
        (own, rest)
    }

    /// Takes the table `[columns]` out of a model file's text: what is left describes the rig alone.
    ///
    /// # Errors
    /// [`ColumnsError`] where it names what no record has, or no unit.
    pub fn split_off(text: &str, file: &str) -> Result<(Self, String), ColumnsError> {
        let (own, rest) = Self::split(text);
        let table = |problem: String| ColumnsError::Table {
            file: file.to_owned(),
            problem,
        };
        let read: BTreeMap<String, BTreeMap<String, Given>> =
            toml::from_str(&own).map_err(|error| table(error.message().to_owned()))?;
        let mut given = BTreeMap::new();
        for (key, column) in read.into_values().flatten() {
            if !variables().any(|name| name == key) {
                return Err(ColumnsError::Variable {
                    file: file.to_owned(),
                    hint: closest(&key, variables())
                        .map(|near| format!(" (is `{near}` meant?)"))
                        .unwrap_or_default(),
                    known: variables().collect::<Vec<_>>().join(", "),
                    key,
                });
            }
            let column = match column {
                Given::Full(column) => column,
                Given::Name(column) => Column {
                    column,
                    unit: None,
                    factor: None,
                },
            };
            match (&column.unit, column.factor) {
                (_, Some(factor))
                    if !factor.is_finite() || factor == 0.0 || key == TIME && factor < 0.0 =>
                {
                    return Err(ColumnsError::Factor {
                        file: file.to_owned(),
                        variable: key,
                        factor,
                    });
                }
                (Some(unit), None) => {
                    factor(file, &key, unit)?;
                }
                _ => {}
            }
            given.insert(key, column);
        }
        let file = file.to_owned();
        Ok((Self { file, given }, rest))
    }

    /// Reads a record or a part of one, in SI units and with the rig's names; beside it what was made of the file, for
    /// [`about`].
    ///
    /// # Errors
    /// [`ColumnsError`], naming the file, the column and what would be right.
    pub fn read(&self, part: &Part) -> Result<(Record, String), ColumnsError> {
        if let Some(table) = &part.table {
            return self.of_table(table);
        }
        let path = part.path.display().to_string();
        let file = match part.span {
            Some((from, to)) => format!("{path}@{from}:{to}"),
            None => path.clone(),
        };
        let (text, is_wide) = text_of(&part.path, &file)?;
        let (text, dialect) = with_commas(&text);
        let mut said: Vec<String> = Vec::new();
        if is_wide {
            said.push("UTF-16".to_owned());
        }
        if !dialect.is_empty() {
            said.push(dialect.join(" and "));
        }
        let (columns, text) = self.renamed(&text, &file)?;
        let mut record = Record::parse(&text, &file, Missing::KeepAsNan)?;
        for column in columns {
            record.convert(&column.name, column.factor);
            said.extend(column.said);
        }
        if let Some((from, to)) = part.span {
            record = record.window(from, to);
            if record.is_empty() {
                return Err(RecordError::NoSamples { file }.into());
            }
        }
        Ok((record, said.join(", ")))
    }

    /// The fields of a file's header, each with the variable that it is taken as; `None` where it is none.
    ///
    /// # Errors
    /// [`ColumnsError`] where the file cannot be read.
    pub fn headings(&self, path: &Path) -> Result<Vec<Heading>, ColumnsError> {
        let file = path.display().to_string();
        let (text, _) = text_of(path, &file)?;
        let (text, _) = with_commas(&text);
        Ok(header(&text)
            .into_iter()
            .map(|field| {
                let found = self.found(field, &file).ok();
                let variable = found.and_then(|found| variables().find(|own| *own == found.name));
                (field.to_owned(), variable)
            })
            .collect())
    }

    /// A table in memory with the rig's names, in SI units.
    fn of_table(&self, table: &Record) -> Result<(Record, String), ColumnsError> {
        let file = table.source();
        // A table's time stands apart from its columns, and has the name that is asked for.
        let time = self.given.get(TIME).map_or(TIME, |given| &given.column);
        let header: Vec<&str> = std::iter::once(time).chain(table.names()).collect();
        let found = self.found_all(&header, file)?;
        let mut record = Record::new(file, table.time().to_vec())?;
        for (own, column) in header.iter().zip(&found).skip(1) {
            record.add_column(&column.name, table.require(own)?.to_vec())?;
        }
        let mut said = Vec::new();
        for column in found {
            record.convert(&column.name, column.factor);
            said.extend(column.said);
        }
        Ok((record, said.join(", ")))
    }

    /// The table with the rig's names in its header, time first.
    fn renamed(&self, text: &str, file: &str) -> Result<(Vec<Found>, String), ColumnsError> {
        let found = self.found_all(&header(text), file)?;
        let time = found.iter().position(|column| column.name == TIME);
        let mut is_header = true;
        let mut lines = Vec::new();
        for line in text.lines() {
            if line.trim().is_empty() {
                lines.push(String::new());
                continue;
            }
            let mut fields: Vec<&str> = if is_header {
                found.iter().map(|column| column.name.as_str()).collect()
            } else {
                line.split(',').collect()
            };
            is_header = false;
            if let Some(at) = time.filter(|at| *at < fields.len()) {
                let first = fields.remove(at);
                fields.insert(0, first);
            }
            lines.push(fields.join(","));
        }
        Ok((found, lines.join("\n")))
    }

    /// What the columns of this header are; all that the model file names must be there.
    fn found_all(&self, header: &[&str], file: &str) -> Result<Vec<Found>, ColumnsError> {
        for (variable, column) in &self.given {
            if !header.contains(&column.column.as_str()) {
                return Err(ColumnsError::Missing {
                    file: file.to_owned(),
                    column: column.column.clone(),
                    variable: variable.clone(),
                    known: header.join(", "),
                });
            }
        }
        header.iter().map(|field| self.found(field, file)).collect()
    }

    /// What the column of this header is.
    fn found(&self, field: &str, file: &str) -> Result<Found, ColumnsError> {
        let (name, in_header) = name_and_unit(field);
        let given = self.given.iter().find(|(_, c)| c.column == field);
        let (variable, unit, own_factor, stated_by) = match given {
            Some((variable, column)) => (
                variable.as_str(),
                column.unit.as_deref().or(in_header),
                column.factor,
                self.file.as_str(),
            ),
            None => {
                let like = variables()
                    .find(|v| v.eq_ignore_ascii_case(name) && !self.given.contains_key(*v));
                let Some(variable) = like else {
                    return Ok(Found {
                        name: field.to_owned(),
                        factor: 1.0,
                        said: None,
                    });
                };
                (variable, in_header, None, file)
            }
        };
        let factor = match (own_factor, unit) {
            (Some(own), _) => own,
            (None, Some(unit)) => factor(stated_by, variable, unit)?,
            (None, None) => 1.0,
        };
        let from = unit.unwrap_or("its unit");
        let said = match (field == variable, factor == 1.0) {
            (true, true) => None,
            (_, true) => (name != variable).then(|| format!("`{field}` taken as {variable}")),
            (_, false) => Some(format!(
                "`{field}` taken as {variable} and converted from {from} to {} (times {})",
                units(variable)[0].0,
                number(factor)
            )),
        };
        Ok(Found {
            name: variable.to_owned(),
            factor,
            said,
        })
    }
}

/// Notes on what was made of files, one for all files of which the same is said.
#[must_use]
pub fn about(said: &[(String, String)]) -> Vec<String> {
    let mut notes: Vec<(&str, Vec<&str>)> = Vec::new();
    for (file, what) in said.iter().filter(|(_, what)| !what.is_empty()) {
        match notes.iter_mut().find(|(other, _)| other == what) {
            Some((_, files)) => files.push(file),
            None => notes.push((what, vec![file])),
        }
    }
    notes
        .into_iter()
        .map(|(what, files)| format!("read from {}: {what}", files.join(", ")))
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn read(model: &str, table: &str) -> (Record, String) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("run-a.csv");
        fs::write(&path, table).unwrap();
        let (columns, rest) = RigColumns::split_off(model, "model.toml").unwrap();
        assert_eq!(rest, "[disc]\ninertia = 1.0\n");
        columns.read(&Part::whole(path)).unwrap()
    }

    #[test]
    fn a_foreign_table_reads_like_our_own() {
        let model = "[disc]\ninertia = 1.0\n[columns]\ntime = { column = \"t\", unit = \"ms\" }\n\
                     N2 = { column = \"load, cell\", unit = \"kN\" }\n\
                     i = { column = \"shunt\", unit = \"mV\", factor = 0.02 }\n"
            .replace("load, cell", "load cell");
        let table = "Theta [deg];t;u;load cell;theta_dot (rpm);shunt\n180,0;0;1;0,5;60;5\n90,0;10;1;0,5;30;5\n";
        let (record, notes) = read(&model, table);
        assert_eq!(record.time(), [0.0, 0.01]);
        let close = |name: &str, wanted: f64| {
            let found = record.column(name).unwrap()[0];
            assert!((found - wanted).abs() < 1e-12, "{name}: {found}");
        };
        close("theta", TAU / 2.0);
        close("theta_dot", TAU);
        close("N2", 500.0);
        close("i", 0.1);
        assert!(notes.contains("semicolons"), "{notes:?}");
        assert!(notes.contains("from deg to rad"), "{notes:?}");
    }

    #[test]
    fn what_cannot_be_a_column_is_refused_with_what_would_be_right() {
        for (model, part) in [
            ("[columns]\nteta = \"a\"\n", "is `theta` meant?"),
            (
                "[columns]\ntheta = { column = \"a\", unit = \"rpm\" }\n",
                "may be rad, deg",
            ),
            ("[columns]\ntheta = 3\n", "unit = \"deg\""),
            (
                "[columns]\ntheta = { column = \"a\", unit = \"V\", factor = 0.0 }\n",
                "other than 0",
            ),
        ] {
            let message = RigColumns::split_off(model, "model.toml")
                .unwrap_err()
                .to_string();
            assert!(message.contains(part), "{message}");
        }
    }
}
