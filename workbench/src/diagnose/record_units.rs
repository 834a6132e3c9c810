//! Whether the columns of a record are in the units they should have, told by their scales.

use std::f64::consts::{PI, TAU};

use stickslip::plant::Rig;

use super::record_check::{RecordProblem, Stretch};
use super::sensors::Sensors;

/// How far the ratio of two scales may be off the one expected.
const SCALE_TOLERANCE: f64 = 0.05;
/// Number of samples over which an angle's change is compared with its velocity.
const SPAN: usize = 10;
/// Normal force beyond which nothing presses on this rig's disc [N].
const LARGEST_FORCE: f64 = 5000.0;
/// Way that both ends of the shaft must have gone for its twist not to matter [rad], and how far their ratio may be off.
const CLEAR_WAY: f64 = 12.0;
const SHAFT_TOLERANCE: f64 = 0.3;
/// Change of an angle from which on its velocity must have been seen [rad].
const CLEAR_TURN: f64 = 1.0;

/// Compares the scales of angles and velocities, of speed and voltage, and of the normal force with what the rig allows.
///
/// # Errors
/// [`RecordProblem`] that asks which unit was meant.
pub fn check_units(
    file: &str,
    stretches: &[Stretch],
    rig: &Rig<f64>,
    sensors: &Sensors,
) -> Result<(), RecordProblem> {
    check_angles(file, stretches)?;
    check_shaft(file, stretches)?;
    check_speed(file, stretches, rig)?;
    check_force(file, stretches, sensors)
}

/// Compares the scales of angles, velocities and time.
///
/// # Errors
/// As for [`check_units`].
pub fn check_angles(file: &str, stretches: &[Stretch]) -> Result<(), RecordProblem> {
    for (column, rate, angle_at, rate_at) in
        [("theta", "theta_dot", 2, 3), ("theta3", "theta3_dot", 4, 5)]
    {
        if let Some((still, moving)) = dead(stretches, (column, angle_at), (rate, rate_at)) {
            return Err(RecordProblem::Dead {
                file: file.to_owned(),
                still,
                moving,
            });
        }
        let Some(ratio) = scale_ratio(stretches, angle_at, rate_at) else {
            continue;
        };
        if (ratio - 1.0).abs() <= SCALE_TOLERANCE {
            continue;
        }
        if let Some(time) = wrap(stretches, angle_at, rate_at) {
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
    Ok(())
}

/// Disc and gearbox output hang on one shaft: over many turns both turn as far.
fn check_shaft(file: &str, stretches: &[Stretch]) -> Result<(), RecordProblem> {
    let way = |at: usize| -> f64 {
        stretches
            .iter()
            .filter_map(|s| Some(s.columns[at].last()? - s.columns[at].first()?))
            .sum()
    };
    let (disc, gear) = (way(2), way(4));
    let ratio = gear / disc;
    if disc.abs().min(gear.abs()) < CLEAR_WAY || (ratio - 1.0).abs() < SHAFT_TOLERANCE {
        return Ok(());
    }
    let near = |expected: f64| (ratio / expected - 1.0).abs() < SHAFT_TOLERANCE;
    let guess = if near(8.0) {
        "are `theta3` and `theta3_dot` on the motor's side of the gearbox? They must be at the gearbox output"
    } else if near(180.0 / PI) {
        "are `theta3` and `theta3_dot` in degrees? They must be in rad and rad/s"
    } else if near(PI / 180.0) {
        "are `theta` and `theta_dot` in degrees? They must be in rad and rad/s"
    } else if near(TAU) {
        "are `theta` and `theta_dot` in turns? They must be in rad and rad/s"
    } else if near(1.0 / TAU) {
        "are `theta3` and `theta3_dot` in turns? They must be in rad and rad/s"
    } else if near(-1.0) {
        "do they count in opposite directions? Both must count forward"
    } else {
        "which units are they in? They must be rad and rad/s of disc D2 and of the gearbox output"
    };
    Err(RecordProblem::Shaft {
        file: file.to_owned(),
        ratio,
        guess,
    })
}

fn check_speed(file: &str, stretches: &[Stretch], rig: &Rig<f64>) -> Result<(), RecordProblem> {
    let mean = |at: usize| mean(stretches, at, f64::abs);
    let (voltage, found) = (mean(0), mean(5));
    if found < 1e-3 && mean(3) < 0.06 {
        return Err(RecordProblem::NoMotion {
            file: file.to_owned(),
        });
    }
    let possible = voltage / (rig.gearbox.ratio * rig.motor.back_emf_constant);
    let share = found / possible;
    // A loaded motor turns more slowly than its back-EMF allows, never much faster: also at a thousandth of the voltage, if
    // that were meant.
    let guess = if share > 300.0 {
        "is u in kV, or are the angles in degrees and u in another unit? They must be V and rad"
    } else if share > 3.0 {
        "are all angles in degrees, or is u a share of the supply voltage? They must be in rad and rad/s, u in V"
    } else if share < 0.0013 {
        "is u in mV? It must be in V"
    } else {
        return Ok(());
    };
    Err(RecordProblem::Speed {
        file: file.to_owned(),
        voltage,
        possible,
        found,
        guess: guess.to_owned(),
    })
}

fn check_force(file: &str, stretches: &[Stretch], sensors: &Sensors) -> Result<(), RecordProblem> {
    let force = |of: fn(f64) -> f64| mean(stretches, 1, of);
    let (level, size) = (force(|v| v), force(f64::abs));
    let largest = stretches
        .iter()
        .flat_map(|s| s.columns[1].iter())
        .fold(0.0_f64, |a, b| a.max(b.abs()));
    let steps: Vec<f64> = stretches
        .iter()
        .flat_map(|s| {
            s.columns[1]
                .windows(2)
                .map(|pair| (pair[1] - pair[0]).abs())
        })
        .collect();
    let scatter = steps.iter().sum::<f64>() / steps.len().max(1) as f64;
    let guess = if largest > LARGEST_FORCE {
        "is it in mN or g? It must be in N"
    } else if level < -3.0 * sensors.load_cell_noise {
        "does it count pulling as positive? Pressing must be positive, and a pin cannot pull"
    } else if size > 0.0 && largest < sensors.load_cell_noise && scatter < 0.1 * level {
        // A level that stands out of its own scatter, but is less than the load cell can tell from nothing.
        "is it in kN? It must be in N; smaller forces than the load cell's noise cannot be read"
    } else {
        return Ok(());
    };
    Err(RecordProblem::Force {
        file: file.to_owned(),
        mean: level,
        guess,
    })
}

/// Mean over all samples of a column, each put through `of`.
fn mean(stretches: &[Stretch], column: usize, of: fn(f64) -> f64) -> f64 {
    let count: usize = stretches.iter().map(|s| s.time.len()).sum();
    let sum: f64 = stretches
        .iter()
        .flat_map(|s| s.columns[column].iter())
        .map(|v| of(*v))
        .sum();
    sum / count as f64
}

/// Which of an angle and its velocity stands still while the other moves, and the one that moves.
fn dead(
    stretches: &[Stretch],
    (angle, angle_at): (&'static str, usize),
    (rate, rate_at): (&'static str, usize),
) -> Option<(&'static str, &'static str)> {
    let path = |at: usize| {
        stretches
            .iter()
            .map(|s| {
                let (low, high) = s.columns[at]
                    .iter()
                    .fold((f64::MAX, f64::MIN), |(low, high), v| {
                        (low.min(*v), high.max(*v))
                    });
                high - low
            })
            .sum::<f64>()
    };
    let travelled: f64 = stretches
        .iter()
        .map(|s| {
            s.columns[rate_at]
                .iter()
                .zip(s.time.windows(2))
                .map(|(v, t)| v * (t[1] - t[0]))
                .sum::<f64>()
                .abs()
        })
        .sum();
    if path(angle_at) == 0.0 && travelled > CLEAR_TURN {
        Some((angle, rate))
    } else if path(rate_at) == 0.0
        && path(angle_at) > CLEAR_TURN
        && travelled < 0.1 * path(angle_at)
    {
        Some((rate, angle))
    } else {
        None
    }
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

/// When the angle first jumps back by a turn while the motion goes on.
fn wrap(stretches: &[Stretch], angle: usize, rate: usize) -> Option<f64> {
    stretches.iter().find_map(|stretch| {
        let (theta, omega) = (&stretch.columns[angle], &stretch.columns[rate]);
        let row = (1..theta.len()).find(|&j| {
            let jump = theta[j] - theta[j - 1];
            let by_a_turn = (jump.abs() - TAU).abs() < 0.7 || (jump.abs() - 360.0).abs() < 40.0;
            by_a_turn && jump * omega[j] < 0.0
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
        (1e-6, "is `time` in µs? It must be in s".to_owned()),
        (60.0, "is `time` in minutes? It must be in s".to_owned()),
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
