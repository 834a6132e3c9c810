//! How certain the numbers of a fit are.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::data::Data;
use super::fit::Fit;
use super::hypothesis::Estimate;
use super::losses::normal_equations;
use super::marginal::Reduced;
use super::robust::Robust;
use super::window::Window;

/// Time over which what the sensors' noise does not explain may pull neighbouring windows the same way [s].
const STRETCH: f64 = 4.0;
/// Fewest stretches whose scatter says how uncertain a number is.
const LEAST_STRETCHES: usize = 8;

impl Fit {
    /// The values of all free numbers with their deviations, which are NaN where the windows say nothing of them.
    ///
    /// The windows' curvature tells the deviations as far as residuals are independent noise. Some are not: a level of the
    /// normal force is known no better than the load cell's noise lets it, and that error is the same as long as the level
    /// lasts. The scatter of what each stretch of windows pulls the numbers by tells this (the sandwich estimate of Huber and
    /// White, clustered by stretches); the larger of the two deviations is given.
    pub fn estimates(&self, data: &Data) -> Vec<Estimate> {
        let covariance = self.covariance(data);
        self.hypothesis
            .estimates(|i, j| covariance.as_ref().map_or(f64::NAN, |c| c[(i, j)]))
    }

    fn covariance(&self, data: &Data) -> Option<DMatrix<f64>> {
        let h = &self.hypothesis;
        let forms = self.reduced(data);
        let precisions = h.prior_precisions();
        let (curvature, _) =
            normal_equations(forms.iter().flatten(), &precisions, &h.x, self.judging);
        let inverse = Cholesky::new(curvature)?.inverse();
        let pulls = pulls(&data.windows, &forms, self.judging, |window| {
            data.runs[window.run].time[window.first]
        });
        Some(widened(&inverse, precisions, &pulls))
    }
}

/// `inverse`, the covariance by the curvature alone, with deviations no less than the scatter of the stretches' pulls tells.
fn widened(inverse: &DMatrix<f64>, precisions: Vec<f64>, pulls: &[DVector<f64>]) -> DMatrix<f64> {
    if pulls.len() < LEAST_STRETCHES {
        return inverse.clone();
    }
    let count = pulls.len() as f64;
    let mean = pulls.iter().sum::<DVector<f64>>() / count;
    let mut scatter = DMatrix::from_diagonal(&DVector::from_vec(precisions));
    for pull in pulls {
        let about = pull - &mean;
        scatter += &about * about.transpose() * (count / (count - 1.0));
    }
    let clustered = inverse * scatter * inverse;
    let wider = |j: usize| (clustered[(j, j)] / inverse[(j, j)]).max(1.0).sqrt();
    DMatrix::from_fn(inverse.nrows(), inverse.ncols(), |i, j| {
        inverse[(i, j)] * wider(i) * wider(j)
    })
}

/// What each stretch of windows of one record pulls the free numbers by.
fn pulls(
    windows: &[Window],
    forms: &[Option<Reduced>],
    robust: Robust,
    begin: impl Fn(&Window) -> f64,
) -> Vec<DVector<f64>> {
    let mut pulls: Vec<DVector<f64>> = Vec::new();
    let mut present = None;
    for (window, form) in windows.iter().zip(forms) {
        let Some(form) = form else { continue };
        let stretch = Some((window.run, (begin(window) / STRETCH) as usize));
        let pull = &form.gradient * robust.weight(form.square, form.residuals);
        match pulls.last_mut() {
            Some(last) if stretch == present => *last += pull,
            _ => pulls.push(pull),
        }
        present = stretch;
    }
    pulls
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two numbers that 20 stretches know with precision 5 each; their pulls have `size` standard deviations.
    fn deviations(size: f64) -> [f64; 2] {
        let inverse = DMatrix::identity(2, 2) / 100.0;
        let pulls: Vec<DVector<f64>> = (0..20)
            .map(|j| {
                let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
                DVector::from_vec(vec![sign * size * 5_f64.sqrt(), 0.0])
            })
            .collect();
        let found = widened(&inverse, vec![0.0; 2], &pulls);
        [found[(0, 0)].sqrt(), found[(1, 1)].sqrt()]
    }

    #[test]
    fn stretches_that_disagree_widen_the_deviation_and_others_do_not_narrow_it() {
        assert_eq!(deviations(0.5), [0.1, 0.1]);
        let [disputed, agreed] = deviations(3.0);
        assert!(
            (disputed - 0.3 * (20.0_f64 / 19.0).sqrt()).abs() < 1e-12,
            "{disputed}"
        );
        assert_eq!(agreed, 0.1);
    }

    #[test]
    fn too_few_stretches_tell_nothing() {
        let inverse = DMatrix::identity(1, 1);
        let pulls = vec![DVector::from_vec(vec![9.0]); LEAST_STRETCHES - 1];
        assert_eq!(widened(&inverse, vec![0.0], &pulls), inverse);
    }
}
