//! A map that is being made in a directory: its journal, its runs, its files.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use super::grid::{Finished, run_rows};
use super::journal::Journal;
use super::picture::picture;
use super::point::Point;
use super::result;
use super::settings::Settings;
use crate::files::journal::JournalError;

/// The runs of a map, some of which an earlier, interrupted work may have made.
#[derive(Debug)]
pub struct Work<'a> {
    settings: &'a Settings,
    out: &'a Path,
    journal: Journal,
    kept: BTreeMap<usize, Vec<Point>>,
}

impl<'a> Work<'a> {
    /// Begins in the directory `out`, or goes on with what is finished there.
    ///
    /// # Errors
    /// [`JournalError`] where the directory has another map that is not finished, or cannot be used.
    pub fn open(settings: &'a Settings, out: &'a Path) -> Result<Self, JournalError> {
        let (journal, kept) = Journal::open(
            &out.join("map.journal"),
            &settings.identity(),
            "a map with other settings",
            (settings.rows(), settings.columns()),
        )?;
        Ok(Self {
            settings,
            out,
            journal,
            kept,
        })
    }

    /// The rows that are finished, by their number.
    #[must_use]
    pub fn kept(&self) -> &BTreeMap<usize, Vec<Point>> {
        &self.kept
    }

    /// Where the finished rows are until the map is complete.
    #[must_use]
    pub fn journal(&self) -> PathBuf {
        self.journal.path().to_owned()
    }

    /// Makes the runs that are missing, as [`run_rows`] does. Of a map that is complete it writes `map.csv`, `map.svg` and
    /// `map.png`, for one parameter `extrema.csv` too.
    ///
    /// # Errors
    /// Where a file cannot be written or the threads not be started.
    pub fn run(
        self,
        stop: &AtomicBool,
        threads: Option<NonZeroUsize>,
        tick: &(dyn Fn() + Sync),
    ) -> anyhow::Result<Finished> {
        let settings = self.settings;
        let finished = run_rows(
            (settings.rows(), settings.columns()),
            &|row, column| settings.run(row, column),
            self.kept,
            &self.journal,
            stop,
            threads,
            tick,
        )?;
        if let Finished::Complete(rows) = &finished {
            result::write(settings, rows, self.out)?;
            picture(settings, rows)?.write(&self.out.join("map"))?;
            self.journal.remove()?;
        }
        Ok(finished)
    }
}
