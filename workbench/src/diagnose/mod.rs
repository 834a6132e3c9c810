//! Naming the missing effect: from a model and records that disagree to a corrected model.
//!
//! Records are cut into windows; the model is restarted from the measured motion in each. What it
//! cannot explain is compared under every hypothesis of the catalogue, with the nominal parameters
//! free within their uncertainty and with random friction as a nuisance.

pub mod catalogue;
pub mod decide;
pub mod fit;
pub mod gram;
pub mod hypothesis;
pub mod load_cell;
pub mod marginal;
pub mod run;
pub mod search;
pub mod sensors;
pub mod structure;
pub mod window;
