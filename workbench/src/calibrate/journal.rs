//! The judgements of a search, in order, so that an interrupted one can be continued.
//!
//! The search is the same for the same seed and the same costs. Its costs are therefore all that needs keeping: a search
//! that is begun again takes the kept ones instead of running, and so arrives where it was.

use std::collections::VecDeque;
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

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
    /// It belongs to another model or target.
    #[error(
        "{path}: belongs to another model or target; finish that search, remove the file or name another directory"
    )]
    Other {
        /// The journal.
        path: PathBuf,
    },
}

/// The costs judged so far.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    kept: VecDeque<f64>,
    /// A search that leaves no trace, for tests and for callers that do not need one.
    in_memory: bool,
}

impl Journal {
    /// Opens the journal of the search with this identity, or begins it.
    ///
    /// # Errors
    /// [`JournalError`] where the file belongs to another search or cannot be used.
    pub fn open(path: &Path, identity: &str) -> Result<Self, JournalError> {
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
        let (kept, sound) = match text.strip_prefix(head.as_str()) {
            Some(body) => {
                let (costs, length) = read_costs(body);
                (costs, head.len() + length)
            }
            // A head that was cut off holds nothing.
            None if head.starts_with(&text) => (VecDeque::new(), 0),
            None => {
                return Err(JournalError::Other {
                    path: path.to_owned(),
                });
            }
        };
        let mut file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(path)
            .map_err(failed("be opened to write"))?;
        // What a cut-off last line left behind must not run into the next one; no whole line is written anew, so that
        // none is lost if this is killed.
        file.set_len(sound as u64)
            .map_err(failed("be cut to its whole lines"))?;
        if sound == 0 {
            file.write_all(head.as_bytes())
                .map_err(failed("be written"))?;
        }
        Ok(Self {
            path: path.to_owned(),
            kept,
            in_memory: false,
        })
    }

    /// A journal that is not kept.
    #[must_use]
    pub fn none() -> Self {
        Self {
            path: PathBuf::new(),
            kept: VecDeque::new(),
            in_memory: true,
        }
    }

    /// Costs kept from before that are not taken yet.
    #[must_use]
    pub fn kept(&self) -> usize {
        self.kept.len()
    }

    /// The next `count` kept costs, if there are as many.
    pub fn take(&mut self, count: usize) -> Option<Vec<f64>> {
        if self.kept.len() < count {
            self.kept.clear();
            return None;
        }
        Some(self.kept.drain(..count).collect())
    }

    /// Appends costs that were judged now.
    ///
    /// # Errors
    /// [`JournalError::Io`] where the file cannot be written.
    pub fn append(&self, costs: &[f64]) -> Result<(), JournalError> {
        if self.in_memory {
            return Ok(());
        }
        let lines: String = costs
            .iter()
            .map(|cost| format!("{:016x}\n", cost.to_bits()))
            .collect();
        OpenOptions::new()
            .append(true)
            .open(&self.path)
            .and_then(|mut file| file.write_all(lines.as_bytes()))
            .map_err(|source| JournalError::Io {
                path: self.path.clone(),
                step: "be written",
                source,
            })
    }

    /// Removes the file; the search is done.
    ///
    /// # Errors
    /// [`JournalError::Io`] where it cannot be removed.
    pub fn remove(self) -> Result<(), JournalError> {
        if self.in_memory {
            return Ok(());
        }
        fs::remove_file(&self.path).map_err(|source| JournalError::Io {
            path: self.path.clone(),
            step: "be removed",
            source,
        })
    }
}

/// The costs of all whole lines, and the length of these lines.
fn read_costs(body: &str) -> (VecDeque<f64>, usize) {
    let mut costs = VecDeque::new();
    let mut sound = 0;
    for line in body.split_inclusive('\n') {
        let Some(bits) = line
            .strip_suffix('\n')
            .filter(|digits| digits.len() == 16)
            .and_then(|digits| u64::from_str_radix(digits, 16).ok())
        else {
            break;
        };
        costs.push_back(f64::from_bits(bits));
        sound += line.len();
    }
    (costs, sound)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_come_back_and_a_cut_off_line_is_dropped() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.journal");
        let journal = Journal::open(&path, "mine").unwrap();
        journal.append(&[0.1, f64::INFINITY, 0.0]).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, &text[..text.len() - 5]).unwrap();
        let mut again = Journal::open(&path, "mine").unwrap();
        assert_eq!(again.take(2).unwrap(), [0.1, f64::INFINITY]);
        assert!(again.take(1).is_none());
        again.append(&[7.0]).unwrap();
        let mut third = Journal::open(&path, "mine").unwrap();
        assert_eq!(third.take(3).unwrap(), [0.1, f64::INFINITY, 7.0]);
        let other = Journal::open(&path, "yours").unwrap_err();
        assert!(other.to_string().contains("another model or target"));
    }
}
