//! How much a window counts whose motion the model misses altogether.
//!
//! A disc that breaks away in the model and not in the record, or the reverse, leaves residuals of hundreds of standard
//! deviations, and derivatives that say nothing of how to bring the two together. Few such windows would outvote all
//! others, so that a window's part of the loss is bounded: with s its residual size and c the limit, s² up to c and
//! 2 c² − c⁴/s² beyond, whose derivative with respect to s² falls as (c/s)⁴.
//!
//! What a model misses counts as noise: the loss is taken relative to its variance, the squared median of s, so that
//! parameters which are known beforehand are not bent by many times their uncertainty to make up for a missing effect.

use super::marginal::Reduced;

/// The least limit, in standard deviations: sensor noise alone stays well below.
const LEAST_LIMIT: f64 = 1.6;
/// Limit over the median residual size of the windows.
const OVER_MEDIAN: f64 = 1.5;
/// Median residual size, in standard deviations, above which the model misses something.
const CERTAINLY_MISSED: f64 = 1.15;

/// A bounded loss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Robust {
    /// Residual size per residual, relative to noise, up to which a window counts with its square.
    limit: f64,
    /// Variance of what the model misses, relative to the sensors'; 1 where that is nothing certain.
    scale: f64,
}

impl Robust {
    /// The loss by which finished fits are judged.
    pub const JUDGING: Self = Self {
        limit: 4.0,
        scale: 1.0,
    };

    /// The loss that lets the better half of the windows decide.
    pub fn adapted(forms: &[Option<Reduced>]) -> Self {
        let mut sizes: Vec<f64> = forms
            .iter()
            .flatten()
            .map(|form| (form.square / form.residuals as f64).sqrt())
            .collect();
        sizes.sort_by(f64::total_cmp);
        let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
        Self {
            limit: (OVER_MEDIAN * median).max(LEAST_LIMIT),
            scale: if median > CERTAINLY_MISSED {
                median * median
            } else {
                1.0
            },
        }
    }

    /// Whether the windows that it was adapted to lack more than the sensors' noise explains.
    pub fn misses_something(self) -> bool {
        self.scale > 1.0
    }

    /// What the scale costs a model for this many residuals: −2 ln likelihood.
    pub fn cost(self, residuals: usize) -> f64 {
        residuals as f64 * self.scale.ln()
    }

    /// Loss of a window with this sum of squares.
    pub fn loss(self, square: f64, residuals: usize) -> f64 {
        let bound = residuals as f64 * self.limit * self.limit;
        let bounded = if square <= bound {
            square
        } else {
            2.0 * bound - bound * bound / square
        };
        bounded / self.scale
    }

    /// Derivative of the loss with respect to the sum of squares.
    pub fn weight(self, square: f64, residuals: usize) -> f64 {
        let bound = residuals as f64 * self.limit * self.limit;
        let share = if square <= bound {
            1.0
        } else {
            (bound / square).powi(2)
        };
        share / self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weight_is_the_derivative_and_the_loss_is_bounded() {
        let robust = Robust::JUDGING;
        for square in [10.0, 1599.0, 1601.0, 5e3, 1e6] {
            let e = 1e-4 * square;
            let slope = (robust.loss(square + e, 100) - robust.loss(square - e, 100)) / (2.0 * e);
            let relative = slope / robust.weight(square, 100) - 1.0;
            assert!(relative.abs() < 1e-3, "{square}: {relative}");
        }
        assert!(robust.loss(1e12, 100) < 3200.0);
    }
}
