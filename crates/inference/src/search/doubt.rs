//! Whether what an effect gains is chance: replicas of the records, made without it, are explained with it and without it.

use std::sync::Arc;

use super::candidate::candidate;
use super::{Candidate, best_first};
use crate::fit::Fit;
use crate::hypothesis::Free;
use crate::policy::{LN_PRIOR_ODDS, REPLICAS, SIGNIFICANT, SURELY};
use crate::problem::Problem;
use crate::replica::{exceeded, replica};
use crate::window::Begin;

/// Steps of the fits to a replica.
const STEPS: usize = 8;

/// Puts the set first that no doubt takes away: sets whose last effect gains what replicas without it gain too are no answers, and
/// those that gain less over the same effects are none all the more.
pub(super) fn weigh(problem: &Problem, known: &mut [Candidate], progress: &mut dyn FnMut(&str)) {
    let mut settled: Vec<(Vec<&'static str>, &'static str)> = Vec::new();
    loop {
        best_first(known);
        let is_answer = known[0].score() > f64::NEG_INFINITY;
        if is_answer && has_a_vanishing_effect(problem, &known[0]) {
            known[0].is_at_limit = true;
            continue;
        }
        let best = known[0].clone();
        let doubted = best
            .effects
            .iter()
            .filter(|name| !settled.contains(&(best.effects.clone(), name)))
            .filter_map(|name| {
                let fewer = without(known, &best, name)?;
                let gain = best.lead(fewer) - LN_PRIOR_ODDS;
                Some((*name, fewer.clone(), gain))
            })
            .min_by(|a, b| a.2.total_cmp(&b.2));
        let Some((name, fewer, gain)) = doubted else {
            return;
        };
        progress(&format!("replicas without {}", name.replace('_', " ")));
        let p_value = chance(problem, &best, &fewer, gain);
        settled.push((best.effects.clone(), name));
        if p_value < SIGNIFICANT {
            continue;
        }
        for other in known.iter_mut() {
            let is_larger = other.effects.len() == fewer.effects.len() + 1
                && fewer.effects.iter().all(|own| other.effects.contains(own));
            if is_larger && other.lead(&fewer) - LN_PRIOR_ODDS <= gain {
                other.p_value = Some(p_value);
            }
        }
    }
}

/// Whether an effect of the set may as well have no size: no number that is nothing where the effect is none is surely something.
fn has_a_vanishing_effect(problem: &Problem, set: &Candidate) -> bool {
    let estimates = set.fit.estimates(&problem.long);
    let is_something = |name: &str, nothing: f64| {
        estimates
            .iter()
            .any(|own| own.name == name && (own.value - nothing).abs() > SURELY * own.deviation)
    };
    set.effects.iter().any(|effect| {
        let is_own = |name: &str| name.split('.').next() == Some(*effect);
        let sizes: Vec<bool> = set
            .fit
            .hypothesis
            .free
            .iter()
            .filter_map(|free| match free {
                Free::Value { name, origin, .. } if is_own(name) => {
                    Some(is_something(name, *origin))
                }
                Free::Polar { amplitude, .. } if is_own(amplitude) => {
                    Some(is_something(amplitude, 0.0))
                }
                _ => None,
            })
            .collect();
        !sizes.is_empty() && !sizes.contains(&true)
    })
}

/// The set without an effect, if it was fitted.
fn without<'a>(known: &'a [Candidate], best: &Candidate, name: &str) -> Option<&'a Candidate> {
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
    (looks * exceeded(gain, gains)).min(1.0)
}

/// What the effect of `best` that `fewer` lacks gains on replica number `seed` of the latter.
fn gain_on_replica(
    problem: &Problem,
    best: &Candidate,
    fewer: &Candidate,
    seed: u64,
) -> Option<f64> {
    let runs = replica(problem, &fewer.fit, seed)?;
    let long = problem.windows_of(Arc::new(runs), Begin::Clear);
    let replayed = Problem {
        long,
        ..problem.clone()
    };
    let data = &replayed.long;
    let disturbance = fewer.fit.disturbance;
    let right = Fit::at(
        data,
        fewer.fit.hypothesis.clone(),
        data.anchors(),
        disturbance,
    )
    .improved(data, STEPS);
    let mut hypothesis = best.fit.hypothesis.clone();
    hypothesis.take_over(&right.hypothesis);
    let more = Fit::at(data, hypothesis, right.starts.clone(), disturbance).improved(data, STEPS);
    let [right, more] = [right, more].map(|fit| candidate(&replayed, fit));
    Some(more.lead(&right) - LN_PRIOR_ODDS)
}
