//! Effects beside a law of many numbers: its numbers bend to make up for an effect that is not there yet, so that nothing
//! shows on top of it, the less so if friction is taken to fluctuate as much as then seems. What promises most over short
//! windows, with friction that fluctuates no more than real contacts do, is therefore fitted first, and the law on top of that.

use super::catalogue::{CATALOGUE, Entry, entry};
use super::close_up::{CloseUp, close_up};
use super::data::Data;
use super::fit::Fit;
use super::law_fits::fit_named;
use super::left::ROUGHNESS;
use super::search::{WRONG, entry_looks};

/// Most effects that are tried beside the law.
const MOST_COMPANIONS: usize = 2;
/// Steps after which it shows over short windows what an effect promises.
const LOOK: usize = 2;

/// The effects that promise most beside `law`, each with `law` fitted after it on top of `base`, the analyst's model, until
/// one of them explains the records; those in `without` are not considered. None where `with_law` is no law of many numbers or
/// leaves little.
pub fn companions(
    data: &Data,
    base: &Fit,
    law: &str,
    with_law: &Fit,
    without: &[String],
    progress: &mut dyn FnMut(&str),
) -> Vec<(&'static Entry, Fit)> {
    let Some(law) = entry(law).filter(|law| law.is_costly()) else {
        return Vec::new();
    };
    if with_law.typical_misfit(data) < WRONG {
        return Vec::new();
    }
    let smooth = data.with_roughness_up_to(ROUGHNESS);
    let analysts = CloseUp::of(&smooth, base);
    let mut both: Vec<(&'static Entry, Fit)> = Vec::new();
    for other in most_promising(&smooth, with_law, without, progress) {
        progress(other.name);
        let first = fit_named(&analysts, other);
        let after_it = first.and_then(|first| fit_named(&CloseUp::of(&smooth, &first), law));
        let Some(fitted) = after_it else {
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

/// The effects that promise most on top of `with_law` over short windows, the most promising first.
fn most_promising(
    smooth: &Data,
    with_law: &Fit,
    without: &[String],
    progress: &mut dyn FnMut(&str),
) -> Vec<&'static Entry> {
    let (close, from) = close_up(smooth, &with_law.hypothesis);
    let others = CATALOGUE
        .iter()
        .filter(|other| !other.is_law() && !without.iter().any(|name| name == other.name));
    let mut promises: Vec<(f64, &'static Entry)> = Vec::new();
    for other in others {
        progress(other.name);
        let promised = entry_looks(&close, &from, other, true)
            .into_iter()
            .map(|look| look.further(&close, LOOK))
            .map(|look| look.promised_loss(&close))
            .min_by(f64::total_cmp);
        promises.extend(promised.map(|promised| (promised, other)));
    }
    promises.sort_by(|a, b| a.0.total_cmp(&b.0));
    promises.truncate(MOST_COMPANIONS);
    promises.into_iter().map(|(_, other)| other).collect()
}
