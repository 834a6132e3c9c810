//! Files that keep what long work has finished, so that it goes on where it was interrupted or killed.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use thiserror::Error;

/// Why a journal cannot be used.
#[derive(Debug, Error)]
pub enum JournalError {
    /// The file could not be read or written.
    #[error("{path}: cannot {step}: {source}")]
    Io {
        /// The journal.
        path: PathBuf,
        /// What was being done.
        step: &'static str,
        /// The operating system's reason.
        source: io::Error,
    },
    /// It belongs to other work.
    #[error(
        "{path}: belongs to {other}; finish that one, remove the file or name another directory"
    )]
    Foreign {
        /// The journal.
        path: PathBuf,
        /// What it may belong to.
        other: &'static str,
    },
}

/// A file to which finished pieces are appended, each in one write, below a line that says which work they are of.
#[derive(Debug)]
pub struct JournalFile {
    path: PathBuf,
    file: Mutex<File>,
}

impl JournalFile {
    /// Opens the journal of the work with this identity, or begins it. `read` makes of its body the finished pieces and
    /// the length of the part that holds them; what follows that, a piece that was cut off, is cut away, and no finished
    /// piece is written anew, so that none is lost if this is killed. `other` says what a journal with another identity
    /// belongs to.
    ///
    /// # Errors
    /// [`JournalError`] where the file belongs to other work or cannot be used.
    pub fn open<T: Default>(
        path: &Path,
        identity: &str,
        other: &'static str,
        read: impl FnOnce(&str) -> (usize, T),
    ) -> Result<(Self, T), JournalError> {
        let failed = |step| {
            move |source| JournalError::Io {
                path: path.to_owned(),
                step,
                source,
            }
        };
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(failed("make its directory"))?;
        }
        let head = format!("{identity:?}\n");
        let text = match fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(failed("be read")(error)),
        };
        let (sound, pieces) = match text.strip_prefix(head.as_str()) {
            Some(body) => {
                let (length, pieces) = read(body);
                (head.len() + length, pieces)
            }
            // A head that was cut off in the middle holds nothing.
            None if head.starts_with(&text) => (0, T::default()),
            None => {
                return Err(JournalError::Foreign {
                    path: path.to_owned(),
                    other,
                });
            }
        };
        let mut file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(path)
            .map_err(failed("be opened to write"))?;
        file.set_len(sound as u64)
            .map_err(failed("be cut to what is finished"))?;
        if sound == 0 {
            file.write_all(head.as_bytes())
                .map_err(failed("be written"))?;
        }
        let journal = Self {
            path: path.to_owned(),
            file: Mutex::new(file),
        };
        Ok((journal, pieces))
    }

    /// Appends finished pieces.
    ///
    /// # Errors
    /// [`JournalError::Io`] where the file cannot be written.
    pub fn append(&self, pieces: &str) -> Result<(), JournalError> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(pieces.as_bytes())
            .map_err(|source| JournalError::Io {
                path: self.path.clone(),
                step: "be written",
                source,
            })
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes it: the work is done.
    ///
    /// # Errors
    /// [`JournalError::Io`] where the file cannot be removed.
    pub fn remove(self) -> Result<(), JournalError> {
        fs::remove_file(&self.path).map_err(|source| JournalError::Io {
            path: self.path,
            step: "be removed",
            source,
        })
    }
}
