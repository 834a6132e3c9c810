//! Every number that decides: significance levels, prior odds and numerical tolerances. No threshold lives anywhere else.

/// Prior odds that a given effect is missing, ln. Half of all models lack something, and there are about twenty-five ways to
/// lack it: 1 : 50, or -3.9. A window whose start was not found may speak for an effect by [`MOST_TOLD`] and must not decide
/// alone: another -3.
pub const LN_PRIOR_ODDS: f64 = -7.0;
/// Most that one window may tell, in log odds: 20 : 1. What an effect does shows in more than two or three windows.
pub const MOST_TOLD: f64 = 3.0;
/// Share of what it acts on (friction torque, load, stiffness, resistance) that an effect must change to be named: a load cell's
/// mean, a held input and the shape of a law are not known better.
pub const LEAST_SHARE: f64 = 0.01;
/// Posterior probability from which on a set of effects is named; below it its rivals are told with it.
pub const NAMED: f64 = 0.9;
/// Posterior probability from which on a set that says otherwise is told as a rival.
pub const RIVAL: f64 = 0.05;
/// Log evidence that a free torque over one coordinate may gain beside a right model. Noise alone gives less than 0; what load
/// cells, rounded encoders and held inputs leave beside noise gave up to 33 on drawn rigs, effects outside the catalogue more.
pub const MOST_LEFT: f64 = 40.0;
/// Log prior odds that something is missing which the catalogue does not have.
pub const PRIOR_ODDS_OF_STRUCTURE: f64 = -MOST_LEFT;
/// Squared residuals over their number up to which a model may be right: instruments are known to a fifth.
pub const MOST_MISFIT: f64 = 1.44;
/// Standard deviations outside of which a normal variable lies with a probability of 5 %: from there on a nominal parameter counts
/// as wrong, and a number as other than zero.
pub const SURELY: f64 = 1.96;
/// Most effects in one set.
pub const MOST_EFFECTS: usize = 3;
/// Squared residuals over their number above which a model without fluctuating friction is wrong.
pub const WRONG: f64 = 1.1;
/// Squared residuals over their number above which linear predictions from the present model are not trusted, so that short
/// windows lead the way.
pub const FAR: f64 = 1.5;
