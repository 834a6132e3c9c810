//! A set of effects, fitted, and what speaks for it.

use crate::data::Data;
use crate::effects::Effect;
use crate::evidence::Told;
use crate::fit::Fit;
use crate::hypothesis::Estimate;
use crate::policy::{LN_PRIOR_ODDS, SURELY};
use crate::problem::Problem;
use crate::sets::EffectSet;

/// Why a set of effects is no answer, whatever its evidence.
#[derive(Clone, Debug, PartialEq)]
pub enum Objection {
    /// These numbers are best where their ranges end, by dotted name.
    AtAnEnd(Vec<String>),
    /// Each of these effects may be none, or its law a simpler one: the 95 % intervals of all numbers that make it vanish contain the
    /// values at which it does. Such a set is one without the effect, and where it explains more all the same, its fit has found other
    /// starts of windows. Laplace's method cannot tell, since it charges nothing for a number all of whose values say the same.
    MayVanish(Vec<&'static str>),
    /// Probability that replicas of the records without one of its effects gain as much by it.
    ByChance(f64),
}

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
    /// What speaks against it as an answer.
    pub objection: Option<Objection>,
}

impl Candidate {
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

impl EffectSet for Candidate {
    /// An effect more must lead alone: whether that is chance, replicas tell.
    fn least_lead() -> f64 {
        0.0
    }

    fn effects(&self) -> &[&'static str] {
        &self.effects
    }

    fn is_answer(&self) -> bool {
        self.objection.is_none()
    }

    fn evidence(&self) -> f64 {
        self.evidence
    }

    fn odds(&self) -> f64 {
        with_prior(self.evidence, self.effects.len())
    }

    fn odds_over(&self, other: &Self) -> f64 {
        if self.effects.len() > other.effects.len() {
            self.lead(other)
        } else {
            -other.lead(self)
        }
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
    let added = problem.effects_of(&fit.hypothesis);
    let objection = objection(&fit, &problem.long, &added);
    Candidate {
        effects: added.iter().map(|effect| effect.name).collect(),
        fit,
        evidence,
        told,
        foretold,
        objection,
    }
}

/// What a fit by itself says against a set.
fn objection(fit: &Fit, data: &Data, effects: &[&Effect]) -> Option<Objection> {
    let ends = fit.hypothesis.at_an_end();
    if ends.is_empty() {
        return may_vanish(effects, &fit.estimates(data));
    }
    let ends = ends.into_iter().map(str::to_owned).collect();
    Some(Objection::AtAnEnd(ends))
}

/// Which of the effects may vanish, if one may, by what is known of their numbers.
pub(super) fn may_vanish(effects: &[&Effect], known: &[Estimate]) -> Option<Objection> {
    let may_be = |(name, value): (String, f64)| {
        let own = known.iter().find(|own| own.name == name);
        own.is_some_and(|own| (own.value - value).abs() < SURELY * own.deviation)
    };
    let vanishing: Vec<&'static str> = effects
        .iter()
        .filter(|effect| {
            let numbers = effect.vanishing();
            !numbers.is_empty() && numbers.into_iter().all(may_be)
        })
        .map(|effect| effect.name)
        .collect();
    (!vanishing.is_empty()).then_some(Objection::MayVanish(vanishing))
}
