//! Trying every effect of the catalogue on top of a fitted hypothesis.

use super::catalogue::{CATALOGUE, Entry};
use super::fit::{Data, FAILED, Fit, fit};
use super::hypothesis::Hypothesis;
use std::cmp::Ordering;

/// Windows in a row that share a fold: what half of the blocks teach is judged on the other half.
const BLOCK: usize = 4;

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
    /// Whether it was fitted to all windows; the gain of the others is projected from a part.
    pub is_finalist: bool,
}

/// A hypothesis on top of `base` before any step: its windows start where the base has put them, or
/// as measured if the base is wrong and that promises more.
pub fn first_look(data: &Data, hypothesis: Hypothesis, base: &Fit, wrong: bool) -> Fit {
    let carried = fit(data, hypothesis, base.starts.clone(), 0);
    if !wrong {
        return carried;
    }
    let anchors = data.windows.iter().map(|window| window.anchor).collect();
    let measured = fit(data, carried.hypothesis.clone(), anchors, 0);
    if measured.promised_loss(data) < carried.promised_loss(data) {
        measured
    } else {
        carried
    }
}

/// Folds of the windows: blocks in turn.
pub fn folds(data: &Data) -> Vec<usize> {
    let mut folds = Vec::with_capacity(data.windows.len());
    for j in 0..data.windows.len() {
        folds.push((j / BLOCK) % 2);
    }
    folds
}

/// Gain of `candidate` over `base` on windows not fitted to, with its 95 % interval.
pub fn gain(data: &Data, base: &[f64], candidate: &[f64]) -> (f64, [f64; 2]) {
    // A window that one of the two could not run through says nothing about which is right.
    let differences: Vec<f64> = base
        .iter()
        .zip(candidate)
        .map(|(&b, &c)| {
            if b >= FAILED || c >= FAILED {
                0.0
            } else {
                0.5 * (b - c)
            }
        })
        .collect();
    let blocks: Vec<f64> = differences
        .chunks(BLOCK)
        .map(|block| block.iter().sum())
        .collect();
    let total: f64 = blocks.iter().sum();
    let mut state = 0x5DEE_CE66_D1CE_5EED_u64 ^ data.windows.len() as u64;
    let mut resampled: Vec<f64> = (0..400)
        .map(|_| {
            (0..blocks.len())
                .map(|_| {
                    state = state
                        .wrapping_mul(6_364_136_223_846_793_005)
                        .wrapping_add(1_442_695_040_888_963_407);
                    blocks[((state >> 33) as usize) % blocks.len()]
                })
                .sum()
        })
        .collect();
    resampled.sort_by(f64::total_cmp);
    (total, [resampled[9], resampled[389]])
}

/// Misfit per residual above which a base counts as wrong, so that effects are also tried from far.
const WRONG: f64 = 1.1;
/// Every so-manieth window serves for the first look at the candidates.
const THINNING: usize = 3;
/// Windows below which none are left out.
const ENOUGH_WINDOWS: usize = 60;
/// Loss above the best, on the thinned windows, by which a fit in progress is given up.
const HOPELESS: f64 = 130.0;
/// Decrease of the loss on the thinned windows that a start must promise to be followed up.
const LEAST_PROMISE: f64 = 3.0;
/// Starts that are followed up although others promise much more.
const FOLLOWED: usize = 6;
/// Starts of one entry of which all are followed.
const SCANNED: usize = 4;
/// Candidates that are fitted to all windows although others are much better.
const FINALISTS: usize = 3;

/// Fits the entries that make sense on top of `base`. Every start is looked at on a part of the
/// windows, where exact derivatives tell what it promises; the promising are followed up there, and
/// the best are fitted to all windows. `progress` is called with the entry's name before each fit.
pub fn try_all(
    data: &Data,
    base: &Fit,
    without: &[String],
    progress: &mut dyn FnMut(&str),
) -> Vec<Tried> {
    let wrong = base.misfit(data) > WRONG || base.disturbance.relative > 0.05;
    let thinning = if data.windows.len() > ENOUGH_WINDOWS {
        THINNING
    } else {
        1
    };
    let kept: Vec<usize> = (0..data.windows.len()).step_by(thinning).collect();
    let part = data.part(&kept);
    let base_part = base.part(&part, &kept);
    let explored = explore(&part, &base_part, without, wrong, progress);
    let part_folds = folds(&part);
    let base_part_losses = base_part.held_out_losses(&part, &part_folds);
    let data_folds = folds(data);
    let base_losses = base.held_out_losses(data, &data_folds);
    let best = explored
        .iter()
        .map(|(_, fit)| fit.loss)
        .fold(base_part.loss, f64::min);
    let mut tried = Vec::new();
    for (rank, (entry, found)) in explored.into_iter().enumerate() {
        let gains = found.loss < base_part.loss - LEAST_PROMISE;
        let is_finalist = gains && (rank < FINALISTS || found.loss < best + HOPELESS);
        if is_finalist {
            progress(entry.name);
            let look = first_look(data, found.hypothesis, base, wrong);
            let fitted = fit(data, look.hypothesis, look.starts, 25);
            let (gain, interval95) = gain(
                data,
                &base_losses,
                &fitted.held_out_losses(data, &data_folds),
            );
            tried.push(Tried {
                name: entry.name,
                fit: fitted,
                gain,
                interval95,
                is_finalist,
            });
        } else {
            let (gain, interval) = gain(
                &part,
                &base_part_losses,
                &found.held_out_losses(&part, &part_folds),
            );
            let scale = thinning as f64;
            tried.push(Tried {
                name: entry.name,
                fit: found,
                gain: gain * scale,
                interval95: interval.map(|bound| bound * scale),
                is_finalist,
            });
        }
    }
    tried.sort_by(|a, b| {
        (b.is_finalist, b.gain)
            .partial_cmp(&(a.is_finalist, a.gain))
            .unwrap_or(Ordering::Equal)
    });
    tried
}

/// The best fit of each entry on a part of the windows, best first.
fn explore(
    part: &Data,
    base: &Fit,
    without: &[String],
    wrong: bool,
    progress: &mut dyn FnMut(&str),
) -> Vec<(&'static Entry, Fit)> {
    let mut starts: Vec<(f64, &'static Entry, Fit)> = Vec::new();
    for entry in CATALOGUE
        .iter()
        .filter(|entry| !without.iter().any(|name| name == entry.name))
    {
        progress(entry.name);
        let look = if entry.is_nonlinear() && wrong { 2 } else { 0 };
        let mut first: Vec<Fit> = entry
            .starts(&base.hypothesis, wrong)
            .into_iter()
            .filter(|start| start.dimension() <= super::gram::MOST_FREE)
            .map(|start| first_look(part, start, base, wrong))
            .collect();
        // Many starts scan a range in which only the neighbourhood of the best is worth steps.
        if first.len() > SCANNED {
            first.sort_by(|a, b| a.loss.total_cmp(&b.loss));
            first.truncate(2);
        }
        for start in first {
            let looked = if look > 0 {
                fit(part, start.hypothesis, start.starts, look)
            } else {
                start
            };
            starts.push((looked.promised_loss(part), entry, looked));
        }
    }
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = base.loss;
    let mut explained = !wrong;
    let mut found: Vec<(&'static Entry, Fit)> = Vec::new();
    for (rank, (promised, entry, start)) in starts.into_iter().enumerate() {
        let mut fitted = start;
        let gains = promised < base.loss - LEAST_PROMISE;
        let rivals = promised < best + HOPELESS;
        if gains && (rivals || !explained && (rank < FOLLOWED || entry.is_nonlinear())) {
            progress(entry.name);
            fitted = fit(part, fitted.hypothesis, fitted.starts, 5);
            if fitted.iterations >= 5 && fitted.promised_loss(part) < best + HOPELESS {
                fitted = fit(part, fitted.hypothesis, fitted.starts, 20);
            }
            best = best.min(fitted.loss);
            explained |= fitted.is_explained(part);
        }
        match found
            .iter_mut()
            .find(|(earlier, _)| earlier.name == entry.name)
        {
            Some((_, earlier)) if earlier.loss <= fitted.loss => {}
            Some((_, earlier)) => *earlier = fitted,
            None => found.push((entry, fitted)),
        }
    }
    found.sort_by(|a, b| a.1.loss.total_cmp(&b.1.loss));
    found
}
