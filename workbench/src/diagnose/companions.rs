//! Effects beside a law of many numbers: its numbers bend to make up for an effect that is not there yet, so that nothing
//! shows on top of it, the less so if friction is taken to fluctuate as much as then seems. What did most on top of the
//! analyst's model is therefore fitted first, and the law on top of that.

use super::catalogue::{Entry, entry};
use super::data::Data;
use super::fit::Fit;
use super::law_fits::fit_named;
use super::left::ROUGHNESS;
use super::search::{Tried, WRONG};

/// Most effects that are tried beside the law.
const MOST_COMPANIONS: usize = 2;

/// The effects that gained most on top of `base`, the analyst's model, by `ranking`, each with `law` fitted after it, until one of
/// them explains the records. None where `with_law` is no law of many numbers or leaves little.
pub fn companions(
    data: &Data,
    base: &Fit,
    law: &str,
    with_law: &Fit,
    ranking: &[Tried],
    progress: &mut dyn FnMut(&str),
) -> Vec<(&'static Entry, Fit)> {
    let Some(law) = entry(law).filter(|law| law.is_costly()) else {
        return Vec::new();
    };
    if with_law.typical_misfit(data) < WRONG {
        return Vec::new();
    }
    let mut others: Vec<(f64, &'static Entry)> = ranking
        .iter()
        .filter_map(|t| Some((t.gain, entry(t.name)?)))
        .filter(|(_, other)| !other.is_law())
        .collect();
    others.sort_by(|a, b| b.0.total_cmp(&a.0));
    others.truncate(MOST_COMPANIONS);
    let smooth = data.with_roughness_up_to(ROUGHNESS);
    let mut both: Vec<(&'static Entry, Fit)> = Vec::new();
    for (_, other) in others {
        progress(other.name);
        let first = fit_named(&smooth, base, other);
        let Some(fitted) = first.and_then(|first| fit_named(&smooth, &first, law)) else {
            continue;
        };
        let is_enough = fitted.is_explained(data);
        both.push((other, fitted));
        if is_enough {
            break;
        }
    }
    both
}
