//! What speaks for an effect: errors on what was left out of the fit, and how certain their difference is.

use super::least_squares::{Fit, Start, fit_from};
use super::motion::Scales;
use super::problem::Problem;
use inference::random::Random;

/// Steps of a refit that leaves a fold out; it starts from the fit to everything.
const REFIT_STEPS: usize = 3;
/// Gain in ln likelihood up to which two fits are the same but for the steps in which they converged.
const SAME: f64 = 0.01;
/// Resamplings of the pieces.
const RESAMPLINGS: usize = 4000;

/// Squared errors piece by piece, each under a fit that has not seen its fold; last those against what was known before.
#[must_use]
pub fn left_out_errors(problem: &dyn Problem, fitted: &Fit, scales: &Scales) -> Vec<f64> {
    let folds = problem.folds();
    let count = folds.iter().max().map_or(0, |last| last + 1);
    let mut errors = vec![0.0; folds.len()];
    let start = Start::new(problem, &fitted.model, scales);
    for fold in 0..count {
        let refit = fit_from(problem, &start, Some(fold), REFIT_STEPS);
        for (at, piece) in refit.residuals.iter().enumerate() {
            if folds[at] == fold {
                errors[at] = piece.iter().map(|r| r * r).sum();
            }
        }
    }
    errors.push(problem.prior(&fitted.model).iter().map(|r| r * r).sum());
    errors
}

/// A gain in ln likelihood with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Gain on what was left out.
    pub value: f64,
    /// Interval that covers it with 95 % probability.
    pub interval95: [f64; 2],
    /// Lower bound that holds with 95 % probability for all of the looks together.
    pub sure: f64,
}

impl Gain {
    /// Whether there is surely a gain. Two effects that do the same in these records, such as two that differ only where the motion
    /// reverses, have neither a gain nor a scatter between them.
    #[must_use]
    pub fn is_certain(&self) -> bool {
        self.interval95[0] >= SAME
    }

    /// Gain over its standard deviation; 0 where it has none.
    #[must_use]
    pub fn significance(&self) -> f64 {
        let [low, high] = self.interval95;
        let deviation = (high - low) / (2.0 * 1.96);
        if deviation > 0.0 {
            self.value / deviation
        } else {
            0.0
        }
    }
}

/// Gain from errors `before` to errors `after`, where `unit` is the squared error that makes one unit of 2 ln likelihood
/// and `looks` candidates were looked at. The last errors are those against what was known before, which no chance has a part in.
#[must_use]
pub fn gain(before: &[f64], after: &[f64], unit: f64, looks: usize) -> Gain {
    let differences: Vec<f64> = before
        .iter()
        .zip(after)
        .map(|(b, a)| (b - a) / (2.0 * unit))
        .collect();
    let Some((known, differences)) = differences.split_last() else {
        return Gain {
            value: 0.0,
            interval95: [0.0; 2],
            sure: 0.0,
        };
    };
    let count = differences.len();
    let mut random = Random::new(20_160_912);
    let mut sums: Vec<f64> = (0..RESAMPLINGS)
        .map(|_| {
            let drawn = (0..count).map(|_| differences[random.index(count)]);
            drawn.sum::<f64>() + known
        })
        .collect();
    sums.sort_by(f64::total_cmp);
    let quantile = |share: f64| {
        let at = (share * RESAMPLINGS as f64) as usize;
        sums.get(at.min(RESAMPLINGS - 1)).copied().unwrap_or(0.0)
    };
    Gain {
        value: differences.iter().sum::<f64>() + known,
        interval95: [quantile(0.025), quantile(0.975)],
        sure: quantile(0.05 / looks.max(1) as f64),
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
        if pairs == 0 || correlation <= 0.0 {
            break;
        }
        together += 2.0 * correlation;
    }
    variance * together
}

#[cfg(test)]
mod tests {
    use super::gain;

    #[test]
    fn effects_that_do_the_same_are_no_certain_gain_over_each_other() {
        let errors = [4.0, 5.0, 6.0, 0.0];
        let nearly = errors.map(|error| error * (1.0 - 1e-9));
        let half = errors.map(|error| 0.5 * error);
        assert!(!gain(&errors, &errors, 1.0, 1).is_certain());
        assert!(!gain(&errors, &nearly, 1.0, 1).is_certain());
        assert!(gain(&errors, &half, 1.0, 1).is_certain());
    }
}
