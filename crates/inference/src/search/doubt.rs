//! Whether what an effect gains is chance: replicas of the records, made without it, are explained with it and without it.

use super::candidate::{Objection, candidate, may_vanish};
use super::looks::is_near;
use super::race::{NEAR, race};
use super::{Candidate, rebuilt};
use crate::certainty::ReplayedEstimates;
use crate::fit::{self, Fit};
use crate::policy::{LN_PRIOR_ODDS, REPLICAS, SIGNIFICANT};
use crate::problem::Problem;
use crate::replica::{exceeded, replica};
use crate::sets::{EffectSet as _, best_first, keep};

/// Steps of the fits to a replica.
const STEPS: usize = 8;

/// Puts the set first that no doubt takes away, and tells its numbers: sets whose last effect gains what replicas without it gain too
/// are no answers, and those that gain less over the same effects are none all the more. Nor is a set one of whose effects may vanish
/// by what replicas tell of its numbers.
pub(super) fn weigh(
    problem: &Problem,
    known: &mut Vec<Candidate>,
    progress: &mut dyn FnMut(&str),
) -> ReplayedEstimates {
    let mut settled: Vec<(Vec<&'static str>, &'static str)> = Vec::new();
    let mut finished: Vec<Vec<&'static str>> = Vec::new();
    loop {
        best_first(known);
        let best = known[0].clone();
        let unfinished = known.iter().position(|own| {
            let is_near = own.is_answer() && own.odds_over(&best) > -NEAR;
            let is_open = !own.fit.is_converged && !finished.contains(&own.effects);
            is_open && (is_near || own.effects == best.effects)
        });
        if let Some(at) = unfinished {
            let fit = known[at].fit.clone();
            finished.push(known[at].effects.clone());
            known[at] = candidate(problem, fit.improved(&problem.long, 2 * fit::STEPS));
            continue;
        }
        let open = best.effects.iter().copied();
        let doubted = open
            .filter(|name| !settled.contains(&(best.effects.clone(), name)))
            .filter_map(|name| Some((name, best.lead(best_without(known, &best, name)?))))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((name, _)) = doubted else {
            progress("what replicas of the records tell of the numbers");
            let numbers = best.fit.replayed_estimates(problem);
            let effects = problem.effects_of(&best.fit.hypothesis);
            let objection = may_vanish(&effects, &numbers.estimates);
            if best.objection.is_none() && objection.is_some() {
                known[0].objection = objection;
                continue;
            }
            return numbers;
        };
        settled.push((best.effects.clone(), name));
        let fewer = fitted_without(problem, &best, name, known);
        // Where no model without the effect could be right, there is no doubt.
        if !is_near(problem, &fewer) {
            continue;
        }
        let gain = best.lead(&fewer) - LN_PRIOR_ODDS;
        progress(&format!("replicas without {}", name.replace('_', " ")));
        let p_value = chance(problem, &best, &fewer, gain);
        if p_value < SIGNIFICANT {
            continue;
        }
        for other in known.iter_mut() {
            let is_larger = other.effects.len() == fewer.effects.len() + 1
                && fewer.effects.iter().all(|own| other.effects.contains(own));
            if is_larger && other.lead(&fewer) - LN_PRIOR_ODDS <= gain {
                other.objection.get_or_insert(Objection::ByChance(p_value));
            }
        }
    }
}

/// The set without an effect, from where that stands with it: where the same windows are missed and friction fluctuates as much, the
/// effect alone makes the difference.
fn fitted_without(
    problem: &Problem,
    best: &Candidate,
    name: &str,
    known: &mut Vec<Candidate>,
) -> Candidate {
    let data = &problem.long;
    let own = best.effects.iter().copied();
    let rest: Vec<&'static str> = own.filter(|own| *own != name).collect();
    let hypothesis = rebuilt(problem, &rest, &best.fit.hypothesis);
    let fit = Fit::at(
        data,
        hypothesis,
        best.fit.starts.clone(),
        best.fit.disturbance,
    );
    let raced = race(problem, vec![fit], best.odds(), &mut |_| {}).remove(0);
    let mut fewer = candidate(problem, raced);
    if is_near(problem, &fewer) {
        fewer = candidate(problem, fewer.fit.improved(data, fit::STEPS));
    }
    keep(known, fewer.clone());
    best_without(known, best, name).cloned().unwrap_or(fewer)
}

/// The set without an effect, if it was fitted.
fn best_without<'a>(known: &'a [Candidate], best: &Candidate, name: &str) -> Option<&'a Candidate> {
    known.iter().find(|other| {
        other.effects.len() + 1 == best.effects.len()
            && !other.effects.contains(&name)
            && other.effects.iter().all(|own| best.effects.contains(own))
    })
}

/// Probability that one of all effects gains so much on records that `fewer` explains, 1 where that cannot run through them. Gains
/// fall off exponentially: where the first replica, or the prior odds, show that so much is far beyond, the others are not needed.
fn chance(problem: &Problem, best: &Candidate, fewer: &Candidate, gain: f64) -> f64 {
    let looks = problem
        .effects
        .iter()
        .filter(|effect| effect.is_possible(&problem.rig))
        .count() as f64;
    let mut gains = Vec::new();
    for seed in 1..=REPLICAS {
        let Some(own) = gain_on_replica(problem, best, fewer, seed) else {
            return 1.0;
        };
        gains.push(own);
        let is_beyond = gain > (looks / SIGNIFICANT).ln() * own.max(-LN_PRIOR_ODDS);
        if own >= gain {
            break;
        }
        if seed == 1 && is_beyond {
            return 0.0;
        }
    }
    exceeded(gain, gains).map_or(1.0, |p_value| (looks * p_value).min(1.0))
}

/// What the effect of `best` that `fewer` lacks gains on replica number `seed` of the latter.
fn gain_on_replica(
    problem: &Problem,
    best: &Candidate,
    fewer: &Candidate,
    seed: u64,
) -> Option<f64> {
    let replica = replica(problem, &fewer.fit, seed)?;
    let (right, long) = fewer.fit.settled(problem, replica, STEPS);
    let mut hypothesis = best.fit.hypothesis.clone();
    hypothesis.take_over(&right.hypothesis);
    let more = Fit::at(&long, hypothesis, right.starts.clone(), right.disturbance)
        .improved_alike(&long, STEPS)
        .with_lost_starts(&long);
    let replayed = Problem {
        long,
        ..problem.clone()
    };
    let [right, more] = [right, more].map(|fit| candidate(&replayed, fit));
    Some(more.lead(&right) - LN_PRIOR_ODDS)
}
