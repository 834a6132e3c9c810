//! Fits side by side: those that cannot catch up with the best are given up.

use super::candidate::with_prior;
use super::{named, own_names};
use crate::fit::{Fit, STEPS};
use crate::problem::Problem;

/// Steps after which it is asked whether a fit can catch up with the best.
const AT_A_TIME: usize = 3;
/// A fit is given up that would need more than so many times its last gain.
const CATCHES_UP: f64 = 8.0;
/// A fit so near in log odds is carried to its end, since the answer tells by how much it is behind: that of a rival, and as much again.
pub(super) const NEAR: f64 = 6.0;

/// A fit that goes on as long as it can catch up with the best.
struct Runner {
    fit: Fit,
    odds: f64,
    gained: f64,
    is_open: bool,
}

/// The fits after further steps, a few of each in turn, as long as each can catch up with the best of them and with `least` in
/// log odds ([`Candidate::odds`]).
pub(super) fn race(
    problem: &Problem,
    fits: Vec<Fit>,
    least: f64,
    progress: &mut dyn FnMut(&str),
) -> Vec<Fit> {
    let odds = |fit: &Fit| {
        let effects = fit.hypothesis.effects.len();
        with_prior(fit.evidence(&problem.long), effects)
    };
    let mut runners: Vec<Runner> = fits
        .into_iter()
        .map(|fit| Runner {
            odds: odds(&fit),
            gained: 0.0,
            is_open: true,
            fit,
        })
        .collect();
    let mut best = least;
    for _ in 0..STEPS / AT_A_TIME {
        for runner in runners.iter_mut().filter(|runner| runner.is_open) {
            progress(&named(&own_names(&runner.fit.hypothesis)));
            runner.fit = runner.fit.clone().improved(&problem.long, AT_A_TIME);
            let now = odds(&runner.fit);
            runner.gained = now - runner.odds;
            runner.odds = now;
            best = best.max(now);
        }
        for runner in &mut runners {
            let behind = best - runner.odds;
            let catches_up = behind < NEAR.max(CATCHES_UP * runner.gained);
            runner.is_open &= catches_up && !runner.fit.is_converged;
        }
    }
    runners.into_iter().map(|runner| runner.fit).collect()
}
