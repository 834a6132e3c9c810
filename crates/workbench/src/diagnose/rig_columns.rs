//! Which column of a record is which variable of the rig, in which unit: as `[columns]` of the model file says, or as the
//! header itself does.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use thiserror::Error;

use super::console::number;
use super::record_part::Part;
use super::rig_variable::{TIME, units, variables};
use crate::component::closest;
use crate::files::record::{Dialect, Missing, Record, RecordError, Table};

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
        let path = part.path.display().to_string();
        let file = match part.span {
            Some((from, to)) => format!("{path}@{from}:{to}"),
            None => path,
        };
        let table = match &part.table {
            // A table's time stands apart from its columns, and has the name that is asked for.
            Some(table) => {
                let time = self.given.get(TIME).map_or(TIME, |given| &given.column);
                Table::of_record(table, time)
            }
            None => Table::open(&part.path, &file, Dialect::Any)?,
        };
        let mut said = table.said().to_vec();
        let columns = self.found_all(table.names(), &file)?;
        let names: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
        let mut record = table.record(&names, Missing::KeepAsNan)?;
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
        let table = Table::open(path, &file, Dialect::Any)?;
        let fields = table.names().iter();
        Ok(fields
            .map(|field| {
                let found = self.found(field, &file).ok();
                let variable = found.and_then(|found| variables().find(|own| *own == found.name));
                (field.clone(), variable)
            })
            .collect())
    }

    /// What the columns of this header are; all that the model file names must be there.
    fn found_all(&self, header: &[String], file: &str) -> Result<Vec<Found>, ColumnsError> {
        for (variable, column) in &self.given {
            if !header.contains(&column.column) {
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
        std::fs::write(&path, table).unwrap();
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
    fn parquet_and_excel_read_as_csv_does() {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
        let read = |file: &str| {
            let part = Part::parse(&data.join(file)).unwrap();
            let (record, said) = RigColumns::default().read(&part).unwrap();
            let columns = record
                .names()
                .map(|name| record.column(name).unwrap().to_vec());
            (record.time().to_vec(), columns.collect::<Vec<_>>(), said)
        };
        for span in ["", "@2:6"] {
            let (time, columns, _) = read(&format!("unbalance/run-a.csv{span}"));
            for (file, wanted) in [
                ("tables/run-a.parquet", ""),
                ("tables/run-a.xlsx", "sheet `bench`"),
                ("tables/run-a.xlsx#bench", ""),
            ] {
                let found = read(&format!("{file}{span}"));
                assert_eq!(
                    found,
                    (time.clone(), columns.clone(), wanted.to_owned()),
                    "{file}{span}"
                );
            }
        }
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
