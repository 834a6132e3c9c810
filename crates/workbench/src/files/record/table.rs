//! A file as a table: named columns, before anybody has said which is which variable.

use std::fs;
use std::path::{Path, PathBuf};

use super::dialect::{decode, with_commas};
use super::error::RecordError;
use super::{Missing, Record, columnar, workbook};

/// How the names of files end that may be records.
pub const ENDINGS: [&str; 3] = ["csv", "parquet", "xlsx"];

/// What the column of times is called in a record.
const TIME: &str = "time";
/// What a row of a CSV file is called.
pub(super) const LINE: &str = "line";
/// The line below a header in the first one.
pub(super) const BELOW_HEADER: usize = 2;
const NOT_FINITE: &str = "is not finite";
/// Most values of a Parquet file or a workbook: a few compressed bytes may stand for any number of them.
pub(super) const MOST_VALUES: usize = 50_000_000;

/// Which CSV is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    /// UTF-8 with commas between values and decimal points.
    Own,
    /// What spreadsheets write, too; [`Table::said`] says so.
    Any,
}

/// A table of a file or of memory.
#[derive(Debug)]
pub struct Table {
    source: String,
    names: Vec<String>,
    said: Vec<String>,
    body: Body,
}

#[derive(Debug)]
enum Body {
    /// Lines with commas, the header among them.
    Text(String),
    /// A column for each name.
    Numbers(Vec<Vec<f64>>, Places),
}

/// Where the rows of a table stand in its file, for messages.
#[derive(Debug)]
pub(super) struct Places {
    /// What a row is called, such as `line`.
    pub word: &'static str,
    /// Number of the first row.
    pub first: usize,
    /// Numbers of all rows, where they do not follow one another.
    pub rows: Vec<usize>,
}

impl Places {
    /// Rows that follow one another, the first of them with this number.
    pub(super) fn from(word: &'static str, first: usize) -> Self {
        let rows = Vec::new();
        Self { word, first, rows }
    }

    pub(super) fn of(&self, row: usize) -> String {
        let number = self.rows.get(row).copied();
        format!("{} {}", self.word, number.unwrap_or(self.first + row))
    }
}

/// The file that a path means and the sheet of it that stands behind a `#`.
#[must_use]
pub fn file_and_sheet(path: &Path) -> (PathBuf, Option<String>) {
    let text = path.to_string_lossy();
    let split = text
        .match_indices('#')
        .map(|(at, _)| (PathBuf::from(&text[..at]), text[at + 1..].to_owned()))
        .find(|(file, _)| !path.exists() && file.is_file());
    match split {
        Some((file, sheet)) => (file, Some(sheet)),
        None => (path.to_owned(), None),
    }
}

impl Table {
    /// Opens a file, CSV, Parquet or Excel by what it has inside; `source` names it in messages. `FILE#SHEET` means a sheet of
    /// a workbook.
    ///
    /// # Errors
    /// [`RecordError`] where it cannot be read or is no table.
    pub fn open(path: &Path, source: &str, dialect: Dialect) -> Result<Self, RecordError> {
        let (file, sheet) = file_and_sheet(path);
        let bytes = fs::read(&file).map_err(|source| RecordError::Read { path: file, source })?;
        Self::of_bytes(bytes, source, sheet.as_deref(), dialect)
    }

    /// The same of a file's content.
    ///
    /// # Errors
    /// As for [`Self::open`].
    pub fn of_bytes(
        bytes: Vec<u8>,
        source: &str,
        sheet: Option<&str>,
        dialect: Dialect,
    ) -> Result<Self, RecordError> {
        let is_workbook = workbook::is_one(&bytes);
        if let Some(sheet) = sheet.filter(|_| !is_workbook) {
            return Err(RecordError::NoSheets {
                file: source.to_owned(),
                sheet: sheet.to_owned(),
            });
        }
        if is_workbook {
            return workbook::table(bytes, source, sheet);
        }
        if columnar::is_one(&bytes) {
            return columnar::table(bytes, source);
        }
        let (text, is_wide) = decode(&bytes).map_err(|problem| RecordError::NoText {
            file: source.to_owned(),
            problem,
        })?;
        let (text, found) = match dialect {
            Dialect::Own => (text.as_str().into(), Vec::new()),
            Dialect::Any => with_commas(&text),
        };
        let mut table = Self::parse(text.into_owned(), source);
        table.said.extend(is_wide.then(|| "UTF-16".to_owned()));
        table
            .said
            .extend((!found.is_empty()).then(|| found.join(" and ")));
        Ok(table)
    }

    /// The table in the text of a CSV file.
    #[must_use]
    pub fn parse(mut text: String, source: &str) -> Self {
        if text.starts_with('\u{feff}') {
            text.remove(0);
        }
        let header = text.lines().find(|line| !line.trim().is_empty());
        let names = header.map(|line| {
            let fields = line.split(',');
            fields
                .map(|field| field.trim().trim_matches('"').trim().to_owned())
                .collect()
        });
        Self {
            source: source.to_owned(),
            names: names.unwrap_or_default(),
            said: Vec::new(),
            body: Body::Text(text),
        }
    }

    /// A record as a table, with its time under the name `time`.
    #[must_use]
    pub fn of_record(record: &Record, time: &str) -> Self {
        let columns = record.columns.iter();
        let names = columns.clone().map(|column| column.name.clone());
        let values = columns.map(|column| column.values.clone());
        Self {
            source: record.source.clone(),
            names: std::iter::once(time.to_owned()).chain(names).collect(),
            said: Vec::new(),
            body: Body::Numbers(
                std::iter::once(record.time.clone()).chain(values).collect(),
                Places::from(LINE, BELOW_HEADER),
            ),
        }
    }

    /// A table of numbers.
    pub(super) fn of_numbers(
        source: &str,
        columns: Vec<(String, Vec<f64>)>,
        places: Places,
        said: Vec<String>,
    ) -> Self {
        let (names, columns) = columns.into_iter().unzip();
        Self {
            source: source.to_owned(),
            names,
            said,
            body: Body::Numbers(columns, places),
        }
    }

    /// Names of the columns, as they stand there.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// What was made of the file, in words.
    #[must_use]
    pub fn said(&self) -> &[String] {
        &self.said
    }

    /// The columns with these names, in their order.
    ///
    /// # Errors
    /// One is not there, or a value is missing or no number.
    pub fn series<const N: usize>(self, wanted: [&str; N]) -> Result<[Vec<f64>; N], RecordError> {
        if self.names.is_empty() {
            return Err(RecordError::Empty { file: self.source });
        }
        let mut at = [0; N];
        for (at, name) in at.iter_mut().zip(wanted) {
            let found = self.names.iter().position(|own| own == name);
            *at = found.ok_or_else(|| self.missing(name))?;
        }
        let read = self
            .body
            .columns(&self.source, &self.names, &at, Missing::Refuse);
        let mut columns = read?.0.into_iter();
        Ok(at.map(|_| columns.next().unwrap_or_default()))
    }

    /// The record, its columns called by `names`, of which one is `time` [s].
    ///
    /// # Errors
    /// A name or a value that no record can have.
    pub fn record(self, names: &[String], missing: Missing) -> Result<Record, RecordError> {
        let Some(first) = names.first() else {
            return Err(RecordError::Empty { file: self.source });
        };
        let Some(time) = names.iter().position(|name| name == TIME) else {
            return Err(match self.body {
                Body::Text(_) => RecordError::NoTime {
                    found: first.clone(),
                    file: self.source,
                },
                Body::Numbers(..) => self.missing(TIME),
            });
        };
        // Names first: what is wrong with them explains what is wrong below them.
        let mut record = Record::new(self.source.as_str(), Vec::new())?;
        let mut wanted: Vec<usize> = (0..names.len()).filter(|at| *at != time).collect();
        for at in &wanted {
            record.add_column(names[*at].as_str(), Vec::new())?;
        }
        wanted.insert(0, time);
        let (columns, places) = self.body.columns(&self.source, names, &wanted, missing)?;
        let mut columns = columns.into_iter();
        record.time = columns.next().unwrap_or_default();
        if record.is_empty() {
            return Err(RecordError::NoSamples { file: self.source });
        }
        check_times(&self.source, &record.time, &places)?;
        for (column, values) in record.columns.iter_mut().zip(columns) {
            column.values = values;
        }
        Ok(record)
    }

    fn missing(&self, name: &str) -> RecordError {
        RecordError::MissingColumn {
            file: self.source.clone(),
            name: name.to_owned(),
            available: self.names.join(", "),
        }
    }
}

impl Body {
    /// The values of the wanted columns, and where the rows stand.
    fn columns(
        self,
        file: &str,
        names: &[String],
        wanted: &[usize],
        missing: Missing,
    ) -> Result<(Vec<Vec<f64>>, Places), RecordError> {
        let wrong = |place: String, column: usize, found: &str, problem| RecordError::Value {
            file: file.to_owned(),
            place,
            column: names[column].clone(),
            found: found.to_owned(),
            problem,
        };
        let text = match self {
            Self::Text(text) => text,
            Self::Numbers(mut columns, places) => {
                let is_wrong = |value: &f64| {
                    value.is_infinite() || value.is_nan() && missing == Missing::Refuse
                };
                let mut found = Vec::new();
                for &at in wanted {
                    let values = std::mem::take(&mut columns[at]);
                    if let Some(row) = values.iter().position(is_wrong) {
                        let value = values[row].to_string();
                        return Err(wrong(places.of(row), at, &value, NOT_FINITE));
                    }
                    found.push(values);
                }
                return Ok((found, places));
            }
        };
        let mut lines = text
            .lines()
            .enumerate()
            .filter(|(_, line)| !line.trim().is_empty());
        lines.next();
        let mut places = Places::from(LINE, BELOW_HEADER);
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); wanted.len()];
        let mut fields = Vec::new();
        for (index, line) in lines {
            let place = || format!("{LINE} {}", index + 1);
            places.rows.push(index + 1);
            fields.clear();
            fields.extend(line.split(',').map(str::trim));
            if fields.len() != names.len() {
                return Err(RecordError::FieldCount {
                    file: file.to_owned(),
                    place: place(),
                    found: fields.len(),
                    expected: names.len(),
                });
            }
            for (values, &at) in columns.iter_mut().zip(wanted) {
                let value = parse_value(fields[at], missing);
                values.push(value.map_err(|problem| wrong(place(), at, fields[at], problem))?);
            }
        }
        Ok((columns, places))
    }
}

pub(super) fn check_times(file: &str, time: &[f64], places: &Places) -> Result<(), RecordError> {
    for (row, &value) in time.iter().enumerate() {
        // A sample without its time has no place in the record, whatever is done about other missing values.
        if !value.is_finite() {
            return Err(RecordError::Value {
                file: file.to_owned(),
                place: places.of(row),
                column: TIME.to_owned(),
                found: value.to_string(),
                problem: NOT_FINITE,
            });
        }
        if row > 0 && value <= time[row - 1] {
            return Err(RecordError::TimeOrder {
                file: file.to_owned(),
                place: places.of(row),
                found: value,
                before: time[row - 1],
            });
        }
    }
    Ok(())
}

fn parse_value(field: &str, missing: Missing) -> Result<f64, &'static str> {
    if field.is_empty() {
        return match missing {
            Missing::Refuse => Err("is empty"),
            Missing::KeepAsNan => Ok(f64::NAN),
        };
    }
    match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(value) if value.is_nan() && missing == Missing::KeepAsNan => Ok(f64::NAN),
        Ok(_) => Err(NOT_FINITE),
        Err(_) => Err("is not a number"),
    }
}
