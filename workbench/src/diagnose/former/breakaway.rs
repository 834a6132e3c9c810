//! At which level the disc broke away: stiction where friction fluctuates.
//!
//! What friction fluctuates by moves the moment at which the disc breaks away, and with it all that follows, further than
//! derivatives reach: a window in which the model breaks away a little earlier or later than the disc did is far from the
//! records. So the windows in which the disc sticks are run with many levels of breakaway, and the likelihoods are averaged over
//! those that the fluctuation may have brought about. Once stiction is found each of these windows has its own level, as far as
//! the fluctuation allows, about that of the law.

use nalgebra::DVector;
use stickslip::friction::{CoulombStiction, Law};
use stickslip::plant::{Rig, RigState};

use super::catalogue::{Entry, entry};
use super::data::{Data, grams, reduced};
use super::fit::{Fit, fit};
use super::hypothesis::Hypothesis;
use super::law_starts::stiction_at;
use super::losses::{FAILED, window_loss};
use super::search::LITTLE_ROUGHNESS;

/// Name of the effect.
pub const STICTION: &str = "stiction";
/// Breakaway over sliding friction: the highest level that windows are run with.
const HIGHEST: f64 = 3.0;
/// Step between those levels.
const STEP: f64 = 0.04;
/// Step between the levels about which friction may fluctuate.
const FINE_STEP: f64 = 0.005;
/// Times that the start of a window is improved at each level.
const IMPROVEMENTS: usize = 2;
/// Standard deviations up to which fluctuating friction is followed.
const REACH: f64 = 4.0;
/// Points on either side of the mean over which is averaged.
const POINTS: i32 = 20;
/// Difference in ln likelihood between levels from which on a window tells of them.
const TELLING: f64 = 4.0;
/// Share of the windows whose level may be none that friction fluctuates about.
const ASTRAY: f64 = 0.02;
/// Standard deviations of the friction by which a disc may on average break away below the mean level: it does so where
/// friction happens to be low.
const LOW: f64 = 0.5;
/// Steps of a fit of stiction.
const STEPS: usize = 25;
/// Gain in ln likelihood from which on it is certain that the disc breaks away above what it slides at: without stiction it
/// stays below 1.
const LEAST_GAIN: f64 = 20.0;
/// Breakaway over sliding friction below which there is no stiction worth naming.
const LEAST_LEVEL: f64 = 1.1;

/// How the disc breaks away in records where friction fluctuates.
#[derive(Clone, Debug)]
pub struct Breakaways {
    /// The records, whose windows break away at levels of their own unless one level for all does as well.
    pub told: Data,
    /// The fit of stiction to them on top of the analyst's model.
    pub stiction: (&'static Entry, Fit),
}

/// A window run with one level.
#[derive(Clone, Copy)]
struct Level {
    likelihood: f64,
    start: RigState<f64>,
}

impl Breakaways {
    /// The disc's breakaways under `base`, if its law is Coulomb's, friction fluctuates, and they are certainly above what the
    /// disc slides at.
    pub fn above_sliding(data: &Data, base: &Fit) -> Option<Self> {
        let relative = base.disturbance.relative;
        let rig = base.hypothesis.rig_at().ok()?;
        let Law::Coulomb(sliding) = rig.law else {
            return None;
        };
        if relative <= LITTLE_ROUGHNESS {
            return None;
        }
        let sticking: Vec<usize> = (0..data.windows.len())
            .filter(|&j| data.windows[j].sticks(&data.runs[data.windows[j].run]))
            .collect();
        let windows = run_with_levels(data, base, &sticking, &rig, sliding.mu_c);
        let about = |mean: f64, astray: f64| -> f64 {
            let each = windows.iter();
            each.map(|at| averaged(at, mean, relative, astray)).sum()
        };
        let levels = levels(FINE_STEP);
        let gains = levels
            .iter()
            .map(|&level| about(level, 0.0) - about(1.0, 0.0));
        let (level, deviation) = moments(&levels, |level| about(level, ASTRAY));
        if gains.fold(0.0, f64::max) < LEAST_GAIN || level < LEAST_LEVEL {
            return None;
        }
        let mut alike = data.clone();
        alike.breakaway_deviation = (deviation / level).hypot(LOW * relative);
        let mut told = alike.clone();
        let mut starts = base.starts.clone();
        for (&j, at) in sticking.iter().zip(&windows) {
            if spread(at) > TELLING {
                let own = likeliest(at, level, relative);
                told.windows[j].breakaway = (1.0 + STEP * own as f64) / level;
                starts[j] = at[own].start;
            }
        }
        let start = stiction_at(&base.hypothesis, level * sliding.mu_c)?;
        let fitted = |data: &Data| fit(data, start.clone(), starts.clone(), STEPS, base.judging);
        let (of_alike, of_told) = (fitted(&alike), fitted(&told));
        // What seemed to fluctuate may have been what stiction explains.
        if of_alike.disturbance.relative <= LITTLE_ROUGHNESS {
            return None;
        }
        let (told, found) = if of_told.loss < of_alike.loss {
            (told, of_told)
        } else {
            (alike, of_alike)
        };
        Some(Self {
            told,
            stiction: (entry(STICTION)?, found),
        })
    }
}

/// Levels from 1 to the highest.
fn levels(step: f64) -> Vec<f64> {
    let count = ((HIGHEST - 1.0) / step).round() as usize;
    (0..=count).map(|k| 1.0 + step * k as f64).collect()
}

/// The windows of these numbers, each with all levels above the sliding friction `mu_c` of `rig`, which is that of `base`.
fn run_with_levels(
    data: &Data,
    base: &Fit,
    sticking: &[usize],
    rig: &Rig<f64>,
    mu_c: f64,
) -> Vec<Vec<Level>> {
    let part = data.part(sticking);
    let starts: Vec<RigState<f64>> = sticking.iter().map(|&j| base.starts[j]).collect();
    let mut windows = vec![Vec::new(); sticking.len()];
    for level in levels(STEP) {
        let mut rig = *rig;
        rig.law = Law::CoulombStiction(CoulombStiction {
            mu_c,
            mu_s: mu_c * level,
        });
        let hypothesis = Hypothesis {
            effects: Vec::new(),
            rig,
            free: Vec::new(),
            x: Vec::new(),
        };
        let found = at_best_starts(&part, base, &hypothesis, &starts);
        for (window, level) in windows.iter_mut().zip(found) {
            window.push(level);
        }
    }
    windows
}

/// Each window of `part` under a hypothesis without free numbers, at the best start that a few improvements find.
fn at_best_starts(
    part: &Data,
    base: &Fit,
    hypothesis: &Hypothesis,
    starts: &[RigState<f64>],
) -> Vec<Level> {
    let nothing = DVector::zeros(0);
    let failed = |&start: &RigState<f64>| Level {
        likelihood: -0.5 * FAILED,
        start,
    };
    let mut best: Vec<Level> = starts.iter().map(failed).collect();
    for mut starts in [part.anchors(), starts.to_vec()] {
        for _ in 0..IMPROVEMENTS {
            let present = grams(part, hypothesis, &starts);
            let forms = reduced(part, &starts, &present, &base.disturbance);
            for (j, form) in forms.iter().enumerate() {
                let likelihood = -0.5 * window_loss(form, base.judging);
                if likelihood > best[j].likelihood {
                    best[j] = Level {
                        likelihood,
                        start: starts[j],
                    };
                }
                if let Some(form) = form {
                    starts[j] = part.windows[j].moved(&starts[j], &form.start_change(&nothing));
                }
            }
        }
    }
    best
}

/// How much the levels differ for a window.
fn spread(at: &[Level]) -> f64 {
    let least = at
        .iter()
        .map(|l| l.likelihood)
        .fold(f64::INFINITY, f64::min);
    most(at) - least
}

/// The most that a window's likelihood is at any level.
fn most(at: &[Level]) -> f64 {
    at.iter()
        .map(|level| level.likelihood)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Which level of a window is the likeliest of those that fluctuate about `mean`.
fn likeliest(at: &[Level], mean: f64, relative: f64) -> usize {
    let posterior = |k: usize| {
        let deviations = (1.0 + STEP * k as f64 - mean) / (relative * mean);
        at[k].likelihood - 0.5 * deviations * deviations
    };
    (0..at.len())
        .max_by(|&a, &b| posterior(a).total_cmp(&posterior(b)))
        .unwrap_or(0)
}

/// ln likelihood of a window at `level` between those that it was run with; beyond them it is that of the last.
fn between(at: &[Level], level: f64) -> f64 {
    let place = ((level - 1.0) / STEP).clamp(0.0, (at.len() - 1) as f64);
    let below = (place as usize).min(at.len() - 2);
    let share = place - below as f64;
    (1.0 - share) * at[below].likelihood + share * at[below + 1].likelihood
}

/// ln of a window's likelihood, averaged over the levels that fluctuate about `mean`, or with the probability `astray` over all.
fn averaged(at: &[Level], mean: f64, relative: f64, astray: f64) -> f64 {
    let most = most(at);
    let (mut sum, mut weights) = (0.0, 0.0);
    for j in -POINTS..=POINTS {
        let deviations = REACH * f64::from(j) / f64::from(POINTS);
        let level = mean * (1.0 + relative * deviations);
        let weight = (-0.5 * deviations * deviations).exp();
        sum += weight * (between(at, level) - most).exp();
        weights += weight;
    }
    let over_all: f64 = at.iter().map(|level| (level.likelihood - most).exp()).sum();
    most + ((1.0 - astray) * sum / weights + astray * over_all / at.len() as f64).ln()
}

/// Mean and standard deviation of the level of this ln likelihood.
fn moments(levels: &[f64], likelihood: impl Fn(f64) -> f64) -> (f64, f64) {
    let at: Vec<f64> = levels.iter().map(|&level| likelihood(level)).collect();
    let most = at.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = at.iter().map(|l| (l - most).exp()).collect();
    let total: f64 = weights.iter().sum();
    let moment = |of: &dyn Fn(f64) -> f64| -> f64 {
        let terms = levels.iter().zip(&weights);
        terms
            .map(|(&level, weight)| of(level) * weight)
            .sum::<f64>()
            / total
    };
    let mean = moment(&|level| level);
    (mean, moment(&|level| (level - mean).powi(2)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::plant::STATES;

    const RELATIVE: f64 = 0.045;

    /// Windows whose discs broke away at these levels.
    fn broken_away(own: &[f64]) -> Vec<Vec<Level>> {
        own.iter()
            .map(|own| {
                levels(STEP)
                    .into_iter()
                    .map(|level| Level {
                        likelihood: -0.5 * ((level - own) / 0.02).powi(2),
                        start: [0.0; STATES],
                    })
                    .collect()
            })
            .collect()
    }

    fn level_of(own: &[f64]) -> (f64, f64) {
        let windows = broken_away(own);
        moments(&levels(FINE_STEP), |mean| {
            let each = windows.iter();
            each.map(|at| averaged(at, mean, RELATIVE, ASTRAY)).sum()
        })
    }

    #[test]
    fn the_level_is_as_certain_as_the_fluctuation_and_the_number_of_windows_allow() {
        for windows in [3, 12] {
            let (level, deviation) = level_of(&vec![1.4; windows]);
            let of_mean = RELATIVE * 1.4 / (windows as f64).sqrt();
            assert!((level - 1.4).abs() < 0.5 * of_mean, "{level}");
            assert!((deviation / of_mean - 1.0).abs() < 0.2, "{deviation}");
        }
    }

    #[test]
    fn a_window_astray_hardly_moves_the_level() {
        let (level, _) = level_of(&[1.38, 1.42, 1.40, 1.44, 1.36, 2.2]);
        assert!((level - 1.4).abs() < 0.03, "{level}");
    }

    #[test]
    fn a_window_breaks_away_at_its_own_level_as_far_as_the_fluctuation_allows() {
        let windows = broken_away(&[1.48, 2.2]);
        let own = windows.iter().map(|at| {
            let at_own = likeliest(at, 1.4, RELATIVE);
            1.0 + STEP * at_own as f64
        });
        let own: Vec<f64> = own.collect();
        assert!((own[0] - 1.48).abs() < 1e-9, "{own:?}");
        assert!(own[1] < 2.2, "{own:?}");
    }

    #[test]
    fn a_disc_that_breaks_away_at_what_it_slides_at_gains_nothing() {
        let windows = broken_away(&[1.0, 1.0, 1.04]);
        let about = |mean: f64| -> f64 {
            let each = windows.iter();
            each.map(|at| averaged(at, mean, RELATIVE, 0.0)).sum()
        };
        let gain = levels(FINE_STEP)
            .into_iter()
            .map(|level| about(level) - about(1.0))
            .fold(0.0, f64::max);
        assert!(gain < 0.05 * LEAST_GAIN, "{gain}");
    }
}
