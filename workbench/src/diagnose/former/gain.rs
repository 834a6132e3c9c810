//! What a fit gains over another on windows that it was not fitted to.

use super::data::Data;
use super::losses::FAILED;

/// Gain in ln likelihood below which no effect is named: on clean records the best of all candidates stays below it.
pub const LEAST_GAIN: f64 = 10.0;
/// Windows in a row that share a fold: what half of the blocks teach is judged on the other half.
const BLOCK: usize = 4;
/// Share of the windows that differ by no more than is usual.
const USUAL_SHARE: f64 = 0.97;
/// Difference of ln likelihood that is usual whatever the others are.
const LEAST_USUAL: f64 = 20.0;

/// Folds of the windows: blocks in turn, and runs begin with each in turn, since what shows only where runs begin must
/// teach both halves.
pub fn folds(data: &Data) -> Vec<usize> {
    folds_of_runs(data.windows.iter().map(|window| window.run))
}

/// The same for windows of these runs.
fn folds_of_runs(runs: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut folds = Vec::new();
    let (mut present, mut first) = (None, 0);
    for (j, run) in runs.enumerate() {
        if present != Some(run) {
            (present, first) = (Some(run), j);
        }
        folds.push(((j - first) / BLOCK + run) % 2);
    }
    folds
}

/// What a fit gains over another.
#[derive(Clone, Copy, Debug)]
pub struct Gain {
    /// Gain in ln likelihood.
    pub total: f64,
    /// Interval that covers it with 95 % probability, by resampling blocks of windows.
    pub interval95: [f64; 2],
    /// The same gain without the block that gains most.
    pub without_best: f64,
}

/// Gain of `candidate` over `base` on windows not fitted to. A window on which they differ by much more than on almost all
/// others counts no more than those: one of the two has not found its start.
pub fn gain(base: &[f64], candidate: &[f64]) -> Gain {
    // A window that one of the two could not run through says nothing about which is right.
    let mut differences: Vec<f64> = base
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
    let most = usual_size(&differences);
    for difference in &mut differences {
        *difference = difference.clamp(-most, most);
    }
    let blocks: Vec<f64> = differences
        .chunks(BLOCK)
        .map(|block| block.iter().sum())
        .collect();
    let total: f64 = blocks.iter().sum();
    let mut state = 0x5DEE_CE66_D1CE_5EED_u64 ^ base.len() as u64;
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
    let best = blocks.iter().copied().fold(0.0, f64::max);
    Gain {
        total,
        interval95: [resampled[9], resampled[389]],
        without_best: total - best,
    }
}

/// The size that almost all of the windows' differences keep to.
fn usual_size(differences: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = differences.iter().map(|d| d.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let at = (USUAL_SHARE * sizes.len() as f64) as usize;
    sizes.get(at).copied().unwrap_or(0.0).max(LEAST_USUAL)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is gained where the candidate is better by `each` in the windows of `at`, of 160.
    fn gained(at: &[usize], each: f64) -> Gain {
        let base = vec![0.0; 160];
        let mut candidate = base.clone();
        for &j in at {
            candidate[j] = -2.0 * each;
        }
        gain(&base, &candidate)
    }

    #[test]
    fn blocks_are_in_turn_and_so_are_the_starts_of_runs() {
        let runs = [[0; 6], [1; 6], [2; 6]].concat();
        let folds = folds_of_runs(runs.into_iter());
        assert_eq!(
            folds,
            [0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 1, 1]
        );
    }

    #[test]
    fn one_window_alone_gains_nothing_for_sure() {
        let one = gained(&[40], 500.0);
        assert_eq!(one.total, LEAST_USUAL);
        assert_eq!(one.interval95[0], 0.0);
        assert_eq!(one.without_best, 0.0);
    }

    #[test]
    fn the_starts_of_two_runs_gain_even_without_the_better_one() {
        let starts = gained(&[40, 120], 15.0);
        assert_eq!(starts.total, 30.0);
        assert_eq!(starts.interval95[0], 0.0);
        assert_eq!(starts.without_best, 15.0);
    }

    #[test]
    fn windows_all_over_the_records_gain_for_sure() {
        let all: Vec<usize> = (0..160).step_by(8).collect();
        assert!(gained(&all, 2.0).interval95[0] > 0.0);
    }
}
