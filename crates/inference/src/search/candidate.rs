//! A set of effects, fitted, and what speaks for it.

use crate::data::Data;
use crate::effects::Effect;
use crate::evidence::Told;
use crate::fit::Fit;
use crate::policy::{LN_PRIOR_ODDS, SURELY};
use crate::problem::Problem;

/// A set of effects, fitted.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The effects in the catalogue's order.
    pub effects: Vec<&'static str>,
    /// The fit.
    pub fit: Fit,
    /// Log evidence.
    pub evidence: f64,
    /// The same window by window.
    pub told: Told,
    /// Log likelihood of windows under what the other half of the records teaches.
    pub foretold: Told,
    /// Whether one of its effects may as well be none, or its law a simpler one, as far as its numbers are known.
    pub may_vanish: bool,
    /// Probability that replicas of the records without one of its effects gain as much by it; `None` where there was no doubt.
    pub p_value: Option<f64>,
}

impl Candidate {
    /// Log evidence and prior odds of its effects; nothing speaks for a set one of whose numbers is best where its range ends, one
    /// of whose effects may as well be none, or that replicas gain from too.
    #[must_use]
    pub fn score(&self) -> f64 {
        let hypothesis = &self.fit.hypothesis;
        if hypothesis.at_an_end().is_empty() && !self.may_vanish && self.p_value.is_none() {
            self.odds()
        } else {
            f64::NEG_INFINITY
        }
    }
}

impl Candidate {
    /// Log evidence and prior odds of its effects, whether it is an answer or not.
    #[must_use]
    pub fn odds(&self) -> f64 {
        with_prior(self.evidence, self.effects.len())
    }

    /// Log odds of this set over `other`, whichever has more effects.
    #[must_use]
    pub fn odds_over(&self, other: &Self) -> f64 {
        if self.effects.len() > other.effects.len() {
            self.lead(other)
        } else {
            -other.lead(self)
        }
    }

    /// Log odds of this set over `other`, which has no more effects.
    #[must_use]
    pub fn lead(&self, other: &Self) -> f64 {
        let more = self.effects.len() as f64 - other.effects.len() as f64;
        let gain = self.told.gain_over(&other.told);
        // What an effect explains it must also foretell.
        let sure = if more > 0.0 {
            gain.min(self.foretold.gain_over(&other.foretold))
        } else {
            gain
        };
        sure + LN_PRIOR_ODDS * more
    }
}

/// Log evidence and prior odds of a set of so many effects.
pub(super) fn with_prior(evidence: f64, effects: usize) -> f64 {
    evidence + LN_PRIOR_ODDS * effects as f64
}

/// The set that `fit` is of, with what the windows tell of it.
pub(super) fn candidate(problem: &Problem, fit: Fit) -> Candidate {
    let told = fit.told(&problem.long);
    let evidence = told.total();
    let foretold = fit.foretold(&problem.long);
    let added: Vec<&Effect> = problem
        .effects
        .iter()
        .filter(|effect| fit.hypothesis.effects.iter().any(|own| own == effect.name))
        .collect();
    let may_vanish = may_vanish(&fit, &problem.long, &added);
    Candidate {
        effects: added.iter().map(|effect| effect.name).collect(),
        fit,
        evidence,
        told,
        foretold,
        may_vanish,
        p_value: None,
    }
}

/// Whether all numbers that make one of the effects vanish are within their 95 % intervals of doing so. Such a set is one without the
/// effect: where it explains more all the same, its fit has found other starts. Laplace's method cannot tell: the windows may say the
/// same of all values down to the vanishing one, so that it charges nothing for them.
fn may_vanish(fit: &Fit, data: &Data, effects: &[&Effect]) -> bool {
    let estimates = fit.estimates(data);
    let is_near = |(name, value): (String, f64)| {
        let own = estimates.iter().find(|own| own.name == name);
        own.is_some_and(|own| (own.value - value).abs() < SURELY * own.deviation)
    };
    effects
        .iter()
        .map(|effect| effect.vanishing())
        .any(|numbers| !numbers.is_empty() && numbers.into_iter().all(is_near))
}
