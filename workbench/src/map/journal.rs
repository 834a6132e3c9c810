//! The finished rows of a map that is being made, so that an interrupted one can be continued.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use thiserror::Error;

use super::point::Point;

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
    /// It belongs to a map with other settings.
    #[error(
        "{path}: belongs to a map with other settings; finish that one, remove the file or name another directory"
    )]
    OtherSettings {
        /// The journal.
        path: PathBuf,
    },
}

/// A file to which each finished row is appended, in one piece.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: Mutex<File>,
}

impl Journal {
    /// Opens the journal of the map with this identity and so many rows and columns, or begins it; returns the rows it
    /// holds.
    ///
    /// # Errors
    /// [`JournalError`] where the file belongs to another map or cannot be used.
    pub fn open(
        path: &Path,
        identity: &str,
        shape: (usize, usize),
    ) -> Result<(Self, BTreeMap<usize, Vec<Point>>), JournalError> {
        let failed = |step| {
            move |source| JournalError::Io {
                path: path.to_owned(),
                step,
                source,
            }
        };
        let head = format!("{identity:?}\n");
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(failed("make its directory"))?;
        }
        let text = match fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(failed("be read")(error)),
        };
        let (sound, rows) = match text.strip_prefix(head.as_str()) {
            Some(body) => {
                let (length, rows) = read_rows(body, shape);
                (head.len() + length, rows)
            }
            // A head that was cut off in the middle holds no row.
            None if head.starts_with(&text) => (0, BTreeMap::new()),
            None => {
                return Err(JournalError::OtherSettings {
                    path: path.to_owned(),
                });
            }
        };
        let mut file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(path)
            .map_err(failed("be opened to write"))?;
        file.set_len(sound as u64)
            .map_err(failed("be cut to its finished rows"))?;
        if sound == 0 {
            file.write_all(head.as_bytes())
                .map_err(failed("be written"))?;
        }
        Ok((
            Self {
                path: path.to_owned(),
                file: Mutex::new(file),
            },
            rows,
        ))
    }

    /// Adds a finished row.
    ///
    /// # Errors
    /// [`JournalError::Io`] where the file cannot be written.
    pub fn add(&self, row: usize, points: &[Point]) -> Result<(), JournalError> {
        let mut block = format!("row {row}\n");
        for point in points {
            block.push_str(&point.to_text());
            block.push('\n');
        }
        block.push_str("end\n");
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(block.as_bytes())
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

    /// Removes it: the map is finished.
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

/// The rows in a journal's body and the length of the part that is sound: a block that was cut off does not count, nor one
/// that is no row of such a map.
fn read_rows(body: &str, (count, columns): (usize, usize)) -> (usize, BTreeMap<usize, Vec<Point>>) {
    let mut rows = BTreeMap::new();
    let mut sound = 0;
    let mut rest = body;
    while let Some((block, after)) = rest.split_once("end\n") {
        let mut lines = block.lines();
        let row = lines
            .next()
            .and_then(|line| line.strip_prefix("row "))
            .and_then(|number| number.parse().ok());
        let (Some(row), Some(points)) =
            (row, lines.map(Point::parse).collect::<Option<Vec<Point>>>())
        else {
            break;
        };
        if row >= count || points.len() != columns {
            break;
        }
        rows.insert(row, points);
        sound = body.len() - after.len();
        rest = after;
    }
    (sound, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finished_rows_are_kept_and_torn_ones_are_not() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("deep/map.journal");
        let (journal, rows) = Journal::open(&path, "settings", (5, 2)).unwrap();
        assert!(rows.is_empty());
        journal.add(3, &[Point::failed(), Point::failed()]).unwrap();
        drop(journal);
        let whole = fs::read_to_string(&path).unwrap();
        for torn in ["row 4\nstick_sl", "row 5\nend\n", "row 4\nend\n"] {
            fs::write(&path, format!("{whole}{torn}")).unwrap();
            let (_, rows) = Journal::open(&path, "settings", (5, 2)).unwrap();
            assert_eq!(rows.keys().copied().collect::<Vec<_>>(), [3], "{torn}");
            assert_eq!(rows[&3].len(), 2);
        }
        let (journal, _) = Journal::open(&path, "settings", (5, 2)).unwrap();
        journal.add(4, &[Point::failed(), Point::failed()]).unwrap();
        assert_eq!(Journal::open(&path, "settings", (5, 2)).unwrap().1.len(), 2);
    }

    #[test]
    fn the_journal_of_another_map_is_left_alone() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("map.journal");
        Journal::open(&path, "settings", (1, 0))
            .unwrap()
            .0
            .add(0, &[])
            .unwrap();
        let before = fs::read(&path).unwrap();
        assert!(matches!(
            Journal::open(&path, "others", (1, 0)),
            Err(JournalError::OtherSettings { .. })
        ));
        assert_eq!(fs::read(&path).unwrap(), before);
    }
}
