//! What windows cost: −2 ln likelihood under a bounded loss, and the quadratic form of the free numbers that they add up to.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::hypothesis::Hypothesis;
use super::marginal::Reduced;
use super::robust::Robust;

/// Loss of a window that the model could not run through: worse than any that it could.
pub const FAILED: f64 = 1e5;

/// −2 ln likelihood of all windows and of the free numbers.
pub fn total_loss(reduced: &[Option<Reduced>], hypothesis: &Hypothesis, robust: Robust) -> f64 {
    let windows: f64 = reduced.iter().map(|form| window_loss(form, robust)).sum();
    windows + prior_loss(hypothesis)
}

fn prior_loss(hypothesis: &Hypothesis) -> f64 {
    hypothesis
        .prior_precisions()
        .iter()
        .zip(&hypothesis.x)
        .map(|(p, x)| p * x * x)
        .sum()
}

/// −2 ln likelihood of one window.
pub fn window_loss(form: &Option<Reduced>, robust: Robust) -> f64 {
    form.as_ref().map_or(FAILED, |r| {
        robust.loss(r.square, r.residuals) + r.log_determinant
    })
}

/// Loss of each window after the change of the free numbers that is best for the windows of all
/// other folds.
pub fn held_out_losses(
    forms: &[Option<Reduced>],
    precisions: &[f64],
    x: &[f64],
    folds: &[usize],
    robust: Robust,
) -> Vec<f64> {
    let mut losses = vec![FAILED; forms.len()];
    let parts = folds.iter().max().map_or(1, |m| m + 1);
    for fold in 0..parts {
        let training = forms
            .iter()
            .zip(folds)
            .filter(|(_, f)| **f != fold)
            .filter_map(|(form, _)| form.as_ref());
        let (curvature, gradient) = normal_equations(training, precisions, x, robust);
        let Some(step) = Cholesky::new(curvature).map(|c| c.solve(&gradient)) else {
            continue;
        };
        for ((loss, form), f) in losses.iter_mut().zip(forms).zip(folds) {
            let Some(form) = form.as_ref().filter(|_| *f == fold) else {
                continue;
            };
            let square =
                form.square - 2.0 * form.gradient.dot(&step) + step.dot(&(&form.curvature * &step));
            *loss = robust.loss(square.max(0.0), form.residuals) + form.log_determinant;
        }
    }
    losses
}

/// Sum of the windows' quadratic forms and the prior's.
pub fn normal_equations<'a>(
    forms: impl Iterator<Item = &'a Reduced>,
    precisions: &[f64],
    x: &[f64],
    robust: Robust,
) -> (DMatrix<f64>, DVector<f64>) {
    let n = x.len();
    let mut curvature = DMatrix::zeros(n, n);
    let mut gradient = DVector::zeros(n);
    for r in forms {
        let weight = robust.weight(r.square, r.residuals);
        curvature += &r.curvature * weight;
        gradient += &r.gradient * weight;
    }
    for (j, p) in precisions.iter().enumerate() {
        curvature[(j, j)] += p;
        gradient[j] -= p * x[j];
    }
    (curvature, gradient)
}
