//! Friction-induced stick-slip of a motor-driven torsional rig: friction laws, plants, an exact
//! hybrid integrator and their export as FMI co-simulation components.
//!
//! Dependencies run one way: friction ← plant ← cosim ← ffi; the integrator knows no plant.

pub mod body;
pub mod controller;
pub mod cosim;
pub mod expression;
pub mod ffi;
pub mod friction;
pub mod integrator;
pub mod parameter;
pub mod plant;
pub mod series;
