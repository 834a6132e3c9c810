//! First looks at what an effect promises, before it is fitted to all windows.

use super::{Candidate, NEAR_STEPS, RIVALS, rebuilt};
use crate::data::{Data, most_free};
use crate::effects::Effect;
use crate::fit::Fit;
use crate::hypothesis::Hypothesis;
use crate::law_start::Scatter;
use crate::loss;
use crate::marginal::Disturbance;
use crate::policy::{FAR, LN_PRIOR_ODDS, RIVAL, WRONG};
use crate::problem::Problem;
use crate::scales::Scales;
use crate::window::Start;
use nalgebra::{Cholesky, DMatrix, DVector};
use std::collections::HashSet;
use std::ops::Range;

/// Windows that suffice for the first looks.
const LOOK_WINDOWS: usize = 40;
/// How many starts are followed for each that may be of one effect, where there are so many effects.
const SHARE_OF_ONE: usize = 3;
/// How many starts are followed, and for how many steps each, before the next fewer.
const ROUNDS: [(usize, usize); 4] = [(18, 2), (9, 3), (6, NEAR_STEPS), (4, 0)];

/// A start of an effect, looked at.
pub(super) struct Look<'a> {
    pub effect: &'a Effect,
    pub fit: Fit,
    promise: f64,
}

impl<'a> Look<'a> {
    fn new(effect: &'a Effect, fit: Fit, data: &Data) -> Self {
        let promise = promise(&fit, data);
        Self {
            effect,
            fit,
            promise,
        }
    }
}

/// Effects that are looked at in one run: each begins with so little that none sees the others.
struct Batch<'a> {
    /// All of them.
    hypothesis: Hypothesis,
    members: Vec<Member<'a>>,
}

struct Member<'a> {
    effect: &'a Effect,
    alone: Hypothesis,
    /// Its numbers among those of the batch.
    numbers: Range<usize>,
}

/// Every start of `effects` on top of `base`, as many in a batch as slots allow.
fn batches<'a>(base: &Hypothesis, effects: &[&'a Effect], scales: &Scales) -> Vec<Batch<'a>> {
    let mut batches: Vec<Batch<'a>> = Vec::new();
    for effect in effects {
        for (number, alone) in effect.starts(base, scales, None).into_iter().enumerate() {
            if alone.dimension() > most_free(&alone.rig) {
                continue;
            }
            let on_top_of = |hypothesis: &Hypothesis| {
                effect
                    .starts(hypothesis, scales, None)
                    .into_iter()
                    .nth(number)
                    .filter(|all| all.dimension() <= most_free(&all.rig))
            };
            let open = batches
                .iter()
                .enumerate()
                .find_map(|(at, batch)| Some((at, on_top_of(&batch.hypothesis)?)));
            let (at, hypothesis) = open.unwrap_or_else(|| {
                batches.push(Batch {
                    hypothesis: base.clone(),
                    members: Vec::new(),
                });
                (batches.len() - 1, alone.clone())
            });
            let numbers = batches[at].hypothesis.dimension()..hypothesis.dimension();
            batches[at].hypothesis = hypothesis;
            batches[at].members.push(Member {
                effect,
                alone,
                numbers,
            });
        }
    }
    batches
}

/// The windows on which starts are looked at on top of a fit, and where they start there.
///
/// A fit that explains the records, be it with fluctuating friction, is looked at as it is: what explains its fluctuation is
/// nothing that is missing. From another one friction is taken to be calm, since fluctuation stands in for what is missing.
fn look_data(problem: &Problem, current: &Candidate) -> (Data, Fit) {
    let long = &problem.long;
    let (data, fit) = if is_near(problem, current) {
        (long, current.fit.clone())
    } else {
        let calm = current.fit.calm(long);
        if calm.misfit(long) > FAR {
            let short = &problem.short;
            let hypothesis = current.fit.hypothesis.clone();
            let fit = Fit::at(short, hypothesis, short.anchors(), Disturbance::NONE)
                .improved_calmly(short, 3);
            (short, fit)
        } else {
            (long, calm)
        }
    };
    let thinning = if std::ptr::eq(data, long) {
        1
    } else {
        (data.windows.len() / LOOK_WINDOWS).max(1)
    };
    let kept: Vec<usize> = (0..data.windows.len()).step_by(thinning).collect();
    let part = data.part(&kept);
    let starts = kept.iter().map(|&j| fit.starts[j].clone());
    let (part, starts) = if fit.disturbance == Disturbance::NONE {
        let without_torques = starts.map(|start| Start::from(start.state));
        (part.undivided(), without_torques.collect())
    } else {
        (part, starts.collect())
    };
    let on_part = Fit::at(&part, fit.hypothesis, starts, fit.disturbance);
    (part, on_part)
}

/// Whether a set explains the records up to noise and some fluctuation of friction.
pub(super) fn is_near(problem: &Problem, current: &Candidate) -> bool {
    !current.fit.fluctuates_most() && current.fit.misfit(&problem.long) <= WRONG
}

/// What every start of `effects` promises on top of `current`, the most first.
pub(super) fn looks<'a>(
    problem: &Problem,
    current: &Candidate,
    effects: &[&'a Effect],
    progress: &mut dyn FnMut(&str),
) -> Vec<Look<'a>> {
    let (part, base) = look_data(problem, current);
    let is_far = base.calm(&part).misfit(&part) > WRONG;
    let scatter = is_far.then(|| scatter(part.clone().divided(), &base));
    let (one_by_one, together): (Vec<&Effect>, Vec<&Effect>) =
        effects.iter().partition(|effect| effect.is_nonlinear());
    let mut looks = Vec::new();
    for batch in batches(&base.hypothesis, &together, &problem.long.scales) {
        for member in &batch.members {
            progress(member.effect.name);
        }
        let dimension = base.hypothesis.dimension();
        let all = Fit::at(
            &part,
            batch.hypothesis,
            base.starts.clone(),
            base.disturbance,
        );
        for member in batch.members {
            let numbers = (0..dimension).chain(member.numbers).collect();
            let fit = all.narrowed(&part, member.alone, numbers);
            looks.push(Look::new(member.effect, fit, &part));
        }
    }
    for effect in one_by_one {
        progress(effect.name);
        for hypothesis in effect.starts(&base.hypothesis, &problem.long.scales, scatter.as_ref()) {
            if hypothesis.dimension() > most_free(&hypothesis.rig) {
                continue;
            }
            let mut fit = Fit::at(&part, hypothesis, base.starts.clone(), base.disturbance);
            if is_far {
                fit = fit.improved_calmly(&part, 2);
            }
            looks.push(Look::new(effect, fit, &part));
        }
    }
    let nothing = promise(&base, &part);
    for look in &mut looks {
        look.promise -= nothing;
    }
    looks.sort_by(|a, b| b.promise.total_cmp(&a.promise));
    looks
}

/// The friction that the windows of `fit` show.
fn scatter(data: Data, fit: &Fit) -> Scatter {
    let calm = Disturbance::NONE;
    let divided = Fit::at(&data, fit.hypothesis.clone(), fit.starts.clone(), calm);
    Scatter::of(&data, &divided)
}

/// Log evidence that one more step promises.
fn promise(fit: &Fit, data: &Data) -> f64 {
    let forms = fit.reduced(data);
    let precisions = fit.hypothesis.prior_precisions();
    let (curvature, gradient) =
        loss::normal_equations(forms.iter().flatten(), &precisions, &fit.hypothesis.x);
    let Some(cholesky) = Cholesky::new(curvature) else {
        return f64::NEG_INFINITY;
    };
    let step = cholesky.solve(&gradient);
    let volume: f64 = 2.0
        * cholesky
            .l_dirty()
            .diagonal()
            .iter()
            .map(|d| d.ln())
            .sum::<f64>();
    let prior: f64 = precisions.iter().map(|p| p.ln()).sum();
    -0.5 * (fit.loss - gradient.dot(&step) + volume - prior)
}

/// The hypotheses to which the most promising of `looks` lead, the best first.
pub(super) fn followed(
    problem: &Problem,
    current: &Candidate,
    looks: Vec<Look<'_>>,
    progress: &mut dyn FnMut(&str),
) -> Vec<Hypothesis> {
    let (part, base) = look_data(problem, current);
    let nothing = promise(&base, &part);
    // Near the truth a step promises what it holds; from afar it may hold more.
    let least = if is_near(problem, current) {
        RIVAL.ln() - LN_PRIOR_ODDS
    } else {
        LN_PRIOR_ODDS
    };
    let mut field: Vec<Look<'_>> = looks
        .into_iter()
        .filter(|look| look.promise > least)
        .collect();
    for (most, steps) in ROUNDS {
        let effects: HashSet<&str> = field.iter().map(|look| look.effect.name).collect();
        let most_of_one = most / effects.len().clamp(1, SHARE_OF_ONE);
        let mut kept: Vec<Look<'_>> = Vec::new();
        for look in field {
            let twins = kept
                .iter()
                .filter(|other| other.effect.name == look.effect.name)
                .count();
            if kept.len() < most && twins < most_of_one {
                kept.push(look);
            }
        }
        for look in &mut kept {
            if steps > 0 {
                progress(look.effect.name);
                let fit = look.fit.clone().improved_calmly(&part, steps);
                look.promise = promise(&fit, &part) - nothing;
                look.fit = fit;
            }
        }
        kept.sort_by(|a, b| b.promise.total_cmp(&a.promise));
        field = kept;
    }
    field.into_iter().map(|look| look.fit.hypothesis).collect()
}

/// Sets with one effect of `current` exchanged that do as well, as far as the looks at one more effect tell: the step that is
/// best where the numbers of the one given up are held at no effect.
pub(super) fn swapped(
    problem: &Problem,
    current: &Candidate,
    looks: &[Look<'_>],
) -> Vec<Hypothesis> {
    let Some(first) = looks.first() else {
        return Vec::new();
    };
    let (part, base) = look_data(problem, current);
    if base.starts.len() != first.fit.starts.len() || base.misfit(&part) > WRONG {
        return Vec::new();
    }
    let nothing = promise(&base, &part);
    let mut found = Vec::new();
    for look in looks {
        for given_up in &current.effects {
            let hypothesis = &look.fit.hypothesis;
            let Some((start, width)) = hypothesis.numbers_of(given_up) else {
                continue;
            };
            let forms = look.fit.reduced(&part);
            let precisions = hypothesis.prior_precisions();
            let (curvature, gradient) =
                loss::normal_equations(forms.iter().flatten(), &precisions, &hypothesis.x);
            let own: Vec<usize> = (start..start + width).collect();
            let others: Vec<usize> = (0..hypothesis.dimension())
                .filter(|j| !own.contains(j))
                .collect();
            let n = others.len();
            let inner = DMatrix::from_fn(n, n, |a, b| curvature[(others[a], others[b])]);
            let pull = DVector::from_fn(n, |a, _| {
                let held: f64 = own
                    .iter()
                    .map(|&j| -curvature[(others[a], j)] * hypothesis.x[j])
                    .sum();
                gradient[others[a]] - held
            });
            let Some(cholesky) = Cholesky::new(inner) else {
                continue;
            };
            let solved = cholesky.solve(&pull);
            let mut step = DVector::zeros(hypothesis.dimension());
            for (&j, d) in others.iter().zip(solved.iter()) {
                step[j] = *d;
            }
            for &j in &own {
                step[j] = -hypothesis.x[j];
            }
            let after = look.fit.loss - 2.0 * gradient.dot(&step) + step.dot(&(&curvature * &step));
            let volume: f64 = 2.0
                * cholesky
                    .l_dirty()
                    .diagonal()
                    .iter()
                    .map(|d| d.ln())
                    .sum::<f64>();
            let prior: f64 = others.iter().map(|&j| precisions[j].ln()).sum();
            let promised = -0.5 * (after + volume - prior);
            if promised < nothing + LN_PRIOR_ODDS {
                continue;
            }
            let mut moved = hypothesis.clone();
            for (x, d) in moved.x.iter_mut().zip(step.iter()) {
                *x += d;
            }
            moved.clamp();
            let mut names: Vec<&'static str> = current
                .effects
                .iter()
                .copied()
                .filter(|name| name != given_up)
                .collect();
            names.push(look.effect.name);
            found.push((promised, rebuilt(problem, &names, &moved)));
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.truncate(RIVALS);
    found
        .into_iter()
        .map(|(_, hypothesis)| hypothesis)
        .collect()
}
