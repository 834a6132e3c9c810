//! Whether the columns of a record are in the units they should have, told by their scales.

use std::f64::consts::{PI, TAU};

use stickslip::friction::Law;
use stickslip::plant::Rig;

use super::record_check::{RecordProblem, Stretch, natural_period};

/// How far the ratio of two scales may be off the one expected.
const SCALE_TOLERANCE: f64 = 0.05;
/// Number of samples over which an angle's change is compared with its velocity.
const SPAN: usize = 10;
/// Friction torque over the motor's largest beyond which, and below which, a normal force contradicts the rig.
const CONTRADICTION: (f64, f64) = (1e-3, 30.0);
/// Way that the shaft must have gone for its twist not to matter, in the twist that friction and the motion bring about, and
/// how far the ratio of its ends' ways may be off.
const CLEAR_WAY: f64 = 4.0;
const SHAFT_TOLERANCE: f64 = 0.3;
/// Change of an angle from which on its velocity must have been seen [rad]: a good part of a turn.
const CLEAR_TURN: f64 = 1.0;
/// Share of the mean of what goes on by which a column's scatter hides it.
const HIDDEN: f64 = 0.1;

/// Compares the scales of angles and velocities, of speed and voltage, and of the normal force with what the rig allows.
///
/// # Errors
/// [`RecordProblem`] that asks which unit was meant.
pub fn check_units(file: &str, stretches: &[Stretch], rig: &Rig<f64>) -> Result<(), RecordProblem> {
    check_angles(file, stretches, rig.gearbox.ratio)?;
    check_shaft(file, stretches, rig)?;
    check_speed(file, stretches, rig)?;
    check_force(file, stretches, rig)
}

/// Largest torque that the motor can hold its gearbox output with under the voltages of a record [N m].
fn stall_torque(stretches: &[Stretch], rig: &Rig<f64>) -> f64 {
    let voltage = largest(stretches, 0);
    voltage * rig.motor.torque_constant * rig.gearbox.ratio / rig.motor.resistance
}

/// Friction torque of the analyst's law under a normal force [N m]; 0 for a law that is none of the force.
fn friction_torque(force: f64, rig: &Rig<f64>) -> f64 {
    match rig.law {
        Law::TwoGaussianTorque(_) => 0.0,
        _ => rig.law.breakaway() * rig.contact.radius * force,
    }
}

fn largest(stretches: &[Stretch], column: usize) -> f64 {
    stretches
        .iter()
        .flat_map(|s| s.columns[column].iter())
        .fold(0.0_f64, |a, b| a.max(b.abs()))
}

/// Compares the scales of angles, velocities and time.
///
/// # Errors
/// As for [`check_units`].
pub fn check_angles(
    file: &str,
    stretches: &[Stretch],
    gear_ratio: f64,
) -> Result<(), RecordProblem> {
    for (column, rate, angle_at, rate_at) in [
        ("theta", "theta_dot", 2, 3),
        ("theta3", "theta3_dot", 4, 5),
        ("theta1", "theta1_dot", 7, 8),
    ] {
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
        let guess = guess(ratio, column, rate, gear_ratio);
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
fn check_shaft(file: &str, stretches: &[Stretch], rig: &Rig<f64>) -> Result<(), RecordProblem> {
    let way = |at: usize| -> f64 {
        stretches
            .iter()
            .filter_map(|s| Some(s.columns[at].last()? - s.columns[at].first()?))
            .sum()
    };
    let (disc, gear) = (way(2), way(4));
    let ratio = gear / disc;
    let twist = friction_torque(largest(stretches, 1), rig) / rig.shaft.stiffness
        + mean_speed(stretches).unwrap_or_default() * natural_period(rig) / TAU;
    let clear = (CLEAR_WAY * twist).max(TAU);
    // An angle in turns goes a sixth of its way.
    let way = disc.abs().max(gear.abs());
    if way < clear || disc == 0.0 || gear == 0.0 || (ratio - 1.0).abs() < SHAFT_TOLERANCE {
        return Ok(());
    }
    let near = |expected: f64| (ratio / expected - 1.0).abs() < SHAFT_TOLERANCE;
    let guess = if near(rig.gearbox.ratio) {
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
        "which units are they in? They must be rad and rad/s of disc D2 and of the gearbox output. If a coupling slips or a sensor does not follow, leave that record out"
    };
    Err(RecordProblem::Shaft {
        file: file.to_owned(),
        ratio,
        guess,
    })
}

fn check_speed(file: &str, stretches: &[Stretch], rig: &Rig<f64>) -> Result<(), RecordProblem> {
    let voltage = mean(stretches, 0, f64::abs);
    let volts_per_speed = rig.gearbox.ratio * rig.motor.back_emf_constant;
    if is_still(stretches) {
        return Err(RecordProblem::NoMotion {
            file: file.to_owned(),
        });
    }
    let Some(found) = mean_speed(stretches) else {
        return Ok(());
    };
    let possible = voltage / volts_per_speed;
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

/// Mean speed [rad/s] by the tachometer or the encoder of the gearbox output, or else of the disc.
fn mean_speed(stretches: &[Stretch]) -> Option<f64> {
    let has = |at: usize| stretches.iter().all(|s| !s.columns[at].is_empty());
    let by_way = |at: usize| {
        let (way, time) = stretches.iter().fold((0.0, 0.0), |(way, time), s| {
            let angle = &s.columns[at];
            let path: f64 = angle.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
            (way + path, time + s.time[s.time.len() - 1] - s.time[0])
        });
        way / time
    };
    [5, 4, 3, 2].into_iter().find(|at| has(*at)).map(|at| {
        if at % 2 == 1 {
            mean(stretches, at, f64::abs)
        } else {
            by_way(at)
        }
    })
}

/// Whether nothing moves: no angle changes, and no velocity is more than what it scatters from sample to sample.
fn is_still(stretches: &[Stretch]) -> bool {
    (2..6).all(|at| {
        let values = || stretches.iter().flat_map(|s| s.columns[at].iter());
        let (low, high) = values().fold((f64::MAX, f64::MIN), |(low, high), v| {
            (low.min(*v), high.max(*v))
        });
        if at % 2 == 0 {
            // A step of an encoder that the shaft rests on may be gone back and forth.
            let steps = stretches
                .iter()
                .flat_map(|s| {
                    s.columns[at]
                        .windows(2)
                        .map(|pair| (pair[1] - pair[0]).abs())
                })
                .filter(|step| *step > 0.0)
                .fold(f64::MAX, f64::min);
            return low >= high || high - low <= 1.5 * steps;
        }
        let size = mean(stretches, at, f64::abs);
        // The mean size of a difference of two samples is √2 times that of noise alone.
        low >= high || size < scatter(stretches, at)
    })
}

/// Mean size of the differences from sample to sample.
fn scatter(stretches: &[Stretch], at: usize) -> f64 {
    let (sum, count) = stretches
        .iter()
        .flat_map(|s| s.columns[at].windows(2))
        .fold((0.0, 0.0), |(sum, count), pair| {
            (sum + (pair[1] - pair[0]).abs(), count + 1.0_f64)
        });
    sum / count.max(1.0)
}

fn check_force(file: &str, stretches: &[Stretch], rig: &Rig<f64>) -> Result<(), RecordProblem> {
    let level = mean(stretches, 1, |v| v);
    let is_clear = scatter(stretches, 1) < HIDDEN * level.abs();
    let share = |force: f64| friction_torque(force, rig) / stall_torque(stretches, rig);
    let has_brake = friction_torque(1.0, rig) > 0.0;
    let guess = if share(largest(stretches, 1)) > CONTRADICTION.1 {
        "with it the friction torque is far beyond what the motor can turn against: is it in mN or g? It must be in N"
    } else if level < 0.0 && is_clear {
        "does it count pulling as positive? Pressing must be positive, and a pin cannot pull"
    } else if has_brake && is_clear && share(level) < CONTRADICTION.0 {
        "with it the friction torque is nothing to the motor: is it in kN? It must be in N"
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
    if stretches
        .iter()
        .any(|s| s.columns[angle_at].is_empty() || s.columns[rate_at].is_empty())
    {
        return None;
    }
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
    let (mut cross, mut square, mut noise) = (0.0, 0.0, 0.0);
    if stretches
        .iter()
        .any(|s| s.columns[angle].is_empty() || s.columns[rate].is_empty())
    {
        return None;
    }
    let noise_of_rate = scatter(stretches, rate);
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
            let step = (time[row + SPAN] - time[row]) / SPAN as f64;
            noise += SPAN as f64 * (noise_of_rate * step).powi(2);
            row += SPAN;
        }
    }
    // Where a tachometer's noise makes up the integral, it says nothing about the scale.
    (square > 30.0 * noise && cross != 0.0).then(|| cross / square)
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
fn guess(ratio: f64, angle: &str, rate: &str, gear_ratio: f64) -> String {
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
            gear_ratio,
            "is it on the motor's side of the gearbox? It must be at the gearbox output".to_owned(),
        ),
        (
            1.0 / gear_ratio,
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
            || "no units differ so: does one of the two instruments have another scale? Put it right, or leave one of the two columns out".to_owned(),
            |(_, text)| text,
        )
}
