//! Naming the missing effect: from a model and records that disagree to a corrected model.
//!
//! The crate `inference` decides; here are files, screens and the comparison on the held-out record through FMUs. Small plants have a
//! search of their own in [`small_plant`].

pub mod amend;
pub mod case;
pub mod catalogue;
pub mod command;
pub mod console;
pub mod disagreements;
pub mod effect_page;
pub mod experiment;
pub mod finding;
pub mod gap;
mod input_check;
pub mod learning;
pub mod load_cell;
pub mod made;
pub mod material;
pub mod naming;
pub mod progress;
pub mod record_check;
pub mod record_part;
mod record_units;
pub mod report;
pub mod request;
pub mod residual_torque;
pub mod restart;
pub mod rig_columns;
pub mod rig_variable;
pub mod score;
pub mod sensors;
mod session;
pub mod show;
pub mod small_plant;
pub(crate) mod supposed;
pub mod uncertainty;
