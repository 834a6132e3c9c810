//! What maps, ensembles and maps of closed loops have in common: thousands of runs in rows, which a directory's journal keeps.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use super::grid::{Finished, run_rows};
use super::journal::Journal;
use super::point::Point;
use crate::files::journal::JournalError;
use crate::outcome::Outcome;

/// Runs in rows, each run on its own.
pub trait Study: Sync {
    /// File of the rows that are finished, until all are.
    const JOURNAL: &'static str;
    /// Whose rows they are where its identity is another: "a map with other settings".
    const OTHER: &'static str;
    /// Name of several rows.
    const ROWS: &'static str;
    /// What becomes of runs that fail.
    const FAILED: &'static str;

    /// All that the runs depend on, as text.
    fn identity(&self) -> String;

    /// Number of rows, and of runs in each.
    fn shape(&self) -> (usize, usize);

    /// Makes one run.
    ///
    /// # Errors
    /// Why it cannot be made.
    fn try_run(&self, row: usize, column: usize) -> Result<Point, String>;

    /// Writes tables and pictures into a directory.
    ///
    /// # Errors
    /// They cannot be written.
    fn write(&self, rows: &[Vec<Point>], out: &Path) -> anyhow::Result<()>;

    /// Makes one run; what cannot be run is a point without a motion.
    fn run(&self, row: usize, column: usize) -> Point {
        self.try_run(row, column)
            .unwrap_or_else(|_| Point::failed())
    }

    /// Why the first of the failed runs failed; empty if none did.
    fn first_failure(&self, rows: &[Vec<Point>]) -> String {
        let mut failed = rows.iter().enumerate().filter_map(|(row, points)| {
            let column = points.iter().position(|point| point.motion.is_none())?;
            self.try_run(row, column).err()
        });
        failed.next().unwrap_or_default()
    }
}

/// A study that is being made in a directory, of which an earlier, interrupted work may have made a part.
#[derive(Debug)]
pub struct Work<'a, S> {
    study: &'a S,
    out: &'a Path,
    journal: Journal,
    kept: BTreeMap<usize, Vec<Point>>,
}

impl<'a, S: Study> Work<'a, S> {
    /// Begins in the directory `out`, or goes on with what is finished there.
    ///
    /// # Errors
    /// [`JournalError`] where the directory has another study that is not finished, or cannot be used.
    pub fn open(study: &'a S, out: &'a Path) -> Result<Self, JournalError> {
        let journal = out.join(S::JOURNAL);
        let (journal, kept) = Journal::open(&journal, &study.identity(), S::OTHER, study.shape())?;
        Ok(Self {
            study,
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

    /// Where the finished rows are until all are.
    #[must_use]
    pub fn journal(&self) -> PathBuf {
        self.journal.path().to_owned()
    }

    /// Makes the runs that are missing, row by row on all cores, and writes what the complete study comes to.
    ///
    /// # Errors
    /// Where a file cannot be written or the threads not be started.
    pub fn run(
        self,
        stop: &AtomicBool,
        threads: Option<NonZeroUsize>,
        tick: &(dyn Fn() + Sync),
    ) -> anyhow::Result<Finished> {
        let study = self.study;
        let finished = run_rows(
            study.shape(),
            &|row, column| study.run(row, column),
            self.kept,
            &self.journal,
            stop,
            threads,
            tick,
        )?;
        if let Finished::Complete(rows) = &finished {
            study.write(rows, self.out)?;
            self.journal.remove()?;
        }
        Ok(finished)
    }
}

/// A complete study.
pub struct Made {
    /// All runs.
    pub rows: Vec<Vec<Point>>,
    /// Number of rows that were there before.
    pub kept: usize,
    /// Time that it took [s].
    pub wall_time: f64,
}

/// Makes a study in a directory for a person at a screen. `None` where it was interrupted, which is said.
///
/// # Errors
/// As for [`Work::open`] and [`Work::run`].
pub fn make<S: Study>(
    study: &S,
    out: &Path,
    stop: &AtomicBool,
    threads: Option<NonZeroUsize>,
) -> anyhow::Result<Option<Made>> {
    let work = Work::open(study, out)?;
    let (kept, journal) = (work.kept().len(), work.journal());
    let (rows, columns) = study.shape();
    let bar = ProgressBar::new((rows * columns) as u64).with_position((kept * columns) as u64);
    if let Ok(style) =
        ProgressStyle::with_template("{wide_bar} {pos}/{len} runs, {per_sec}, {eta} left")
    {
        bar.set_style(style);
    }
    let begun = Instant::now();
    let finished = work.run(stop, threads, &|| bar.inc(1))?;
    let wall_time = begun.elapsed().as_secs_f64();
    bar.finish_and_clear();
    match finished {
        Finished::Complete(rows) => Ok(Some(Made {
            rows,
            kept,
            wall_time,
        })),
        Finished::Interrupted => {
            eprintln!(
                "interrupted; the finished {} are kept in {}: the same command goes on from there",
                S::ROWS,
                journal.display()
            );
            Ok(None)
        }
    }
}

/// Says which runs failed, if any.
pub fn judge<S: Study>(study: &S, rows: &[Vec<Point>]) -> Outcome {
    let failed = rows.iter().flatten().filter(|point| point.motion.is_none());
    let failed = failed.count();
    if failed > 0 {
        eprintln!(
            "{failed} runs failed; {}. The first: {}",
            S::FAILED,
            study.first_failure(rows)
        );
    }
    Outcome::of(failed == 0)
}
