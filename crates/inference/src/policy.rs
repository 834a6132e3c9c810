//! Every number that decides: significance levels, prior odds and numerical tolerances. No threshold lives anywhere else.

/// Log prior odds that something given is missing, whether the catalogue has it or not.
///
/// Half of all models lack something, and there are about twenty-five ways to lack it: 1 : 50, or -3.9. A window whose start was not
/// found, or a stretch of a record in which something else happened, may speak for it by [`MOST_TOLD`] and must not decide alone:
/// another -3.
pub const LN_PRIOR_ODDS: f64 = -7.0;
/// Replicas of the records that tell what a right model leaves of them, and what an effect gains that is not missing.
pub const REPLICAS: u64 = 9;
/// Probability with which replicas may show as much as the records do, below which it is no chance.
pub const SIGNIFICANT: f64 = 0.01;
/// Whether numbers that should be normal, of standard deviation 1, are no chance: one of them is beyond x with a probability below
/// exp(−x²/2).
#[must_use]
pub fn is_no_chance(deviations: &[f64]) -> bool {
    let limit = (deviations.len() as f64 / SIGNIFICANT).ln();
    deviations.iter().any(|own| 0.5 * own * own > limit)
}

/// By how much a stated deviation may be too small where the records contradict it. Of a hundred statements one is wrong so far, which makes
/// what is known of a number a mixture of two normal densities (Tukey's contaminated normal). The wide one is the likelier from 3.7
/// deviations on, where for ten numbers [`is_no_chance`] stops to believe in the narrow one.
pub const DOUBT: f64 = 10.0;
/// Most that one window may tell, in log odds: 20 : 1. What an effect does shows in more than two or three windows.
pub const MOST_TOLD: f64 = 3.0;
/// Posterior probability from which on a set of effects is named; below it its rivals are told with it.
pub const NAMED: f64 = 0.9;

/// Log odds that belong to [`NAMED`].
#[must_use]
pub fn sure_odds() -> f64 {
    (NAMED / (1.0 - NAMED)).ln()
}

/// Posterior probability from which on a set that says otherwise is told as a rival.
pub const RIVAL: f64 = 0.05;
/// Squared residuals over their number up to which a model may be right: instruments are known to a fifth.
pub const MOST_MISFIT: f64 = 1.44;
/// Standard deviations outside of which a normal variable lies with a probability of 5 %: from there on a nominal parameter counts
/// as wrong, and a number as other than zero.
pub const SURELY: f64 = 1.96;
/// Share of the measured force that a model may leave, noise apart, and still be right. Engineers call a model right that follows the
/// force within a twentieth; no evidence tells this number, since a model of a real plant always leaves something.
pub const NEGLIGIBLE: f64 = 0.05;
/// Most effects in one set.
pub const MOST_EFFECTS: usize = 3;
/// Squared residuals over their number above which a model without fluctuating friction is wrong.
pub const WRONG: f64 = 1.1;
/// Squared residuals over their number above which linear predictions from the present model are not trusted, so that short
/// windows lead the way.
pub const FAR: f64 = 1.5;
