//! What can be used of a record: stretches without holes, in the right units.

use std::f64::consts::{PI, TAU};

use stickslip::plant::Rig;
use thiserror::Error;

use crate::files::record::{Record, RecordError};

/// Columns that a diagnosis needs, in this order.
pub const COLUMNS: [&str; 6] = ["u", "N2", "theta", "theta_dot", "theta3", "theta3_dot"];
/// Shortest stretch that is used [s].
const SHORTEST_STRETCH: f64 = 1.0;
/// Longest sampling interval at which the motion can be followed [s].
const LONGEST_INTERVAL: f64 = 0.05;
/// How far the ratio of two scales may be off the one expected.
const SCALE_TOLERANCE: f64 = 0.05;
/// Number of samples over which an angle's change is compared with its velocity.
const SPAN: usize = 10;

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
    #[error("{file}: column `N2` reaches {largest}; is it in {unit}? It must be in N")]
    Force {
        /// The record.
        file: String,
        /// Largest value.
        largest: f64,
        /// Unit that is more likely.
        unit: &'static str,
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
pub fn check(record: &Record, rig: &Rig<f64>) -> Result<Checked, RecordProblem> {
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
    units(&file, &stretches, rig)?;
    if interval > LONGEST_INTERVAL {
        return Err(RecordProblem::Coarse { file, interval });
    }
    Ok(Checked {
        name: file,
        stretches,
        notes,
    })
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
    let length = |(from, to): (usize, usize)| record.time()[to] - record.time()[from];
    let longest = pieces
        .iter()
        .map(|piece| length(*piece))
        .fold(0.0, f64::max);
    let used: Vec<(usize, usize)> = pieces
        .iter()
        .copied()
        .filter(|piece| length(*piece) >= SHORTEST_STRETCH)
        .collect();
    if used.is_empty() {
        return Err(RecordProblem::TooShort {
            file: record.source().to_owned(),
            seconds: longest,
        });
    }
    if pieces.len() > 1 || used[0] != (0, record.len() - 1) {
        let rows: usize = used.iter().map(|(from, to)| to - from + 1).sum();
        notes.push(format!(
            "{}: has holes; {} stretches with {rows} of {} samples are used",
            record.source(),
            used.len(),
            record.len()
        ));
    }
    Ok(used
        .into_iter()
        .map(|(from, to)| Stretch {
            time: record.time()[from..=to].to_vec(),
            columns: std::array::from_fn(|c| columns[c][from..=to].to_vec()),
        })
        .collect())
}

fn units(file: &str, stretches: &[Stretch], rig: &Rig<f64>) -> Result<(), RecordProblem> {
    for (column, rate, angle_at, rate_at) in
        [("theta", "theta_dot", 2, 3), ("theta3", "theta3_dot", 4, 5)]
    {
        let Some(ratio) = scale_ratio(stretches, angle_at, rate_at) else {
            continue;
        };
        if (ratio - 1.0).abs() <= SCALE_TOLERANCE {
            continue;
        }
        if let Some(time) = wrap(stretches, angle_at) {
            return Err(RecordProblem::Wrapped {
                file: file.to_owned(),
                column,
                time,
            });
        }
        let guess = guess(ratio, column, rate);
        return Err(RecordProblem::Units {
            file: file.to_owned(),
            column,
            rate,
            ratio,
            guess,
        });
    }
    let mean = |at: usize| {
        let count: usize = stretches.iter().map(|s| s.time.len()).sum();
        stretches
            .iter()
            .flat_map(|s| s.columns[at].iter())
            .map(|v| v.abs())
            .sum::<f64>()
            / count as f64
    };
    let (voltage, found) = (mean(0), mean(5));
    if found < 1e-3 && mean(3) < 0.06 {
        return Err(RecordProblem::NoMotion {
            file: file.to_owned(),
        });
    }
    let possible = voltage / (rig.gearbox.ratio * rig.motor.back_emf_constant);
    let share = found / possible;
    // A loaded motor turns more slowly than its back-EMF allows, never much faster; a blocked one is no matter of units.
    let guess = if share > 300.0 {
        Some(
            "is u in kV, or are the angles in degrees and u in another unit? They must be V and rad",
        )
    } else if share > 3.0 {
        Some("are all angles in degrees? They must be in rad and rad/s, u in V")
    } else if share < 0.005 {
        Some("is u in mV? It must be in V")
    } else {
        None
    };
    if let Some(guess) = guess {
        return Err(RecordProblem::Speed {
            file: file.to_owned(),
            voltage,
            possible,
            found,
            guess: guess.to_owned(),
        });
    }
    let largest = stretches
        .iter()
        .flat_map(|s| s.columns[1].iter())
        .fold(0.0_f64, |a, b| a.max(b.abs()));
    if largest > 5000.0 {
        return Err(RecordProblem::Force {
            file: file.to_owned(),
            largest,
            unit: "mN or g",
        });
    }
    Ok(())
}

/// Change of the angle over the integral of its velocity, by least squares over spans; `None` where nothing moves.
fn scale_ratio(stretches: &[Stretch], angle: usize, rate: usize) -> Option<f64> {
    let (mut cross, mut square) = (0.0, 0.0);
    for stretch in stretches {
        let (time, theta, omega) = (
            &stretch.time,
            &stretch.columns[angle],
            &stretch.columns[rate],
        );
        let mut row = 0;
        while row + SPAN < time.len() {
            let integral: f64 = (row..row + SPAN)
                .map(|j| 0.5 * (omega[j] + omega[j + 1]) * (time[j + 1] - time[j]))
                .sum();
            cross += integral * (theta[row + SPAN] - theta[row]);
            square += integral * integral;
            row += SPAN;
        }
    }
    // Tachometer noise alone adds up to far less than a tenth of a turn in all.
    (square > 1e-3 && cross != 0.0).then(|| cross / square)
}

fn wrap(stretches: &[Stretch], angle: usize) -> Option<f64> {
    stretches.iter().find_map(|stretch| {
        let theta = &stretch.columns[angle];
        let row = (1..theta.len()).find(|&j| {
            let jump = (theta[j] - theta[j - 1]).abs();
            (jump - TAU).abs() < 0.7 || (jump - 360.0).abs() < 40.0
        })?;
        Some(stretch.time[row])
    })
}

/// Which units would explain the ratio.
fn guess(ratio: f64, angle: &str, rate: &str) -> String {
    let known = [
        (
            PI / 30.0,
            format!("is `{rate}` in rpm? It must be in rad/s"),
        ),
        (
            PI / 180.0,
            format!("is `{rate}` in degrees per second? It must be in rad/s"),
        ),
        (
            TAU,
            format!("is `{rate}` in turns per second? It must be in rad/s"),
        ),
        (
            180.0 / PI,
            format!("is `{angle}` in degrees? It must be in rad"),
        ),
        (
            1.0 / TAU,
            format!("is `{angle}` in turns? It must be in rad"),
        ),
        (
            6.0,
            format!("is `{angle}` in degrees and `{rate}` in rpm? They must be in rad and rad/s"),
        ),
        (
            1.0 / 60.0,
            format!("is `{angle}` in turns and `{rate}` in rpm? They must be in rad and rad/s"),
        ),
        (1e-3, "is `time` in ms? It must be in s".to_owned()),
        (
            8.0,
            "is it on the motor's side of the gearbox? It must be at the gearbox output".to_owned(),
        ),
        (
            1.0 / 8.0,
            format!(
                "is `{rate}` on the motor's side of the gearbox? It must be at the gearbox output"
            ),
        ),
        (
            -1.0,
            "have they opposite signs? Both must count forward".to_owned(),
        ),
    ];
    known
        .into_iter()
        .filter(|(factor, _)| factor * ratio > 0.0)
        .map(|(factor, text)| ((ratio / factor).ln().abs(), text))
        .filter(|(distance, _)| *distance < SCALE_TOLERANCE)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or_else(
            || "which units are they in? They must be rad and rad/s".to_owned(),
            |(_, text)| text,
        )
}
