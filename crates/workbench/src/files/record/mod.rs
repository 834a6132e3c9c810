//! Records: tables whose columns are FMU variables, with `time`, in SI units; from CSV, Parquet and Excel.

use std::fmt::Write as _;
use std::path::Path;

use super::atomic;

mod columnar;
mod dialect;
mod error;
mod table;
mod workbook;

pub use error::RecordError;
use table::{BELOW_HEADER, LINE, Places, check_times};
pub use table::{Dialect, ENDINGS, Table, file_and_sheet};
pub use workbook::sheets;

/// A record: sample times and one series of equal length per named variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Where it came from, for messages.
    source: String,
    time: Vec<f64>,
    columns: Vec<Column>,
}

#[derive(Debug, Clone, PartialEq)]
struct Column {
    name: String,
    values: Vec<f64>,
}

/// What to do with a value that is empty or `NaN`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Missing {
    /// Refuse the record and say where it is.
    Refuse,
    /// Keep it as NaN; [`Record::missing`] lists such places.
    KeepAsNan,
}

/// A hole in the sampling: a step longer than one and a half times the median step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Index of the sample before the hole.
    pub after: usize,
    /// Time of that sample [s].
    pub time: f64,
    /// Length of the step over the hole [s].
    pub step: f64,
}

impl Record {
    /// A record without columns yet; `source` names it in messages.
    ///
    /// # Errors
    /// [`RecordError::TimeOrder`] or [`RecordError::Value`] where the times [s] do not increase or are not finite.
    pub fn new(source: impl Into<String>, time: Vec<f64>) -> Result<Self, RecordError> {
        let source = source.into();
        check_times(&source, &time, &Places::from(LINE, BELOW_HEADER))?;
        Ok(Self {
            source,
            time,
            columns: Vec::new(),
        })
    }

    /// Adds a column.
    ///
    /// # Errors
    /// Where its length differs from that of the time column, or its name is taken.
    pub fn add_column(
        &mut self,
        name: impl Into<String>,
        values: Vec<f64>,
    ) -> Result<(), RecordError> {
        let name = name.into();
        if values.len() != self.time.len() {
            return Err(RecordError::Length {
                file: self.source.clone(),
                name,
                found: values.len(),
                expected: self.time.len(),
            });
        }
        let position = self.columns.len() + 2;
        if let Some(problem) = name_problem(&name, self.names()) {
            return Err(RecordError::ColumnName {
                file: self.source.clone(),
                position,
                name,
                problem,
            });
        }
        self.columns.push(Column { name, values });
        Ok(())
    }

    /// Reads a record, refusing values that are missing or not finite.
    ///
    /// # Errors
    /// [`RecordError`], naming file, line, column, what stands there and what is right.
    pub fn read(path: &Path) -> Result<Self, RecordError> {
        Self::read_with(path, Missing::Refuse)
    }

    /// Reads a record with a choice of what to do about missing values.
    ///
    /// # Errors
    /// As for [`Record::read`].
    pub fn read_with(path: &Path, missing: Missing) -> Result<Self, RecordError> {
        // Callers say nothing of what was made of the file, so nothing is made of CSV.
        let table = Table::open(path, &path.display().to_string(), Dialect::Own)?;
        let names = table.names().to_vec();
        table.record(&names, missing)
    }

    /// Reads a record from the text of a CSV file; `file` names it in messages.
    ///
    /// # Errors
    /// As for [`Record::read`].
    pub fn parse(text: &str, file: &str, missing: Missing) -> Result<Self, RecordError> {
        let table = Table::parse(text.to_owned(), file);
        let names = table.names().to_vec();
        table.record(&names, missing)
    }

    /// The record as CSV; reading it back gives the same numbers bit for bit.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut text = String::with_capacity((self.columns.len() + 1) * (self.time.len() + 1) * 12);
        text.push_str("time");
        for column in &self.columns {
            text.push(',');
            text.push_str(&column.name);
        }
        text.push('\n');
        for (row, time) in self.time.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(text, "{time:?}");
            for column in &self.columns {
                let _ = write!(text, ",{:?}", column.values[row]);
            }
            text.push('\n');
        }
        text
    }

    /// Writes the record whole or not at all.
    ///
    /// # Errors
    /// [`RecordError::Write`] where the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), RecordError> {
        Ok(atomic::write_file(path, self.to_csv().as_bytes())?)
    }

    /// What messages call this record: its file.
    #[must_use]
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Sample times [s], increasing.
    #[must_use]
    pub fn time(&self) -> &[f64] {
        &self.time
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Names of the columns after `time`, in their order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|column| column.name.as_str())
    }

    /// The series of a column, if there is one of that name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns
            .iter()
            .find(|column| column.name == name)
            .map(|column| column.values.as_slice())
    }

    /// The series of a column that is needed.
    ///
    /// # Errors
    /// [`RecordError::MissingColumn`], listing the columns there are.
    pub fn require(&self, name: &str) -> Result<&[f64], RecordError> {
        self.column(name).ok_or_else(|| RecordError::MissingColumn {
            file: self.source.clone(),
            name: name.to_owned(),
            available: std::iter::once("time")
                .chain(self.names())
                .collect::<Vec<_>>()
                .join(", "),
        })
    }

    /// Multiplies a column, or `time`, by a positive or negative factor; a column that is not there stays so.
    pub(crate) fn convert(&mut self, name: &str, factor: f64) {
        let values = if name == "time" {
            Some(&mut self.time)
        } else {
            let own = self.columns.iter_mut().find(|column| column.name == name);
            own.map(|column| &mut column.values)
        };
        for value in values.into_iter().flatten() {
            *value *= factor;
        }
    }

    /// Median of the sampling steps [s]; NaN with fewer than two samples.
    #[must_use]
    pub fn median_step(&self) -> f64 {
        let mut steps: Vec<f64> = self.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or(f64::NAN)
    }

    /// The holes in the sampling, in order of time.
    #[must_use]
    pub fn gaps(&self) -> Vec<Gap> {
        let longest = 1.5 * self.median_step();
        self.time
            .windows(2)
            .enumerate()
            .filter(|(_, pair)| pair[1] - pair[0] > longest)
            .map(|(after, pair)| Gap {
                after,
                time: pair[0],
                step: pair[1] - pair[0],
            })
            .collect()
    }

    /// Places of missing values as (column name, sample index).
    #[must_use]
    pub fn missing(&self) -> Vec<(&str, usize)> {
        self.columns
            .iter()
            .flat_map(|column| {
                let name = column.name.as_str();
                column
                    .values
                    .iter()
                    .enumerate()
                    .filter(|(_, value)| !value.is_finite())
                    .map(move |(row, _)| (name, row))
            })
            .collect()
    }

    /// The samples in which none of these columns lacks its value.
    #[must_use]
    pub fn without_missing(&self, names: &[&str]) -> Self {
        let wanted: Vec<&[f64]> = names.iter().filter_map(|name| self.column(name)).collect();
        let is_whole = |row: &usize| wanted.iter().all(|values| values[*row].is_finite());
        let rows: Vec<usize> = (0..self.len()).filter(is_whole).collect();
        let of = |values: &[f64]| rows.iter().map(|row| values[*row]).collect();
        Self {
            source: self.source.clone(),
            time: of(&self.time),
            columns: self
                .columns
                .iter()
                .map(|column| Column {
                    name: column.name.clone(),
                    values: of(&column.values),
                })
                .collect(),
        }
    }

    /// The samples with `from` ≤ time < `to` [s].
    #[must_use]
    pub fn window(&self, from: f64, to: f64) -> Self {
        let start = self.time.partition_point(|&time| time < from);
        let end = self.time.partition_point(|&time| time < to).max(start);
        Self {
            source: self.source.clone(),
            time: self.time[start..end].to_vec(),
            columns: self
                .columns
                .iter()
                .map(|column| Column {
                    name: column.name.clone(),
                    values: column.values[start..end].to_vec(),
                })
                .collect(),
        }
    }
}

fn name_problem<'a>(name: &str, mut others: impl Iterator<Item = &'a str>) -> Option<&'static str> {
    if name.is_empty() {
        Some("which is empty; name a variable of the FMU")
    } else if name == "time" || others.any(|other| other == name) {
        Some("which an earlier column is named already")
    } else if name.contains([',', '"', '\n', '\r']) {
        Some("which contains a comma, a quote or a line break")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        Record::parse(text, "run.csv", Missing::Refuse)
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn a_record_survives_being_written_and_read() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("run.csv");
        let mut record = Record::new(path.display().to_string(), vec![0.0, 0.1, 0.2]).unwrap();
        record
            .add_column("theta", vec![1.0 / 3.0, -1e-300, 6.02e23])
            .unwrap();
        record.add_column("contact.mu_s", vec![0.2; 3]).unwrap();
        record.write(&path).unwrap();
        assert_eq!(Record::read(&path).unwrap(), record);
    }

    #[test]
    fn marks_of_other_programs_are_read() {
        let record = Record::parse(
            "\u{feff}\"time\",\"u\"\r\n0, 1\r\n\r\n1, 2\r\n",
            "run.csv",
            Missing::Refuse,
        )
        .unwrap();
        assert_eq!(record.time(), [0.0, 1.0]);
        assert_eq!(record.column("u"), Some([1.0, 2.0].as_slice()));
    }

    #[test]
    fn messages_name_file_line_column_and_value() {
        assert_eq!(
            refused("time,u\n0,1\n1,abc\n"),
            "run.csv line 3, column `u`: `abc` is not a number; a finite number such as 1.25e-3 is needed"
        );
        assert!(refused("time,u\n0,NaN\n").contains("line 2, column `u`: `NaN` is not finite"));
        assert!(refused("time,u\n0,\n").contains("`` is empty"));
        assert!(
            refused("time,u\n0,1\n0,1\n").contains("line 3, column `time`: 0 s comes after 0 s")
        );
        assert!(
            refused("time,u\n0,1,2\n").contains("line 2: has 3 values; the header names 2 columns")
        );
        assert!(refused("time;u\n0;1\n").contains("the first column is `time;u`"));
        assert!(refused("time,u,u\n0,1,2\n").contains("column 3 is named `u`"));
        assert!(refused("time,,u\n0,1,2\n").contains("column 2 is named ``, which is empty"));
        assert!(refused("").contains("is empty"));
        assert!(refused("time,u\n").contains("no sample"));
    }

    #[test]
    fn a_missing_column_is_answered_with_those_there_are() {
        let record = Record::parse("time,u\n0,1\n", "run.csv", Missing::Refuse).unwrap();
        assert_eq!(
            record.require("N2").unwrap_err().to_string(),
            "run.csv: has no column `N2`; it has time, u"
        );
    }

    #[test]
    fn missing_values_are_kept_and_listed_on_request() {
        let record =
            Record::parse("time,u,N2\n0,1,\n1,nan,2\n", "run.csv", Missing::KeepAsNan).unwrap();
        assert_eq!(record.missing(), [("u", 1), ("N2", 0)]);
        let timeless = Record::parse("time,u\n,1\n", "run.csv", Missing::KeepAsNan);
        assert!(matches!(timeless, Err(RecordError::Value { .. })));
    }

    #[test]
    fn gaps_and_windows() {
        let record = Record::new("memory", vec![0.0, 0.1, 0.2, 0.6, 0.7]).unwrap();
        let gaps = record.gaps();
        assert_eq!(gaps.len(), 1);
        assert_eq!(gaps[0].after, 2);
        assert!((gaps[0].step - 0.4).abs() < 1e-12);
        assert_eq!(record.window(0.1, 0.6).time(), [0.1, 0.2]);
        assert!(record.window(5.0, 1.0).is_empty());
    }

    #[test]
    fn series_of_another_length_are_refused() {
        let mut record = Record::new("memory", vec![0.0, 1.0]).unwrap();
        assert!(matches!(
            record.add_column("u", vec![1.0]),
            Err(RecordError::Length {
                found: 1,
                expected: 2,
                ..
            })
        ));
        assert!(matches!(
            Record::new("memory", vec![0.0, 0.0]),
            Err(RecordError::TimeOrder { .. })
        ));
    }
}
