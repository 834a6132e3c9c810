//! Which of several effects the others make superfluous.

use super::data::Data;
use super::fit::Fit;
use super::gain::{LEAST_GAIN, folds, gain};
use super::law_fits::{fit_from_numbers, refit_with};
use super::rounds::Rounds;

impl Rounds {
    /// Takes away effects that the others make superfluous.
    pub fn drop_superfluous(&mut self, data: &Data) {
        let mut at = 0;
        // The last has been judged on top of all others.
        while at + 1 < self.additions.len() {
            match self.as_good_without(data, at) {
                Some(fitted) => {
                    self.current = fitted;
                    self.additions.remove(at);
                    self.left = None;
                }
                None => at += 1,
            }
        }
    }

    /// The model without the effect at `at`, if it explains as much.
    fn as_good_without(&self, data: &Data, at: usize) -> Option<Fit> {
        let others: Vec<&str> = (self.additions.iter().enumerate())
            .filter(|(j, _)| *j != at)
            .map(|(_, other)| other.name)
            .collect();
        if !self.may_do_much(&others) {
            return None;
        }
        let is_enough = |rest: &Fit| self.explains_no_more_than(data, rest);
        fit_from_numbers(data, &self.base, &others, &self.current)
            .filter(is_enough)
            .or_else(|| {
                others
                    .iter()
                    .try_fold(self.base.clone(), |fitted, name| {
                        refit_with(data, &fitted, name)
                    })
                    .filter(is_enough)
            })
    }

    /// Whether the model with all effects gains nothing that counts over `rest`.
    fn explains_no_more_than(&self, data: &Data, rest: &Fit) -> bool {
        let folds = folds(data);
        let losses = rest.held_out_losses(data, &folds);
        let lost = gain(&losses, &self.current.held_out_losses(data, &folds));
        let by_chance = lost.total < 3.0 * LEAST_GAIN || lost.without_best < LEAST_GAIN;
        lost.total < LEAST_GAIN || lost.interval95[0] < 0.0 && by_chance
    }

    /// Whether `others` may explain what all effects do together: where it is one, as far as its gain on top of the analyst's
    /// model tells.
    fn may_do_much(&self, others: &[&str]) -> bool {
        let [other] = others else {
            return true;
        };
        let alone = self.ranking.iter().find(|t| t.name == *other);
        alone.is_none_or(|t| t.gain > 0.5 * self.explained())
    }
}
