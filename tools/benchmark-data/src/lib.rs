//! Maker of sealed records with a hidden effect.
//!
//! The physics here is written on its own: a fixed-step leapfrog scheme at 10 µs over *bristle*
//! (LuGre) contacts, where the product uses exact switching and Taylor series. Nothing in this
//! crate imports the product and nothing in the product imports this crate.

pub mod answers;
pub mod axis;
pub mod axis_fmu;
pub mod balance;
pub mod bristle;
pub mod case_files;
mod disc;
pub mod effects;
pub mod error;
pub mod excitation;
pub mod hidden_effect;
pub mod instruments;
pub mod kinds;
pub mod law;
pub mod numerics;
pub mod other_rigs;
pub mod plan;
pub mod practice;
pub mod random;
pub mod recipe;
pub mod records;
pub mod rig;
pub mod simulator;
