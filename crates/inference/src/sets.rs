//! Sets of effects compete, whatever evidence they are fitted to: the moves from one to another, their weights and the verdict.

use crate::policy::{NAMED, RIVAL};

/// Share of what a set gains that a part of it must gain by itself for other effects to be tried beside it.
const CONSIDERABLE: f64 = 0.1;

/// A set of effects, fitted.
pub trait EffectSet: Clone {
    /// The effects.
    fn effects(&self) -> &[&'static str];
    /// Whether nothing speaks against it as an answer.
    fn is_answer(&self) -> bool;
    /// Log evidence, but for a number that all sets share.
    fn evidence(&self) -> f64;
    /// The same with the prior odds of its effects.
    fn odds(&self) -> f64;
    /// Log odds of this set over `other`.
    fn odds_over(&self, other: &Self) -> f64;
    /// Log odds by which a set must lead a plainer one to be better.
    fn least_lead() -> f64;
    /// How much it takes to say what is missing: a set of which this is less is plainer.
    fn size(&self) -> usize {
        self.effects().len()
    }

    /// Log evidence with prior odds; −∞ for a set that is no answer.
    fn score(&self) -> f64 {
        if self.is_answer() {
            self.odds()
        } else {
            f64::NEG_INFINITY
        }
    }
}

/// Fits that lead from one set to others; what they come to goes to the sets that are known.
pub trait Moves {
    /// The sets.
    type Set: EffectSet;

    /// Most effects in a set.
    fn most_effects(&self) -> usize;
    /// How many of the sets of one effect more than the best are tried with all further effects, whether they gain or not: of two
    /// effects that hide each other, none gains alone.
    fn rivals(&self) -> usize;
    /// Whether further effects are tried beside parts of the best set.
    fn tries_parts(&self) -> bool;
    /// Tries further effects on top of `current`.
    fn add(&mut self, current: &Self::Set, known: &mut Vec<Self::Set>);
    /// Fits `current` without one of its effects; the best known fit of what is left.
    fn remove(
        &mut self,
        current: &Self::Set,
        left_out: &'static str,
        known: &mut Vec<Self::Set>,
    ) -> Self::Set;
    /// Moves that this evidence has beside those.
    fn revise(&mut self, current: &Self::Set, known: &mut Vec<Self::Set>);
}

/// Goes on from the best of `known` until no move gains, and puts the best first.
pub fn explore<M: Moves>(moves: &mut M, known: &mut Vec<M::Set>) {
    let mut expanded: Vec<Vec<&'static str>> = Vec::new();
    known.sort_by(|a, b| b.score().total_cmp(&a.score()));
    let Some(mut current) = known.first().cloned() else {
        return;
    };
    let is_new = |set: &M::Set, expanded: &mut Vec<Vec<&'static str>>| {
        let is_new = !expanded.iter().any(|other| is_same(other, set.effects()));
        expanded.push(set.effects().to_vec());
        is_new
    };
    while is_new(&current, &mut expanded) {
        let count = current.effects().len();
        if count < moves.most_effects() {
            moves.add(&current, known);
        }
        if count + 1 < moves.most_effects() {
            for rival in strongest(known, count + 1, moves.rivals()) {
                if is_new(&rival, &mut expanded) {
                    moves.add(&rival, known);
                }
            }
        }
        if count > 1 {
            for left_out in current.effects().to_vec() {
                let fewer = moves.remove(&current, left_out, known);
                if moves.tries_parts()
                    && share(&fewer, &current, known) > CONSIDERABLE
                    && is_new(&fewer, &mut expanded)
                {
                    moves.add(&fewer, known);
                }
            }
        }
        moves.revise(&current, known);
        best_first(known);
        current = known[0].clone();
    }
}

/// Share of what `current` gains over no effects that `fewer` gains.
fn share<S: EffectSet>(fewer: &S, current: &S, known: &[S]) -> f64 {
    let alone = known
        .iter()
        .find(|set| set.effects().is_empty())
        .map_or(f64::NEG_INFINITY, EffectSet::evidence);
    (fewer.evidence() - alone) / (current.evidence() - alone)
}

/// The sets of so many effects that explain most, at most `most` of them.
fn strongest<S: EffectSet>(known: &[S], effects: usize, most: usize) -> Vec<S> {
    let of_size = known.iter().filter(|set| set.effects().len() == effects);
    let mut all: Vec<S> = of_size.cloned().collect();
    all.sort_by(|a, b| b.evidence().total_cmp(&a.evidence()));
    all.truncate(most);
    all
}

/// Sorts sets by their scores, and puts before them the best: the one to which the leads go, plainer sets first.
pub fn best_first<S: EffectSet>(known: &mut [S]) {
    known.sort_by(|a, b| b.score().total_cmp(&a.score()));
    let mut order: Vec<usize> = (0..known.len()).collect();
    order.sort_by_key(|at| known[*at].size());
    let best = order.into_iter().reduce(|best, other| {
        let is_better = known[other].is_answer() && leads(&known[other], &known[best]);
        if is_better { other } else { best }
    });
    if let Some(best) = best {
        known[..=best].rotate_right(1);
    }
}

/// Whether a set leads another that is no larger.
fn leads<S: EffectSet>(set: &S, other: &S) -> bool {
    let is_larger = set.size() > other.size();
    let least = if is_larger { S::least_lead() } else { 0.0 };
    set.odds_over(other) > least
}

/// Adds a set to those that are known, or puts it in the place of a worse fit of the same effects.
pub fn keep<S: EffectSet>(known: &mut Vec<S>, set: S) {
    match known
        .iter_mut()
        .find(|other| is_same(other.effects(), set.effects()))
    {
        Some(other) if other.evidence() >= set.evidence() => {}
        Some(other) => *other = set,
        None => known.push(set),
    }
}

/// Whether two sets have the same effects, in whatever order.
#[must_use]
pub fn is_same(one: &[&str], other: &[&str]) -> bool {
    one.len() == other.len() && one.iter().all(|name| other.contains(name))
}

/// Posterior probabilities of sets, the best of which comes first: it counts whatever speaks against it, since none is better.
#[must_use]
pub fn probabilities<S: EffectSet>(sets: &[S]) -> Vec<f64> {
    let weight = |(place, set): (usize, &S)| {
        if place > 0 && !set.is_answer() {
            return 0.0;
        }
        set.odds_over(&sets[0]).exp()
    };
    let weights: Vec<f64> = sets.iter().enumerate().map(weight).collect();
    let all: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / all).collect()
}

/// Whether a set is worth telling: it is probable, and not just the best with something added.
#[must_use]
pub fn is_told(effects: &[&str], probability: f64, best: &[&str]) -> bool {
    let is_larger = effects.len() > best.len() && best.iter().all(|own| effects.contains(own));
    probability > RIVAL && !is_larger
}

/// Sum of differences, and its standard error by their scatter.
#[must_use]
pub fn sum_and_error(differences: &[f64]) -> (f64, f64) {
    let count = differences.len() as f64;
    let total: f64 = differences.iter().sum();
    let squares = differences.iter().map(|own| (own - total / count).powi(2));
    let variance = squares.sum::<f64>() / (count - 1.0).max(1.0);
    (total, (count * variance).sqrt())
}

/// What a diagnosis comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The model explains the records.
    NothingMissing,
    /// Other nominal parameters explain the records; no effect is missing.
    Parameters,
    /// The effects named are missing.
    Named,
    /// One of several sets of effects is missing; these records cannot tell which.
    Ambiguous,
    /// Something is missing that no effect of the catalogue explains.
    NotInCatalogue,
}

impl Verdict {
    /// The verdict on the best set: whether it explains the records, the probabilities of its effects, and whether nominal parameters
    /// are other than what is known of them.
    #[must_use]
    pub fn of(is_explained: bool, effects: &[f64], have_moved: bool) -> Self {
        match () {
            () if !is_explained => Self::NotInCatalogue,
            () if effects.is_empty() && have_moved => Self::Parameters,
            () if effects.is_empty() => Self::NothingMissing,
            () if effects.iter().all(|probability| *probability >= NAMED) => Self::Named,
            () => Self::Ambiguous,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{EffectSet, Verdict, best_first, is_told, probabilities};

    #[derive(Clone)]
    struct Toy(Vec<&'static str>, f64, bool);

    impl EffectSet for Toy {
        fn effects(&self) -> &[&'static str] {
            &self.0
        }
        fn is_answer(&self) -> bool {
            self.2
        }
        fn evidence(&self) -> f64 {
            self.1
        }
        fn odds(&self) -> f64 {
            self.1
        }
        fn odds_over(&self, other: &Self) -> f64 {
            self.1 - other.1
        }
        fn least_lead() -> f64 {
            2.0
        }
    }

    #[test]
    fn an_effect_more_must_lead_by_so_much_and_be_an_answer() {
        let mut known = vec![
            Toy(vec![], 0.0, true),
            Toy(vec!["drag"], 3.0, true),
            Toy(vec!["drag", "wear"], 4.0, true),
            Toy(vec!["law"], 9.0, false),
        ];
        best_first(&mut known);
        assert_eq!(known[0].0, ["drag"]);
        let weights = probabilities(&known);
        let all = 1.0 + 1f64.exp() + (-3f64).exp();
        assert!((weights[0] - 1.0 / all).abs() < 1e-12, "{weights:?}");
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        // The likelier set has the best in it, so that it is no rival.
        assert!(!is_told(&known[1].0, weights[1], &known[0].0));
        assert!(is_told(&["law"], 0.2, &["drag"]));
    }

    #[test]
    fn a_verdict_needs_an_explanation_and_sure_effects() {
        assert_eq!(Verdict::of(false, &[1.0], false), Verdict::NotInCatalogue);
        assert_eq!(Verdict::of(true, &[], true), Verdict::Parameters);
        assert_eq!(Verdict::of(true, &[0.95, 0.5], true), Verdict::Ambiguous);
        assert_eq!(Verdict::of(true, &[0.95, 0.9], true), Verdict::Named);
    }
}
