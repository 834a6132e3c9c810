//! Adding effects to a model, one a round, until the records are explained or nothing gains any more.

use std::mem;

use super::breakaway::{Breakaways, STICTION};
use super::catalogue::{Entry, entry};
use super::companions::companions;
use super::data::Data;
use super::fit::Fit;
use super::gain::LEAST_GAIN;
use super::law_fits::with_costly_law_last;
use super::left::{Left, jumps};
use super::rivals::{counts, indistinguishable, least_astray, simplest};
use super::search::{LITTLE_ROUGHNESS, Tried, WRONG, try_all, try_known};
use super::structure::Structure;

/// The same as [`LEAST_GAIN`] for an effect on top of others.
const LEAST_FURTHER_GAIN: f64 = 20.0;
/// The same where friction fluctuates: a few windows in which it happens to be high or low gain half as much.
const LEAST_ROUGH_GAIN: f64 = 40.0;
/// Share of what an effect explains that it must still do where the rest of the model has been shown the way.
const STILL_WANTED: f64 = 0.4;
/// Most effects that are added one after the other.
const MOST_EFFECTS: usize = 3;
/// Effects that must have explained something together for another one to be looked for.
const FIRST_EFFECTS: usize = 2;
/// Share of the loss that they leave if they have not.
const LITTLE_EXPLAINED: f64 = 0.9;

/// An effect that was added.
pub struct Addition {
    /// Name of the effect.
    pub name: &'static str,
    /// Its gain on top of those before it.
    pub gain: f64,
    /// Names of others whose gain cannot be told from its own.
    pub rivals: Vec<&'static str>,
}

/// A model and what was added to it.
pub struct Rounds {
    /// The model without any effect.
    pub base: Fit,
    /// The model with all of them.
    pub current: Fit,
    /// What was added, in this order.
    pub additions: Vec<Addition>,
    /// Every candidate on top of the model without any effect, most gain first.
    pub ranking: Vec<Tried>,
    /// What the model with all effects leaves, where that has been looked at.
    pub left: Option<Left>,
}

impl Rounds {
    /// Adds effects to `base`, those in `without` apart, with the fits of some that are `known` already; `progress` is called with
    /// the name of each before it is tried and with the number of those added so far.
    pub fn of(
        data: &Data,
        base: &Fit,
        breakaways: Option<&Breakaways>,
        mut known: Vec<(&'static Entry, Fit)>,
        without: &[String],
        progress: &mut dyn FnMut(&str, usize),
    ) -> Self {
        let mut rounds = Self {
            base: base.clone(),
            current: base.clone(),
            additions: Vec::new(),
            ranking: Vec::new(),
            left: None,
        };
        let mut guided = false;
        known.extend(breakaways.map(|breakaways| breakaways.stiction.clone()));
        while rounds.may_go_on() {
            let round = rounds.additions.len();
            let tried = if known.iter().any(|(_, both)| both.is_explained(data)) {
                try_known(data, &rounds.current, known.clone())
            } else {
                try_all(data, &rounds.current, without, known.clone(), &mut |name| {
                    progress(name, round)
                })
            };
            let least_gain = rounds.least_gain();
            let accepted = rounds
                .accepted(data, &tried, least_gain)
                .or_else(|| breakaways.and_then(|_| rounds.broken_away(&tried)));
            if !guided && let Some((gain, better)) = rounds.shown_the_way(data, &tried) {
                guided = true;
                let explains_still = accepted.is_some_and(|best| {
                    let explained = rounds.current.loss - best.fit.loss;
                    better.loss - best.fit.loss > STILL_WANTED * explained
                });
                if rounds.additions.is_empty() {
                    rounds.base = better.clone();
                }
                rounds.current = better;
                if !explains_still {
                    let look = round > 0 && jumps(&rounds.current);
                    let nothing_is_left = rounds.nothing_is_left(data, look);
                    // What shows so little of it leads to nothing that would be added.
                    let is_little = round > 0 && accepted.is_none() && gain < least_gain;
                    if nothing_is_left || is_little {
                        break;
                    }
                    continue;
                }
            }
            let is_accepted = accepted.is_some();
            if let Some(best) = accepted {
                let simple = simplest(data, best, &tried, LEAST_FURTHER_GAIN.max(least_gain));
                let beside = known.iter().any(|(entry, _)| entry.name == simple.name);
                rounds.add(data, best, simple, &tried, beside);
                guided = false;
            }
            if rounds.ranking.is_empty() {
                rounds.ranking = tried;
            }
            if !is_accepted || rounds.current.is_explained(data) && round > 0 {
                break;
            }
            let look = jumps(&rounds.current) || rounds.nearly_all_is_explained(data);
            if rounds.nothing_is_left(data, look) {
                break;
            }
            known = match rounds.additions[..] {
                [Addition { name: law, .. }] => companions(
                    data,
                    &rounds.base,
                    law,
                    &rounds.current,
                    without,
                    &mut |name| progress(name, 1),
                ),
                _ => Vec::new(),
            };
        }
        rounds
    }

    /// What the model with all effects leaves, where the analyst's leaves `structure`. Of effects that the gains cannot tell
    /// apart, one that leaves nothing is better than one that leaves structure, and is put in its place.
    pub fn what_is_left(&mut self, data: &Data, structure: &[Structure]) -> Left {
        let explained = self.explained();
        let left = match self.left.take() {
            Some(left) => left,
            None if self.additions.is_empty() => {
                Left::among(data, &self.current, structure.to_vec(), explained)
            }
            None => Left::by(data, &self.current, explained),
        };
        let [only] = &mut self.additions[..] else {
            return left;
        };
        if !left.counts {
            return left;
        }
        let better = only.rivals.iter().enumerate().find_map(|(at, name)| {
            let fitted = &self.ranking.iter().find(|t| t.name == *name)?.fit;
            let left = Left::by(data, fitted, explained);
            (!left.counts).then(|| (at, fitted.clone(), left))
        });
        let Some((at, fitted, nothing)) = better else {
            return left;
        };
        let name = only.rivals.remove(at);
        only.rivals.push(mem::replace(&mut only.name, name));
        self.current = fitted;
        nothing
    }

    /// Gains of all effects together.
    pub fn explained(&self) -> f64 {
        self.additions.iter().map(|addition| addition.gain).sum()
    }

    /// Whether a further effect may be found: not where those there are leave nearly all that there was, since it would stand in
    /// as they do.
    fn may_go_on(&self) -> bool {
        let added = self.additions.len();
        let did_too_little =
            added >= FIRST_EFFECTS && self.current.loss > LITTLE_EXPLAINED * self.base.loss;
        added < MOST_EFFECTS && !did_too_little
    }

    /// Gain that the next effect must bring.
    fn least_gain(&self) -> f64 {
        if self.current.disturbance.relative > LITTLE_ROUGHNESS {
            LEAST_ROUGH_GAIN
        } else if self.additions.is_empty() {
            LEAST_GAIN
        } else {
            LEAST_FURTHER_GAIN
        }
    }

    /// The effect to add, if any of `tried` gains `least_gain` surely.
    fn accepted<'a>(&self, data: &Data, tried: &'a [Tried], least_gain: f64) -> Option<&'a Tried> {
        let is_first = self.additions.is_empty();
        // Clean records never gain as much in all. Where friction fluctuates, or on top of another effect, what else is in the
        // records may; but sticking friction shows in few windows only.
        let elsewhere = |best: &Tried| {
            let is_law = entry(best.name).is_some_and(Entry::is_law);
            match (is_first, is_law) {
                (true, true) => LEAST_GAIN,
                (true, false) => least_gain,
                (false, _) => 2.0 * least_gain,
            }
        };
        let best = tried
            .iter()
            .filter(|t| t.is_finalist)
            .find(|t| counts(data, t))
            .filter(|best| best.gains_surely(least_gain, elsewhere(best)))?;
        Some(if is_first {
            best
        } else {
            least_astray(data, best, tried)
        })
    }

    /// Stiction, where its windows alone make it certain on top of the analyst's model.
    fn broken_away<'a>(&self, tried: &'a [Tried]) -> Option<&'a Tried> {
        tried
            .iter()
            .find(|t| t.name == STICTION && t.is_finalist)
            .filter(|_| self.additions.is_empty())
    }

    /// The current model with other numbers: an effect of no size that fits better has only shown the rest of it the way. With
    /// what that effect gains.
    fn shown_the_way(&self, data: &Data, tried: &[Tried]) -> Option<(f64, Fit)> {
        let guide = tried
            .iter()
            .take_while(|t| t.is_finalist)
            .find(|t| t.gain > LEAST_GAIN && !counts(data, t))?;
        let better = guide.fit.without_last_effect(data, &self.current)?;
        Some((guide.gain, better))
    }

    /// Adds `simple`, which is `best` of `tried` or its limit; `beside` tells whether its fit has a costly law fitted last.
    fn add(&mut self, data: &Data, best: &Tried, simple: &Tried, tried: &[Tried], beside: bool) {
        let mut rivals = indistinguishable(data, simple, tried);
        rivals.retain(|name| *name != best.name);
        self.additions.push(Addition {
            name: simple.name,
            gain: simple.gain,
            rivals,
        });
        self.current = if beside {
            simple.fit.clone()
        } else {
            let names: Vec<&str> = self.additions.iter().map(|a| a.name).collect();
            with_costly_law_last(data, &self.base, &names, simple.fit.clone())
        };
        self.left = None;
    }

    fn nearly_all_is_explained(&self, data: &Data) -> bool {
        self.additions.len() >= FIRST_EFFECTS && self.current.typical_misfit(data) < WRONG
    }

    /// Whether a `look` at what the current model leaves, which is kept, shows nothing that counts.
    fn nothing_is_left(&mut self, data: &Data, look: bool) -> bool {
        self.left = look.then(|| Left::by(data, &self.current, self.explained()));
        self.left.as_ref().is_some_and(|left| !left.counts)
    }
}
