//! Makes the runs of a map on all cores.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;
use rayon::prelude::*;

use super::journal::Journal;
use super::point::Point;

/// How the work ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Finished {
    /// All rows, in order.
    Complete(Vec<Vec<Point>>),
    /// It was stopped; the journal has the finished rows.
    Interrupted,
}

/// Makes the rows of a map of so many rows and columns that `kept` lacks, each point by `run` from row and column, writes each to the journal as it is finished, and stops after the runs at hand once
/// `stop` is set. `tick` is called after every run, from any thread.
///
/// # Errors
/// Where the journal cannot be written or the threads not be started.
pub fn run_rows(
    (count, columns): (usize, usize),
    run: &(dyn Fn(usize, usize) -> Point + Sync),
    kept: BTreeMap<usize, Vec<Point>>,
    journal: &Journal,
    stop: &AtomicBool,
    threads: Option<NonZeroUsize>,
    tick: &(dyn Fn() + Sync),
) -> anyhow::Result<Finished> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.map_or(0, NonZeroUsize::get))
        .build()
        .context("the threads could not be started")?;
    let missing: Vec<usize> = (0..count).filter(|row| !kept.contains_key(row)).collect();
    let rows = Mutex::new(kept);
    pool.install(|| {
        missing.par_iter().with_max_len(1).try_for_each(|&row| {
            let mut points = Vec::with_capacity(columns);
            for column in 0..columns {
                if stop.load(Ordering::Relaxed) {
                    return Ok(());
                }
                points.push(run(row, column));
                tick();
            }
            journal.add(row, &points)?;
            rows.lock()
                .unwrap_or_else(PoisonError::into_inner)
                .insert(row, points);
            Ok::<(), anyhow::Error>(())
        })
    })?;
    let rows = rows.into_inner().unwrap_or_else(PoisonError::into_inner);
    if rows.len() == count {
        Ok(Finished::Complete(rows.into_values().collect()))
    } else {
        Ok(Finished::Interrupted)
    }
}
