//! What can be used of a record: stretches without holes, in the right units.

use stickslip::plant::Rig;
use thiserror::Error;

use super::record_units::{check_angles, check_units};
use super::sensors::Sensors;
use crate::files::record::{Record, RecordError};

/// Columns that a diagnosis needs, in this order.
pub const COLUMNS: [&str; 6] = ["u", "N2", "theta", "theta_dot", "theta3", "theta3_dot"];
/// How many of them, from the first, are inputs.
const INPUTS: usize = 2;
/// Shortest stretch that is used [s].
const SHORTEST_STRETCH: f64 = 1.0;
/// Longest sampling interval at which the motion can be followed [s].
const LONGEST_INTERVAL: f64 = 0.05;
/// Sampling interval towards which faster records are thinned out [s]: the engine's time grows with the samples, and the
/// motion has nothing faster to show.
const THINNED_INTERVAL: f64 = 0.01;

/// Why a record cannot be used.
#[derive(Debug, Error)]
pub enum RecordProblem {
    /// A column is missing.
    #[error("{0}; a diagnosis needs time, u, N2, theta, theta_dot, theta3 and theta3_dot")]
    Column(RecordError),
    /// No stretch is long enough.
    #[error(
        "{file}: has no stretch of {SHORTEST_STRETCH} s without holes; its longest has {seconds:.2} s"
    )]
    TooShort {
        /// The record.
        file: String,
        /// Length of its longest stretch [s].
        seconds: f64,
    },
    /// Samples are too rare.
    #[error(
        "{file}: is sampled every {interval:.3} s; sticking and slipping can be followed up to {LONGEST_INTERVAL} s"
    )]
    Coarse {
        /// The record.
        file: String,
        /// Median sampling interval [s].
        interval: f64,
    },
    /// Nothing moves.
    #[error(
        "{file}: neither disc nor motor moves; a record without motion says nothing about what is missing"
    )]
    NoMotion {
        /// The record.
        file: String,
    },
    /// An angle starts over after a turn.
    #[error(
        "{file}: column `{column}` jumps by a whole turn at {time} s; give the angle unwrapped, counting on beyond a turn"
    )]
    Wrapped {
        /// The record.
        file: String,
        /// The angle.
        column: &'static str,
        /// When it first jumps [s].
        time: f64,
    },
    /// Two columns do not fit in the units they should have.
    #[error(
        "{file}: column `{column}` changes {ratio:.4} times as much as `{rate}` over time says; {guess}"
    )]
    Units {
        /// The record.
        file: String,
        /// The angle.
        column: &'static str,
        /// Its velocity.
        rate: &'static str,
        /// Change of the angle over the integral of the velocity.
        ratio: f64,
        /// Which unit that would be, as a question.
        guess: String,
    },
    /// Speed and voltage do not fit.
    #[error(
        "{file}: at the mean of |u| = {voltage:.4} this motor turns its gearbox at most at {possible:.3} rad/s, but |theta3_dot| has the mean {found:.3}; {guess}"
    )]
    Speed {
        /// The record.
        file: String,
        /// Mean of |u|.
        voltage: f64,
        /// Speed at which the back-EMF equals that [rad/s].
        possible: f64,
        /// Mean of |theta3_dot|.
        found: f64,
        /// Which unit that would be, as a question.
        guess: String,
    },
    /// The normal force is not of a size that the rig has.
    #[error("{file}: column `N2` has the mean {mean:.4}; {guess}")]
    Force {
        /// The record.
        file: String,
        /// Its mean.
        mean: f64,
        /// Which unit that would be, as a question.
        guess: &'static str,
    },
    /// Disc and gearbox output, at the ends of one shaft, turn differently far.
    #[error(
        "{file}: `theta3` goes {ratio:.3} times as far as `theta` at the other end of the shaft; {guess}"
    )]
    Shaft {
        /// The record.
        file: String,
        /// Way of the gearbox output over that of the disc.
        ratio: f64,
        /// Which unit that would be, as a question.
        guess: &'static str,
    },
    /// An angle stands still while its velocity does not, or the other way round.
    #[error(
        "{file}: column `{still}` does not change while `{moving}` says that it should; is its sensor connected?"
    )]
    Dead {
        /// The record.
        file: String,
        /// The column that stands still.
        still: &'static str,
        /// The one that moves.
        moving: &'static str,
    },
}

/// A part of a record without holes.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Sample times [s].
    pub time: Vec<f64>,
    /// The columns of [`COLUMNS`].
    pub columns: [Vec<f64>; 6],
}

/// A record that can be used.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// File.
    pub name: String,
    /// Its parts without holes.
    pub stretches: Vec<Stretch>,
    /// What has to be said about it.
    pub notes: Vec<String>,
}

/// Checks a record and takes it apart at its holes.
///
/// # Errors
/// [`RecordProblem`] where a column is missing, nothing moves, it is too short or coarse, or units do not fit.
pub fn check(record: &Record, rig: &Rig<f64>, sensors: &Sensors) -> Result<Checked, RecordProblem> {
    let file = record.source().to_owned();
    let mut notes = Vec::new();
    for name in COLUMNS {
        record.require(name).map_err(RecordProblem::Column)?;
    }
    let ignored: Vec<&str> = record
        .names()
        .filter(|name| !COLUMNS.contains(name))
        .collect();
    if !ignored.is_empty() {
        notes.push(format!("{file}: columns not used: {}", ignored.join(", ")));
    }
    let stretches = stretches(record, &mut notes)?;
    let interval = record.median_step();
    check_units(&file, &stretches, rig, sensors)?;
    if interval > LONGEST_INTERVAL {
        return Err(RecordProblem::Coarse { file, interval });
    }
    let every = (THINNED_INTERVAL / interval * (1.0 + 1e-6)) as usize;
    let stretches = if every > 1 {
        notes.push(format!(
            "{file}: is sampled every {:.3} ms; every {every}th sample is used, with the inputs' means between them",
            1e3 * interval
        ));
        stretches.iter().map(|s| thinned(s, every)).collect()
    } else {
        stretches
    };
    Ok(Checked {
        name: file,
        stretches,
        notes,
    })
}

/// Every `every`th sample. Inputs are held from one sample to the next, so each of those kept stands for the mean until
/// the following one; readings are taken as they are, which keeps their noise what `sensors.toml` says.
fn thinned(stretch: &Stretch, every: usize) -> Stretch {
    let pick = |series: &[f64]| series.iter().step_by(every).copied().collect::<Vec<f64>>();
    let mean = |series: &[f64]| {
        series
            .chunks(every)
            .map(|chunk| chunk.iter().sum::<f64>() / chunk.len() as f64)
            .collect::<Vec<f64>>()
    };
    Stretch {
        time: pick(&stretch.time),
        columns: std::array::from_fn(|c| {
            let series = &stretch.columns[c];
            if c < INPUTS {
                mean(series)
            } else {
                pick(series)
            }
        }),
    }
}

fn stretches(record: &Record, notes: &mut Vec<String>) -> Result<Vec<Stretch>, RecordProblem> {
    let columns: Vec<&[f64]> = COLUMNS
        .iter()
        .filter_map(|name| record.column(name))
        .collect();
    let complete = |row: usize| columns.iter().all(|column| column[row].is_finite());
    let longest_step = 1.5 * record.median_step();
    let mut pieces: Vec<(usize, usize)> = Vec::new();
    for row in (0..record.len()).filter(|row| complete(*row)) {
        match pieces.last_mut() {
            Some((_, end))
                if *end + 1 == row && record.time()[row] - record.time()[*end] <= longest_step =>
            {
                *end = row
            }
            _ => pieces.push((row, row)),
        }
    }
    let stretch = |&(from, to): &(usize, usize)| Stretch {
        time: record.time()[from..=to].to_vec(),
        columns: std::array::from_fn(|c| columns[c][from..=to].to_vec()),
    };
    let length = |&(from, to): &(usize, usize)| record.time()[to] - record.time()[from];
    let used: Vec<(usize, usize)> = pieces
        .iter()
        .copied()
        .filter(|piece| length(piece) >= SHORTEST_STRETCH)
        .collect();
    if used.is_empty() {
        // Time in another unit may be all that makes it short.
        let all: Vec<Stretch> = pieces.iter().map(stretch).collect();
        check_angles(record.source(), &all)?;
        return Err(RecordProblem::TooShort {
            file: record.source().to_owned(),
            seconds: pieces.iter().map(length).fold(0.0, f64::max),
        });
    }
    if pieces.len() > 1 || used[0] != (0, record.len() - 1) {
        notes.push(format!(
            "{}: has holes; {} with {:.2} of {:.2} s used",
            record.source(),
            if used.len() == 1 {
                "one stretch".to_owned()
            } else {
                format!("{} stretches", used.len())
            },
            used.iter().map(length).sum::<f64>(),
            length(&(0, record.len() - 1))
        ));
    }
    Ok(used.iter().map(stretch).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_readings_and_the_inputs_impulse() {
        let count = 1001;
        let time: Vec<f64> = (0..count).map(|j| 1e-3 * f64::from(j)).collect();
        let column = |c: i32| (0..count).map(|j| f64::from(c * 10_000 + j)).collect();
        let stretch = Stretch {
            time,
            columns: [
                column(0),
                column(1),
                column(2),
                column(3),
                column(4),
                column(5),
            ],
        };
        let thin = thinned(&stretch, 10);
        assert_eq!(thin.time.len(), 101);
        assert_eq!(thin.time[3], stretch.time[30]);
        assert_eq!(thin.columns[2][3], stretch.columns[2][30]);
        // The mean of samples 30 … 39.
        assert_eq!(thin.columns[0][3], 34.5);
    }
}
