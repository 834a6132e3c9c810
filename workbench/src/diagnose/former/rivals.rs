//! Which of the effects that gain alike is the one to name.

use super::catalogue::{Entry, entry};
use super::data::Data;
use super::gain::{folds, gain};
use super::search::{LITTLE_ROUGHNESS, Tried, WRONG};

/// Share of a rival's shortfall that must be certain before the best is called better.
const RIVAL_MARGIN: f64 = 4.0;
/// Share by which an effect on top of others that leaves most windows explained may gain less than one that does not: a
/// stand-in spreads its misfit over all windows, and a few that go astray under the right effect weigh as much.
const ASTRAY: f64 = 0.2;

/// Whether an effect that was fitted to all windows is of a size worth naming, and this size is certain enough to tell it
/// from none.
pub fn counts(data: &Data, tried: &Tried) -> bool {
    tried.is_material() && tried.fit.is_certain_of(data, tried.name)
}

/// Whether nothing is wrong with most windows although friction does not fluctuate.
fn explains_most(data: &Data, tried: &Tried) -> bool {
    tried.fit.typical_misfit(data) < WRONG && tried.fit.disturbance.relative < LITTLE_ROUGHNESS
}

/// `best`, or where it leaves much of most windows one that does not and gains nearly as much.
pub fn least_astray<'a>(data: &Data, best: &'a Tried, tried: &'a [Tried]) -> &'a Tried {
    if explains_most(data, best) {
        return best;
    }
    tried
        .iter()
        .filter(|t| t.is_finalist && t.gain > (1.0 - ASTRAY) * best.gain)
        .find(|t| explains_most(data, t) && counts(data, t))
        .unwrap_or(best)
}

/// Names whose shortfall behind the best is not certain.
pub fn indistinguishable(data: &Data, best: &Tried, tried: &[Tried]) -> Vec<&'static str> {
    let folds = folds(data);
    let best_losses = best.fit.held_out_losses(data, &folds);
    tried
        .iter()
        .filter(|t| t.is_finalist && t.name != best.name && t.gain > 0.3 * best.gain)
        .filter(|t| t.gain <= best.gain || explains_most(data, t))
        .filter(|t| {
            let shortfall = gain(&t.fit.held_out_losses(data, &folds), &best_losses);
            shortfall.total < RIVAL_MARGIN
                || shortfall.interval95[0] < 0.0 && shortfall.total < 3.0 * RIVAL_MARGIN
        })
        .map(|t| t.name)
        .collect()
}

/// Of a law and its limit, which has fewer numbers, the limit, unless the law's further number gains `least` on top of it and
/// can be told from zero.
pub fn simplest<'a>(data: &Data, best: &'a Tried, tried: &'a [Tried], least: f64) -> &'a Tried {
    let Some((limit, number)) = entry(best.name).and_then(Entry::limit) else {
        return best;
    };
    tried
        .iter()
        .find(|t| t.name == limit)
        .filter(|limit| limit.is_finalist && counts(data, limit))
        .filter(|limit| limit.gain > best.gain - least || !best.fit.tells_from(data, number, 0.0))
        .unwrap_or(best)
}
