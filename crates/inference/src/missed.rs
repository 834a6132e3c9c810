//! What a model misses: windows that start from rest, and leave more than the instruments can.
//!
//! Elsewhere a window may be missed because its start was not found. The start of one from rest is known, so that nothing excuses it.
//! One window may be missed all the same, where friction that fluctuates lets the disc go a moment later; replicas of the records tell
//! how often.

use crate::data::Data;
use crate::fit::Fit;
use crate::marginal::Reduced;
use crate::policy::{MOST_MISFIT, MOST_TOLD};
use crate::problem::Problem;
use crate::replica::{STEPS, replica};
use crate::window::Begin;
use nalgebra::{Cholesky, DMatrix};
use std::sync::Arc;

/// Windows from rest, and how many of them a model misses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FromRest {
    /// All of them.
    pub windows: usize,
    /// Those that the model misses.
    pub missed: usize,
}

impl std::ops::Add for FromRest {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            windows: self.windows + other.windows,
            missed: self.missed + other.missed,
        }
    }
}

impl FromRest {
    /// Probability that as many of these are missed as there are, if those of `replicas` are missed as easily: that of
    /// drawing so many from all that are missed (hypergeometric distribution).
    #[must_use]
    pub fn chance(self, replicas: Self) -> f64 {
        let all = self + replicas;
        // The windows are drawn one after the other, and `by_missed[k]` is the probability that k of them are missed ones.
        let mut by_missed = vec![0.0; self.windows + 1];
        by_missed[0] = 1.0;
        for drawn in 0..self.windows {
            for missed in (0..=drawn).rev() {
                let left = all.missed.saturating_sub(missed) as f64;
                let share = left / (all.windows - drawn) as f64;
                let before = by_missed[missed];
                by_missed[missed + 1] += before * share;
                by_missed[missed] = before * (1.0 - share);
            }
        }
        by_missed[self.missed..].iter().sum()
    }
}

/// The records and the held-out one, as a fit meets them.
pub(crate) struct Encounter<'a> {
    problem: &'a Problem,
    fit: &'a Fit,
    /// How well the records tell the numbers of the fit.
    known: DMatrix<f64>,
    /// The held-out record, and the fit there.
    held_out: Option<(Problem, Fit)>,
}

impl<'a> Encounter<'a> {
    pub fn new(problem: &'a Problem, fit: &'a Fit) -> Self {
        let held_out = problem.held_out.clone().map(|unseen| {
            let (there, long) = fit.carried_to(unseen);
            let posed = Problem {
                long,
                held_out: None,
                ..problem.clone()
            };
            (posed, there)
        });
        Self {
            problem,
            fit,
            known: fit.curvature(&problem.long),
            held_out,
        }
    }

    /// Of the records themselves.
    pub fn of_records(&self) -> FromRest {
        let data = &self.problem.long;
        let learned = from_rest(data, &self.fit.reduced(data), None);
        let held_out = self.held_out.as_ref().map(|(posed, there)| {
            from_rest(&posed.long, &there.reduced(&posed.long), Some(&self.known))
        });
        learned + held_out.unwrap_or_default()
    }

    /// Of replica number `seed`; `None` where the model cannot run through it.
    pub fn of_replica(&self, seed: u64) -> Option<FromRest> {
        let learned = replica(self.problem, self.fit, seed)?;
        let (settled, data) = self.fit.settled(self.problem, learned, STEPS);
        let learned = from_rest(&data, &settled.reduced(&data), None);
        let Some((posed, fit)) = &self.held_out else {
            return Some(learned);
        };
        let runs = Arc::new(replica(posed, fit, seed)?);
        let (there, data) = self.fit.carried_to(posed.windows_of(runs, Begin::Clear));
        Some(learned + from_rest(&data, &there.reduced(&data), Some(&self.known)))
    }
}

/// Windows from rest. The model misses one that it cannot run through, or that leaves more than instruments and numbers that are `known`
/// so well explain, by as much as one window may tell.
fn from_rest(data: &Data, forms: &[Option<Reduced>], known: Option<&DMatrix<f64>>) -> FromRest {
    let is_missed = |form: &Reduced| {
        let n = form.residuals.max(1) as f64;
        0.5 * n * (square(form, known) / (MOST_MISFIT * n)).ln() > MOST_TOLD
    };
    let windows = forms.iter().zip(&data.windows);
    let from_rest = windows.filter(|(_, window)| window.is_start_known());
    let each: Vec<bool> = from_rest
        .map(|(form, _)| form.as_ref().is_none_or(is_missed))
        .collect();
    FromRest {
        windows: each.len(),
        missed: each.into_iter().filter(|missed| *missed).count(),
    }
}

/// Squared residuals, less what the uncertainty of the numbers explains.
fn square(form: &Reduced, known: Option<&DMatrix<f64>>) -> f64 {
    let uncertain = known.and_then(|known| Cholesky::new(&form.curvature + known));
    let explained = uncertain.map_or(0.0, |c| form.gradient.dot(&c.solve(&form.gradient)));
    form.square - explained
}

#[cfg(test)]
mod tests {
    use super::FromRest;

    const fn of(windows: usize, missed: usize) -> FromRest {
        FromRest { windows, missed }
    }

    #[test]
    fn the_chance_is_that_of_drawing_so_many() {
        let none = of(45, 0);
        assert!((of(5, 0).chance(none) - 1.0).abs() < 1e-12);
        assert!((of(5, 1).chance(none) - 0.1).abs() < 1e-12);
        // C(5, 2) of C(50, 2) pairs.
        assert!((of(5, 2).chance(none) - 10.0 / 1225.0).abs() < 1e-12);
        // All five of the seven that are missed: C(7, 5) of C(50, 5).
        assert!((of(5, 5).chance(of(45, 2)) - 21.0 / 2_118_760.0).abs() < 1e-12);
    }
}
