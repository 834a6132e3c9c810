//! Dry friction: the laws, one file each, and the contact that sticks and slips under them.
//!
//! Every law is written for forward sliding (positive slip velocity); the contact mirrors it. A law
//! gives the Taylor coefficients of its level along the motion, order by order, and the level at
//! which a stuck contact breaks away.

mod contact;
mod coulomb;
mod coulomb_stiction;
mod karnopp;
mod law;
mod random_function;
mod slip;
mod slopes;
mod stribeck;
mod switch;
mod two_gaussian;
mod two_gaussian_mu;
mod two_gaussian_torque;
mod wojewoda;

pub use contact::{ContactMode, Direction, Regime};
pub use coulomb::Coulomb;
pub use coulomb_stiction::CoulombStiction;
pub use karnopp::Karnopp;
pub use law::{LAW_NAMES, Law};
pub use random_function::{HARMONICS, RandomFunction};
pub use slip::{LoopFunction, Slip, SlipJet};
pub use slopes::{KnownSlip, LevelSlopes, MOST_PARAMETERS};
pub use stribeck::{ExponentialCurve, Stribeck};
pub use switch::Switch;
pub use two_gaussian::{TwoGaussian, acceleration_angle};
pub use two_gaussian_mu::TwoGaussianMu;
pub use two_gaussian_torque::TwoGaussianTorque;
pub use wojewoda::Wojewoda;
