//! Which set of effects the records speak for: best first over sets by adding, removing and swapping.

mod candidate;
mod doubt;
mod looks;
mod race;

use self::candidate::candidate;
pub use self::candidate::{Candidate, Objection};
use self::looks::{followed, looks, swapped};
use self::race::race;
use crate::certainty::ReplayedEstimates;
use crate::effects::Effect;
use crate::fit::{Fit, STEPS, rescue, worse};
use crate::hypothesis::Hypothesis;
use crate::law_start::Scatter;
use crate::loss;
use crate::marginal::Disturbance;
use crate::policy::{MOST_EFFECTS, WRONG};
use crate::problem::Problem;
use crate::sets::{EffectSet as _, Moves, explore, keep};

/// Steps of a fit to short windows.
const NEAR_STEPS: usize = 10;
/// Windows on which sets are looked for before they are fitted to all.
const PART_WINDOWS: usize = 75;
/// Sets with effects that are fitted to all windows.
const RIVALS: usize = 3;

/// All sets that were fitted, the best first, and the analyst's model.
#[derive(Clone, Debug)]
pub struct Search {
    /// Sets with effects or none, by score.
    pub candidates: Vec<Candidate>,
    /// Values and deviations of all that is free in the first of them.
    pub numbers: ReplayedEstimates,
    /// The analyst's model with its parameters refitted.
    pub base: Candidate,
}

/// Goes over sets of effects until no move gains, first on a part of the windows, where there are many, and from what that leads to on all
/// of them; `progress` hears of each set that is fitted.
#[must_use]
pub fn search(problem: &Problem, progress: &mut dyn FnMut(&str)) -> Search {
    progress("the analyst's model");
    let part = problem.part(PART_WINDOWS);
    let first = candidate(&part, fit_from(&part, part.hypothesis(), None, true));
    let mut known = vec![first.clone()];
    // Parts of the best set are tried with all effects once: on a part of the windows, or where that was right at once, on all.
    let is_wrong = first.fit.calm(&part.long).misfit(&part.long) > WRONG;
    let is_all = part.long.windows.len() == problem.long.windows.len();
    if is_wrong || is_all {
        let mut moves = Windows {
            problem: &part,
            tries_parts: true,
            progress,
        };
        explore(&mut moves, &mut known);
    }
    let mut whole = if is_all {
        known
    } else {
        let mut whole = carried_over(problem, &known, progress);
        let mut moves = Windows {
            problem,
            tries_parts: !is_wrong,
            progress,
        };
        explore(&mut moves, &mut whole);
        whole
    };
    let numbers = doubt::weigh(problem, &mut whole, progress);
    let base = whole
        .iter()
        .find(|candidate| candidate.effects.is_empty())
        .cloned()
        .unwrap_or(first);
    Search {
        candidates: whole,
        numbers,
        base,
    }
}

/// The best of the sets that are known from a part of the windows, fitted to all of them, which start as measured.
fn carried_over(
    problem: &Problem,
    known: &[Candidate],
    progress: &mut dyn FnMut(&str),
) -> Vec<Candidate> {
    let rivals = known.iter().filter(|c| !c.effects.is_empty()).take(RIVALS);
    let nothing = known.iter().find(|c| c.effects.is_empty());
    let fits = rivals
        .chain(nothing)
        .map(|on_part| begun(problem, on_part.fit.hypothesis.clone(), None))
        .collect();
    race(problem, fits, f64::NEG_INFINITY, progress)
        .into_iter()
        .map(|fit| candidate(problem, fit))
        .collect()
}

fn named(effects: &[&str]) -> String {
    if effects.is_empty() {
        "the analyst's model".to_owned()
    } else {
        effects.join(" and ")
    }
}

/// The moves of a rig, whose sets are fitted to windows of the records.
struct Windows<'a, 'b> {
    problem: &'a Problem,
    tries_parts: bool,
    progress: &'a mut (dyn FnMut(&str) + 'b),
}

impl Moves for Windows<'_, '_> {
    type Set = Candidate;

    fn most_effects(&self) -> usize {
        MOST_EFFECTS
    }

    fn rivals(&self) -> usize {
        0
    }

    fn tries_parts(&self) -> bool {
        self.tries_parts
    }

    fn add(&mut self, current: &Candidate, known: &mut Vec<Candidate>) {
        add(self.problem, current, known, self.progress);
    }

    fn remove(
        &mut self,
        current: &Candidate,
        left_out: &'static str,
        known: &mut Vec<Candidate>,
    ) -> Candidate {
        remove(self.problem, current, left_out, known, self.progress)
    }

    fn revise(&mut self, current: &Candidate, known: &mut Vec<Candidate>) {
        let Self {
            problem, progress, ..
        } = self;
        try_laws(problem, current, known, progress);
        for larger in stand_ins(current, known) {
            if larger.objection.is_some() {
                // The law may have started at the wrong place for the effect beside it.
                try_laws(problem, &larger, known, progress);
            }
            let extra = |name: &&&'static str| !current.effects.contains(*name);
            if let Some(left_out) = larger.effects.iter().find(extra) {
                remove(problem, &larger, left_out, known, progress);
            }
        }
        share_starts(problem, known);
    }
}

/// Sets of one effect more than `current` that explain more, whether they lead or are no answer: what they explain, the numbers of the
/// others may explain as well once they are free to get there.
fn stand_ins(current: &Candidate, known: &[Candidate]) -> Vec<Candidate> {
    known
        .iter()
        .filter(|larger| {
            larger.effects.len() == current.effects.len() + 1
                && !current.effects.is_empty()
                && current
                    .effects
                    .iter()
                    .all(|name| larger.effects.contains(name))
                && match larger.objection {
                    None => larger.odds_over(current) > 0.0,
                    Some(_) => larger.evidence > current.evidence,
                }
        })
        .cloned()
        .collect()
}

/// The fit of these effects on top of the analyst's model, whether it gains or not; `None` where one of them makes no sense.
#[must_use]
pub fn fit_effects(
    problem: &Problem,
    names: &[&str],
    progress: &mut dyn FnMut(&str),
) -> Option<Candidate> {
    progress("the analyst's model");
    let mut current = candidate(problem, fit_from(problem, problem.hypothesis(), None, true));
    for name in names {
        let effect = problem.effect(name)?;
        progress(effect.name);
        let looks = looks(problem, &current, &[effect], &mut |_| {});
        let first = looks.first().map(|look| look.fit.hypothesis.clone());
        let fits = followed(problem, &current, looks, progress)
            .into_iter()
            .map(|hypothesis| begun(problem, hypothesis, Some(&current.fit)))
            .collect();
        let best = race(problem, fits, current.odds(), progress)
            .into_iter()
            .map(|fit| candidate(problem, fit))
            .max_by(|a, b| a.evidence.total_cmp(&b.evidence));
        // What promises nothing is not followed in a search; here it is fitted all the same.
        current = match best {
            Some(best) => best,
            None => candidate(
                problem,
                fit_from(problem, first?, Some(&current.fit), false),
            ),
        };
    }
    Some(current)
}

/// Fits a hypothesis to all windows, over short ones first if `closely`; windows start as in `from` where that is better.
fn fit_from(problem: &Problem, hypothesis: Hypothesis, from: Option<&Fit>, closely: bool) -> Fit {
    let calm = Disturbance::NONE;
    let mut hypothesis = hypothesis;
    if closely {
        let near = Fit::at(&problem.short, hypothesis, problem.short.anchors(), calm)
            .improved_calmly(&problem.short, NEAR_STEPS);
        hypothesis = near.hypothesis;
    }
    begun(problem, hypothesis, from).improved(&problem.long, STEPS)
}

/// A hypothesis on all windows, which start as measured or as in `from`.
fn begun(problem: &Problem, hypothesis: Hypothesis, from: Option<&Fit>) -> Fit {
    let calm = Disturbance::NONE;
    let data = &problem.long;
    let measured = Fit::at(data, hypothesis.clone(), data.anchors(), calm);
    match from {
        Some(from) => {
            let carried = Fit::at(data, hypothesis, from.starts.clone(), calm);
            if carried.loss < measured.promised_loss(data) || carried.loss < measured.loss {
                carried
            } else {
                measured
            }
        }
        None => measured,
    }
}

fn add(
    problem: &Problem,
    current: &Candidate,
    known: &mut Vec<Candidate>,
    progress: &mut dyn FnMut(&str),
) {
    let effects: Vec<&Effect> = problem
        .effects
        .iter()
        .filter(|effect| !current.effects.contains(&effect.name))
        .filter(|effect| effect.is_possible(&problem.rig))
        .collect();
    let looks = looks(problem, current, &effects, progress);
    let exchanged = swapped(problem, current, &looks);
    let fits = followed(problem, current, looks, progress)
        .into_iter()
        .chain(exchanged)
        .map(|hypothesis| begun(problem, hypothesis, Some(&current.fit)))
        .collect();
    for fit in race(problem, fits, current.odds(), progress) {
        keep(known, candidate(problem, fit));
    }
}

fn own_names(hypothesis: &Hypothesis) -> Vec<&str> {
    hypothesis.effects.iter().map(String::as_str).collect()
}

/// Fits the laws that `current` may have, from the starts that the records suggest beside the numbers of its other effects: its own,
/// since those may not have been there when the law was added, and those with fewer numbers, since a law with more can imitate them.
fn try_laws(
    problem: &Problem,
    current: &Candidate,
    known: &mut Vec<Candidate>,
    progress: &mut dyn FnMut(&str),
) {
    let laws = || problem.effects.iter().filter(|effect| effect.is_law());
    let Some(own) = laws().find(|law| current.effects.contains(&law.name)) else {
        return;
    };
    let others = current.effects.iter().copied();
    let others: Vec<&'static str> = others.filter(|name| *name != own.name).collect();
    let hypothesis = rebuilt(problem, &others, &current.fit.hypothesis);
    let without = candidate(problem, begun(problem, hypothesis, Some(&current.fit)));
    let is_simpler = |law: &Effect| {
        let starts = law.starts(&without.fit.hypothesis, &problem.long.scales, None);
        let first = starts.first().map(Hypothesis::dimension);
        first.is_some_and(|numbers| numbers < current.fit.hypothesis.dimension())
    };
    for law in laws().filter(|law| law.name == own.name && !others.is_empty() || is_simpler(law)) {
        let looks = looks(problem, &without, &[law], progress);
        let fits = followed(problem, &without, looks, progress)
            .into_iter()
            .map(|hypothesis| begun(problem, hypothesis, Some(&current.fit)))
            .collect();
        for fit in race(problem, fits, current.odds(), progress) {
            keep(known, candidate(problem, fit));
        }
    }
}

fn remove(
    problem: &Problem,
    current: &Candidate,
    left_out: &str,
    known: &mut Vec<Candidate>,
    progress: &mut dyn FnMut(&str),
) -> Candidate {
    let rest: Vec<&'static str> = current
        .effects
        .iter()
        .copied()
        .filter(|name| *name != left_out)
        .collect();
    progress(&format!("without {left_out}"));
    let hypothesis = rebuilt(problem, &rest, &current.fit.hypothesis);
    let fit = fit_from(problem, hypothesis, Some(&current.fit), false);
    let fewer = candidate(problem, fit);
    keep(known, fewer.clone());
    known
        .iter()
        .find(|other| other.effects == fewer.effects)
        .cloned()
        .unwrap_or(fewer)
}

/// The analyst's model with these effects, and with the numbers of `like` where that has them.
fn rebuilt(problem: &Problem, names: &[&'static str], like: &Hypothesis) -> Hypothesis {
    let mut hypothesis = problem.hypothesis();
    for name in names {
        let start = problem.effect(name).and_then(|effect| {
            let nowhere = Scatter::default();
            let starts = effect.starts(&hypothesis, &problem.long.scales, Some(&nowhere));
            let alike = |start: &Hypothesis| {
                let order = |rig: &Hypothesis| rig.rig.parameter("gear_ripple.order");
                order(start) == order(like)
            };
            let at = starts.iter().position(alike).unwrap_or(0);
            starts.into_iter().nth(at)
        });
        if let Some(start) = start {
            hypothesis = start;
        } else if let Some(law) = law_of(like, &hypothesis, name) {
            hypothesis = law;
        }
    }
    hypothesis.take_over(like);
    hypothesis
}

/// `hypothesis` with the friction law, and its free numbers, of `fitted`.
fn law_of(fitted: &Hypothesis, hypothesis: &Hypothesis, name: &str) -> Option<Hypothesis> {
    let mut h = hypothesis.clone();
    h.rig.law = fitted.rig.law;
    let is_law = |free: &crate::hypothesis::Free| {
        matches!(free, crate::hypothesis::Free::Nominal { name, .. }
            | crate::hypothesis::Free::Value { name, .. } if name.starts_with("contact."))
    };
    let (mut free, mut x, mut at) = (Vec::new(), Vec::new(), 0);
    for own in &hypothesis.free {
        if !is_law(own) {
            free.push(own.clone());
            x.extend_from_slice(&hypothesis.x[at..at + own.width()]);
        }
        at += own.width();
    }
    at = 0;
    for own in &fitted.free {
        if is_law(own) {
            free.push(own.clone());
            x.extend_from_slice(&fitted.x[at..at + own.width()]);
        }
        at += own.width();
    }
    h.free = free;
    h.x = x;
    h.effects.push(name.to_owned());
    Some(h)
}

/// Starts windows in every candidate from where another has found a better start: sets are compared by their models, not by
/// which of them has found a window's start.
fn share_starts(problem: &Problem, known: &mut [Candidate]) {
    let data = &problem.long;
    known.sort_by(|a, b| b.score().total_cmp(&a.score()));
    let count = known.len().min(4);
    for at in 0..count {
        let mut forms = known[at].fit.reduced(data);
        let mut fit = known[at].fit.clone();
        for other in 0..count {
            if other == at {
                continue;
            }
            let theirs = known[other].fit.reduced(data);
            let starts = known[other].fit.starts.clone();
            // A set that is worse in most windows is so by its model.
            if 2 * worse(&theirs, &starts, &fit, &forms).len() < forms.len() {
                rescue(data, &theirs, &starts, &mut fit, &mut forms);
            }
        }
        fit.loss = loss::total(&forms, &fit.hypothesis);
        if fit.loss < known[at].fit.loss - 1.0 {
            let fit = fit.improved(data, 3);
            known[at] = candidate(problem, fit);
        }
    }
}
