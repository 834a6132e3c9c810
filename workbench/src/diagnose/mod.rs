//! Naming the missing effect: from a model and records that disagree to a corrected model.
//!
//! Records are cut into windows; the model is restarted from the measured motion in each. What it
//! cannot explain is compared under every hypothesis of the catalogue, with the nominal parameters
//! free within their uncertainty and with random friction as a nuisance.

pub mod amend;
mod breakaway;
pub mod bristle_start;
pub mod case;
pub mod catalogue;
mod certainty;
mod close_up;
pub mod command;
mod companions;
pub mod console;
pub mod data;
pub mod decide;
pub mod effect_page;
pub mod experiment;
pub mod finding;
pub mod fit;
pub mod forced;
pub mod gain;
pub mod gram;
pub mod hypothesis;
mod law_fits;
mod law_starts;
mod left;
pub mod load_cell;
pub mod located;
pub mod losses;
pub mod marginal;
pub mod naming;
pub mod progress;
pub mod record_check;
mod record_units;
mod rehearsal;
pub mod report;
pub mod residual_torque;
pub mod restart;
mod restated;
mod rivals;
pub mod robust;
mod rounds;
pub mod run;
pub mod score;
pub mod search;
pub mod sensors;
pub mod show;
pub mod small_plant;
pub mod structure;
mod superfluous;
pub mod window;
