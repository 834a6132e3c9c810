//! From the sets that were searched to an answer: a table of three numbers, the posterior, the check and what moved.

use crate::certainty::ReplayedEstimates;
use crate::check::{Check, check};
use crate::data::BLOCK;
use crate::fit::Fit;
use crate::learned::{Learned, friction_over_speed, learn};
use crate::policy::{LN_PRIOR_ODDS, SURELY, is_no_chance};
use crate::problem::Problem;
use crate::search::{Candidate, Objection, Search, search};
pub use crate::sets::Verdict;
use crate::sets::{EffectSet as _, probabilities, sum_and_error};
use crate::structure::{Structure, structures};

/// A set of effects beside the best one.
#[derive(Clone, Debug, PartialEq)]
pub struct Rival {
    /// The effects; empty for the analyst's model.
    pub effects: Vec<&'static str>,
    /// Posterior probability of the set, 0 … 1.
    pub probability: f64,
    /// Log odds of the set against the best one.
    pub score: f64,
    /// Why it is no answer, if it is none.
    pub objection: Option<Objection>,
    /// Gain of the best set over this one in ln likelihood on windows that were not fitted to.
    pub margin: f64,
    /// Standard error of that gain, from the scatter of blocks of windows.
    pub margin_error: f64,
    /// Gain of this set over the analyst's refitted model in ln likelihood on windows that were not fitted to.
    pub gain: f64,
    /// Standard error of that gain.
    pub gain_error: f64,
    /// Whether its fit converged.
    pub is_converged: bool,
}

/// All that was found, in the plant's units ([`Problem::units`]).
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// What it comes to.
    pub verdict: Verdict,
    /// The effects of the best set, whatever the verdict; empty where none is better than the analyst's model.
    pub effects: Vec<&'static str>,
    /// Posterior probability of that set, 0 … 1.
    pub probability: f64,
    /// All sets that were fitted, the best first.
    pub ranking: Vec<Rival>,
    /// The analyst's model with its parameters refitted.
    pub base: Fit,
    /// The best set's fit.
    pub best: Fit,
    /// Values and deviations of all that is free in the fit that the amended model is made of.
    pub numbers: ReplayedEstimates,
    /// Where the analyst's model leaves structure, strongest first.
    pub structure: Vec<Structure>,
    /// Where the best set does, strongest first.
    pub structure_left: Vec<Structure>,
    /// Whether the best set explains the records.
    pub check: Check,
    /// The free function that explains most; looked for where the check failed.
    pub learned: Option<Learned>,
    /// Whether what was known of the model's numbers before had to be doubted ([`Problem::doubting`]).
    pub is_doubting: bool,
}

impl Diagnosis {
    /// Probability that this effect is missing, whatever else is missing beside it.
    #[must_use]
    pub fn probability_of(&self, effect: &str) -> f64 {
        probability_of(&self.ranking, effect)
    }

    /// The fit that the amended model is made of: the best set where it is named, else the analyst's refitted model.
    #[must_use]
    pub fn amended(&self) -> &Fit {
        match self.verdict {
            Verdict::Named | Verdict::Ambiguous => &self.best,
            _ => &self.base,
        }
    }
}

/// Finds what is missing; `progress` hears of what is being fitted.
///
/// An effect can stand in for a number that is further off than the model says, or other numbers can. So where the best set contradicts
/// what was known of them, the records are asked again with less faith in it.
#[must_use]
pub fn diagnose(problem: &Problem, progress: &mut dyn FnMut(&str)) -> Diagnosis {
    let first = Explanation::of(problem, progress);
    if first.may_be_of_numbers() && is_no_chance(&first.best().fit.hypothesis.nominal_deviations())
    {
        let doubting = problem.doubting();
        let again = Explanation::of(&doubting, progress);
        if again.check.is_passed() {
            let found = again.finish(&doubting, progress);
            return Diagnosis {
                verdict: match found.verdict {
                    Verdict::NothingMissing => Verdict::Parameters,
                    other => other,
                },
                is_doubting: true,
                ..found
            };
        }
    }
    first.finish(problem, progress)
}

/// The best set of effects, and what it leaves.
struct Explanation {
    found: Search,
    structure: Vec<Structure>,
    structure_left: Vec<Structure>,
    check: Check,
}

impl Explanation {
    fn of(problem: &Problem, progress: &mut dyn FnMut(&str)) -> Self {
        let found = search(problem, progress);
        progress("what is left");
        let data = &problem.long;
        let best = &found.candidates[0];
        let structure = structures(data, &found.base.fit);
        let structure_left = if best.effects.is_empty() {
            structure.clone()
        } else {
            structures(data, &best.fit)
        };
        let mut check = check(problem, &best.fit, &structure_left, progress);
        if check.is_passed()
            && let Some(lead) = lead_of_function(problem, &found.base.fit, best, progress)
            && lead > 0.0
        {
            check.reasons.push(format!(
                "friction as a free function of the speed explains more than {}, by {lead:.0} in log evidence",
                best.effects.join(" and ").replace('_', " ")
            ));
        }
        Self {
            found,
            structure,
            structure_left,
            check,
        }
    }

    fn best(&self) -> &Candidate {
        &self.found.candidates[0]
    }

    /// Whether wrong numbers could be all there is. Where effects gain and yet do not explain the records, something else is missing.
    fn may_be_of_numbers(&self) -> bool {
        self.best().effects.is_empty() || self.check.is_passed()
    }

    fn finish(self, problem: &Problem, progress: &mut dyn FnMut(&str)) -> Diagnosis {
        let Self { found, check, .. } = self;
        let best = &found.candidates[0];
        let learned = if check.is_passed() {
            None
        } else {
            learn(problem, &found.base.fit, progress)
        };
        let ranking = ranking(problem, &found.candidates, &found.base);
        let probability = ranking.first().map_or(0.0, |rival| rival.probability);
        let of_effects: Vec<f64> = best
            .effects
            .iter()
            .map(|name| probability_of(&ranking, name))
            .collect();
        let verdict = Verdict::of(check.is_passed(), &of_effects, moved(&found.base.fit));
        let numbers = if verdict == Verdict::NotInCatalogue && !best.effects.is_empty() {
            found.base.fit.replayed_estimates(problem)
        } else {
            found.numbers
        };
        Diagnosis {
            verdict,
            effects: best.effects.clone(),
            probability,
            ranking,
            numbers,
            base: found.base.fit.clone(),
            best: best.fit.clone(),
            structure: self.structure,
            structure_left: self.structure_left,
            check,
            learned,
            is_doubting: false,
        }
    }
}

/// Log odds of friction that is a free function of the speed over a set with a law of velocity and acceleration. Such a law bends almost
/// as freely, so that it must explain more.
fn lead_of_function(
    problem: &Problem,
    base: &Fit,
    set: &Candidate,
    progress: &mut dyn FnMut(&str),
) -> Option<f64> {
    if !set.fit.hypothesis.rig.law.has_branches() || problem.rig.law.has_branches() {
        return None;
    }
    let function = friction_over_speed(problem, base, progress)?;
    let fewer = set.effects.len() as f64 - 1.0;
    Some(function.gain_over(&set.told) - LN_PRIOR_ODDS * fewer)
}

fn probability_of(ranking: &[Rival], effect: &str) -> f64 {
    ranking
        .iter()
        .filter(|rival| rival.effects.contains(&effect))
        .map(|rival| rival.probability)
        .sum()
}

/// Whether any nominal parameter is further off than what is known of it allows to overlook.
fn moved(fit: &Fit) -> bool {
    let nominal = fit.hypothesis.nominal_deviations();
    nominal.iter().any(|off| off.abs() > SURELY)
}

fn ranking(problem: &Problem, candidates: &[Candidate], base: &Candidate) -> Vec<Rival> {
    let data = &problem.long;
    let losses = |candidate: &Candidate| candidate.fit.held_out_losses(data);
    let (best, nothing) = (losses(&candidates[0]), losses(base));
    let mut ranking: Vec<Rival> = candidates
        .iter()
        .zip(probabilities(candidates))
        .map(|(candidate, probability)| {
            let own = losses(candidate);
            let (margin, margin_error) = gain(&own, &best);
            let (gain, gain_error) = gain(&nothing, &own);
            Rival {
                effects: candidate.effects.clone(),
                probability,
                score: candidate.odds_over(&candidates[0]),
                objection: candidate.objection.clone(),
                margin,
                margin_error,
                gain,
                gain_error,
                is_converged: candidate.fit.is_converged,
            }
        })
        .collect();
    ranking[1..].sort_by(|a, b| {
        let is_objected = |own: &Rival| own.objection.is_some();
        is_objected(a)
            .cmp(&is_objected(b))
            .then(b.score.total_cmp(&a.score))
    });
    ranking
}

/// What `better` gains over `worse` in ln likelihood, with its standard error from the scatter of blocks of windows.
pub(crate) fn gain(worse: &[Option<f64>], better: &[Option<f64>]) -> (f64, f64) {
    let differences: Vec<f64> = worse
        .iter()
        .zip(better)
        .map(|(worse, better)| match (worse, better) {
            (Some(worse), Some(better)) => 0.5 * (worse - better),
            _ => 0.0,
        })
        .collect();
    let blocks: Vec<f64> = differences
        .chunks(BLOCK)
        .map(|block| block.iter().sum())
        .collect();
    sum_and_error(&blocks)
}
