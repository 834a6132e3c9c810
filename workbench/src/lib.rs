//! The workbench behind the command `stickslip`: simulating, mapping and examining the rig.
//!
//! - [`files`]: CSV records and writing whole or not at all;
//! - [`analysis`]: spectra, limit cycles and the measures by which two records are compared;
//! - [`plot`]: pictures as SVG and PNG from one description.

pub mod analysis;
pub mod cli;
pub mod component;
pub mod files;
pub mod plot;
pub mod simulate;
