//! The workbench behind the command `stickslip`: simulating, mapping and examining the rig.
//!
//! One module per command: [`simulate`], [`map`], [`ensemble`], [`closed_loop`], [`info`], [`diagnose`], [`studio`], [`build`], [`export`],
//! [`cross_check`], [`experiment`], [`identify`], [`calibrate`]; [`cli`] dispatches. They stand on
//!
//! - [`component`]: the native model and FMUs of both versions behind one trait;
//! - [`files`]: CSV records and writing whole or not at all;
//! - [`analysis`]: spectra, limit cycles and the measures by which two records are compared;
//! - [`plot`]: pictures as SVG and PNG from one description.

pub mod analysis;
pub mod build;
pub mod calibrate;
pub mod cli;
pub mod closed_loop;
pub mod cross_check;
pub mod diagnose;
pub mod ensemble;
pub mod experiment;
pub mod export;
pub mod files;
pub mod identify;
pub mod info;
pub mod map;
pub mod oscillator;
pub mod outcome;
pub mod plot;
pub mod simulate;
pub mod studio;

pub use build_fmu::component;
