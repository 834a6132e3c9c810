//! Fits of a free function together with the free numbers of the model.

use super::basis::{Basis, KNOTS};
use super::table::TableEffect;
use crate::data::{Data, grams, reduced};
use crate::evidence::Told;
use crate::fit::Fit;
use crate::hypothesis::Hypothesis;
use crate::loss;
use crate::marginal::{Disturbance, Reduced};
use crate::window::Start;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Most steps of a fit, and the share of a step below which none is tried.
const MOST_STEPS: usize = 12;
const SHORTEST: f64 = 0.01;
/// Decrease of −2 ln likelihood below which a step gains nothing.
const CONVERGED: f64 = 0.5;

/// A fit of a function and of the free numbers.
pub(super) struct State {
    /// The fit in small pieces.
    pub fit: Fit,
    /// Values at the knots, as multiples of the columns of the covariance's root.
    weights: DVector<f64>,
    /// Quadratic forms in the free numbers and the weights.
    forms: Vec<Option<Reduced>>,
    loss: f64,
}

impl State {
    fn at(
        basis: &Basis<'_>,
        data: &Data,
        root: &DMatrix<f64>,
        (hypothesis, weights): (Hypothesis, DVector<f64>),
        starts: Vec<Start>,
    ) -> Option<Self> {
        let values: Vec<f64> = (root * &weights).iter().copied().collect();
        let mut own = hypothesis;
        own.rig = basis.table(&values).added_to(&basis.problem.rig)?;
        let grams = grams(data, &own, &starts);
        let augmented = basis.augmented(&grams, &values);
        let forms = reduced(data, &starts, &augmented, &Disturbance::NONE);
        let forms = in_weights(&forms, own.dimension(), root);
        let loss = loss::total(&forms, &own) + weights.norm_squared();
        Some(Self {
            fit: Fit {
                hypothesis: own,
                starts,
                grams,
                disturbance: Disturbance::NONE,
                loss,
                is_converged: false,
            },
            weights,
            forms,
            loss,
        })
    }

    fn numbers(&self) -> (Vec<f64>, Vec<f64>) {
        let mut precisions = self.fit.hypothesis.prior_precisions();
        let mut x = self.fit.hypothesis.x.clone();
        precisions.extend(self.weights.iter().map(|_| 1.0));
        x.extend(self.weights.iter());
        (precisions, x)
    }

    /// The free numbers and the weights.
    pub(super) fn values(&self) -> (Hypothesis, DVector<f64>) {
        (self.fit.hypothesis.clone(), self.weights.clone())
    }

    /// Log evidence, window by window.
    pub(super) fn told(&self, data: &Data) -> Told {
        let (precisions, x) = self.numbers();
        Told::at(&data.windows, &self.forms, &precisions, &x)
    }

    /// The state after `share` of the step that the quadratic forms suggest.
    fn stepped(
        &self,
        basis: &Basis<'_>,
        data: &Data,
        root: &DMatrix<f64>,
        share: f64,
    ) -> Option<Self> {
        let (precisions, x) = self.numbers();
        let (curvature, gradient) =
            loss::normal_equations(self.forms.iter().flatten(), &precisions, &x);
        let step = Cholesky::new(curvature)?.solve(&gradient) * share;
        let mut hypothesis = self.fit.hypothesis.clone();
        for (x, d) in hypothesis.x.iter_mut().zip(step.iter()) {
            *x += d;
        }
        hypothesis.clamp();
        let own = hypothesis.dimension();
        let weights = &self.weights + step.rows(own, self.weights.len());
        let starts = self
            .fit
            .starts
            .iter()
            .zip(&self.forms)
            .zip(&data.windows)
            .map(|((start, form), window)| match form {
                Some(form) => Start {
                    state: window.moved(&start.state, &form.start_change(&step)),
                    torques: form.torques(&step),
                },
                None => start.clone(),
            })
            .collect();
        Self::at(basis, data, root, (hypothesis, weights), starts)
    }
}

/// Windows as quadratic forms in `own` free numbers and the weights of the columns of `root`.
pub(super) fn in_weights(
    forms: &[Option<Reduced>],
    own: usize,
    root: &DMatrix<f64>,
) -> Vec<Option<Reduced>> {
    let count = root.ncols();
    let mut map = DMatrix::identity(own + count, own + count);
    map.view_mut((own, own), (count, count)).copy_from(root);
    let mapped = |form: &Reduced| form.mapped(&map);
    forms.iter().map(|form| form.as_ref().map(mapped)).collect()
}

/// The fit of a function, begun at these values of the free numbers and weights and from these starts of the windows.
pub(super) fn fitted(
    basis: &Basis<'_>,
    data: &Data,
    root: &DMatrix<f64>,
    values: (Hypothesis, DVector<f64>),
    starts: Vec<Start>,
) -> Option<State> {
    let mut state = State::at(basis, data, root, values, starts)?;
    let mut share = 1.0;
    for _ in 0..MOST_STEPS {
        let trial = state.stepped(basis, data, root, share);
        match trial.filter(|trial| trial.loss < state.loss) {
            Some(trial) => {
                let gained = state.loss - trial.loss;
                state = trial;
                share = (2.0 * share).min(1.0);
                if gained < CONVERGED {
                    break;
                }
            }
            None => share *= 0.3,
        }
        if share < SHORTEST {
            break;
        }
    }
    Some(state)
}

/// The function and the standard deviations of its values, SI units.
pub(super) fn tabulated(
    basis: &Basis<'_>,
    state: &State,
    root: &DMatrix<f64>,
) -> Option<(TableEffect, Vec<f64>)> {
    let own = state.fit.hypothesis.dimension();
    let values: Vec<f64> = (root * &state.weights).iter().copied().collect();
    let (precisions, x) = state.numbers();
    let (curvature, _) = loss::normal_equations(state.forms.iter().flatten(), &precisions, &x);
    let covariance = Cholesky::new(curvature)?.inverse();
    let of_values = root * covariance.view((own, own), (KNOTS, KNOTS)) * root.transpose();
    let ([_, unit], _) = basis.family.units(&basis.problem.units);
    let deviations = (0..KNOTS).map(|k| of_values[(k, k)].max(0.0).sqrt() * unit);
    Some((basis.table(&values), deviations.collect()))
}
