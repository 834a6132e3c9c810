//! Fits: damped Gauss–Newton steps (Levenberg, Marquardt) that keep the normal equations of every piece.
//!
//! The pieces' own normal equations are what cross-validation and robust intervals are made of, which is why no library
//! does this. Numbers that must be positive or between bounds are fitted through a transformation, so that no step leaves
//! their range.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use stickslip::parameter::Range;

use super::evidence::unit;
use super::known::{self, deviations};
use super::model::Model;
use super::motion::Scales;
use super::problem::Problem;
use super::unit::Usual as _;

/// Step of the differences, in units of a number's usual size.
const STEP: f64 = 1e-5;
/// Gain in ln likelihood that counts as none where sets compete.
pub const SETTLED: f64 = 0.01;
/// The same where the numbers of the answer come to rest.
pub const AT_REST: f64 = 1e-6;

/// A model fitted to records.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The model.
    pub model: Model,
    /// Its residuals, piece by piece.
    pub residuals: Vec<Vec<f64>>,
    /// Sum of squares of the residuals it was fitted to.
    pub loss: f64,
    /// Derivatives of its errors, where the fit ended with them.
    derivatives: Option<Vec<DMatrix<f64>>>,
}

/// Place of a number's term, its place there, its range and its usual size.
type Coordinate = (usize, usize, Range, f64);

/// Transformed numbers and back.
struct Coordinates {
    places: Vec<Coordinate>,
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
    let column = |(column, &(term, number, range, scale)): (usize, &Coordinate)| {
        if let Some(mut slopes) = problem.slopes(model, residuals, (term, number)) {
            slopes.push(known::slopes(problem.known(), (term, number)));
            let scale = Coordinates::slope(x[column], range, scale);
            slopes.iter_mut().flatten().for_each(|own| *own *= scale);
            return slopes;
        }
        let mut shifted = x.clone();
        shifted[column] += STEP;
        let mut moved = errors(problem, &coordinates.set(model, &shifted));
        let pairs = moved.iter_mut().flatten().zip(residuals.iter().flatten());
        pairs.for_each(|(after, before)| *after = (*after - before) / STEP);
        moved
    };
    let places = coordinates.places.par_iter().enumerate();
    let columns: Vec<Vec<Vec<f64>>> = places.map(column).collect();
    let pieces = residuals.iter().enumerate();
    pieces
        .map(|(piece, errors)| {
            DMatrix::from_fn(errors.len(), x.len(), |row, own| columns[own][piece][row])
        })
        .collect()
}

/// A model with its errors and their derivatives.
pub struct Linearised {
    model: Model,
    coordinates: Coordinates,
    errors: Vec<Vec<f64>>,
    jacobian: Vec<DMatrix<f64>>,
}

impl Linearised {
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

    /// Where a fit of this problem ended, which gives away the derivatives that it has.
    #[must_use]
    pub fn at(problem: &dyn Problem, fit: &mut Fit, scales: &Scales) -> Self {
        let coordinates = Coordinates::new(&fit.model, scales);
        let mut errors = fit.residuals.clone();
        errors.push(deviations(problem.known(), &fit.model));
        let known = fit.derivatives.take();
        Self {
            model: fit.model.clone(),
            jacobian: known.unwrap_or_else(|| jacobian(problem, &coordinates, &fit.model, &errors)),
            coordinates,
            errors,
        }
    }
}

/// Fits all free numbers of `model` in at most `steps` steps, until none gains as much as `settled` in ln likelihood.
#[must_use]
pub fn fit(
    problem: &dyn Problem,
    model: &Model,
    scales: &Scales,
    (steps, settled): (usize, f64),
) -> Fit {
    let mut here = Linearised::new(problem, model, scales);
    let used = vec![true; here.errors.len()];
    let mut descent = Descent::new(&here, &used);
    for _ in 0..steps {
        if !descent.step(problem, &here.coordinates, &here.jacobian, settled) {
            break;
        }
        here.jacobian = jacobian(
            problem,
            &here.coordinates,
            &descent.best.model,
            &descent.best.residuals,
        );
    }
    Fit {
        derivatives: Some(here.jacobian),
        ..descent.end()
    }
}

/// Fits them once more in at most `steps` steps, leaving out the pieces of fold `without`. It ends so near that the derivatives stay.
#[must_use]
pub fn refit(problem: &dyn Problem, start: &Linearised, without: usize, steps: usize) -> Fit {
    let folds = problem.folds().iter();
    let used: Vec<bool> = folds.map(|fold| *fold != without).chain([true]).collect();
    let mut descent = Descent::new(start, &used);
    for _ in 0..steps {
        if !descent.step(problem, &start.coordinates, &start.jacobian, SETTLED) {
            break;
        }
    }
    descent.end()
}

/// The way down to the least loss.
struct Descent<'a> {
    best: Fit,
    /// Which pieces count.
    used: &'a [bool],
    damping: f64,
}

impl<'a> Descent<'a> {
    fn new(start: &Linearised, used: &'a [bool]) -> Self {
        Self {
            best: Fit {
                model: start.model.clone(),
                residuals: start.errors.clone(),
                loss: 0.0,
                derivatives: None,
            },
            used,
            damping: 1e-3,
        }
    }

    fn loss(&self, errors: &[Vec<f64>], counts: &[f64]) -> f64 {
        let pieces = errors.iter().zip(counts).zip(self.used);
        pieces
            .filter(|(_, used)| **used)
            .map(|((piece, count), _)| count * piece.iter().map(|r| r * r).sum::<f64>())
            .sum()
    }

    /// Goes a step down with these derivatives; whether there was one that promised as much as `settled` and kept it.
    fn step(
        &mut self,
        problem: &dyn Problem,
        coordinates: &Coordinates,
        jacobian: &[DMatrix<f64>],
        settled: f64,
    ) -> bool {
        let size = coordinates.places.len();
        let mut normal = DMatrix::zeros(size, size);
        let mut gradient = DVector::zeros(size);
        let counts = counts(&self.best.residuals);
        let pieces = jacobian.iter().zip(&self.best.residuals).zip(&counts);
        for (((jacobian, residuals), count), _) in pieces.zip(self.used).filter(|(_, used)| **used)
        {
            normal += *count * jacobian.tr_mul(jacobian);
            gradient += *count * jacobian.tr_mul(&DVector::from_column_slice(residuals));
        }
        self.best.loss = self.loss(&self.best.residuals, &counts);
        let x = coordinates.of(&self.best.model);
        let residuals = self.best.residuals.split_last();
        let least = 2.0 * settled * residuals.map_or(0.0, |(_, residuals)| unit(residuals));
        while self.damping.is_finite() {
            if let Some(step) = damped_step(&normal, &gradient, self.damping) {
                let step = coordinates.shortened(step);
                let promised = 2.0 * gradient.dot(&step) - step.dot(&(&normal * &step));
                if promised.is_nan() || promised < least {
                    return false;
                }
                let moved: Vec<f64> = x.iter().zip(step.iter()).map(|(x, dx)| x - dx).collect();
                let model = coordinates.set(&self.best.model, &moved);
                let residuals = errors(problem, &model);
                let loss = self.loss(&residuals, &counts);
                if loss < self.best.loss {
                    self.damping = (0.2 * self.damping).max(1e-12);
                    self.best = Fit {
                        model,
                        residuals,
                        loss,
                        derivatives: None,
                    };
                    return true;
                }
            }
            self.damping *= 6.0;
        }
        false
    }

    /// The best of the way, without the deviations that stand behind its residuals.
    fn end(mut self) -> Fit {
        self.best.residuals.pop();
        self.best
    }
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
pub fn intervals(problem: &dyn Problem, fit: &Linearised) -> Vec<Interval> {
    let coordinates = &fit.coordinates;
    let (Some((known, pieces)), Some((_, residuals))) =
        (fit.jacobian.split_last(), fit.errors.split_last())
    else {
        return Vec::new();
    };
    let size = coordinates.places.len();
    let mut normal = DMatrix::<f64>::zeros(size, size);
    let mut between = DMatrix::<f64>::zeros(size, size);
    for (jacobian, residuals) in pieces.iter().zip(residuals) {
        normal += jacobian.tr_mul(jacobian);
        let pull = jacobian.tr_mul(&DVector::from_column_slice(residuals));
        between += &pull * pull.transpose();
    }
    if !problem.known().is_empty() {
        let noise = unit(residuals);
        let information = noise * known.tr_mul(known);
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
