//! What can be wrong with a record.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::files::atomic::WriteError;

/// Why a record could not be read, written or used.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The file could not be read.
    #[error("{path}: cannot be read: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The file is none of the kinds that are read.
    #[error("{file}: {problem}")]
    NoText {
        /// The file.
        file: String,
        /// What it is instead.
        problem: &'static str,
    },
    /// The file cannot be read to its end.
    #[error("{file}: is a damaged {kind}: {reason}; write it anew, or as CSV")]
    Damaged {
        /// The file.
        file: String,
        /// What it is.
        kind: &'static str,
        /// What its reader says.
        reason: String,
    },
    /// The file stands for more than can be held.
    #[error("{file}: is too large, {found}; a record may have {most}")]
    TooLarge {
        /// The file.
        file: String,
        /// What it has.
        found: String,
        /// What it may have.
        most: String,
    },
    /// A column holds something else than numbers.
    #[error("{file}: column `{column}` holds {found}; numbers are needed: {remedy}")]
    NoNumbers {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// What it holds.
        found: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// A sheet is named where there are none.
    #[error("{file}: has no sheets, so none called `{sheet}`; only an Excel workbook (.xlsx) has")]
    NoSheets {
        /// The file.
        file: String,
        /// The sheet.
        sheet: String,
    },
    /// No sheet of a workbook is clearly meant.
    #[error("{file}: {problem}; it has the sheets {sheets}")]
    Sheet {
        /// The file.
        file: String,
        /// What is wrong.
        problem: String,
        /// All sheets.
        sheets: String,
    },
    /// The file has no header.
    #[error("{file}: is empty; a header such as `time,u,N2` is needed")]
    Empty {
        /// The file.
        file: String,
    },
    /// There is a header but no sample.
    #[error("{file}: has a header and no sample below it")]
    NoSamples {
        /// The file.
        file: String,
    },
    /// No column of a CSV file is `time`.
    #[error(
        "{file} line 1: has no column `time` [s], the first column is `{found}`; the others must be named like the FMU's variables, separated by commas"
    )]
    NoTime {
        /// The file.
        file: String,
        /// What stands there.
        found: String,
    },
    /// A column has no name, or two have the same.
    #[error("{file}: column {position} is named `{name}`, {problem}")]
    ColumnName {
        /// The file.
        file: String,
        /// Position, counted from 1.
        position: usize,
        /// The name as it stands there.
        name: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// A line has another number of values than the header.
    #[error("{file} {place}: has {found} values; the header names {expected} columns")]
    FieldCount {
        /// The file.
        file: String,
        /// Its line or row.
        place: String,
        /// Values found.
        found: usize,
        /// Columns in the header.
        expected: usize,
    },
    /// A value is no finite number.
    #[error(
        "{file} {place}, column `{column}`: `{found}` {problem}; a finite number such as 1.25e-3 is needed"
    )]
    Value {
        /// The file.
        file: String,
        /// Its line or row.
        place: String,
        /// Column name.
        column: String,
        /// The value as it stands there.
        found: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// Time stands still or runs backward.
    #[error(
        "{file} {place}, column `time`: {found} s comes after {before} s; times must increase from line to line"
    )]
    TimeOrder {
        /// The file.
        file: String,
        /// Its line or row.
        place: String,
        /// The time on that line [s].
        found: f64,
        /// The time on the line before [s].
        before: f64,
    },
    /// A column that is needed is not there.
    #[error("{file}: has no column `{name}`; it has {available}")]
    MissingColumn {
        /// The file.
        file: String,
        /// The column that is needed.
        name: String,
        /// The columns it has.
        available: String,
    },
    /// A series has another length than the time column.
    #[error("{file}: column `{name}` has {found} values, `time` has {expected}")]
    Length {
        /// The file or what stands for it.
        file: String,
        /// The column.
        name: String,
        /// Its number of values.
        found: usize,
        /// Number of times.
        expected: usize,
    },
}
