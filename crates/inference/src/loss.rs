//! What windows cost: −2 ln likelihood, each window with a noise of its own that is at least that of the instruments.
//!
//! With s the sum of squared whitened residuals of a window of n, and its noise c ≥ 1 times that of the instruments, the
//! likelihood is largest at c² = max(1, s/n), and −2 ln of it is s up to n and n (1 + ln s/n) beyond. A disc that breaks away
//! in the model and not in the record leaves hundreds of standard deviations, and derivatives that say nothing of how to
//! bring the two together; such a window counts by the logarithm of what it leaves.

use crate::hypothesis::Hypothesis;
use crate::marginal::Reduced;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Loss of a window that the model could not run through, for each of its residuals: worse than any that it could.
const FAILED: f64 = 20.0;

/// −2 ln likelihood of a window whose `n` residuals leave the sum of squares `square`.
#[must_use]
pub fn of_square(square: f64, n: usize) -> f64 {
    let n = n as f64;
    if square <= n {
        square
    } else {
        n * (1.0 + (square / n).ln())
    }
}

/// Derivative of [`of_square`] with respect to the sum of squares.
#[must_use]
pub fn weight(square: f64, n: usize) -> f64 {
    (n as f64 / square).min(1.0)
}

/// −2 ln likelihood of one window.
#[must_use]
pub fn of_window(form: &Option<Reduced>) -> f64 {
    form.as_ref().map_or(FAILED * 100.0, |form| {
        of_square(form.square, form.residuals) + form.log_determinant
    })
}

/// −2 ln likelihood of all windows and of the free numbers.
#[must_use]
pub fn total(forms: &[Option<Reduced>], hypothesis: &Hypothesis) -> f64 {
    let windows: f64 = forms.iter().map(of_window).sum();
    windows + prior(hypothesis)
}

fn prior(hypothesis: &Hypothesis) -> f64 {
    hypothesis
        .prior_precisions()
        .iter()
        .zip(&hypothesis.x)
        .map(|(p, x)| p * x * x)
        .sum()
}

/// Sum of the windows' quadratic forms and the prior's: curvature and descent direction.
#[must_use]
pub fn normal_equations<'a>(
    forms: impl Iterator<Item = &'a Reduced>,
    precisions: &[f64],
    x: &[f64],
) -> (DMatrix<f64>, DVector<f64>) {
    let n = x.len();
    let mut curvature = DMatrix::zeros(n, n);
    let mut gradient = DVector::zeros(n);
    for form in forms {
        let weight = weight(form.square, form.residuals);
        curvature += &form.curvature * weight;
        gradient += &form.gradient * weight;
    }
    for (j, p) in precisions.iter().enumerate() {
        curvature[(j, j)] += p;
        gradient[j] -= p * x[j];
    }
    (curvature, gradient)
}

/// The change of the free numbers, within `ranges`, that is best for a quadratic form: numbers that would leave their range stop at its
/// end, and the others move as is best then. `None` where the curvature is not positive.
#[must_use]
pub fn step_within(
    ranges: &[(f64, f64)],
    curvature: &DMatrix<f64>,
    gradient: &DVector<f64>,
) -> Option<DVector<f64>> {
    let mut step = DVector::zeros(gradient.len());
    let mut open: Vec<usize> = (0..gradient.len()).collect();
    while !open.is_empty() {
        let n = open.len();
        let own = DMatrix::from_fn(n, n, |i, j| curvature[(open[i], open[j])]);
        let pull = DVector::from_fn(n, |i, _| {
            let held: f64 = (0..step.len())
                .filter(|j| !open.contains(j))
                .map(|j| curvature[(open[i], j)] * step[j])
                .sum();
            gradient[open[i]] - held
        });
        let solved = Cholesky::new(own)?.solve(&pull);
        let mut still_open = Vec::with_capacity(n);
        for (&at, &wanted) in open.iter().zip(&solved) {
            let (low, high) = ranges[at];
            step[at] = wanted.clamp(low, high);
            if step[at] == wanted {
                still_open.push(at);
            }
        }
        if still_open.len() == n {
            break;
        }
        open = still_open;
    }
    Some(step)
}

/// Loss of each window after the change of the free numbers, within `ranges`, that is best for the windows of all other folds.
#[must_use]
pub fn held_out(
    forms: &[Option<Reduced>],
    precisions: &[f64],
    x: &[f64],
    ranges: &[(f64, f64)],
    folds: &[usize],
) -> Vec<Option<f64>> {
    let mut losses = vec![None; forms.len()];
    let parts = folds.iter().max().map_or(1, |m| m + 1);
    for fold in 0..parts {
        let training = forms
            .iter()
            .zip(folds)
            .filter(|(_, f)| **f != fold)
            .filter_map(|(form, _)| form.as_ref());
        let (curvature, gradient) = normal_equations(training, precisions, x);
        let Some(step) = step_within(ranges, &curvature, &gradient) else {
            continue;
        };
        for ((loss, form), f) in losses.iter_mut().zip(forms).zip(folds) {
            let Some(form) = form.as_ref().filter(|_| *f == fold) else {
                continue;
            };
            let square =
                form.square - 2.0 * form.gradient.dot(&step) + step.dot(&(&form.curvature * &step));
            *loss = Some(of_square(square.max(0.0), form.residuals) + form.log_determinant);
        }
    }
    losses
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weight_is_the_derivative_of_the_loss() {
        for square in [10.0, 99.0, 101.0, 5e3, 1e6] {
            let e = 1e-5 * square;
            let slope = (of_square(square + e, 100) - of_square(square - e, 100)) / (2.0 * e);
            let relative = slope / weight(square, 100) - 1.0;
            assert!(relative.abs() < 1e-3, "{square}: {relative}");
        }
    }
    #[test]
    fn a_number_stops_at_the_end_of_its_range_and_the_others_move_as_is_best_then() {
        let curvature = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let gradient = DVector::from_vec(vec![4.0, 5.0]);
        let free = [(f64::NEG_INFINITY, f64::INFINITY); 2];
        let best = step_within(&free, &curvature, &gradient).unwrap();
        assert!((best - DVector::from_vec(vec![1.0, 2.0])).norm() < 1e-14);
        let bounded = [(-0.5, 0.5), free[1]];
        let best = step_within(&bounded, &curvature, &gradient).unwrap();
        assert!((best - DVector::from_vec(vec![0.5, 2.25])).norm() < 1e-14);
    }
}
