//! What a model misses: windows that start from rest, and leave more than the instruments can.
//!
//! Elsewhere a window may be missed because its start was not found. The start of one from rest is known, so that nothing excuses it;
//! replicas of the records tell what friction that fluctuates leaves there.

use crate::data::Data;
use crate::fit::Fit;
use crate::marginal::{Disturbance, Reduced};
use crate::policy::MOST_MISFIT;
use crate::problem::Problem;
use crate::replica::replica;
use crate::window::Begin;
use nalgebra::{Cholesky, DMatrix};
use std::sync::Arc;

/// Steps in which the fitted model settles on a replica.
const STEPS: usize = 4;

/// What a fit misses from rest, in ln likelihood.
pub(crate) struct Missed<'a> {
    problem: &'a Problem,
    fit: &'a Fit,
    /// How well the records tell the numbers of the fit.
    known: DMatrix<f64>,
    /// The held-out record, and the fit there.
    held_out: Option<(Problem, Fit)>,
}

impl<'a> Missed<'a> {
    pub fn new(problem: &'a Problem, fit: &'a Fit) -> Self {
        let held_out = problem.held_out.as_ref();
        Self {
            problem,
            fit,
            known: fit.curvature(&problem.long),
            held_out: held_out.map(|unseen| {
                let there = there(fit, unseen.clone());
                let long = there.0;
                let posed = Problem {
                    long,
                    held_out: None,
                    ..problem.clone()
                };
                (posed, there.1)
            }),
        }
    }

    /// Of the records, and of the held-out one.
    pub fn of_records(&self) -> f64 {
        let learned = excess(
            &self.problem.long,
            &self.fit.reduced(&self.problem.long),
            None,
        );
        let held_out = self.held_out.as_ref().map_or(0.0, |(posed, there)| {
            excess(&posed.long, &there.reduced(&posed.long), Some(&self.known))
        });
        learned + held_out
    }

    /// The same of replica number `seed` of all of them; `None` where the model cannot run through one.
    pub fn of_replica(&self, seed: u64) -> Option<f64> {
        let learned = replica(self.problem, self.fit, seed)?;
        let (settled, data) = self.fit.settled(self.problem, learned, STEPS);
        let mut missed = excess(&data, &settled.reduced(&data), None);
        if let Some((posed, fit)) = &self.held_out {
            let runs = Arc::new(replica(posed, fit, seed)?);
            let (data, there) = there(self.fit, posed.windows_of(runs, Begin::Clear));
            missed += excess(&data, &there.reduced(&data), Some(&self.known));
        }
        Some(missed)
    }
}

/// The fit with its numbers as they are on windows that it has not seen.
fn there(fit: &Fit, unseen: Data) -> (Data, Fit) {
    let data = if fit.disturbance == Disturbance::NONE {
        unseen.undivided()
    } else {
        unseen
    };
    let there = Fit::at(
        &data,
        fit.hypothesis.clone(),
        data.anchors(),
        fit.disturbance,
    );
    let found = there.with_lost_starts(&data);
    (data, found)
}

/// What windows that start from rest leave beyond what the instruments and numbers that are `known` so well can explain, in ln
/// likelihood.
fn excess(data: &Data, forms: &[Option<Reduced>], known: Option<&DMatrix<f64>>) -> f64 {
    let windows = forms.iter().zip(&data.windows);
    let from_rest = windows.filter(|(_, window)| window.is_start_known());
    let each = from_rest.filter_map(|(form, _)| form.as_ref()).map(|form| {
        let n = form.residuals.max(1) as f64;
        (0.5 * n * (square(form, known) / (MOST_MISFIT * n)).ln()).max(0.0)
    });
    each.sum()
}

/// Squared residuals, less what the uncertainty of the numbers explains.
fn square(form: &Reduced, known: Option<&DMatrix<f64>>) -> f64 {
    let uncertain = known.and_then(|known| Cholesky::new(&form.curvature + known));
    let explained = uncertain.map_or(0.0, |c| form.gradient.dot(&c.solve(&form.gradient)));
    form.square - explained
}
