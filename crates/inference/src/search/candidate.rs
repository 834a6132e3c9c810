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
    /// Whether a law of the set is what it becomes in its limit, as far as its numbers are known.
    pub is_at_limit: bool,
    /// Probability that replicas of the records without one of its effects gain as much by it; `None` where there was no doubt.
    pub p_value: Option<f64>,
}

impl Candidate {
    /// Log evidence and prior odds of its effects; nothing speaks for a set one of whose numbers is best where its range ends, whose
    /// law may as well be the one that it becomes in its limit, or that replicas gain from too.
    #[must_use]
    pub fn score(&self) -> f64 {
        let hypothesis = &self.fit.hypothesis;
        if hypothesis.at_an_end().is_empty() && !self.is_at_limit && self.p_value.is_none() {
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
    let is_at_limit = is_at_limit(&fit, &problem.long, &added);
    Candidate {
        effects: added.iter().map(|effect| effect.name).collect(),
        fit,
        evidence,
        told,
        foretold,
        is_at_limit,
        p_value: None,
    }
}

/// Whether the number that tells an effect from its limit is within its 95 % interval of vanishing. There the windows say the same
/// of all its values, so that Laplace's method charges nothing for it, and the simpler law could never win.
fn is_at_limit(fit: &Fit, data: &Data, effects: &[&Effect]) -> bool {
    let telling: Vec<&str> = effects
        .iter()
        .filter_map(|effect| effect.vanishing())
        .collect();
    !telling.is_empty()
        && fit
            .estimates(data)
            .iter()
            .any(|own| telling.contains(&own.name.as_str()) && own.value < SURELY * own.deviation)
}
