//! Which of several effects the others make superfluous.

use super::data::Data;
use super::fit::Fit;
use super::gain::{LEAST_GAIN, folds, gain};
use super::law_fits::refit_with;
use super::search::Tried;

/// Whether the effects other than that at `at` may explain without it what all do together: where there is one other, as
/// far as its gain on top of the analyst's model tells.
fn others_do_much(at: usize, names: &[&'static str], gains: &[f64], ranking: &[Tried]) -> bool {
    let total: f64 = gains.iter().sum();
    let alone = |name: &&str| ranking.iter().find(|t| t.name == *name);
    let mut others = names.iter().enumerate().filter(|(j, _)| *j != at);
    match (others.next(), others.next()) {
        (Some((_, other)), None) => alone(other).is_none_or(|t| t.gain > 0.5 * total),
        _ => true,
    }
}

/// Takes away effects that the others make superfluous.
pub fn drop_superfluous(
    data: &Data,
    base: &Fit,
    current: &mut Fit,
    names: &mut Vec<&'static str>,
    gains: &mut Vec<f64>,
    rivals: &mut Vec<Vec<&'static str>>,
    ranking: &[Tried],
) {
    let mut at = 0;
    // The last has been judged on top of all others.
    while at + 1 < names.len() {
        if !others_do_much(at, names, gains, ranking) {
            at += 1;
            continue;
        }
        let mut rest: Option<Fit> = Some(base.clone());
        for (j, name) in names.iter().enumerate() {
            if j == at {
                continue;
            }
            rest = rest.and_then(|fitted| refit_with(data, &fitted, name));
        }
        let folds = folds(data);
        let superfluous = rest.filter(|fitted| {
            let losses = fitted.held_out_losses(data, &folds);
            let lost = gain(&losses, &current.held_out_losses(data, &folds));
            let by_chance = lost.total < 3.0 * LEAST_GAIN || lost.without_best < LEAST_GAIN;
            lost.total < LEAST_GAIN || lost.interval95[0] < 0.0 && by_chance
        });
        match superfluous {
            Some(fitted) => {
                *current = fitted;
                names.remove(at);
                gains.remove(at);
                rivals.remove(at);
            }
            None => at += 1,
        }
    }
}
