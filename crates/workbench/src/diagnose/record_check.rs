//! What can be used of a record: stretches without holes, in the right units.

use std::f64::consts::TAU;

use inference::record::{CHANNELS, channel};
use stickslip::plant::{Rig, RigKind};
use thiserror::Error;

use super::console::number;
use super::record_units::{check_angles, check_units};
use crate::files::record::{Record, RecordError};

/// Columns that a diagnosis can use, in this order: inputs, which it needs, what may be measured of the motion, and of the
/// full rig the normal force on disc D1, which it needs too.
pub const COLUMNS: [&str; WIDTH] = [
    "u",
    "N2",
    "theta",
    "theta_dot",
    "theta3",
    "theta3_dot",
    "i",
    "theta1",
    "theta1_dot",
    "N1",
];
/// How many of them, from the first, are inputs of every rig.
pub(super) const INPUTS: usize = 2;
/// How many of them, from the first, the reduced rig has.
const REDUCED: usize = INPUTS + channel::THETA1;
const WIDTH: usize = INPUTS + CHANNELS + 1;
/// The columns of the motion of disc D2 and of the gearbox output, one of which is needed.
const NEEDED: std::ops::Range<usize> = INPUTS..INPUTS + channel::CURRENT;

/// The columns that records of this rig have.
fn columns(rig: &Rig<f64>) -> &'static [&'static str] {
    match rig.kind() {
        RigKind::Reduced => &COLUMNS[..REDUCED],
        RigKind::Full => &COLUMNS,
    }
}
/// Shortest stretch that is used, in natural periods of the disc on its shaft.
const SHORTEST_STRETCH: f64 = 0.75;
/// Fewest samples in such a period at which sticking and slipping can be followed.
const FEWEST_SAMPLES: f64 = 12.0;
/// Samples in such a period towards which faster records are thinned out: the engine's time grows with the samples, and the
/// motion has nothing faster to show.
const THINNED_SAMPLES: f64 = 130.0;

/// Natural period of the disc on its shaft [s]: what long and short mean to a record.
#[must_use]
pub fn natural_period(rig: &Rig<f64>) -> f64 {
    TAU * (rig.disc.inertia / rig.shaft.stiffness).sqrt()
}

/// Why a record cannot be used.
#[derive(Debug, Error)]
pub enum RecordProblem {
    /// An input is missing.
    #[error(
        "{0}; a diagnosis needs time, u, N2 (and N1 of the full rig) and some of theta, theta_dot, theta3, theta3_dot and i"
    )]
    Column(RecordError),
    /// No motion was measured.
    #[error(
        "{file}: has no column of the motion; a diagnosis needs at least one of theta [rad], theta_dot [rad/s], theta3 [rad] and theta3_dot [rad/s]"
    )]
    NoColumn {
        /// The record.
        file: String,
    },
    /// No stretch is long enough.
    #[error(
        "{file}: has no stretch of {needed:.3} s without holes, three quarters of a period of the disc on its shaft; its longest has {seconds:.3} s"
    )]
    TooShort {
        /// The record.
        file: String,
        /// Length that is needed [s].
        needed: f64,
        /// Length of its longest stretch [s].
        seconds: f64,
    },
    /// Samples are too rare.
    #[error(
        "{file}: is sampled every {interval:.4} s; sticking and slipping of this rig can be followed up to {longest:.4} s, {FEWEST_SAMPLES} samples in a period of the disc on its shaft"
    )]
    Coarse {
        /// The record.
        file: String,
        /// Longest interval [s].
        longest: f64,
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
        "{file}: at the mean of |u| = {voltage:.4} this motor turns its gearbox at most at {possible:.3} rad/s, but the measured speed has the mean {found:.3}; {guess}"
    )]
    Speed {
        /// The record.
        file: String,
        /// Mean of |u|.
        voltage: f64,
        /// Speed at which the back-EMF equals that [rad/s].
        possible: f64,
        /// Mean speed as measured [rad/s].
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
    /// The columns of [`COLUMNS`]; empty where one was not measured.
    pub columns: [Vec<f64>; WIDTH],
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

impl Checked {
    /// Which channels were measured.
    #[must_use]
    pub fn has(&self) -> [bool; CHANNELS] {
        let first = self.stretches.first();
        std::array::from_fn(|c| first.is_some_and(|s| !s.columns[INPUTS + c].is_empty()))
    }
}

/// Checks a record and takes it apart at its holes.
///
/// # Errors
/// [`RecordProblem`] where a column is missing, nothing moves, it is too short or coarse, or units do not fit.
pub fn check(record: &Record, rig: &Rig<f64>) -> Result<Checked, RecordProblem> {
    let file = record.source().to_owned();
    let mut notes = Vec::new();
    let used = columns(rig);
    let disc1_force = used[REDUCED..].last();
    for name in used[..INPUTS].iter().chain(disc1_force) {
        record.require(name).map_err(RecordProblem::Column)?;
    }
    if COLUMNS[NEEDED]
        .iter()
        .all(|name| record.column(name).is_none())
    {
        return Err(RecordProblem::NoColumn { file });
    }
    let ignored: Vec<&str> = record.names().filter(|name| !used.contains(name)).collect();
    if !ignored.is_empty() {
        notes.push(format!("{file}: columns not used: {}", ignored.join(", ")));
    }
    let period = natural_period(rig);
    let stretches = stretches(record, used, rig, &mut notes)?;
    let interval = record.median_step();
    check_units(&file, &stretches, rig)?;
    let longest = period / FEWEST_SAMPLES;
    if interval > longest {
        return Err(RecordProblem::Coarse {
            file,
            interval,
            longest,
        });
    }
    let every = (period / THINNED_SAMPLES / interval).round() as usize;
    let stretches = if every > 1 {
        notes.push(format!(
            "{file}: is sampled every {} s; one sample in {every} is used and those at steps of the voltage, with the inputs' means \
             between them",
            number(interval)
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

/// Every `every`th sample, and those between them at which alone the voltage changes. Inputs are held from one sample to the next, so
/// each of those kept stands for the mean until the following one; readings are taken as they are, which keeps their noise what
/// `sensors.toml` says.
fn thinned(stretch: &Stretch, every: usize) -> Stretch {
    let kept = kept(&stretch.columns[0], every);
    let pick = |series: &[f64]| {
        kept.iter()
            .filter_map(|&at| series.get(at).copied())
            .collect()
    };
    let mean = |series: &[f64]| {
        let ends = kept.iter().skip(1).copied().chain([series.len()]);
        let parts = kept
            .iter()
            .zip(ends)
            .filter_map(|(&from, to)| series.get(from..to));
        let means = parts.map(|part| part.iter().sum::<f64>() / part.len() as f64);
        means.collect::<Vec<f64>>()
    };
    Stretch {
        time: pick(&stretch.time),
        columns: std::array::from_fn(|c| {
            let series = &stretch.columns[c];
            if c < INPUTS || c + 1 == WIDTH {
                mean(series)
            } else {
                pick(series)
            }
        }),
    }
}

/// Samples that are kept. The motor follows a step of the voltage faster than the disc: a mean over it would show.
fn kept(voltage: &[f64], every: usize) -> Vec<usize> {
    let mut kept = Vec::new();
    for first in (0..voltage.len()).step_by(every) {
        let mut changes = (first + 1..voltage.len().min(first + every))
            .filter(|&at| voltage[at] != voltage[at - 1]);
        kept.push(first);
        if let (Some(step), None) = (changes.next(), changes.next()) {
            kept.push(step);
        }
    }
    kept
}

fn stretches(
    record: &Record,
    used: &[&str],
    rig: &Rig<f64>,
    notes: &mut Vec<String>,
) -> Result<Vec<Stretch>, RecordProblem> {
    let needed = SHORTEST_STRETCH * natural_period(rig);
    let columns: [&[f64]; WIDTH] = std::array::from_fn(|c| {
        let name = used.get(c).copied();
        name.and_then(|name| record.column(name))
            .unwrap_or_default()
    });
    let complete = |row: usize| {
        columns
            .iter()
            .all(|column| column.get(row).is_none_or(|value| value.is_finite()))
    };
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
        columns: columns.map(|column| column.get(from..=to).unwrap_or_default().to_vec()),
    };
    let length = |&(from, to): &(usize, usize)| record.time()[to] - record.time()[from];
    let used: Vec<(usize, usize)> = pieces
        .iter()
        .copied()
        .filter(|piece| length(piece) >= needed)
        .collect();
    if used.is_empty() {
        // Time in another unit may be all that makes it short.
        let all: Vec<Stretch> = pieces.iter().map(stretch).collect();
        check_angles(record.source(), &all, rig.gearbox.ratio)?;
        return Err(RecordProblem::TooShort {
            file: record.source().to_owned(),
            needed,
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
                Vec::new(),
                Vec::new(),
                Vec::new(),
                Vec::new(),
            ],
        };
        let thin = thinned(&stretch, 10);
        assert_eq!(thin.time.len(), 101);
        assert_eq!(thin.time[3], stretch.time[30]);
        assert_eq!(thin.columns[2][3], stretch.columns[2][30]);
        // The mean of samples 30 … 39.
        assert_eq!(thin.columns[0][3], 34.5);
        assert!(thin.columns[6].is_empty());
    }

    #[test]
    fn a_step_of_the_voltage_keeps_its_instant_where_samples_are_left_out() {
        let mut columns: [Vec<f64>; WIDTH] = std::array::from_fn(|_| vec![0.0; 40]);
        // One step between two samples that are kept, then one at every sample.
        columns[0][14..].fill(6.0);
        for at in 30..40 {
            columns[0][at] = at as f64;
        }
        let time: Vec<f64> = (0..40).map(f64::from).collect();
        let thin = thinned(&Stretch { time, columns }, 10);
        assert_eq!(thin.time, [0.0, 10.0, 14.0, 20.0, 30.0]);
        assert_eq!(thin.columns[0], [0.0, 0.0, 6.0, 6.0, 34.5]);
        assert_eq!(thin.columns[2].len(), 5);
    }
}
