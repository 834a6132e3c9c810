//! The judgements of a search, in order, so that an interrupted one can be continued.
//!
//! The search is the same for the same seed and the same costs. Its costs are therefore all that needs keeping: a search
//! that is begun again takes the kept ones instead of running, and so arrives where it was.

use std::collections::VecDeque;
use std::path::Path;

use crate::files::journal::{JournalError, JournalFile};

/// The costs judged so far.
#[derive(Debug)]
pub struct Journal {
    /// `None` for a search that leaves no trace, for tests and for callers that do not need one.
    file: Option<JournalFile>,
    kept: VecDeque<f64>,
}

impl Journal {
    /// Opens the journal of the search with this identity, or begins it.
    ///
    /// # Errors
    /// [`JournalError`] where the file belongs to another search or cannot be used.
    pub fn open(path: &Path, identity: &str) -> Result<Self, JournalError> {
        let other = "another model or target";
        let (file, kept) = JournalFile::open(path, identity, other, read_costs)?;
        Ok(Self {
            file: Some(file),
            kept,
        })
    }

    /// A journal that is not kept.
    #[must_use]
    pub fn none() -> Self {
        Self {
            file: None,
            kept: VecDeque::new(),
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
        let Some(file) = &self.file else {
            return Ok(());
        };
        let lines: String = costs
            .iter()
            .map(|cost| format!("{:016x}\n", cost.to_bits()))
            .collect();
        file.append(&lines)
    }

    /// Removes the file; the search is done.
    ///
    /// # Errors
    /// [`JournalError::Io`] where it cannot be removed.
    pub fn remove(self) -> Result<(), JournalError> {
        self.file.map_or(Ok(()), JournalFile::remove)
    }
}

/// The length of all whole lines, and their costs.
fn read_costs(body: &str) -> (usize, VecDeque<f64>) {
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
    (sound, costs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

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
