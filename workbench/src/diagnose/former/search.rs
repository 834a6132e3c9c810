//! Trying every effect of the catalogue on top of a fitted hypothesis.

use super::catalogue::{CATALOGUE, Entry, entry};
use super::close_up::CloseUp;
use super::data::Data;
use super::fit::{Fit, fit};
use super::gain::{folds, gain};
use super::hypothesis::Hypothesis;
use super::law_fits::{better_from_short_windows, fit_laws_from_far, limits_from_laws};
use std::cmp::Ordering;

/// A catalogue entry fitted on top of a base.
#[derive(Clone, Debug)]
pub struct Tried {
    /// Name of the effect.
    pub name: &'static str,
    /// The best of its fits.
    pub fit: Fit,
    /// Gain in ln likelihood on windows not fitted to.
    pub gain: f64,
    /// Interval that covers the gain with 95 % probability, by resampling blocks of windows.
    pub interval95: [f64; 2],
    /// The gain without the few windows in a row that gain most.
    pub gain_without_best: f64,
    /// Whether it was fitted to all windows; the gain of the others is projected from a part.
    pub is_finalist: bool,
}

impl Tried {
    /// Whether it gains more than `least`, and not by a few windows in a row alone, without which it must gain `elsewhere`.
    /// Sticking friction may show only where runs begin: so few windows leave the interval open, but each run tells of it.
    pub fn gains_surely(&self, least: f64, elsewhere: f64) -> bool {
        self.gain > least && (self.interval95[0] > 0.0 || self.gain_without_best > elsewhere)
    }

    /// Whether the effect has a size that is worth naming; the smaller it is, the better records must show it.
    pub fn is_material(&self) -> bool {
        let size = entry(self.name).map_or(0.0, |entry| entry.relative_size(&self.fit.hypothesis));
        size > CONSIDERABLE
            || size > 1.0 && self.gain > WELL_SHOWN
            || size > NEARLY_NOTHING && self.gain > BEYOND_DOUBT
    }
}

/// A hypothesis on top of `base` before any step: its windows start where the base has put them, or
/// as measured if the base is wrong and that promises more.
pub fn first_look(data: &Data, hypothesis: Hypothesis, base: &Fit, wrong: bool) -> Fit {
    let carried = fit(data, hypothesis, base.starts.clone(), 0, base.judging);
    if !wrong {
        return carried;
    }
    let measured = fit(
        data,
        carried.hypothesis.clone(),
        data.anchors(),
        0,
        base.judging,
    );
    if measured.promised_loss(data) < carried.promised_loss(data) {
        measured
    } else {
        carried
    }
}

/// Multiple of the size worth naming from which on an effect needs no more gain than any.
const CONSIDERABLE: f64 = 3.0;
/// Gain in ln likelihood that an effect of the size worth naming needs: the real ones have several times as much.
const WELL_SHOWN: f64 = 40.0;
/// Share of the size worth naming below which an effect is none.
const NEARLY_NOTHING: f64 = 0.1;
/// Gain in ln likelihood that no imperfection of the method brings about.
const BEYOND_DOUBT: f64 = 100.0;
/// Misfit per residual above which a base counts as wrong, so that effects are also tried from far.
pub const WRONG: f64 = 1.1;
/// Every so-manieth window serves for the first look at the candidates.
const THINNING: usize = 3;
/// Windows below which none are left out.
const ENOUGH_WINDOWS: usize = 60;
/// Relative friction disturbance above which friction counts as fluctuating.
pub const LITTLE_ROUGHNESS: f64 = 0.02;
/// Loss above the best, on the thinned windows, by which a fit in progress is given up.
const HOPELESS: f64 = 130.0;
/// Loss above the best, on the thinned windows, up to which small effects are fitted to all windows.
const RIVALS: f64 = 25.0;
/// Most small effects that are fitted to all windows.
const MOST_RIVALS: usize = 5;
/// Most effects on top of a wrong base that are.
const MOST_WRONG_RIVALS: usize = 8;
/// Decrease of the loss on the thinned windows that a start must promise to be followed up.
const LEAST_PROMISE: f64 = 3.0;
/// The same on top of another effect, where more gain is asked for.
const LEAST_FURTHER_PROMISE: f64 = 8.0;
/// Effects, the most promising, whose starts are followed up although others promise much more.
const FOLLOWED: usize = 6;
/// Starts of one entry of which all are followed.
const SCANNED: usize = 4;
/// The same of an entry that is costly to fit.
const COSTLY_SCANNED: usize = 2;
/// Every so-manieth window serves for looking at the starts of a costly entry.
const SCAN_THINNING: usize = 3;
/// Gain projected from a part of the windows, over the least promise, from which on a small effect is fitted to all.
const PROMISING: f64 = 2.0;
/// Most effects that are fitted to all windows for that reason alone.
const MOST_HOPEFUL: usize = 2;
/// Share of what the best explains that a candidate must explain to be fitted to all windows although others are much better.
const CONSIDERABLE_SHARE: f64 = 0.1;
/// Multiple of the misfit that the best leaves beyond which a candidate cannot catch up.
const CATCHES_UP: f64 = 3.0;
/// Most such candidates.
const FINALISTS: usize = 3;

/// Fits the entries that make sense on top of `base`. Every start is looked at on a part of the
/// windows, where exact derivatives tell what it promises; the promising are followed up there, and
/// the best are fitted to all windows. Where there is a better fit of an entry in `known`, it is taken. `progress` is called
/// with the entry's name before each fit.
pub fn try_all(
    data: &Data,
    base: &Fit,
    without: &[String],
    known: Vec<(&'static Entry, Fit)>,
    progress: &mut dyn FnMut(&str),
) -> Vec<Tried> {
    // Under a law with branches even a small effect moves windows to another branch, which small steps do not undo.
    let branches = base.hypothesis.rig.law.has_branches() && !base.is_explained(data);
    let wrong = base.typical_misfit(data) > WRONG || base.disturbance.relative > 0.05 || branches;
    let thinning = thinning(data);
    let kept: Vec<usize> = (0..data.windows.len()).step_by(thinning).collect();
    let part = data.part(&kept);
    let base_part = base.part(&part, &kept).judged_by_itself(&part);
    let close_up = CloseUp::of(data, base);
    let explored = if wrong {
        explore_closely(&close_up, &part, &base_part, without, progress)
    } else {
        explore(&part, &base_part, without, wrong, progress)
    };
    let best = explored
        .iter()
        .map(|(_, fit)| fit.loss)
        .fold(base_part.loss, f64::min);
    // What the base would gain itself by fitting the part alone is no gain of an effect.
    let promised = base_part.promised_loss(&part);
    let (mut whole, mut on_part) = (Vec::new(), Vec::new());
    let explained = explored
        .first()
        .is_some_and(|(_, fit)| fit.is_explained_but_rough(&part));
    let least_misfit = explored
        .first()
        .map_or(f64::INFINITY, |(_, fit)| fit.typical_misfit(&part));
    for (rank, (entry, found)) in explored.into_iter().enumerate() {
        let gains = found.loss < promised - least_promise(base);
        let rivals = if wrong {
            rank < MOST_WRONG_RIVALS && found.loss < best + HOPELESS
        } else {
            rank < MOST_RIVALS && found.loss < best + RIVALS
        };
        let considerable = promised - found.loss > CONSIDERABLE_SHARE * (promised - best)
            && found.typical_misfit(&part) < CATCHES_UP * least_misfit;
        if gains && (rivals || !explained && rank < FINALISTS && considerable) {
            progress(entry.name);
            let look = first_look(data, found.hypothesis, base, wrong);
            let fitted = look.further(data, 25);
            whole.push((entry, better_from_short_windows(&close_up, entry, fitted)));
        } else {
            on_part.push((entry, found));
        }
    }
    let mut projected = compared(&part, base_part, on_part, thinning as f64);
    projected.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut left = Vec::new();
    for (rank, mut hopeful) in projected.into_iter().enumerate() {
        let promising = hopeful.gain > PROMISING * least_promise(base);
        if !wrong
            && promising
            && rank < MOST_HOPEFUL
            && let Some(entry) = entry(hopeful.name)
        {
            progress(entry.name);
            let starts = base.starts.clone();
            let fitted = fit(data, hopeful.fit.hypothesis, starts, 25, base.judging);
            whole.push((entry, fitted));
        } else {
            hopeful.is_finalist = false;
            left.push(hopeful);
        }
    }
    fit_laws_from_far(&close_up, without, &mut whole, progress);
    for (entry, fitted) in known {
        keep_better(&mut whole, entry, fitted);
    }
    let mut tried = compared(data, base.clone(), whole, 1.0);
    if let Some(freed) = limits_from_laws(data, base, &tried, without, progress) {
        tried = compared(data, base.clone(), freed, 1.0);
    }
    left.retain(|on_part| tried.iter().all(|fitted| fitted.name != on_part.name));
    tried.extend(left);
    tried.sort_by(|a, b| {
        (b.is_finalist, b.gain)
            .partial_cmp(&(a.is_finalist, a.gain))
            .unwrap_or(Ordering::Equal)
    });
    tried
}

/// What these fits of all windows gain over `base`, most first.
pub fn try_known(data: &Data, base: &Fit, known: Vec<(&'static Entry, Fit)>) -> Vec<Tried> {
    let mut tried = compared(data, base.clone(), known, 1.0);
    tried.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    tried
}

/// Adds the fit of an entry, or puts it in the place of one that leaves more.
pub fn keep_better(fits: &mut Vec<(&'static Entry, Fit)>, entry: &'static Entry, fitted: Fit) {
    match fits.iter_mut().find(|(other, _)| other.name == entry.name) {
        Some((_, earlier)) if earlier.loss <= fitted.loss => {}
        Some((_, earlier)) => *earlier = fitted,
        None => fits.push((entry, fitted)),
    }
}

/// The gain of each fit over `base` on the windows of `data`, times `scale`; every window starts for each of them where
/// one of them has found the best start.
fn compared(data: &Data, base: Fit, fits: Vec<(&'static Entry, Fit)>, scale: f64) -> Vec<Tried> {
    let mut base = base;
    let mut fits = fits;
    for (_, fitted) in &mut fits {
        fitted.share_starts(data, &base);
        base.share_starts(data, fitted);
    }
    let folds = folds(data);
    let base_losses = base.held_out_losses(data, &folds);
    fits.into_iter()
        .map(|(entry, fitted)| {
            let gained = gain(&base_losses, &fitted.held_out_losses(data, &folds));
            Tried {
                name: entry.name,
                fit: fitted,
                gain: scale * gained.total,
                interval95: gained.interval95.map(|bound| scale * bound),
                gain_without_best: scale * gained.without_best,
                is_finalist: true,
            }
        })
        .collect()
}

/// The best fit of each entry on a part of the windows, best first. The base is so wrong that windows of the usual
/// length go astray, so that the effects are fitted over short ones first.
fn explore_closely(
    close_up: &CloseUp<'_>,
    part: &Data,
    base_part: &Fit,
    without: &[String],
    progress: &mut dyn FnMut(&str),
) -> Vec<(&'static Entry, Fit)> {
    let (close, base) = close_up.fitted();
    let explored = explore(close, base, without, true, progress);
    let nearest = explored.first().map_or(base.loss, |(_, fit)| fit.loss);
    let mut best = base_part.loss;
    let mut found: Vec<(&'static Entry, Fit)> = Vec::new();
    for (rank, (entry, close_fit)) in explored.into_iter().enumerate() {
        let rivals = rank < FINALISTS || close_fit.loss < nearest + HOPELESS;
        let look = first_look(part, close_fit.hypothesis, base_part, true);
        let mut fitted = look;
        if rivals && fitted.promised_loss(part) < best + HOPELESS {
            progress(entry.name);
            fitted = fitted.further(part, 4);
            if fitted.promised_loss(part) < best + HOPELESS {
                fitted = fitted.further(part, 20);
            }
        }
        best = best.min(fitted.loss);
        found.push((entry, fitted));
    }
    found.sort_by(|a, b| a.1.loss.total_cmp(&b.1.loss));
    found
}

/// What is known while starts are followed up on a part of the windows.
struct Exploration<'a> {
    part: &'a Data,
    base: &'a Fit,
    /// Whether the base is so wrong that effects are also tried from far.
    wrong: bool,
    /// Loss that the base promises after one more step: what an effect adds is judged against it.
    promised: f64,
    /// Best loss so far.
    best: f64,
    /// Whether a fit has been found that leaves nothing to explain.
    explained: bool,
    found: Vec<(&'static Entry, Fit)>,
}

/// The best fit of each entry on a part of the windows, best first.
fn explore(
    part: &Data,
    base: &Fit,
    without: &[String],
    wrong: bool,
    progress: &mut dyn FnMut(&str),
) -> Vec<(&'static Entry, Fit)> {
    let mut exploration = Exploration {
        part,
        base,
        wrong,
        promised: base.promised_loss(part),
        best: base.loss,
        explained: base.is_explained(part),
        found: Vec::new(),
    };
    let wanted = |entry: &&Entry| !without.iter().any(|name| name == entry.name);
    // A law with many free numbers is fitted only where nothing simpler explains the records.
    for costly in [false, true] {
        let entries: Vec<&'static Entry> = CATALOGUE
            .iter()
            .filter(|entry| entry.is_costly() == costly)
            .filter(wanted)
            .collect();
        if costly && exploration.explained {
            break;
        }
        let starts = exploration.looks(&entries, progress);
        exploration.follow(starts, progress);
    }
    let mut found = exploration.found;
    found.sort_by(|a, b| a.1.loss.total_cmp(&b.1.loss));
    found
}

impl Exploration<'_> {
    /// Every start of `entries`, looked at, the most promising first.
    fn looks(
        &self,
        entries: &[&'static Entry],
        progress: &mut dyn FnMut(&str),
    ) -> Vec<(f64, &'static Entry, Fit)> {
        let mut starts: Vec<(f64, &'static Entry, Fit)> = Vec::new();
        for entry in entries {
            progress(entry.name);
            let branches = self.base.hypothesis.rig.law.has_branches();
            let look = if self.wrong && (entry.is_nonlinear() || branches) {
                2
            } else {
                0
            };
            let first = entry_looks(self.part, self.base, entry, self.wrong);
            for start in first {
                let looked = if look > 0 {
                    start.further(self.part, look)
                } else {
                    start
                };
                starts.push((looked.promised_loss(self.part), entry, looked));
            }
        }
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts
    }

    /// Fits the starts that promise something and keeps the best fit of each entry.
    fn follow(&mut self, starts: Vec<(f64, &'static Entry, Fit)>, progress: &mut dyn FnMut(&str)) {
        let mut looked_at: Vec<&str> = Vec::new();
        for (promised, entry, start) in starts {
            let mut fitted = start;
            if !looked_at.contains(&entry.name) {
                looked_at.push(entry.name);
            }
            let gains = promised < self.promised - least_promise(self.base);
            let rivals = promised < self.best + HOPELESS;
            let unsettled =
                !self.explained && (looked_at.len() <= FOLLOWED || entry.is_nonlinear());
            if gains && (rivals || self.wrong && unsettled) {
                progress(entry.name);
                fitted = fitted.further(self.part, 5);
                if fitted.iterations >= 5 && fitted.promised_loss(self.part) < self.best + HOPELESS
                {
                    fitted = fitted.further(self.part, 20);
                }
                self.best = self.best.min(fitted.loss);
                self.explained |= fitted.is_explained(self.part)
                    || self.wrong && fitted.is_explained_but_rough(self.part);
            }
            keep_better(&mut self.found, entry, fitted);
        }
    }
}

/// The starts of one entry on top of `base`, looked at on the windows of `part`; of many only those that promise most.
pub fn entry_looks(part: &Data, base: &Fit, entry: &Entry, wrong: bool) -> Vec<Fit> {
    let mut starts = fittable_starts(base, entry, wrong);
    if entry.is_costly() {
        starts = most_promising(part, base, starts);
    }
    let mut first = looks(part, base, starts);
    // Many starts scan a range in which only the neighbourhood of the best is worth steps.
    if first.len() > SCANNED {
        first.sort_by(|a, b| a.promised_loss(part).total_cmp(&b.promised_loss(part)));
        first.truncate(SCANNED);
    }
    first
}

/// Every start of one entry on top of `base` that is known, from far too, looked at on the windows of `part`.
pub fn every_look(part: &Data, base: &Fit, entry: &Entry) -> Vec<Fit> {
    looks(part, base, fittable_starts(base, entry, true))
}

fn fittable_starts(base: &Fit, entry: &Entry, wrong: bool) -> Vec<Hypothesis> {
    entry
        .starts(&base.hypothesis, wrong)
        .into_iter()
        .filter(|start| start.dimension() <= super::gram::MOST_FREE)
        .collect()
}

fn looks(part: &Data, base: &Fit, starts: Vec<Hypothesis>) -> Vec<Fit> {
    starts
        .into_iter()
        .map(|start| fit(part, start, base.starts.clone(), 0, base.judging))
        .collect()
}

/// Of the many starts of a costly entry the few that promise most on every so-manieth window.
fn most_promising(part: &Data, base: &Fit, starts: Vec<Hypothesis>) -> Vec<Hypothesis> {
    let kept: Vec<usize> = (0..part.windows.len()).step_by(SCAN_THINNING).collect();
    let few = part.part(&kept);
    let base = base.part(&few, &kept);
    let mut looked: Vec<(f64, Hypothesis)> = starts
        .into_iter()
        .map(|start| fit(&few, start, base.starts.clone(), 0, base.judging))
        .map(|look| (look.promised_loss(&few), look.hypothesis))
        .collect();
    looked.sort_by(|a, b| a.0.total_cmp(&b.0));
    looked.truncate(COSTLY_SCANNED);
    looked.into_iter().map(|(_, start)| start).collect()
}

/// Decrease of the loss on the thinned windows that an effect on top of `base` must bring.
fn least_promise(base: &Fit) -> f64 {
    if base.hypothesis.effects.is_empty() {
        LEAST_PROMISE
    } else {
        LEAST_FURTHER_PROMISE
    }
}

/// Every so-manieth window is enough for a first look at `data`.
pub fn thinning(data: &Data) -> usize {
    if data.windows.len() > ENOUGH_WINDOWS {
        THINNING
    } else {
        1
    }
}
