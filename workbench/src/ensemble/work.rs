//! An ensemble that is being made in a directory: its journal, its runs, its files.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use super::bands::at_places;
use super::picture::picture;
use super::result;
use super::settings::Settings;
use crate::files::journal::JournalError;
use crate::map::{Finished, Journal, Point, run_rows};

/// The runs of an ensemble, some of which an earlier, interrupted work may have made.
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
    /// [`JournalError`] where the directory has another ensemble that is not finished, or cannot be used.
    pub fn open(settings: &'a Settings, out: &'a Path) -> Result<Self, JournalError> {
        let (journal, kept) = Journal::open(
            &out.join("ensemble.journal"),
            &settings.identity(),
            "an ensemble with other settings",
            (settings.runs(), settings.places()),
        )?;
        Ok(Self {
            settings,
            out,
            journal,
            kept,
        })
    }

    /// The rigs whose runs are finished, by their number.
    #[must_use]
    pub fn kept(&self) -> &BTreeMap<usize, Vec<Point>> {
        &self.kept
    }

    /// Where the finished runs are until the ensemble is complete.
    #[must_use]
    pub fn journal(&self) -> PathBuf {
        self.journal.path().to_owned()
    }

    /// Makes the runs that are missing, a row for each rig, as [`run_rows`] does. Of an ensemble that is complete it writes
    /// `ensemble.csv`, `runs.csv`, `rigs.csv`, `ensemble.svg` and `ensemble.png`.
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
            (settings.runs(), settings.places()),
            &|run, place| settings.run(run, place),
            self.kept,
            &self.journal,
            stop,
            threads,
            tick,
        )?;
        if let Finished::Complete(rows) = &finished {
            let bands = at_places(rows, settings.places());
            result::write(settings, rows, &bands, self.out)?;
            picture(settings, rows, &bands).write(&self.out.join("ensemble"))?;
            self.journal.remove()?;
        }
        Ok(finished)
    }
}
