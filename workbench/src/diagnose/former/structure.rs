//! Where what is left has structure: residual torques on the disc and on the motor as functions of
//! one coordinate after the other, judged on windows they were not fitted to.

use super::data::{Data, reduced};
use super::fit::Fit;
use super::gain::{folds, gain};
use super::gram::{Gram, Place};
use super::losses::held_out_losses;
use super::robust::Robust;
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Standard deviation of the torques that a residual function may have a priori [N m].
const PRIOR_TORQUE: f64 = 0.05;

/// A family of functions of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coordinate {
    /// Disc torque over the disc's speed.
    Speed,
    /// Disc torque over the phase-plane angle.
    Alpha,
    /// Disc torque over the disc's acceleration.
    Acceleration,
    /// Disc torque over the disc's angle, orders 1 to 3.
    DiscAngle,
    /// Disc torque over the normal force.
    NormalForce,
    /// Disc torque over time.
    Time,
    /// Shaft torque over the twist.
    Twist,
    /// Motor torque over speed and current.
    MotorState,
    /// Motor torque over time.
    MotorTime,
    /// Motor torque over the motor's angle, order 1.
    MotorAngle,
    /// Disc torque at fixed frequencies from this one [Hz] on, eight in a row.
    Frequency(f64),
}

/// Step between the frequencies that are looked at [Hz].
const FREQUENCY_STEP: f64 = 0.05;

impl Coordinate {
    /// All families.
    pub fn all() -> Vec<Self> {
        let mut all = vec![
            Self::Speed,
            Self::Alpha,
            Self::Acceleration,
            Self::DiscAngle,
            Self::NormalForce,
            Self::Time,
            Self::Twist,
            Self::MotorState,
            Self::MotorTime,
            Self::MotorAngle,
        ];
        all.extend((0..12).map(|j| Self::Frequency(0.2 + 8.0 * FREQUENCY_STEP * f64::from(j))));
        all
    }

    /// Name in findings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Alpha => "alpha",
            Self::Acceleration => "acceleration",
            Self::DiscAngle => "disc_angle",
            Self::NormalForce => "normal_force",
            Self::Time => "time",
            Self::Twist => "twist",
            Self::MotorState => "motor_speed_and_current",
            Self::MotorTime => "motor_time",
            Self::MotorAngle => "motor_angle",
            Self::Frequency(_) => "frequency",
        }
    }

    /// Which equation the torque belongs to.
    pub fn equation(self) -> &'static str {
        match self {
            Self::Twist => "shaft",
            Self::MotorState | Self::MotorTime | Self::MotorAngle => "motor",
            _ => "disc",
        }
    }

    /// Values of the family's functions at a place, as (disc, motor) torques of the size of
    /// [`PRIOR_TORQUE`].
    fn functions(self, place: &Place) -> Vec<(f64, f64)> {
        let slides = if place.sliding {
            place.speed.signum()
        } else {
            0.0
        };
        let friction = place.friction / 0.5;
        let disc = |values: Vec<f64>| {
            values
                .into_iter()
                .map(|v| (PRIOR_TORQUE * v, 0.0))
                .collect()
        };
        let motor = |values: Vec<f64>| {
            values
                .into_iter()
                .map(|v| (0.0, PRIOR_TORQUE * v))
                .collect()
        };
        match self {
            Self::Speed => disc(hats(
                place.speed.abs(),
                &[0.0, 0.7, 1.5, 3.0, 5.0, 7.5, 10.0, 13.0],
                slides,
            )),
            Self::Alpha => {
                let mut values = Vec::new();
                for order in 1..=3 {
                    let (s, c) = (f64::from(order) * place.alpha).sin_cos();
                    values.extend([slides * friction * c, slides * friction * s]);
                }
                disc(values)
            }
            Self::Acceleration => {
                let a = place.acceleration / 30.0;
                disc(vec![a, slides * a.abs(), slides * a * a, a * a * a])
            }
            Self::DiscAngle => {
                let mut values = Vec::new();
                for order in 1..=3 {
                    let (s, c) = (f64::from(order) * place.disc_angle).sin_cos();
                    values.extend([c, s, slides * friction * c, slides * friction * s]);
                }
                disc(values)
            }
            Self::NormalForce => {
                let n = place.normal_force / 50.0;
                disc(vec![
                    slides,
                    slides * n,
                    slides * n * n,
                    slides * n.max(0.0).sqrt(),
                ])
            }
            Self::Time => {
                let t = place.time / 20.0 - 1.0;
                let f = slides * friction;
                disc(vec![
                    slides * t,
                    slides * t * t,
                    f * t,
                    f * t * t,
                    f * t * t * t,
                ])
            }
            Self::Twist => {
                let s = place.twist;
                [s, s * s, s * s * s, s.signum()]
                    .iter()
                    .map(|v| (-PRIOR_TORQUE * v, PRIOR_TORQUE * v))
                    .collect()
            }
            Self::MotorState => {
                let (w, i) = (place.gear_speed / 6.0, place.current / 3.0);
                motor(vec![1.0, w, w * w, i, i * i, w * i])
            }
            Self::MotorTime => {
                let (t, i) = (place.time / 20.0 - 1.0, place.current / 3.0);
                motor(vec![t, t * t, t * i, t * t * i])
            }
            Self::MotorAngle => {
                let (s, c) = (8.0 * place.gear_angle).sin_cos();
                motor(vec![c, s])
            }
            Self::Frequency(first) => {
                let mut values = Vec::new();
                for j in 0..8 {
                    let (s, c) =
                        (TAU * (first + FREQUENCY_STEP * f64::from(j)) * place.time).sin_cos();
                    values.extend([c, s]);
                }
                disc(values)
            }
        }
    }
}

/// Piecewise linear functions that are 1 at one knot and 0 at the others, times `factor`.
fn hats(x: f64, knots: &[f64], factor: f64) -> Vec<f64> {
    let mut values = vec![0.0; knots.len()];
    let last = knots.len() - 1;
    if x >= knots[last] {
        values[last] = factor;
        return values;
    }
    for j in 0..last {
        if x >= knots[j] && x < knots[j + 1] {
            let share = (x - knots[j]) / (knots[j + 1] - knots[j]);
            values[j] = (1.0 - share) * factor;
            values[j + 1] = share * factor;
        }
    }
    values
}

/// How much a residual torque over one coordinate explains.
#[derive(Clone, Debug)]
pub struct Structure {
    /// The coordinate.
    pub coordinate: Coordinate,
    /// Gain in ln likelihood on windows not fitted to.
    pub gain: f64,
    /// Interval that covers the gain with 95 % probability.
    pub interval95: [f64; 2],
}

/// Structure that `fit` leaves, strongest first.
pub fn structures(data: &Data, fit: &Fit) -> Vec<Structure> {
    let folds = folds(data);
    let base = fit.held_out_losses(data, &folds);
    let mut found: Vec<Structure> = Coordinate::all()
        .into_iter()
        .map(|coordinate| {
            let grams: Vec<Option<Gram>> = fit
                .grams
                .iter()
                .map(|gram| gram.as_ref().map(|g| augment(g, coordinate)))
                .collect();
            let forms = reduced(data, &fit.starts, &grams, &fit.disturbance);
            let mut precisions = fit.hypothesis.prior_precisions();
            let mut x = fit.hypothesis.x.clone();
            let extra = grams
                .iter()
                .flatten()
                .next()
                .map_or(0, |g| g.residual() - g.free())
                - x.len();
            precisions.extend(std::iter::repeat_n(1.0, extra));
            x.extend(std::iter::repeat_n(0.0, extra));
            let losses = held_out_losses(&forms, &precisions, &x, &folds, Robust::JUDGING);
            let gained = gain(&base, &losses);
            Structure {
                coordinate,
                gain: gained.total,
                interval95: gained.interval95,
            }
        })
        .collect();
    found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    found
}

/// The Gram matrix with the coefficients of a residual torque's functions as further free numbers.
fn augment(gram: &Gram, coordinate: Coordinate) -> Gram {
    let functions: Vec<Vec<(f64, f64)>> = gram
        .places
        .iter()
        .map(|place| coordinate.functions(place))
        .collect();
    let extra = functions.first().map_or(0, Vec::len);
    let old = gram.products.ncols();
    let residual = gram.residual();
    let mut map = DMatrix::zeros(old, old + extra);
    for j in 0..residual {
        map[(j, j)] = 1.0;
    }
    map[(residual, residual + extra)] = 1.0;
    for (piece, values) in functions.iter().enumerate() {
        for (b, (disc, motor)) in values.iter().enumerate() {
            map[(Gram::DISC + piece, residual + b)] = *disc;
            map[(gram.motor() + piece, residual + b)] = *motor;
        }
    }
    let products = map.transpose() * &gram.products * &map;
    Gram {
        products,
        ..gram.clone()
    }
}
