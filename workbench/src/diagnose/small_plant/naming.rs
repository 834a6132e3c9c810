//! Naming: every effect of the catalogue is tried on top of the model, the best that chance does not give is kept, and so on.

use rayon::prelude::*;

use super::equation::uses;
use super::evidence::{Gain, gain, left_out_errors, unit};
use super::least_squares::{Fit, fit, intervals};
use super::model::Model;
use super::motion::Scales;
use super::problem::Problem;
use super::term::{Entry, Formula};
use stickslip::body::Kind;
use stickslip::body::coordinate::TIME;

/// Most effects that are named one after the other.
pub const MOST_EFFECTS: usize = 8;
/// Steps of a first look at each start, and of fits that are carried to the end.
const FIRST_LOOK: usize = 8;
const TO_THE_END: usize = 40;
/// Gain in ln likelihood below which no effect is named, however certain its sign.
pub const LEAST_GAIN: f64 = 10.0;
/// Candidates that are tried in pairs where none is enough alone.
const PAIRED: usize = 4;
/// Share of the best gain above which another candidate can pass for it.
const RIVAL: f64 = 0.5;

/// A candidate that was tried.
#[derive(Debug, Clone)]
pub struct Tried {
    /// The effect, or two of them.
    pub entries: Vec<&'static Entry>,
    /// The model with it.
    pub fit: Fit,
    /// Squared errors on what was left out, piece by piece.
    pub errors: Vec<f64>,
    /// Gain over the model without it.
    pub gain: Gain,
}

impl Tried {
    /// Gain less a little for each free number: of two that explain the same, the one with fewer numbers is the better.
    fn worth(&self) -> f64 {
        self.gain.value - 0.1 * self.numbers() as f64
    }

    fn numbers(&self) -> usize {
        self.fit.model.free().len()
    }
}

/// One effect that was kept, with what came of it.
#[derive(Debug, Clone)]
pub struct Kept {
    /// The effect.
    pub entry: &'static Entry,
    /// Gain when it was added.
    pub gain: Gain,
    /// Names whose shortfall behind it was not certain.
    pub rivals: Vec<&'static str>,
}

/// What naming came to.
#[derive(Debug, Clone)]
pub struct Naming {
    /// The analyst's model with its numbers refitted.
    pub base: Fit,
    /// Effects that were kept, in the order in which they were named.
    pub kept: Vec<Kept>,
    /// Every candidate of the first round, best first.
    pub ranking: Vec<Tried>,
    /// The amended model.
    pub amended: Fit,
}

impl Naming {
    /// The effects that were kept.
    #[must_use]
    pub fn names(&self) -> Vec<&'static str> {
        self.kept.iter().map(|kept| kept.entry.name).collect()
    }
}

/// Fits all numbers of a model.
#[must_use]
pub fn fit_base(problem: &dyn Problem, model: &Model, scales: &Scales) -> Fit {
    let near = problem
        .first_look()
        .map(|smooth| fit(smooth, model, scales, None, TO_THE_END).model);
    fit(
        problem,
        near.as_ref().unwrap_or(model),
        scales,
        None,
        TO_THE_END,
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
            None,
            FIRST_LOOK,
        )
    });
    let best = looks.min_by(|a, b| a.loss.total_cmp(&b.loss));
    let model = best.map_or_else(|| model.clone(), |look| look.model);
    fit(problem, &model, scales, None, TO_THE_END)
}

/// Names what `model` lacks, trying `candidates`, until so many are named or none is missing.
pub fn name(
    problem: &dyn Problem,
    model: &Model,
    scales: &Scales,
    (candidates, most): (&[&'static Entry], usize),
    progress: &mut dyn FnMut(&str),
) -> Naming {
    progress("nominal parameters");
    let base = fit_base(problem, model, scales);
    let mut current = base.clone();
    let mut ranking: Option<Vec<Tried>> = None;
    let mut kept: Vec<Kept> = Vec::new();
    while kept.len() < most {
        let on_top = kept
            .last()
            .map(|kept| format!(", on top of {}", kept.entry.name));
        progress(&format!(
            "candidates, round {}{}",
            kept.len() + 1,
            on_top.unwrap_or_default()
        ));
        let before = left_out_errors(problem, &current, scales);
        let round = Round {
            problem,
            scales,
            unit: unit(&current.residuals),
            before: &before,
        };
        let open: Vec<&'static Entry> = candidates
            .iter()
            .copied()
            .filter(|entry| !current.model.has(entry.name))
            .collect();
        let single: Vec<Vec<&'static Entry>> = open.iter().map(|entry| vec![*entry]).collect();
        let tried = round.try_all(&current.model, &single, open.len());
        let mut accepted = accepted(&tried);
        if accepted.is_none() {
            // Two effects can hide each other: each alone makes other records worse, both explain them.
            progress(&format!("pairs of candidates, round {}", kept.len() + 1));
            let pairs = pairs(&tried);
            let together = round.try_all(&current.model, &pairs, open.len() + pairs.len());
            accepted = self::accepted(&together);
        } else if let Some(plainer) = accepted
            .as_ref()
            .and_then(|best| round.plainer_pair(&current.model, best, &tried, &open))
        {
            accepted = Some(plainer);
        }
        let rivals = match &accepted {
            Some(best) if best.entries.len() == 1 => round.rivals(best, &tried),
            _ => Vec::new(),
        };
        ranking.get_or_insert(tried);
        let Some(best) = accepted else { break };
        for entry in &best.entries {
            kept.push(Kept {
                entry,
                gain: best.gain,
                rivals: rivals.clone(),
            });
        }
        current = best.fit;
    }
    progress("effects that the others make superfluous, and rivals");
    drop_unsized(problem, scales, &mut current, &mut kept);
    drop_superfluous(problem, scales, &mut current, &mut kept);
    keep_true_rivals(problem, scales, candidates, &current, &mut kept);
    Naming {
        base,
        kept,
        ranking: ranking.unwrap_or_default(),
        amended: current,
    }
}

/// Takes away, one by one, the effects whose size has zero in its 95 % interval beside the others: together they draw a curve that none
/// of them has alone, and no one of them can be named for it.
fn drop_unsized(problem: &dyn Problem, scales: &Scales, current: &mut Fit, kept: &mut Vec<Kept>) {
    while kept.len() > 1 {
        let known = intervals(problem, current, scales);
        let Model { kind, path, .. } = current.model;
        let certainty = |kept: &Kept| {
            let terms = current.model.terms();
            let at = terms.iter().position(|term| term.entry == kept.entry)?;
            let origins = kept.entry.origins(kind, path, scales);
            let decisive = origins.iter().enumerate().filter_map(|(number, origin)| {
                let distance = (terms[at].values[number] - (*origin)?).abs();
                let mut known = known.iter();
                let own = known.find(|own| (own.term, own.number) == (at, number));
                Some(own.map_or(0.0, |own| distance / own.half_width))
            });
            decisive.reduce(f64::max)
        };
        if known.is_empty() {
            return;
        }
        let uncertain = kept
            .iter()
            .enumerate()
            .filter_map(|(at, one)| Some((at, certainty(one)?)));
        let Some((at, share)) = uncertain.min_by(|a, b| a.1.total_cmp(&b.1)) else {
            return;
        };
        if share > 1.0 {
            return;
        }
        *current = fit_base(problem, &current.model.without(kept[at].entry.name), scales);
        kept.remove(at);
    }
}

/// Takes away effects that those named later make superfluous.
fn drop_superfluous(
    problem: &dyn Problem,
    scales: &Scales,
    current: &mut Fit,
    kept: &mut Vec<Kept>,
) {
    let mut at = 0;
    while kept.len() > 1 && at < kept.len() {
        let rest = fit_base(problem, &current.model.without(kept[at].entry.name), scales);
        let without = left_out_errors(problem, &rest, scales);
        let with = left_out_errors(problem, current, scales);
        let gain = gain(&without, &with, unit(&current.residuals), kept.len());
        if gain.value > LEAST_GAIN && gain.sure > 0.0 {
            at += 1;
        } else {
            *current = rest;
            kept.remove(at);
        }
    }
}

/// Leaves those rivals that could stand in for the effect in the final model: what was named itself later on was a companion,
/// and what those named later stand in for is none any more.
fn keep_true_rivals(
    problem: &dyn Problem,
    scales: &Scales,
    candidates: &[&'static Entry],
    last: &Fit,
    kept: &mut [Kept],
) {
    let names: Vec<&str> = kept.iter().map(|kept| kept.entry.name).collect();
    if kept.iter().all(|kept| kept.rivals.is_empty()) {
        return;
    }
    let errors = left_out_errors(problem, last, scales);
    let unit = unit(&last.residuals);
    for kept in kept {
        let rest = last.model.without(kept.entry.name);
        kept.rivals.retain(|rival| {
            let mut candidates = candidates.iter();
            let entry = candidates.find(|entry| entry.name == *rival && !names.contains(rival));
            let Some(entry) = entry else {
                return false;
            };
            let other = fit_with(problem, &rest, entry, scales);
            let shortfall = gain(&left_out_errors(problem, &other, scales), &errors, unit, 1);
            shortfall.value < LEAST_GAIN && !shortfall.is_certain()
        });
    }
}

/// Whether so many records can show this effect for what it is. In a single free swing time passes as the amplitude falls:
/// what changes with time passes for a loss that changes with the amplitude.
#[must_use]
pub fn shows(entry: &Entry, kind: Kind, records: usize) -> bool {
    let by_time =
        matches!(entry.formula, Formula::Equation { operations, .. } if uses(operations, TIME));
    !by_time || !kind.runs_alone() || records > 1
}

/// What a round's candidates are compared with.
struct Round<'a> {
    problem: &'a dyn Problem,
    scales: &'a Scales,
    /// The same for all, so that gains compare as errors do.
    unit: f64,
    before: &'a [f64],
}

impl Round<'_> {
    /// Every set of effects on top of a model, best first.
    fn try_all(&self, model: &Model, sets: &[Vec<&'static Entry>], looks: usize) -> Vec<Tried> {
        let mut tried: Vec<Tried> = sets
            .par_iter()
            .map(|entries| {
                let fitted = entries.iter().fold(None, |fitted: Option<Fit>, &entry| {
                    let model = fitted.as_ref().map_or(model, |fit| &fit.model);
                    Some(fit_with(self.problem, model, entry, self.scales))
                });
                let fitted = fitted.unwrap_or_else(|| fit_base(self.problem, model, self.scales));
                let errors = left_out_errors(self.problem, &fitted, self.scales);
                Tried {
                    entries: entries.clone(),
                    gain: gain(self.before, &errors, self.unit, looks),
                    fit: fitted,
                    errors,
                }
            })
            .collect();
        tried.sort_by(|a, b| b.worth().total_cmp(&a.worth()));
        tried
    }

    /// Two effects that explain more than the best one or as much, with no more numbers: one of many numbers can pass for a sum of
    /// plain ones.
    fn plainer_pair(
        &self,
        model: &Model,
        best: &Tried,
        tried: &[Tried],
        open: &[&'static Entry],
    ) -> Option<Tried> {
        let numbers = |entries: &[&'static Entry]| -> usize {
            entries.iter().map(|entry| entry.parameters.len()).sum()
        };
        let most = numbers(&best.entries);
        let first = tried
            .iter()
            .find(|t| numbers(&t.entries) < most && t.gain.value > RIVAL * best.gain.value)?;
        let pairs: Vec<Vec<&'static Entry>> = open
            .iter()
            .filter(|entry| !best.entries.contains(entry) && !first.entries.contains(entry))
            .map(|entry| [&first.entries[..], &[*entry]].concat())
            .filter(|pair| numbers(pair) <= most)
            .collect();
        let together = self.try_all(model, &pairs, open.len() + pairs.len());
        accepted(&together).filter(|pair| pair.worth() > best.worth())
    }

    /// Names whose shortfall behind the best is not certain.
    fn rivals(&self, best: &Tried, tried: &[Tried]) -> Vec<&'static str> {
        tried
            .iter()
            .filter(|t| t.entries != best.entries && t.gain.value > RIVAL * best.gain.value)
            // More numbers that gain nothing are the best itself in disguise.
            .filter(|t| t.numbers() <= best.numbers() || t.gain.value > best.gain.value + 1.0)
            .filter(|t| !gain(&t.errors, &best.errors, self.unit, 1).is_certain())
            .flat_map(|t| t.entries.iter().map(|entry| entry.name))
            .collect()
    }
}

fn accepted(tried: &[Tried]) -> Option<Tried> {
    tried
        .iter()
        .find(|best| best.gain.value > LEAST_GAIN && best.gain.sure > 0.0)
        .cloned()
}

/// Pairs of the candidates that fit best alone.
fn pairs(tried: &[Tried]) -> Vec<Vec<&'static Entry>> {
    let mut by_loss: Vec<&Tried> = tried.iter().collect();
    by_loss.sort_by(|a, b| a.fit.loss.total_cmp(&b.fit.loss));
    by_loss.truncate(PAIRED);
    let names: Vec<&'static Entry> = by_loss
        .iter()
        .flat_map(|t| t.entries.iter().copied())
        .collect();
    let mut pairs = Vec::new();
    for (at, first) in names.iter().enumerate() {
        for second in &names[at + 1..] {
            pairs.push(vec![*first, *second]);
        }
    }
    pairs
}
