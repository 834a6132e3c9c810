//! Where what is left has structure: a free torque on the disc or the motor as a function of one coordinate after the other,
//! entered as one more hypothesis and judged by its log evidence.

use crate::data::{Data, grams, reduced};
use crate::evidence::Told;
use crate::fit::Fit;
use crate::gram::{Gram, Place};
use crate::loss;
use crate::marginal::{Disturbance, Reduced};
use crate::scales::Scales;
use nalgebra::{Cholesky, DMatrix};

/// Standard deviation a priori of a free torque, as a share of the friction torque.
const PRIOR: f64 = 0.1;
/// Frequencies that are looked at together.
const TOGETHER: usize = 8;
/// Step between frequencies, in frequencies of the shaft.
const FREQUENCY_STEP: f64 = 0.06;
/// Bands of frequencies.
const BANDS: usize = 12;

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
    /// Disc torque at fixed frequencies from this multiple of the shaft's on, eight in a row.
    Frequency(f64),
}

impl Coordinate {
    /// All families.
    #[must_use]
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
        let width = TOGETHER as f64 * FREQUENCY_STEP;
        all.extend((0..BANDS).map(|j| Self::Frequency(0.25 + width * j as f64)));
        all
    }

    /// Name in findings.
    #[must_use]
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
    #[must_use]
    pub fn equation(self) -> &'static str {
        match self {
            Self::Twist => "shaft",
            Self::MotorState | Self::MotorTime | Self::MotorAngle => "motor",
            _ => "disc",
        }
    }

    /// Band of frequencies, in radians per unit of time.
    #[must_use]
    pub fn band(self) -> Option<[f64; 2]> {
        match self {
            Self::Frequency(first) => Some([first, first + FREQUENCY_STEP * (TOGETHER - 1) as f64]),
            _ => None,
        }
    }

    /// Values of the family's functions at a place, of the order of one, as (disc, motor) torques.
    fn functions(self, place: &Place, scales: &Scales, ratio: f64) -> Vec<(f64, f64)> {
        let slides = if place.sliding {
            place.speed.signum()
        } else {
            0.0
        };
        let friction = place.friction / scales.torque;
        let disc = |values: Vec<f64>| values.into_iter().map(|v| (v, 0.0)).collect();
        let motor = |values: Vec<f64>| values.into_iter().map(|v| (0.0, v)).collect();
        match self {
            Self::Speed => {
                let knots = [0.0, 0.06, 0.12, 0.25, 0.4, 0.6, 0.8, 1.0];
                disc(hats(place.speed.abs() / scales.speed, &knots, slides))
            }
            Self::Alpha => {
                let mut values = Vec::new();
                for order in 1..=3 {
                    let (s, c) = (f64::from(order) * place.alpha).sin_cos();
                    values.extend([slides * friction * c, slides * friction * s]);
                }
                disc(values)
            }
            Self::Acceleration => {
                let a = place.acceleration / scales.acceleration;
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
                let n = if scales.load > 0.0 {
                    place.normal_force / scales.load
                } else {
                    0.0
                };
                disc(vec![
                    slides,
                    slides * n,
                    slides * n * n,
                    slides * n.max(0.0).sqrt(),
                ])
            }
            Self::Time => {
                let t = 2.0 * place.time / scales.duration - 1.0;
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
                let s = place.twist / scales.twist;
                [s, s * s, s * s * s, s.signum()]
                    .iter()
                    .map(|v| (-v, *v))
                    .collect()
            }
            Self::MotorState => {
                let (w, i) = (
                    place.gear_speed / scales.speed,
                    place.current / scales.current,
                );
                motor(vec![1.0, w, w * w, i, i * i, w * i])
            }
            Self::MotorTime => {
                let t = 2.0 * place.time / scales.duration - 1.0;
                let i = place.current / scales.current;
                motor(vec![t, t * t, t * i, t * t * i])
            }
            Self::MotorAngle => {
                let (s, c) = (ratio * place.gear_angle).sin_cos();
                motor(vec![c, s])
            }
            Self::Frequency(first) => {
                let mut values = Vec::new();
                for j in 0..TOGETHER {
                    let (s, c) = ((first + FREQUENCY_STEP * j as f64) * place.time).sin_cos();
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

/// How much a free torque over one coordinate explains.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure {
    /// The coordinate.
    pub coordinate: Coordinate,
    /// Gain in log evidence over the model without it.
    pub gain: f64,
}

/// Structure that `fit` leaves, strongest first.
#[must_use]
pub fn structures(data: &Data, fit: &Fit) -> Vec<Structure> {
    let data = &data.clone().with_motor_torques();
    let own = grams(data, &fit.hypothesis, &fit.starts);
    let Some(without) = linear_evidence(data, fit, &own, &fit.disturbance, 0) else {
        return Vec::new();
    };
    let mut found: Vec<Structure> = Coordinate::all()
        .into_iter()
        .map(|coordinate| {
            let ratio = fit.hypothesis.rig.gearbox.ratio;
            let grams: Vec<Option<Gram>> = own
                .iter()
                .map(|gram| {
                    let size = PRIOR * data.scales.torque;
                    let functions = |place: &Place| {
                        let values = coordinate.functions(place, &data.scales, ratio);
                        let sized = |(disc, motor): (f64, f64)| (size * disc, size * motor);
                        values.into_iter().map(sized).collect()
                    };
                    gram.as_ref().map(|g| augment(g, functions))
                })
                .collect();
            let extra = grams
                .iter()
                .flatten()
                .next()
                .map_or(0, |g| g.residual() - g.free())
                .saturating_sub(fit.hypothesis.dimension());
            Structure {
                coordinate,
                gain: linear_evidence(data, fit, &grams, &fit.disturbance, extra)
                    .map_or(f64::NEG_INFINITY, |with| with.gain_over(&without)),
            }
        })
        .collect();
    found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    found
}

/// Log evidence at the best values of the quadratic forms, with `extra` further free numbers of standard deviation one.
pub(crate) fn linear_evidence(
    data: &Data,
    fit: &Fit,
    grams: &[Option<Gram>],
    disturbance: &Disturbance,
    extra: usize,
) -> Option<Told> {
    let forms = reduced(data, &fit.starts, grams, disturbance);
    let mut precisions = fit.hypothesis.prior_precisions();
    let mut x = fit.hypothesis.x.clone();
    precisions.extend(std::iter::repeat_n(1.0, extra));
    x.extend(std::iter::repeat_n(0.0, extra));
    evidence(data, &forms, &precisions, &x)
}

/// Log evidence at the best values of quadratic forms in numbers that are `x` and have these precisions a priori.
pub(crate) fn evidence(
    data: &Data,
    forms: &[Option<Reduced>],
    precisions: &[f64],
    x: &[f64],
) -> Option<Told> {
    let (curvature, gradient) = loss::normal_equations(forms.iter().flatten(), precisions, x);
    let cholesky = Cholesky::new(curvature)?;
    let step = cholesky.solve(&gradient);
    let windows = forms
        .iter()
        .flatten()
        .map(|form| {
            let square =
                form.square - 2.0 * form.gradient.dot(&step) + step.dot(&(&form.curvature * &step));
            -0.5 * (loss::of_square(square.max(0.0), form.residuals) + form.log_determinant)
        })
        .collect();
    let prior: f64 = precisions
        .iter()
        .zip(x)
        .zip(step.iter())
        .map(|((p, x), d)| p * (x + d).powi(2) - p.ln())
        .sum();
    let volume: f64 = 2.0
        * cholesky
            .l_dirty()
            .diagonal()
            .iter()
            .map(|d| d.ln())
            .sum::<f64>();
    let run = data.windows.iter().zip(forms);
    let run = run.filter(|(_, form)| form.is_some());
    Some(Told {
        windows,
        is_start_known: run.map(|(window, _)| window.is_start_known()).collect(),
        numbers: -0.5 * (prior + volume),
    })
}

/// The Gram matrix with further free numbers: how much of each of the torques on disc and, where there are any, motor that
/// `functions` has at a place.
pub(crate) fn augment(gram: &Gram, functions: impl Fn(&Place) -> Vec<(f64, f64)>) -> Gram {
    let functions: Vec<Vec<(f64, f64)>> = gram.places.iter().map(functions).collect();
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
            map[(gram.disc() + piece, residual + b)] = *disc;
            if let Some(first) = gram.motor() {
                map[(first + piece, residual + b)] = *motor;
            }
        }
    }
    let products = map.transpose() * &gram.products * &map;
    Gram {
        products,
        ..gram.clone()
    }
}
