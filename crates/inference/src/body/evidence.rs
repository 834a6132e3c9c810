//! What speaks for a model: errors on what was left out of the fit, and how certain their difference is.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::known::misfit;
use super::least_squares::{Fit, Linearised, refit};
use super::motion::Scales;
use super::problem::Problem;
use crate::policy::{LN_PRIOR_ODDS, SURELY, sure_odds};
use crate::sets::sum_and_error;

/// Steps of a refit that leaves a fold out; it starts from the fit to everything.
const REFIT_STEPS: usize = 3;

/// Errors of a model on what it was not fitted to.
#[derive(Debug, Clone, PartialEq)]
pub struct Errors {
    /// Squared errors piece by piece.
    pub pieces: Vec<f64>,
    /// Squared errors of the model's numbers against what was known of them before, in standard deviations.
    pub known: f64,
    /// Squared error that makes one unit of 2 ln likelihood.
    pub unit: f64,
}

impl Errors {
    /// Errors of a fitted model, in each piece under a fit that has not seen its fold.
    #[must_use]
    pub fn left_out(problem: &dyn Problem, fitted: &Fit, scales: &Scales) -> Self {
        let start = Linearised::new(problem, &fitted.model, scales);
        Self::left_out_from(problem, fitted, &start)
    }

    /// The same from where the fit ended, with its derivatives.
    #[must_use]
    pub fn left_out_from(problem: &dyn Problem, fitted: &Fit, start: &Linearised) -> Self {
        let folds = problem.folds();
        let count = folds.iter().max().map_or(0, |last| last + 1);
        let mut pieces = vec![0.0; folds.len()];
        let refits = (0..count).into_par_iter();
        let refits = refits.map(|fold| refit(problem, start, fold, REFIT_STEPS).residuals);
        for (fold, residuals) in refits.collect::<Vec<_>>().iter().enumerate() {
            for (at, piece) in residuals.iter().enumerate() {
                if folds[at] == fold {
                    pieces[at] = piece.iter().map(|r| r * r).sum();
                }
            }
        }
        Self {
            pieces,
            known: misfit(problem.known(), &fitted.model),
            unit: unit(&fitted.residuals),
        }
    }

    /// Errors that these residuals are, piece by piece, of a model whose numbers lie so far from what was known.
    #[must_use]
    pub fn of(residuals: &[Vec<f64>], known: f64) -> Self {
        let square = |piece: &Vec<f64>| piece.iter().map(|r| r * r).sum();
        Self {
            pieces: residuals.iter().map(square).collect(),
            known,
            unit: unit(residuals),
        }
    }

    /// Those of the pieces for which `is_in` holds.
    #[must_use]
    pub fn part(&self, is_in: &[bool]) -> Self {
        let pieces = self.pieces.iter().zip(is_in);
        Self {
            pieces: pieces
                .filter_map(|(error, is_in)| is_in.then_some(*error))
                .collect(),
            ..self.clone()
        }
    }

    /// Whether the model could run through all of the records.
    #[must_use]
    pub fn are_finite(&self) -> bool {
        let sum: f64 = self.pieces.iter().sum();
        (sum + self.known + self.unit).is_finite()
    }

    /// Gain in ln likelihood of a model with these errors over one with those, where the noise is as large as each model leaves it.
    #[must_use]
    pub fn gain_over(&self, other: &Self) -> Gain {
        let unit = 2.0 * logarithmic_mean(self.unit, other.unit);
        let differences: Vec<f64> = other
            .pieces
            .iter()
            .zip(&self.pieces)
            .map(|(other, own)| (other - own) / unit)
            .collect();
        let (pieces, error) = sum_and_error(&differences);
        Gain {
            value: pieces + 0.5 * (other.known - self.known),
            error,
        }
    }
}

/// A gain in ln likelihood with its standard error, by the scatter between pieces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Gain on what was left out.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

impl Gain {
    /// Log odds that a gain with these prior log odds means: the probability averaged over a gain that is normally distributed,
    /// by MacKay's approximation (Neural Computation 4, 1992).
    #[must_use]
    pub fn odds(&self, prior: f64) -> f64 {
        (self.value + prior) / (1.0 + PI / 8.0 * self.error * self.error).sqrt()
    }

    /// Whether it speaks for one more effect, with the probability that names are given.
    #[must_use]
    pub fn is_sure(&self) -> bool {
        self.odds(LN_PRIOR_ODDS) > sure_odds()
    }

    /// Interval that covers it with 95 % probability.
    #[must_use]
    pub fn interval95(&self) -> [f64; 2] {
        [
            self.value - SURELY * self.error,
            self.value + SURELY * self.error,
        ]
    }
}

/// The mean m of two units for which (S₁ − S₂)/m is n·ln(S₁/S₂), where S₁ and S₂ are n units each: ln likelihood with the noise that
/// fits each best is n/2·ln S.
fn logarithmic_mean(one: f64, other: f64) -> f64 {
    let ratio = one / other;
    // Closer to one the difference of logarithms is lost in rounding; the mean is then that of any kind.
    if (ratio - 1.0).abs() < 1e-6 {
        0.5 * (one + other)
    } else {
        (one - other) / ratio.ln()
    }
}

/// Squared error that makes one unit of 2 ln likelihood: variance times the number of residuals that count as one, because
/// they are correlated.
#[must_use]
pub fn unit(residuals: &[Vec<f64>]) -> f64 {
    let count: usize = residuals.iter().map(Vec::len).sum();
    let variance = super::problem::square(residuals) / count.max(1) as f64;
    let longest = residuals.iter().map(Vec::len).max().unwrap_or(0);
    let mut together = 1.0;
    for lag in 1..longest {
        let (mut sum, mut pairs) = (0.0, 0_usize);
        for piece in residuals {
            for (a, b) in piece.iter().zip(piece.iter().skip(lag)) {
                sum += a * b;
                pairs += 1;
            }
        }
        let correlation = sum / (pairs.max(1) as f64 * variance);
        if pairs == 0 || correlation.is_nan() || correlation <= 0.0 {
            break;
        }
        together += 2.0 * correlation;
    }
    variance * together
}

#[cfg(test)]
mod tests {
    use super::{Errors, Gain};

    fn errors(size: f64) -> Errors {
        Errors {
            pieces: [4.0, 5.0, 6.0].map(|error| size * error).to_vec(),
            known: 0.0,
            unit: 0.1,
        }
    }

    #[test]
    fn effects_that_do_the_same_have_even_odds() {
        let same = errors(1.0).gain_over(&errors(1.0));
        assert!(same.odds(0.0).abs() < 1e-12 && !same.is_sure());
        assert!(errors(0.5).gain_over(&errors(1.0)).is_sure());
    }

    #[test]
    fn a_model_that_halves_the_noise_gains_half_a_logarithm_of_two_for_each_reading() {
        let left = |size: f64| Errors::of(&vec![vec![size, -size]; 50], 0.0);
        let gain = left(1.0).gain_over(&left(2f64.sqrt()));
        assert!((gain.value - 50.0 * 2f64.ln()).abs() < 1e-9, "{gain:?}");
    }

    #[test]
    fn odds_are_those_of_the_gain_as_far_as_it_is_known() {
        let known = Gain {
            value: 9.0,
            error: 0.0,
        };
        assert_eq!(known.odds(-4.0), 5.0);
        // Mean of 1/(1 + exp(−g)) over a normal g of mean 5 and deviation 10, by Simpson's rule: 0.6887.
        let vague = Gain {
            error: 10.0,
            ..known
        };
        let probability = 1.0 / (1.0 + (-vague.odds(-4.0)).exp());
        assert!((probability - 0.6887).abs() < 0.01, "{probability}");
    }
}
