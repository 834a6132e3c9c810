//! Friction laws whose fits small steps from the analyst's model do not reach.

use super::catalogue::{CATALOGUE, Entry, entry};
use super::close_up::CloseUp;
use super::data::Data;
use super::fit::{Fit, fit};
use super::search::{LITTLE_ROUGHNESS, Tried, WRONG, keep_better};

/// Share of a law's gain below which the fit of its limit may have got stuck.
const STUCK: f64 = 0.5;

/// Share by which the loss of a fit from short windows may be greater where neither explains the records: short windows
/// lead to the numbers that are nearest although another effect is missing, with which that one is then found.
const NEARLY_AS_GOOD: f64 = 0.05;

/// A law with many free numbers whose fit has got stuck is fitted once more, over short windows to the end: friction that
/// fluctuates throws windows of the usual length from branch to branch until its numbers are nearly right.
pub fn better_from_short_windows(close_up: &CloseUp<'_>, entry: &Entry, fitted: Fit) -> Fit {
    let data = close_up.data;
    if !entry.is_costly() || fitted.typical_misfit(data) < WRONG {
        return fitted;
    }
    let Some(anew) = close_up.fit_entry(entry) else {
        return fitted;
    };
    let nearer = anew.typical_misfit(data) < fitted.typical_misfit(data)
        && anew.loss < (1.0 + NEARLY_AS_GOOD) * fitted.loss;
    if nearer || anew.loss < fitted.loss {
        anew
    } else {
        fitted
    }
}

/// Adds fits of the laws of few numbers that do not go out from the model, where small steps may not lead to them: where
/// friction fluctuates, which may stand for the peaks of a law that the model lacks, and where every fit leaves windows far
/// off: in a few of them the disc may break away too early, and those may not be in the part that was looked at first.
pub fn fit_laws_from_far(
    close_up: &CloseUp<'_>,
    without: &[String],
    whole: &mut Vec<(&'static Entry, Fit)>,
    progress: &mut dyn FnMut(&str),
) {
    let (data, base) = (close_up.data, close_up.base);
    let explained = whole.iter().any(|(_, fitted)| fitted.is_explained(data));
    let rough = !explained && base.disturbance.relative > LITTLE_ROUGHNESS;
    let far_off = base.has_a_window_far_off(data)
        && whole
            .iter()
            .all(|(_, fitted)| fitted.has_a_window_far_off(data));
    let laws = CATALOGUE
        .iter()
        .filter(|entry| entry.is_law() && !entry.is_costly())
        .filter(|_| rough || far_off)
        .filter(|entry| !entry.starts(&base.hypothesis, true).is_empty())
        .filter(|entry| !without.iter().any(|name| name == entry.name));
    for law in laws {
        progress(law.name);
        let Some(fitted) = close_up.fit_entry(law) else {
            continue;
        };
        keep_better(whole, law, fitted);
    }
}

/// The best fit of an effect that is known: that from short windows or, for the limit of a law, that from the law's numbers,
/// since short windows may not hold what the limit adds.
pub fn fit_named(close_up: &CloseUp<'_>, entry: &Entry) -> Option<Fit> {
    let (data, base) = (close_up.data, close_up.base);
    let own = close_up.fit_entry(entry);
    let from_law = CATALOGUE
        .iter()
        .find(|law| law.limit().is_some_and(|(name, _)| name == entry.name))
        .and_then(|law| close_up.fit_entry(law))
        .and_then(|law| fit_from_numbers(data, base, &[entry.name], &law));
    match (own, from_law) {
        (Some(own), Some(from_law)) if from_law.loss < own.loss => Some(from_law),
        (own, _) => own,
    }
}

/// The fit of the effects `names` on top of `base` that goes out from the numbers of `fitted`, which has other effects; `None`
/// where one of them makes no sense.
pub fn fit_from_numbers(data: &Data, base: &Fit, names: &[&str], fitted: &Fit) -> Option<Fit> {
    let mut hypothesis = names
        .iter()
        .try_fold(base.hypothesis.clone(), |on_top_of, name| {
            entry(name)?.starts(&on_top_of, true).into_iter().next()
        })?;
    hypothesis.take_over(&fitted.hypothesis);
    let starts = fitted.starts.clone();
    Some(fit(data, hypothesis, starts, 25, fitted.judging))
}

/// The best fit of one named effect on top of `base`.
pub fn refit_with(data: &Data, base: &Fit, name: &str) -> Option<Fit> {
    fit_named(&CloseUp::of(data, base), entry(name)?)
}

/// `fitted`, or the fit of the same effects on top of `base` with a law of many free numbers fitted last if that is better:
/// its numbers bend to make up for an effect that is not there yet, and small steps do not bend them back.
pub fn with_costly_law_last(data: &Data, base: &Fit, names: &[&str], fitted: Fit) -> Fit {
    let (laws, others): (Vec<&Entry>, Vec<&Entry>) = names
        .iter()
        .filter_map(|name| entry(name))
        .partition(|entry| entry.is_costly());
    let is_last = names
        .last()
        .and_then(|name| entry(name))
        .is_some_and(Entry::is_costly);
    if laws.is_empty() || is_last || fitted.typical_misfit(data) < WRONG {
        return fitted;
    }
    let anew = others
        .into_iter()
        .chain(laws)
        .try_fold(base.clone(), |on_top_of, entry| {
            fit_named(&CloseUp::of(data, &on_top_of), entry)
        });
    match anew {
        Some(anew) if anew.loss < fitted.loss => anew,
        _ => fitted,
    }
}

/// The fits with that of a law's limit anew, from the numbers of the law, where it has none or its own gains so much less that it
/// may have got stuck; `None` where that finds nothing better.
pub fn limits_from_laws(
    data: &Data,
    base: &Fit,
    tried: &[Tried],
    without: &[String],
    progress: &mut dyn FnMut(&str),
) -> Option<Vec<(&'static Entry, Fit)>> {
    let mut fits: Vec<(&'static Entry, Fit)> = tried
        .iter()
        .filter_map(|t| Some((entry(t.name)?, t.fit.clone())))
        .collect();
    let mut freed = false;
    for law in tried {
        let limit = entry(law.name).and_then(Entry::limit);
        let Some(limit) = limit.and_then(|(name, _)| entry(name)) else {
            continue;
        };
        let at = tried.iter().position(|t| t.name == limit.name);
        let is_found = at.is_some_and(|at| tried[at].gain >= STUCK * law.gain);
        if is_found || without.iter().any(|name| name == limit.name) {
            continue;
        }
        progress(limit.name);
        let Some(anew) = fit_from_numbers(data, base, &[limit.name], &law.fit) else {
            continue;
        };
        match at {
            Some(at) if anew.loss < fits[at].1.loss => fits[at].1 = anew,
            None if anew.loss < base.loss => fits.push((limit, anew)),
            _ => continue,
        }
        freed = true;
    }
    freed.then_some(fits)
}
