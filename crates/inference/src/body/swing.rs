//! Pendulum and joint: the motion that the model predicts from the start of a stretch against the angle that was read.
//!
//! Each stretch starts from the state from which the model follows its readings best; in between the model runs alone.
//! Steps are those of Runge and Kutta's fourth order, ended exactly where the direction of motion turns, so that dry
//! friction costs no accuracy. A joint stands still again and again: it goes by the implicit midpoint rule that lets it stick
//! ([`operations::Coupling`]), under the mean voltage of each step.

use nalgebra::{Matrix2, Vector2};

use operations::{Coupling, Guess, Moment};

use super::balance::Balance;
use super::known::Known;
use super::model::{Acting, Model};
use super::motion::{Measurement, Motion, Scales};
use super::problem::Problem;
use super::term::Sample;
use stickslip::body::Kind;

/// Length of a piece in periods.
const PIECE: f64 = 2.0;
/// Most times that a stretch's start is improved.
const START_STEPS: usize = 4;
/// Stretches of a joint that are run side by side; it changes no angle.
const AT_ONCE: usize = 8;
/// Share of its usual size by which a number is moved to see what that does.
const NUDGE: f64 = 1e-5;

/// A stretch of readings.
#[derive(Debug, Clone)]
struct Stretch {
    /// Time of its first reading since the record's start [s].
    begin: f64,
    step: f64,
    readings: Vec<f64>,
    /// Mean voltage over the step after each reading [V], and the share of it in which the motor's terminals are connected.
    driven: Vec<(f64, f64)>,
    /// Angle and rate read at its start.
    start: [f64; 2],
}

/// Readings of a swing in stretches.
#[derive(Debug, Clone)]
pub struct Swing {
    stretches: Vec<Stretch>,
    /// Readings of a piece.
    piece: usize,
    /// By how much angle and rate of a start are moved to see what that does.
    nudge: [f64; 2],
    folds: Vec<usize>,
    /// Balance of forces of the same records, where fits start from that.
    forces: Option<Balance>,
    /// Numbers that were known before.
    known: Vec<Known>,
}

impl Swing {
    /// Each record as one stretch: the free run.
    #[must_use]
    pub fn whole(records: &[Motion], measurement: &Measurement, scales: &Scales) -> Self {
        Self::cut(records, measurement, scales, f64::INFINITY)
    }

    /// All records cut into stretches of one piece each. Where a run sticks jumps with its numbers, so that fits start from the
    /// balance of forces.
    #[must_use]
    pub fn pieces(records: &[Motion], measurement: &Measurement, scales: &Scales) -> Self {
        Self {
            forces: Some(Balance::new(records, measurement, scales)),
            ..Self::cut(records, measurement, scales, PIECE * scales.period)
        }
    }

    /// All records cut into stretches of about this length [s].
    #[must_use]
    pub fn cut(
        records: &[Motion],
        measurement: &Measurement,
        scales: &Scales,
        length: f64,
    ) -> Self {
        let mut stretches = Vec::new();
        for record in records {
            let stride = (1.0 / (measurement.compare_rate * record.interval))
                .round()
                .max(1.0) as usize;
            let indices: Vec<usize> = (0..record.len()).step_by(stride).collect();
            let step = record.interval * stride as f64;
            let count = (record.seconds() / length).round().max(1.0) as usize;
            for part in indices.chunks(indices.len().div_ceil(count)) {
                let first = part[0];
                stretches.push(Stretch {
                    begin: first as f64 * record.interval,
                    step,
                    readings: part.iter().map(|&at| record.reading[at]).collect(),
                    driven: part.iter().map(|&at| driven(record, at, stride)).collect(),
                    start: [record.position[first], record.velocity[first]],
                });
            }
        }
        let step = stretches.first().map_or(1.0, |stretch| stretch.step);
        let piece = ((PIECE * scales.period / step).round() as usize).max(1);
        let pieces = |(at, stretch): (usize, &Stretch)| {
            // A stretch a little longer than a piece is one piece.
            vec![at; (stretch.readings.len() / piece).max(1)]
        };
        Self {
            folds: stretches.iter().enumerate().flat_map(pieces).collect(),
            piece,
            forces: None,
            known: Vec::new(),
            nudge: [NUDGE * scales.position, NUDGE * scales.speed],
            stretches,
        }
    }

    /// The same where these numbers were known before.
    #[must_use]
    pub fn knowing(mut self, known: &[Known]) -> Self {
        self.forces = self.forces.map(|forces| forces.knowing(known));
        self.known = known.to_vec();
        self
    }

    /// The model's run through the first stretch, from the start that fits its first `fitted` readings best, and on for
    /// `count` steps in all [rad].
    #[must_use]
    pub fn run(&self, model: &Model, fitted: usize, count: usize) -> Vec<f64> {
        self.stretches.first().map_or_else(Vec::new, |stretch| {
            if model.kind == Kind::Joint {
                let angles = turn(model, &[stretch], count);
                return angles.into_iter().map(|[angle]| angle).collect();
            }
            let known = &stretch.readings[..fitted.min(stretch.readings.len())];
            let start = best_start(model, stretch, known, self.nudge);
            simulate(model, stretch, start, count)
        })
    }

    /// The model's run through each stretch: of a pendulum from the start that fits best; of a joint, whose friction forgets the start,
    /// from the one that was read.
    fn runs(&self, model: &Model) -> Vec<Vec<f64>> {
        if model.kind != Kind::Joint {
            let runs = self.stretches.iter().map(|stretch| {
                let start = best_start(model, stretch, &stretch.readings, self.nudge);
                simulate(model, stretch, start, stretch.readings.len())
            });
            return runs.collect();
        }
        let mut runs = Vec::with_capacity(self.stretches.len());
        let alike = self.stretches.chunk_by(|one, next| one.step == next.step);
        for group in alike.flat_map(|own| own.chunks(AT_ONCE)) {
            let lanes =
                std::array::from_fn::<_, AT_ONCE, _>(|lane| &group[lane.min(group.len() - 1)]);
            let longest = group
                .iter()
                .map(|own| own.readings.len())
                .max()
                .unwrap_or(0);
            let angles = turn(model, &lanes, longest);
            runs.extend(group.iter().enumerate().map(|(lane, own)| {
                let angles = angles.iter().take(own.readings.len());
                angles.map(|all| all[lane]).collect::<Vec<f64>>()
            }));
        }
        runs
    }

    /// All readings [rad].
    #[must_use]
    pub fn readings(&self) -> Vec<f64> {
        self.stretches
            .iter()
            .flat_map(|stretch| stretch.readings.iter().copied())
            .collect()
    }

    /// Time between readings [s].
    #[must_use]
    pub fn time_step(&self) -> f64 {
        self.stretches.first().map_or(0.0, |stretch| stretch.step)
    }

    /// Number of readings of the first stretch.
    #[must_use]
    pub fn first_length(&self) -> usize {
        self.stretches
            .first()
            .map_or(0, |stretch| stretch.readings.len())
    }
}

impl Problem for Swing {
    fn residuals(&self, model: &Model) -> Vec<Vec<f64>> {
        let mut pieces = Vec::with_capacity(self.folds.len());
        for (stretch, run) in self.stretches.iter().zip(self.runs(model)) {
            let count = stretch.readings.len();
            let residuals: Vec<f64> = stretch
                .readings
                .iter()
                .zip(run)
                .map(|(y, x)| y - x)
                .collect();
            let parts = (count / self.piece).max(1);
            for part in 0..parts {
                pieces.push(residuals[part * count / parts..(part + 1) * count / parts].to_vec());
            }
        }
        pieces
    }

    fn first_look(&self) -> Option<&dyn Problem> {
        self.forces.as_ref().map(|forces| forces as &dyn Problem)
    }

    fn known(&self) -> &[Known] {
        &self.known
    }

    fn folds(&self) -> &[usize] {
        &self.folds
    }
}

/// Angle and rate from which the model follows the readings best.
fn best_start(model: &Model, stretch: &Stretch, readings: &[f64], nudge: [f64; 2]) -> [f64; 2] {
    let count = readings.len();
    let run = |start: [f64; 2]| simulate(model, stretch, start, count);
    let misfit =
        |run: &[f64]| -> f64 { readings.iter().zip(run).map(|(y, x)| (y - x).powi(2)).sum() };
    let mut start = stretch.start;
    let mut course = run(start);
    let mut loss = misfit(&course);
    for _ in 0..START_STEPS {
        let moved = [
            run([start[0] + nudge[0], start[1]]),
            run([start[0], start[1] + nudge[1]]),
        ];
        let (mut normal, mut pull) = (Matrix2::zeros(), Vector2::zeros());
        for (at, reading) in readings.iter().enumerate() {
            let slope = Vector2::new(
                (moved[0][at] - course[at]) / nudge[0],
                (moved[1][at] - course[at]) / nudge[1],
            );
            normal += slope * slope.transpose();
            pull += slope * (reading - course[at]);
        }
        let Some(step) = normal.try_inverse().map(|inverse| inverse * pull) else {
            break;
        };
        let next = [start[0] + step[0], start[1] + step[1]];
        let next_course = run(next);
        let next_loss = misfit(&next_course);
        if !next_loss.is_finite() || next_loss > loss * (1.0 - 1e-6) {
            break;
        }
        (start, course, loss) = (next, next_course, next_loss);
    }
    start
}

/// Mean voltage and share of connection over `stride` samples after `at`, which go straight from one to the next.
fn driven(record: &Motion, at: usize, stride: usize) -> (f64, f64) {
    let last = record.len() - 1;
    let (mut voltage, mut connected) = (0.0, 0.0);
    for from in at..at + stride {
        let (from, to) = (from.min(last), (from + 1).min(last));
        voltage += 0.5 * (record.voltage[from] + record.voltage[to]);
        connected += 0.5 * (record.connected[from] + record.connected[to]);
    }
    (voltage / stride as f64, connected / stride as f64)
}

/// Angles of a joint that runs alone through each of these stretches, of the same step, under the measured voltage.
fn turn<const LANES: usize>(
    model: &Model,
    stretches: &[&Stretch; LANES],
    count: usize,
) -> Vec<[f64; LANES]> {
    let acting = model.at_port(0);
    let length = stretches[0].step;
    let mut state = stretches.map(|own| own.start);
    let mut angles = Vec::with_capacity(count);
    let mut last = [Guess::new(0.0); LANES];
    for at in 0..count {
        angles.push(state.map(|[position, _]| position));
        let from: [Moment; LANES] = std::array::from_fn(|lane| Moment {
            time: stretches[lane].begin + at as f64 * length,
            position: state[lane][0],
            velocity: state[lane][1],
            acceleration: 0.0,
            direction: 0.0,
        });
        // A stretch that has ended runs on with open terminals.
        let driven = stretches.map(|own| own.driven.get(at).copied().unwrap_or_default());
        let against = |moments: &[Moment; LANES]| {
            acting.forces(&std::array::from_fn(|lane| {
                let moment = &moments[lane];
                let (voltage, connected) = driven[lane];
                Sample {
                    time: moment.time,
                    position: moment.position,
                    velocity: moment.velocity,
                    acceleration: moment.acceleration,
                    direction: moment.direction,
                    load: 1.0,
                    voltage,
                    connected,
                    ..Sample::default()
                }
            }))
        };
        let mut coupling = Coupling {
            against,
            inertia: 1.0,
        };
        last = coupling.force(&from, length, [0.0; LANES], last);
        for ([position, velocity], Guess { force, .. }) in state.iter_mut().zip(last) {
            *position += length * (*velocity + 0.5 * length * force);
            *velocity += length * force;
        }
    }
    angles
}

/// Angles that are read while the model runs alone from a start.
fn simulate(model: &Model, stretch: &Stretch, start: [f64; 2], count: usize) -> Vec<f64> {
    let encoder = model.eccentricity();
    let acting = model.at_port(0);
    let mut state = start;
    let mut angles = Vec::with_capacity(count);
    for at in 0..count {
        angles.push(encoder.map_or(state[0], |encoder| encoder.reading(state[0])));
        state = step(
            &acting,
            state,
            stretch.begin + at as f64 * stretch.step,
            stretch.step,
        );
    }
    angles
}

/// One step of time; the direction of motion that friction opposes is held until it turns.
fn step(acting: &Acting<'_>, state: [f64; 2], time: f64, length: f64) -> [f64; 2] {
    // At a standstill it moves where the forces without friction push it.
    let direction = if state[1] == 0.0 {
        acceleration(acting, state, time, 0.0).signum()
    } else {
        state[1].signum()
    };
    let next = runge_kutta(acting, state, time, length, direction);
    if next[1] * direction >= 0.0 || state[1] == 0.0 {
        return next;
    }
    // The rate is nearly straight over a step: two corrections put its zero within rounding.
    let mut part = length * state[1] / (state[1] - next[1]);
    for _ in 0..2 {
        let there = runge_kutta(acting, state, time, part, direction);
        let slope = acceleration(acting, there, time + part, direction);
        if slope != 0.0 {
            part = (part - there[1] / slope).clamp(0.0, length);
        }
    }
    let turn = runge_kutta(acting, state, time, part, direction);
    runge_kutta(
        acting,
        [turn[0], 0.0],
        time + part,
        length - part,
        -direction,
    )
}

fn runge_kutta(
    acting: &Acting<'_>,
    state: [f64; 2],
    time: f64,
    h: f64,
    direction: f64,
) -> [f64; 2] {
    let slope = |x: f64, v: f64, t: f64| acceleration(acting, [x, v], t, direction);
    let [x, v] = state;
    let k1 = slope(x, v, time);
    let k2 = slope(x + 0.5 * h * v, v + 0.5 * h * k1, time + 0.5 * h);
    let k3 = slope(
        x + 0.5 * h * (v + 0.5 * h * k1),
        v + 0.5 * h * k2,
        time + 0.5 * h,
    );
    let k4 = slope(x + h * (v + 0.5 * h * k2), v + h * k3, time + h);
    [
        x + h * v + h * h / 6.0 * (k1 + k2 + k3),
        v + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4),
    ]
}

fn acceleration(acting: &Acting<'_>, state: [f64; 2], time: f64, direction: f64) -> f64 {
    let [force] = acting.forces(&[Sample {
        time,
        position: state[0],
        velocity: state[1],
        acceleration: 0.0,
        direction,
        load: 1.0,
        ..Sample::default()
    }]);
    -force
}
