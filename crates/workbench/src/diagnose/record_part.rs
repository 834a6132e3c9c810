//! Records to learn from or to judge on: files, whole or in part, and tables in memory.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use thiserror::Error;

use crate::files::record::Record;

/// A file with the part of it that is meant, or a table in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The file, or what messages call the table.
    pub path: PathBuf,
    /// From and to [s], in the file's own time; `None` for all of it.
    pub span: Option<(f64, f64)>,
    /// The table, read instead of the file, with the columns' own names and units.
    pub table: Option<Arc<Record>>,
}

/// What stands after the @ is no span of time.
#[derive(Debug, Error, PartialEq)]
#[error("{text}: what stands after @ must be FROM:TO in seconds, such as {file}@31:40")]
pub struct PartError {
    text: String,
    file: String,
}

impl Part {
    /// All of a file.
    #[must_use]
    pub fn whole(path: PathBuf) -> Self {
        Self {
            path,
            span: None,
            table: None,
        }
    }

    /// All of a table that messages call by its source.
    #[must_use]
    pub fn of_table(table: Record) -> Self {
        Self {
            path: PathBuf::from(table.source()),
            span: None,
            table: Some(Arc::new(table)),
        }
    }

    /// `FILE` or `FILE@FROM:TO` with times in seconds.
    ///
    /// # Errors
    /// [`PartError`] where there is no such file and what stands after its last @ is no span.
    pub fn parse(path: &Path) -> Result<Self, PartError> {
        let text = path.to_string_lossy();
        let Some((file, span)) = text.rsplit_once('@').filter(|_| !path.exists()) else {
            return Ok(Self::whole(path.to_owned()));
        };
        let ends: Option<(f64, f64)> = span
            .split_once(':')
            .and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
        match ends {
            Some((from, to)) if from < to => Ok(Self {
                path: PathBuf::from(file),
                span: Some((from, to)),
                table: None,
            }),
            _ => Err(PartError {
                text: text.to_string(),
                file: file.to_owned(),
            }),
        }
    }
}
