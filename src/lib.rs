//! stickslip

pub mod cosim;
