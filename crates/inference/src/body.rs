//! Small plants: a drive under a known force, a pendulum that swings freely, a joint under its motor's voltage, a contact whose torque and
//! motion are measured, a balance of measured and predicted force, anybody's FMU.
//!
//! Their motion is measured, so that a model is judged by the force it needs for that motion, or by the swing that it predicts (pendulum,
//! joint). A [`model::Model`] is a base and effects, each a term of one equation; a [`problem::Problem`] gives its residuals;
//! [`least_squares`] fits, [`evidence`] judges on what was left out, and [`naming`] lets sets of effects compete by the moves and odds of
//! [`crate::sets`].

pub mod balance;
#[cfg(test)]
mod balance_tests;
pub mod base;
pub mod catalogue;
mod certainty;
pub mod eccentricity;
pub mod effect_file;
pub mod equation;
pub mod evidence;
pub mod filter;
pub mod known;
pub mod least_squares;
pub mod model;
pub mod motion;
pub mod naming;
pub mod prepared;
pub mod problem;
mod series;
mod shift;
pub mod start;
pub mod structure;
pub mod swing;
pub mod term;
pub mod unit;
