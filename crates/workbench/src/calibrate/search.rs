//! Global, then local: from a target to the set of parameter values that meet it.

use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use stickslip::plant::Rig;

use super::cost::Judgement;
use super::evolution::Population;
use super::journal::Journal;
use super::simplex;
use super::target::Target;
use crate::files::journal::JournalError;

/// Evaluations of the local search.
pub const LOCAL_EVALUATIONS: usize = 250;
/// First size of the local search's simplex, as a share of each parameter's range.
const LOCAL_SIZE: f64 = 0.02;

/// A parameter set with its judgement.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Values of the sought parameters, in the target's order.
    pub values: Vec<f64>,
    /// How it meets the target.
    pub judgement: Judgement,
}

/// What a calibration finds.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The best set after the local searches.
    pub best: Solution,
    /// All sets found that meet every bar.
    pub ensemble: Vec<Solution>,
    /// Parameter sets that were judged.
    pub evaluations: usize,
    /// Whether the search came to its end; one that was interrupted holds what it had found by then.
    pub complete: bool,
}

impl Calibration {
    /// Lowest and highest value of each sought parameter over the ensemble.
    #[must_use]
    pub fn ranges(&self) -> Vec<(f64, f64)> {
        (0..self.best.values.len())
            .map(|index| {
                self.ensemble.iter().fold(
                    (f64::INFINITY, f64::NEG_INFINITY),
                    |(low, high), solution| {
                        (
                            low.min(solution.values[index]),
                            high.max(solution.values[index]),
                        )
                    },
                )
            })
            .collect()
    }
}

/// Where a search is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Independent start, from 0.
    pub start: usize,
    /// Parameter sets judged so far, those of earlier starts included.
    pub judged: usize,
    /// Members of the present population that meet every bar.
    pub met: usize,
}

/// Parameter sets that the whole search judges.
#[must_use]
pub fn planned(target: &Target) -> usize {
    let settings = &target.search;
    settings.starts * (settings.population * (settings.generations + 1) + LOCAL_EVALUATIONS)
}

fn values_at(target: &Target, place: &[f64]) -> Vec<f64> {
    target
        .parameter
        .iter()
        .zip(place)
        .map(|(sought, x)| sought.minimum + x * (sought.maximum - sought.minimum))
        .collect()
}

/// Judges places, from the journal where it holds them.
struct Judge<'a> {
    rig: &'a Rig<f64>,
    target: &'a Target,
    interrupted: &'a AtomicBool,
    journal: RefCell<&'a mut Journal>,
    failure: RefCell<Option<JournalError>>,
    judged: RefCell<usize>,
}

impl Judge<'_> {
    fn solution(&self, place: &[f64]) -> Solution {
        let values = values_at(self.target, place);
        let judgement = Judgement::of(self.rig, self.target, &values);
        Solution { values, judgement }
    }

    fn stopped(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed) || self.failure.borrow().is_some()
    }

    /// Costs of `places`; infinite ones, which change nothing, once the search is to stop.
    fn costs(&self, places: &[Vec<f64>], cost: impl Fn(&Judgement) -> f64 + Sync) -> Vec<f64> {
        let kept = self.journal.borrow_mut().take(places.len());
        let costs = kept.unwrap_or_else(|| {
            let (rig, target, interrupted) = (self.rig, self.target, self.interrupted);
            let fresh: Vec<f64> = places
                .par_iter()
                .with_max_len(1)
                .map(|place| {
                    if interrupted.load(Ordering::Relaxed) {
                        return f64::INFINITY;
                    }
                    cost(&Judgement::of(rig, target, &values_at(target, place)))
                })
                .collect();
            // What was given up half-way is judged again when the search goes on.
            if !self.stopped()
                && let Err(error) = self.journal.borrow().append(&fresh)
            {
                *self.failure.borrow_mut() = Some(error);
            }
            fresh
        });
        *self.judged.borrow_mut() += places.len();
        costs
    }
}

/// Searches until done or `interrupted`; `progress` hears of every generation and every step of the local search.
///
/// # Errors
/// [`JournalError`] where the journal cannot be written.
pub fn search(
    rig: &Rig<f64>,
    target: &Target,
    journal: &mut Journal,
    interrupted: &AtomicBool,
    progress: impl Fn(Progress),
) -> Result<Calibration, JournalError> {
    let judge = Judge {
        rig,
        target,
        interrupted,
        journal: RefCell::new(journal),
        failure: RefCell::new(None),
        judged: RefCell::new(0),
    };
    let settings = &target.search;
    let mut found: Vec<Vec<f64>> = Vec::new();
    let mut best: Option<(f64, Vec<f64>)> = None;
    for start in 0..settings.starts {
        let seed = settings.seed.wrapping_add(1000 * start as u64);
        let costs = |places: &[Vec<f64>]| judge.costs(places, Judgement::excess);
        let mut population =
            Population::strewn(settings.population, target.parameter.len(), seed, costs);
        let mut met = 0;
        let report = |met: usize| {
            progress(Progress {
                start,
                judged: *judge.judged.borrow(),
                met,
            });
        };
        for _ in 0..settings.generations {
            if judge.stopped() {
                break;
            }
            met = population.evolve(costs);
            report(met);
        }
        let sound = population
            .members
            .iter()
            .filter(|member| member.cost == 0.0);
        found.extend(sound.map(|member| member.place.clone()));
        let lead = population.best().place.clone();
        let distance = |place: &[f64]| {
            // Constant once stopped, which ends the simplex.
            if judge.stopped() {
                return f64::INFINITY;
            }
            let value = judge.costs(&[place.to_vec()], Judgement::distance)[0];
            report(met);
            value
        };
        let (place, value) = simplex::improve(&lead, LOCAL_SIZE, LOCAL_EVALUATIONS, distance);
        if best.as_ref().is_none_or(|(least, _)| value < *least) {
            best = Some((value, place));
        }
        if judge.stopped() {
            break;
        }
    }
    if let Some(error) = judge.failure.take() {
        return Err(error);
    }
    let mut places = found;
    places.push(best.map(|(_, place)| place).unwrap_or_default());
    let mut solutions: Vec<Solution> = places.iter().map(|place| judge.solution(place)).collect();
    let best = solutions[solutions.len() - 1].clone();
    solutions.retain(|solution| solution.judgement.excess() == 0.0);
    Ok(Calibration {
        best,
        ensemble: solutions,
        evaluations: *judge.judged.borrow(),
        complete: !interrupted.load(Ordering::Relaxed),
    })
}
