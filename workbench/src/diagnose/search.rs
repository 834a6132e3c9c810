//! Trying every effect of the catalogue on top of a fitted hypothesis.

use super::catalogue::{CATALOGUE, Entry};
use super::fit::{Data, FAILED, Fit, fit};
use stickslip::plant::RigState;

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
}

impl Entry {
    /// Where the windows start when this effect is tried on top of `base`: where the base has put
    /// them, or as measured if the base is wrong and the effect far from it.
    pub fn window_starts(&self, data: &Data, base: &Fit, wrong: bool) -> Vec<RigState<f64>> {
        if wrong && self.is_nonlinear() {
            data.windows.iter().map(|window| window.anchor).collect()
        } else {
            base.starts.clone()
        }
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
/// Loss above the best by which a fit in progress is given up.
const HOPELESS: f64 = 400.0;
/// Decrease of the loss that a start must promise to be followed up.
const LEAST_PROMISE: f64 = 8.0;
/// Starts that are followed up although others promise much more.
const FOLLOWED: usize = 6;

/// Fits the entries that make sense on top of `base`: a first look at each start tells from exact
/// derivatives what it promises, and the promising are fitted to the end. `progress` is called with
/// the entry's name before each fit.
pub fn try_all(
    data: &Data,
    base: &Fit,
    without: &[String],
    progress: &mut dyn FnMut(&str),
) -> Vec<Tried> {
    let folds = folds(data);
    let base_losses = base.held_out_losses(data, &folds);
    let wrong = base.misfit(data) > WRONG || base.disturbance.relative > 0.05;
    let mut starts: Vec<(f64, &'static Entry, Fit)> = Vec::new();
    for entry in CATALOGUE
        .iter()
        .filter(|entry| !without.iter().any(|name| name == entry.name))
    {
        progress(entry.name);
        for start in entry.starts(&base.hypothesis, wrong) {
            if start.dimension() <= super::gram::MOST_FREE {
                let look = if entry.is_nonlinear() && wrong { 2 } else { 0 };
                let first = fit(data, start, entry.window_starts(data, base, wrong), look);
                starts.push((first.promised_loss(data), entry, first));
            }
        }
    }
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = base.loss;
    let mut tried: Vec<Tried> = Vec::new();
    let mut explained = !wrong;
    for (rank, (promised, entry, start)) in starts.into_iter().enumerate() {
        let mut fitted = start;
        let gains = promised < base.loss - LEAST_PROMISE;
        let rivals = promised < best + HOPELESS;
        if gains && (rivals || !explained && (rank < FOLLOWED || entry.is_nonlinear())) {
            progress(entry.name);
            fitted = fit(data, fitted.hypothesis, fitted.starts, 5);
            if fitted.iterations >= 5 && fitted.promised_loss(data) < best + HOPELESS {
                fitted = fit(data, fitted.hypothesis, fitted.starts, 20);
            }
            best = best.min(fitted.loss);
            explained |= fitted.is_explained(data);
        } else if tried.iter().any(|t| t.name == entry.name) {
            continue;
        }
        let (gain, interval95) = gain(data, &base_losses, &fitted.held_out_losses(data, &folds));
        match tried.iter_mut().find(|t| t.name == entry.name) {
            Some(earlier) if earlier.fit.loss <= fitted.loss => {}
            Some(earlier) => {
                *earlier = Tried {
                    name: entry.name,
                    fit: fitted,
                    gain,
                    interval95,
                }
            }
            None => tried.push(Tried {
                name: entry.name,
                fit: fitted,
                gain,
                interval95,
            }),
        }
    }
    tried.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    tried
}
