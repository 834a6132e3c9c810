//! The finished rows of a map that is being made, so that an interrupted one can be continued.

use std::collections::BTreeMap;
use std::path::Path;

use super::point::Point;
use crate::files::journal::{JournalError, JournalFile};

/// A file to which each finished row is appended, in one piece.
#[derive(Debug)]
pub struct Journal(JournalFile);

impl Journal {
    /// Opens the journal of the map with this identity and so many rows and columns, or begins it; returns the rows it
    /// holds. `other` says what a journal with another identity belongs to.
    ///
    /// # Errors
    /// [`JournalError`] where the file belongs to another map or cannot be used.
    pub fn open(
        path: &Path,
        identity: &str,
        other: &'static str,
        shape: (usize, usize),
    ) -> Result<(Self, BTreeMap<usize, Vec<Point>>), JournalError> {
        let (file, rows) = JournalFile::open(path, identity, other, |body| read_rows(body, shape))?;
        Ok((Self(file), rows))
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
        self.0.append(&block)
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Removes it: the map is finished.
    ///
    /// # Errors
    /// [`JournalError::Io`] where the file cannot be removed.
    pub fn remove(self) -> Result<(), JournalError> {
        self.0.remove()
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
    use std::fs;

    const OTHER: &str = "another map";

    #[test]
    fn finished_rows_are_kept_and_torn_ones_are_not() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("deep/map.journal");
        let (journal, rows) = Journal::open(&path, "settings", OTHER, (5, 2)).unwrap();
        assert!(rows.is_empty());
        journal.add(3, &[Point::failed(), Point::failed()]).unwrap();
        drop(journal);
        let whole = fs::read_to_string(&path).unwrap();
        for torn in ["row 4\nstick_sl", "row 5\nend\n", "row 4\nend\n"] {
            fs::write(&path, format!("{whole}{torn}")).unwrap();
            let (_, rows) = Journal::open(&path, "settings", OTHER, (5, 2)).unwrap();
            assert_eq!(rows.keys().copied().collect::<Vec<_>>(), [3], "{torn}");
            assert_eq!(rows[&3].len(), 2);
        }
        let (journal, _) = Journal::open(&path, "settings", OTHER, (5, 2)).unwrap();
        journal.add(4, &[Point::failed(), Point::failed()]).unwrap();
        assert_eq!(
            Journal::open(&path, "settings", OTHER, (5, 2))
                .unwrap()
                .1
                .len(),
            2
        );
    }

    #[test]
    fn the_journal_of_another_map_is_left_alone() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("map.journal");
        Journal::open(&path, "settings", OTHER, (1, 0))
            .unwrap()
            .0
            .add(0, &[])
            .unwrap();
        let before = fs::read(&path).unwrap();
        assert!(matches!(
            Journal::open(&path, "others", OTHER, (1, 0)),
            Err(JournalError::Foreign { .. })
        ));
        assert_eq!(fs::read(&path).unwrap(), before);
    }
}
