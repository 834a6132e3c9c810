//! Fits: damped Gauss–Newton steps (Levenberg, Marquardt) that keep the normal equations of every piece.
//!
//! The pieces' own normal equations are what cross-validation and robust intervals are made of, which is why no library
//! does this. Numbers that must be positive or between bounds are fitted through a transformation, so that no step leaves
//! their range.

use nalgebra::{DMatrix, DVector};
use stickslip::parameter::Range;

use super::evidence::unit;
use super::known::{self, deviations};
use super::model::Model;
use super::motion::Scales;
use super::problem::Problem;
use super::unit::Usual as _;

/// Step of the differences, in units of a number's usual size.
const STEP: f64 = 1e-5;
/// Share of the loss below which an improvement counts as none.
const SETTLED: f64 = 1e-9;
/// Damping beyond which no step is short enough.
const HOPELESS: f64 = 1e10;

/// A model fitted to records.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The model.
    pub model: Model,
    /// Its residuals, piece by piece.
    pub residuals: Vec<Vec<f64>>,
    /// Sum of squares of the residuals it was fitted to.
    pub loss: f64,
}

/// Transformed numbers and back.
struct Coordinates {
    places: Vec<(usize, usize, Range, f64)>,
}

impl Coordinates {
    fn new(model: &Model, scales: &Scales) -> Self {
        let places = model
            .free()
            .into_iter()
            .map(|(term, at, parameter)| {
                (term, at, parameter.range, parameter.dimension.scale(scales))
            })
            .collect();
        Self { places }
    }

    fn of(&self, model: &Model) -> Vec<f64> {
        self.places
            .iter()
            .map(|&(term, at, range, scale)| {
                let value = model.value(term, at);
                match range {
                    Range::Finite => value / scale,
                    Range::Positive => (value / scale).ln(),
                    Range::NonNegative => (value / scale).sqrt(),
                    Range::Between(low, high) => {
                        (std::f64::consts::PI * ((value - low) / (high - low) - 0.5)).tan()
                    }
                }
            })
            .collect()
    }

    /// How a number grows with its coordinate.
    fn slope(x: f64, range: Range, scale: f64) -> f64 {
        match range {
            Range::Finite => scale,
            Range::Positive => x.exp() * scale,
            // At zero too it must show that the number can grow.
            Range::NonNegative => (2.0 * x + STEP) * scale,
            Range::Between(low, high) => (high - low) / (std::f64::consts::PI * (1.0 + x * x)),
        }
    }

    /// The step, or that part of it in which no positive number changes by more than a factor of e: derivatives tell no more of it, and
    /// an effect whose width ran away has none.
    fn shortened(&self, step: DVector<f64>) -> DVector<f64> {
        let places = self.places.iter().zip(step.iter());
        let logarithms = places.filter(|((.., range, _), _)| *range == Range::Positive);
        let largest = logarithms.fold(1.0, |largest, (_, own)| own.abs().max(largest));
        step / largest
    }

    fn set(&self, model: &Model, coordinates: &[f64]) -> Model {
        let mut model = model.clone();
        for (&(term, at, range, scale), x) in self.places.iter().zip(coordinates) {
            let value = match range {
                Range::Finite => x * scale,
                Range::Positive => x.exp() * scale,
                Range::NonNegative => x * x * scale,
                Range::Between(low, high) => {
                    low + (high - low) * (0.5 + x.atan() / std::f64::consts::PI)
                }
            };
            model.set(term, at, value);
        }
        model
    }
}

/// Residuals and, as one piece more, deviations from what was known before.
fn errors(problem: &dyn Problem, model: &Model) -> Vec<Vec<f64>> {
    let mut all = problem.residuals(model);
    all.push(deviations(problem.known(), model));
    all
}

/// What each piece's squares count: those of the last, the deviations, as much as the noise that the model leaves.
fn counts(errors: &[Vec<f64>]) -> Vec<f64> {
    let mut counts = vec![1.0; errors.len()];
    if let (Some(count), Some((known, residuals))) = (counts.last_mut(), errors.split_last())
        && !known.is_empty()
    {
        *count = unit(residuals);
    }
    counts
}

/// Derivatives of the errors, piece by piece: one row per error, one column per free number.
fn jacobian(
    problem: &dyn Problem,
    coordinates: &Coordinates,
    model: &Model,
    residuals: &[Vec<f64>],
) -> Vec<DMatrix<f64>> {
    let x = coordinates.of(model);
    let mut pieces: Vec<DMatrix<f64>> = residuals
        .iter()
        .map(|piece| DMatrix::zeros(piece.len(), x.len()))
        .collect();
    for (column, &(term, number, range, scale)) in coordinates.places.iter().enumerate() {
        if let Some(mut slopes) = problem.slopes(model, residuals, (term, number)) {
            slopes.push(known::slopes(problem.known(), (term, number)));
            let scale = Coordinates::slope(x[column], range, scale);
            for (piece, slopes) in pieces.iter_mut().zip(&slopes) {
                for (row, slope) in slopes.iter().enumerate() {
                    piece[(row, column)] = slope * scale;
                }
            }
            continue;
        }
        let mut shifted = x.clone();
        shifted[column] += STEP;
        let moved = errors(problem, &coordinates.set(model, &shifted));
        for ((piece, before), after) in pieces.iter_mut().zip(residuals).zip(&moved) {
            for (row, (b, a)) in before.iter().zip(after).enumerate() {
                piece[(row, column)] = (a - b) / STEP;
            }
        }
    }
    pieces
}

/// Fits all free numbers of `model`, leaving out the pieces of fold `without`, in at most `steps` steps.
#[must_use]
pub fn fit(
    problem: &dyn Problem,
    model: &Model,
    scales: &Scales,
    without: Option<usize>,
    steps: usize,
) -> Fit {
    fit_from(problem, &Start::new(problem, model, scales), without, steps)
}

/// Where fits begin: a model with its errors and their derivatives. Fits that leave one fold after the other out share it.
pub struct Start {
    model: Model,
    coordinates: Coordinates,
    errors: Vec<Vec<f64>>,
    jacobian: Vec<DMatrix<f64>>,
}

impl Start {
    /// At `model`.
    #[must_use]
    pub fn new(problem: &dyn Problem, model: &Model, scales: &Scales) -> Self {
        let coordinates = Coordinates::new(model, scales);
        let errors = errors(problem, model);
        Self {
            model: model.clone(),
            jacobian: jacobian(problem, &coordinates, model, &errors),
            coordinates,
            errors,
        }
    }
}

/// As [`fit`], from where `start` is.
#[must_use]
pub fn fit_from(problem: &dyn Problem, start: &Start, without: Option<usize>, steps: usize) -> Fit {
    let coordinates = &start.coordinates;
    let used: Vec<bool> = problem
        .folds()
        .iter()
        .map(|fold| Some(*fold) != without)
        .chain([true])
        .collect();
    let loss = |errors: &[Vec<f64>], counts: &[f64]| -> f64 {
        let pieces = errors.iter().zip(counts).zip(&used);
        pieces
            .filter(|(_, used)| **used)
            .map(|((piece, count), _)| count * piece.iter().map(|r| r * r).sum::<f64>())
            .sum()
    };
    let mut best = Fit {
        model: start.model.clone(),
        residuals: start.errors.clone(),
        loss: 0.0,
    };
    best.loss = loss(&best.residuals, &counts(&best.residuals));
    let mut damping = 1e-3;
    for step in 0..steps {
        let further;
        let pieces = if step == 0 {
            &start.jacobian
        } else {
            further = jacobian(problem, coordinates, &best.model, &best.residuals);
            &further
        };
        let size = coordinates.places.len();
        let mut normal = DMatrix::zeros(size, size);
        let mut gradient = DVector::zeros(size);
        let counts = counts(&best.residuals);
        for (((jacobian, residuals), count), _) in pieces
            .iter()
            .zip(&best.residuals)
            .zip(&counts)
            .zip(&used)
            .filter(|(_, used)| **used)
        {
            normal += *count * jacobian.tr_mul(jacobian);
            gradient += *count * jacobian.tr_mul(&DVector::from_column_slice(residuals));
        }
        best.loss = loss(&best.residuals, &counts);
        let x = coordinates.of(&best.model);
        let before = best.loss;
        while damping < HOPELESS {
            if let Some(step) = damped_step(&normal, &gradient, damping) {
                let step = coordinates.shortened(step);
                let moved: Vec<f64> = x.iter().zip(step.iter()).map(|(x, dx)| x - dx).collect();
                let model = coordinates.set(&best.model, &moved);
                let residuals = errors(problem, &model);
                let loss = loss(&residuals, &counts);
                if loss < best.loss {
                    best = Fit {
                        model,
                        residuals,
                        loss,
                    };
                    damping = (0.2 * damping).max(1e-12);
                    break;
                }
            }
            damping *= 6.0;
        }
        if best.loss > before * (1.0 - SETTLED) {
            break;
        }
    }
    best.residuals.pop();
    best
}

fn damped_step(
    normal: &DMatrix<f64>,
    gradient: &DVector<f64>,
    damping: f64,
) -> Option<DVector<f64>> {
    let mut damped = normal.clone();
    let largest = normal.diagonal().max();
    for j in 0..damped.nrows() {
        // A number without any influence must not make the matrix singular.
        damped[(j, j)] += damping * normal[(j, j)] + 1e-14 * largest;
    }
    damped.cholesky().map(|factor| factor.solve(gradient))
}

/// What is known of a number of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Place of its term.
    pub term: usize,
    /// Its place among the term's numbers.
    pub number: usize,
    /// What covers it with 95 % probability.
    pub ends: [f64; 2],
    /// Distance from its estimate that covers it so, as if it were fitted without a transformation.
    pub half_width: f64,
}

/// Intervals that cover each free number with 95 % probability; none of a number that may be of any size.
///
/// The spread is that between pieces (sandwich estimate), so that residuals may be correlated within them.
#[must_use]
pub fn intervals(problem: &dyn Problem, fit: &Fit, scales: &Scales) -> Vec<Interval> {
    let coordinates = Coordinates::new(&fit.model, scales);
    let mut pieces = jacobian(
        problem,
        &coordinates,
        &fit.model,
        &errors(problem, &fit.model),
    );
    let known = pieces.pop();
    let size = coordinates.places.len();
    let mut normal = DMatrix::<f64>::zeros(size, size);
    let mut between = DMatrix::<f64>::zeros(size, size);
    for (jacobian, residuals) in pieces.iter().zip(&fit.residuals) {
        normal += jacobian.tr_mul(jacobian);
        let pull = jacobian.tr_mul(&DVector::from_column_slice(residuals));
        between += &pull * pull.transpose();
    }
    if !problem.known().is_empty()
        && let Some(known) = known
    {
        let noise = unit(&fit.residuals);
        let information = noise * known.tr_mul(&known);
        between += noise * &information;
        normal += information;
    }
    let count = pieces.len() as f64;
    // Fewer pieces than numbers say nothing about the spread between them.
    let correction = count / (count - size as f64).max(1.0);
    let is_told: Vec<bool> = normal.diagonal().iter().map(|own| *own > 0.0).collect();
    for (j, _) in is_told.iter().enumerate().filter(|(_, is_told)| !**is_told) {
        normal[(j, j)] = 1.0;
    }
    let Some(inverse) = normal.try_inverse() else {
        return Vec::new();
    };
    let covariance = &inverse * between * &inverse * correction;
    let x = coordinates.of(&fit.model);
    coordinates
        .places
        .iter()
        .enumerate()
        .filter(|(j, _)| is_told[*j])
        .map(|(j, &(term, number, _, _))| {
            let half = 1.96 * covariance[(j, j)].max(0.0).sqrt();
            let end = |shift: f64| {
                let mut moved = x.clone();
                moved[j] += shift;
                coordinates.set(&fit.model, &moved).value(term, number)
            };
            Interval {
                term,
                number,
                ends: [end(-half), end(half)],
                half_width: half * (end(STEP) - end(-STEP)).abs() / (2.0 * STEP),
            }
        })
        .filter(|interval| interval.ends.iter().all(|end| end.is_finite()))
        .collect()
}
