//! Naming: sets of effects on top of the analyst's model compete by what they explain of records that were left out.

use rayon::prelude::*;

use super::certainty::Certainty;
use super::evidence::Errors;
use super::least_squares::{Fit, Linearised, SETTLED, fit, intervals};
use super::model::Model;
use super::motion::Scales;
use super::problem::Problem;
use super::term::Entry;
use crate::policy::{LN_PRIOR_ODDS, sure_odds};
use crate::sets::{EffectSet, Moves, explore, is_same, keep, probabilities};
use stickslip::body::Kind;
use stickslip::body::coordinate::TIME;

/// Most effects in a set. It bounds the search and decides nothing: EMPS, the richest of the real measurements, comes to seven.
pub const MOST_EFFECTS: usize = 8;
/// Steps of a first look at each start, and of fits that are carried to the end.
const FIRST_LOOK: usize = 8;
const TO_THE_END: usize = 40;
/// Sets of one effect more that are tried with all further effects: more cost time alone.
const RIVALS: usize = 3;

/// A set of effects, fitted.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The effects in the order in which they were added.
    pub entries: Vec<&'static Entry>,
    /// Their names.
    pub names: Vec<&'static str>,
    /// The model with them.
    pub fit: Fit,
    /// Its errors on what was left out.
    pub errors: Errors,
    /// Gain in ln likelihood over the analyst's refitted model.
    evidence: f64,
    /// What its places and widths cost, in log odds ([`Certainty`]).
    price: f64,
    /// Effects whose size may be zero, or whose widths may be any ([`Certainty`]).
    unneeded: Vec<&'static str>,
}

impl EffectSet for Candidate {
    fn least_lead() -> f64 {
        sure_odds()
    }

    /// The numbers that records must tell: two effects of one number each are plainer than one of three.
    fn size(&self) -> usize {
        self.entries.iter().map(|own| own.parameters.len()).sum()
    }

    fn effects(&self) -> &[&'static str] {
        &self.names
    }

    fn is_answer(&self) -> bool {
        self.unneeded.is_empty()
    }

    fn evidence(&self) -> f64 {
        self.evidence
    }

    fn odds(&self) -> f64 {
        self.evidence + self.prior()
    }

    fn odds_over(&self, other: &Self) -> f64 {
        let gain = self.errors.gain_over(&other.errors);
        gain.odds(self.prior() - other.prior())
    }
}

impl Candidate {
    /// Log prior odds of its effects, less what their places and widths cost.
    fn prior(&self) -> f64 {
        LN_PRIOR_ODDS * self.names.len() as f64 + self.price
    }
}

/// What naming came to.
#[derive(Debug, Clone)]
pub struct Naming {
    /// The analyst's model with its numbers refitted.
    pub base: Candidate,
    /// Every set that was fitted, the best first.
    pub sets: Vec<Candidate>,
    /// Their posterior probabilities.
    pub probabilities: Vec<f64>,
}

impl Naming {
    /// The best set.
    #[must_use]
    pub fn best(&self) -> &Candidate {
        self.sets.first().unwrap_or(&self.base)
    }

    /// Probability that this effect is missing, whatever else is missing beside it.
    #[must_use]
    pub fn probability_of(&self, effect: &str) -> f64 {
        let weighed = self.sets.iter().zip(&self.probabilities);
        weighed
            .filter(|(set, _)| set.names.contains(&effect))
            .map(|(_, probability)| probability)
            .sum()
    }

    /// The best set without one of its effects, if it was fitted.
    #[must_use]
    pub fn best_without(&self, effect: &str) -> Option<&Candidate> {
        let rest: Vec<&str> = self
            .best()
            .names
            .iter()
            .copied()
            .filter(|own| *own != effect)
            .collect();
        self.sets.iter().find(|set| is_same(&set.names, &rest))
    }
}

/// Fits all numbers of a model.
#[must_use]
pub fn fit_base(problem: &dyn Problem, model: &Model, scales: &Scales) -> Fit {
    let near = problem
        .first_look()
        .map(|smooth| fit(smooth, model, scales, (TO_THE_END, SETTLED)).model);
    fit(
        problem,
        near.as_ref().unwrap_or(model),
        scales,
        (TO_THE_END, SETTLED),
    )
}

/// Fits an effect on top of a model, from each of its starts.
#[must_use]
pub fn fit_with(
    problem: &dyn Problem,
    model: &Model,
    entry: &'static Entry,
    scales: &Scales,
) -> Fit {
    let smooth = problem.first_look();
    let starts = entry.starts(model.kind, model.path, scales);
    let looks = starts.into_iter().map(|values| {
        fit(
            smooth.unwrap_or(problem),
            &model.with(entry, values),
            scales,
            (FIRST_LOOK, SETTLED),
        )
    });
    let best = looks.min_by(|a, b| a.loss.total_cmp(&b.loss));
    let model = best.map_or_else(|| model.clone(), |look| look.model);
    fit(problem, &model, scales, (TO_THE_END, SETTLED))
}

/// Names what `model` lacks, among `candidates` and of them at most so many.
pub fn name(
    problem: &dyn Problem,
    model: &Model,
    scales: &Scales,
    (candidates, most): (&[&'static Entry], usize),
    progress: &mut dyn FnMut(&str),
) -> Naming {
    progress("nominal parameters");
    let mut fit = fit_base(problem, model, scales);
    let end = Linearised::at(problem, &mut fit, scales);
    let base = Candidate {
        entries: Vec::new(),
        names: Vec::new(),
        errors: Errors::left_out_from(problem, &fit, &end),
        fit,
        evidence: 0.0,
        price: 0.0,
        unneeded: Vec::new(),
    };
    let mut sets = vec![base.clone()];
    let mut moves = Pieces {
        ground: Ground {
            problem,
            scales,
            base: &base,
        },
        candidates,
        most,
        progress,
    };
    explore(&mut moves, &mut sets);
    Naming {
        probabilities: probabilities(&sets),
        sets,
        base,
    }
}

/// Whether so many records can show this effect for what it is. In a single free swing time passes as the amplitude falls:
/// what changes with time passes for a loss that changes with the amplitude.
#[must_use]
pub fn shows(entry: &Entry, kind: Kind, records: usize) -> bool {
    !entry.uses(TIME) || !kind.runs_alone() || records > 1
}

/// What sets of effects are fitted to.
#[derive(Clone, Copy)]
struct Ground<'a> {
    problem: &'a dyn Problem,
    scales: &'a Scales,
    base: &'a Candidate,
}

impl Ground<'_> {
    fn set(&self, entries: Vec<&'static Entry>, mut fit: Fit) -> Candidate {
        let end = Linearised::at(self.problem, &mut fit, self.scales);
        let errors = Errors::left_out_from(self.problem, &fit, &end);
        let known = intervals(self.problem, &end);
        let Certainty { unneeded, price } = Certainty::of(self.scales, &fit, &known, &entries);
        Candidate {
            names: entries.iter().map(|entry| entry.name).collect(),
            unneeded,
            price,
            evidence: errors.gain_over(&self.base.errors).value,
            entries,
            fit,
            errors,
        }
    }
}

/// The moves of a small plant, whose sets are fitted to pieces of the records.
struct Pieces<'a, 'b> {
    ground: Ground<'a>,
    candidates: &'a [&'static Entry],
    most: usize,
    progress: &'a mut (dyn FnMut(&str) + 'b),
}

impl Moves for Pieces<'_, '_> {
    type Set = Candidate;

    fn most_effects(&self) -> usize {
        self.most
    }

    fn rivals(&self) -> usize {
        RIVALS
    }

    fn tries_parts(&self) -> bool {
        true
    }

    fn add(&mut self, current: &Candidate, known: &mut Vec<Candidate>) {
        let on_top = match current.names.last() {
            None => String::new(),
            Some(_) => format!(", on top of {}", current.names.join(" and ")),
        };
        (self.progress)(&format!("candidates{on_top}"));
        let open: Vec<&'static Entry> = self
            .candidates
            .iter()
            .copied()
            .filter(|entry| !current.names.contains(&entry.name))
            .filter(|entry| {
                let larger = [&current.names[..], &[entry.name]].concat();
                !known.iter().any(|set| is_same(&set.names, &larger))
            })
            .collect();
        let ground = self.ground;
        let tried: Vec<Candidate> = open
            .par_iter()
            .map(|entry| {
                let fit = fit_with(ground.problem, &current.fit.model, entry, ground.scales);
                ground.set([&current.entries[..], &[*entry]].concat(), fit)
            })
            .collect();
        for set in tried.into_iter().filter(|set| set.errors.are_finite()) {
            keep(known, set);
        }
    }

    fn remove(
        &mut self,
        current: &Candidate,
        left_out: &'static str,
        known: &mut Vec<Candidate>,
    ) -> Candidate {
        let rest = current.entries.iter().copied();
        let rest: Vec<&'static Entry> = rest.filter(|entry| entry.name != left_out).collect();
        let names: Vec<&str> = rest.iter().map(|entry| entry.name).collect();
        if let Some(fewer) = known.iter().find(|set| is_same(&set.names, &names)) {
            return fewer.clone();
        }
        (self.progress)(&format!("without {left_out}"));
        let model = current.fit.model.without_effect(left_out);
        let Ground {
            problem, scales, ..
        } = self.ground;
        let fewer = self.ground.set(rest, fit_base(problem, &model, scales));
        if fewer.errors.are_finite() {
            keep(known, fewer.clone());
        }
        fewer
    }

    /// Takes from sets that explain more the effects that are not needed there: together they draw a curve that none of them has alone.
    fn revise(&mut self, current: &Candidate, known: &mut Vec<Candidate>) {
        let open = |set: &&Candidate| !set.is_answer() && set.odds_over(current) > 0.0;
        for set in known.iter().filter(open).cloned().collect::<Vec<_>>() {
            for name in &set.unneeded {
                self.remove(&set, name, known);
            }
        }
    }
}
