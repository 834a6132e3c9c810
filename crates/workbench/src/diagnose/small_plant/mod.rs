//! Small plants: a drive under a known force, a pendulum that swings freely, a contact whose torque and motion are measured, a
//! balance of measured and predicted force, anybody's FMU.
//!
//! Files, commands and screens of what `inference::body` finds. The commands are those of the rig: [`command`].

pub mod amend;
mod belief;
pub mod case;
pub mod columns;
pub mod command;
pub mod console;
pub mod finding;
pub mod fmu;
pub mod model_file;
pub mod model_reader;
mod model_text;
pub mod reading;
pub mod report;
pub mod showing;
mod timing;
