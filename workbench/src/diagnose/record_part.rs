//! Files to learn from or to judge on, whole or in part.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// A file with the part of it that is meant.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The file.
    pub path: PathBuf,
    /// From and to [s], in the file's own time; `None` for all of it.
    pub span: Option<(f64, f64)>,
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
        Self { path, span: None }
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
            }),
            _ => Err(PartError {
                text: text.to_string(),
                file: file.to_owned(),
            }),
        }
    }
}
