//! Replays practice cases with their true parameters and compares with what was recorded.
//!
//! This is the check of the maker itself: another simulator, another friction class, the same
//! equations. Agreement within the sensor noise says that the equations are the same.

use crate::answers::{Answer, Answers};
use crate::effects::Effects;
use crate::error::{MakerError, at};
use crate::excitation::Excitation;
use crate::hidden_effect::practice_law;
use crate::random::{Purpose, Stream};
use crate::rig::{FRICTION_LEVEL, NOMINAL};
use crate::simulator::{Simulator, State, TrueRig};
use std::path::Path;

/// Samples over which the practice records hold their normal force.
const FORCE_PLATEAU: usize = 1000;

/// A record as read from CSV, columns in file order.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Rows of time, u, N2, theta, theta_dot, theta3, theta3_dot.
    pub rows: Vec<[f64; 7]>,
}

/// Root mean square differences between replay and record over one stretch of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Disc angle, the half step of the encoder taken out [rad].
    pub disc_angle: f64,
    /// Disc speed, with the tachometer's noise [rad/s].
    pub disc_speed: f64,
    /// Gearbox angle, the half step of the encoder taken out [rad].
    pub gearbox_angle: f64,
    /// Gearbox speed, with the tachometer's noise [rad/s].
    pub gearbox_speed: f64,
}

/// Reads a record of seven numeric columns.
pub fn read_record(path: &Path) -> Result<Record, MakerError> {
    let text = std::fs::read_to_string(path).map_err(at(path))?;
    let problem = |line: usize| MakerError::Practice {
        path: path.to_owned(),
        problem: format!("line {}: expected seven numbers", line + 1),
    };
    let rows = text
        .lines()
        .enumerate()
        .skip(1)
        .map(|(index, line)| {
            let numbers: Vec<f64> = line
                .split(',')
                .map(str::parse)
                .collect::<Result<_, _>>()
                .map_err(|_| problem(index))?;
            numbers.try_into().map_err(|_| problem(index))
        })
        .collect::<Result<_, _>>()?;
    Ok(Record { rows })
}

/// Reads `ANSWERS.json` of a directory of cases.
pub fn read_answers(directory: &Path) -> Result<Answers, MakerError> {
    let path = directory.join("ANSWERS.json");
    let text = std::fs::read_to_string(&path).map_err(at(&path))?;
    serde_json::from_str(&text).map_err(|error| MakerError::Practice {
        path,
        problem: error.to_string(),
    })
}

/// The true rig behind an answer of the practice records.
pub fn true_rig(answer: &Answer) -> Result<TrueRig, MakerError> {
    let law = practice_law(&answer.truth).ok_or_else(|| MakerError::Practice {
        path: "ANSWERS.json".into(),
        problem: format!("unknown friction law {}", answer.truth),
    })?;
    let level = answer.parameter_ratio.get(FRICTION_LEVEL);
    Ok(TrueRig {
        parameters: NOMINAL.scaled(&answer.parameter_ratio),
        law: law.with_level(level.copied().unwrap_or(1.0)),
        effects: Effects::from_answers(&answer.effects)?,
        disc1: None,
    })
}

/// Simulates `rig` from rest under the inputs of `record` and returns the differences over
/// consecutive stretches of `stretch` samples.
pub fn replay(
    rig: &TrueRig,
    record: &Record,
    stretch: usize,
) -> Result<Vec<Difference>, MakerError> {
    let excitation = inputs_of(record, rig.effects.cell_bias);
    let noise = Stream::new(0, Purpose::Contact(0));
    let samples = Simulator::new(rig, State::default(), noise).run(&excitation)?;
    let encoder_bias = [
        0.5 * crate::instruments::DISC_ENCODER_STEP,
        0.5 * crate::instruments::MOTOR_ENCODER_STEP,
    ];
    let squares: Vec<[f64; 4]> = samples
        .iter()
        .zip(&record.rows)
        .map(|(sample, row)| {
            [
                sample.seen_disc_angle - row[3] - encoder_bias[0],
                sample.seen_disc_speed - row[4],
                sample.state.gearbox_angle - row[5] - encoder_bias[1],
                sample.state.gearbox_speed - row[6],
            ]
            .map(|difference| difference * difference)
        })
        .collect();
    Ok(squares
        .chunks(stretch.max(1))
        .map(|chunk| {
            let root = |column: usize| {
                libm::sqrt(chunk.iter().map(|row| row[column]).sum::<f64>() / chunk.len() as f64)
            };
            Difference {
                disc_angle: root(0),
                disc_speed: root(1),
                gearbox_angle: root(2),
                gearbox_speed: root(3),
            }
        })
        .collect())
}

/// The inputs that made a practice record: its voltage, and the whole newtons nearest to the
/// mean reading of each plateau without the cell's bias.
fn inputs_of(record: &Record, cell_bias: f64) -> Excitation {
    let mut excitation = Excitation::default();
    for plateau in record.rows.chunks(FORCE_PLATEAU) {
        let mean = plateau.iter().map(|row| row[2]).sum::<f64>() / plateau.len() as f64;
        let force = if mean == 0.0 {
            0.0
        } else {
            (mean - cell_bias).round()
        };
        for row in plateau {
            excitation.voltage.push(row[1]);
            excitation.normal_force.push(force);
        }
    }
    excitation
}
