//! How certain the numbers of a fit are.

use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;

use crate::data::{BLOCK, Data};
use crate::fit::Fit;
use crate::hypothesis::Estimate;
use crate::loss::{normal_equations, weight};
use crate::marginal::Reduced;
use crate::policy::{REPLICAS, SURELY};
use crate::problem::Problem;
use crate::replica::replica;
use crate::window::Window;

/// Windows in a row that what the sensors' noise does not explain may pull the same way.
const STRETCH: usize = 2 * BLOCK;
/// Least degrees of freedom for which [`student`] holds to a hundredth, and least number of stretches whose scatter says anything of
/// a number: without one of two that tell it, hardly more than the prior is left.
const LEAST_FREEDOM: f64 = 3.0;
/// Steps in which the numbers settle on a replica: more move them no further.
const STEPS: usize = 2;

/// Values and deviations of what is free in a fit.
#[derive(Clone, Debug)]
pub struct ReplayedEstimates {
    /// The estimates.
    pub estimates: Vec<Estimate>,
    /// Whether replicas of the records had a say in the deviations; not where the fit cannot run through the records.
    pub is_replayed: bool,
}

impl Fit {
    /// Values and standard deviations of all that is free; deviations are NaN where the windows say nothing of a number.
    ///
    /// The windows' curvature tells the deviations as far as residuals are independent noise. Some are not: a level of the
    /// normal force is known no better than the load cell's noise lets it, and that error is the same as long as the level
    /// lasts. How far the numbers move when one stretch of windows after the other is left out tells this (the jackknife over
    /// clusters, with Student's factor for the few that it rests on: Bell and McCaffrey, Survey Methodology 28, 2002); the
    /// larger of the two deviations is given.
    #[must_use]
    pub fn estimates(&self, data: &Data) -> Vec<Estimate> {
        self.estimates_with(self.covariance(data).as_ref())
    }

    /// The same, with deviations no less than how far the numbers of replicas of the records come out from those that the replicas
    /// were made with (the parametric bootstrap: Efron and Tibshirani, An Introduction to the Bootstrap, 1993, section 6.5).
    ///
    /// Replicas know what no curvature tells: where friction fluctuates, a disc breaks away where it happens to be low, and all
    /// torques come out smaller.
    #[must_use]
    pub fn replayed_estimates(&self, problem: &Problem) -> ReplayedEstimates {
        let own = self.covariance(&problem.long);
        let replayed = own.as_ref().zip(self.scatter_of_replicas(problem));
        let is_replayed = replayed.is_some();
        let student = student(REPLICAS as f64) / SURELY;
        let wider = replayed.map(|(own, scatter)| {
            let factor = |j: usize| (student * (scatter[(j, j)] / own[(j, j)]).sqrt()).max(1.0);
            scaled(own, factor)
        });
        ReplayedEstimates {
            estimates: self.estimates_with(wider.as_ref().or(own.as_ref())),
            is_replayed,
        }
    }

    fn estimates_with(&self, covariance: Option<&DMatrix<f64>>) -> Vec<Estimate> {
        let hypothesis = &self.hypothesis;
        hypothesis.estimates(|i, j| covariance.map_or(f64::NAN, |c| c[(i, j)]))
    }

    /// Mean square by which the numbers of replicas miss, and what their priors leave open; `None` where the model cannot run through
    /// the records.
    fn scatter_of_replicas(&self, problem: &Problem) -> Option<DMatrix<f64>> {
        let precisions = self.hypothesis.prior_precisions();
        let x = DVector::from_column_slice(&self.hypothesis.x);
        let forms = self.reduced(&problem.long);
        let (curvature, _) =
            normal_equations(forms.iter().flatten(), &precisions, &self.hypothesis.x);
        let inverse = Cholesky::new(curvature)?.inverse();
        let prior = DMatrix::from_diagonal(&DVector::from_vec(precisions));
        // A prior pulls numbers towards the analyst's, which is no error of theirs.
        let pulled = &inverse * &prior * &x;
        let mut scatter = &inverse * prior * &inverse;
        let found = |seed| {
            let replica = replica(problem, self, seed)?;
            Some(self.settled(problem, replica, STEPS).0.hypothesis.x)
        };
        let found: Option<Vec<Vec<f64>>> = (1..=REPLICAS).into_par_iter().map(found).collect();
        for own in found? {
            let missed = DVector::from_vec(own) - &x + &pulled;
            scatter += &missed * missed.transpose() / REPLICAS as f64;
        }
        Some(scatter)
    }

    fn covariance(&self, data: &Data) -> Option<DMatrix<f64>> {
        let forms = self.reduced(data);
        let precisions = self.hypothesis.prior_precisions();
        let (curvature, _) =
            normal_equations(forms.iter().flatten(), &precisions, &self.hypothesis.x);
        widened(&curvature, precisions, &stretches(&data.windows, &forms))
    }
}

/// What a stretch of windows of one record says of the free numbers.
struct Stretch {
    curvature: DMatrix<f64>,
    pull: DVector<f64>,
}

/// The inverse of `curvature`, with deviations no less than what leaving out each stretch tells.
fn widened(
    curvature: &DMatrix<f64>,
    precisions: Vec<f64>,
    stretches: &[Stretch],
) -> Option<DMatrix<f64>> {
    let inverse = Cholesky::new(curvature.clone())?.inverse();
    let count = stretches.len() as f64;
    let prior = DMatrix::from_diagonal(&DVector::from_vec(precisions));
    let prior_share = &inverse * prior * &inverse;
    let mut freedom = Freedom::new(&prior_share);
    let mut scatter = prior_share;
    for stretch in stretches {
        freedom.add(&(&inverse * &stretch.curvature * &inverse));
        let moved = match Cholesky::new(curvature - &stretch.curvature) {
            Some(rest) => rest.solve(&stretch.pull),
            // A number that this stretch alone tells cannot be judged without it.
            None => &inverse * &stretch.pull,
        };
        scatter += &moved * moved.transpose() * ((count - 1.0) / count);
    }
    let wider = |j: usize| {
        if freedom.of(j) < LEAST_FREEDOM {
            return 1.0;
        }
        let ratio = (scatter[(j, j)] / inverse[(j, j)]).sqrt();
        (ratio * student(freedom.of(j)) / SURELY).max(1.0)
    };
    Some(scaled(&inverse, wider))
}

/// A covariance whose deviations are multiplied by these factors.
fn scaled(covariance: &DMatrix<f64>, factor: impl Fn(usize) -> f64) -> DMatrix<f64> {
    DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
        covariance[(i, j)] * factor(i) * factor(j)
    })
}

/// How many stretches a number's scatter rests on (Satterthwaite's degrees of freedom): as many as tell the same of it.
struct Freedom {
    sum: DVector<f64>,
    squares: DVector<f64>,
}

impl Freedom {
    fn new(share: &DMatrix<f64>) -> Self {
        let own = share.diagonal();
        Self {
            squares: own.map(|x| x * x),
            sum: own,
        }
    }

    fn add(&mut self, share: &DMatrix<f64>) {
        let own = share.diagonal();
        self.squares += own.map(|x| x * x);
        self.sum += own;
    }

    fn of(&self, number: usize) -> f64 {
        self.sum[number].powi(2) / self.squares[number]
    }
}

/// Deviations within which Student's variable lies with 95 % probability (Abramowitz and Stegun 26.7.5).
fn student(freedom: f64) -> f64 {
    let inverse = 1.0 / freedom;
    SURELY + inverse * (2.372 + inverse * (2.823 + inverse * 2.556))
}

/// The windows of each record, joined into stretches.
fn stretches(windows: &[Window], forms: &[Option<Reduced>]) -> Vec<Stretch> {
    let mut stretches: Vec<Stretch> = Vec::new();
    let (mut present, mut joined) = (None, 0);
    for (window, form) in windows.iter().zip(forms) {
        let Some(form) = form else { continue };
        let weight = weight(form.square, form.residuals);
        let (curvature, pull) = (&form.curvature * weight, &form.gradient * weight);
        match stretches.last_mut() {
            Some(last) if present == Some(window.run) && joined < STRETCH => {
                last.curvature += curvature;
                last.pull += pull;
                joined += 1;
            }
            _ => {
                stretches.push(Stretch { curvature, pull });
                (present, joined) = (Some(window.run), 1);
            }
        }
    }
    stretches
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two numbers that 20 stretches know with precision 5 each; their pulls have `size` standard deviations.
    fn deviations(size: f64) -> [f64; 2] {
        let stretches: Vec<Stretch> = (0..20)
            .map(|j| {
                let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
                Stretch {
                    curvature: DMatrix::identity(2, 2) * 5.0,
                    pull: DVector::from_vec(vec![sign * size * 5_f64.sqrt(), 0.0]),
                }
            })
            .collect();
        let curvature = DMatrix::identity(2, 2) * 100.0;
        let found = widened(&curvature, vec![0.0; 2], &stretches).unwrap();
        [found[(0, 0)].sqrt(), found[(1, 1)].sqrt()]
    }

    #[test]
    fn stretches_that_disagree_widen_the_deviation_and_others_do_not_narrow_it() {
        assert_eq!(deviations(0.5), [0.1, 0.1]);
        let [disputed, agreed] = deviations(3.0);
        // The mean of twenty values: standard deviation over the square root of their number, and Student's factor.
        let scatter = 0.3 * (20.0_f64 / 19.0).sqrt() * student(20.0) / SURELY;
        assert!((disputed - scatter).abs() < 1e-12, "{disputed}");
        assert_eq!(agreed, 0.1);
    }

    #[test]
    fn students_variable_as_tabulated() {
        for (freedom, tabulated) in [(3.0, 3.182), (5.0, 2.571), (10.0, 2.228), (30.0, 2.042)] {
            assert!(
                (student(freedom) / tabulated - 1.0).abs() < 0.01,
                "{freedom}"
            );
        }
        assert!((student(1e9) - SURELY).abs() < 1e-6);
    }

    #[test]
    fn a_number_that_two_stretches_tell_is_not_judged_by_their_scatter() {
        let stretches: Vec<Stretch> = (0..20)
            .map(|j| Stretch {
                curvature: DMatrix::identity(1, 1) * if j < 2 { 50.0 } else { 0.0 },
                pull: DVector::from_vec(vec![if j < 2 { 9.0 } else { 0.0 }]),
            })
            .collect();
        let curvature = DMatrix::identity(1, 1) * 101.0;
        let found = widened(&curvature, vec![1.0], &stretches).unwrap();
        assert!((found[(0, 0)] * 101.0 - 1.0).abs() < 1e-12);
    }
}
