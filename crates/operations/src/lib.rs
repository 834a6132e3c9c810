//! Equations as lists of operations, each on the results of earlier ones: the form in which programs and FMUs hand equations on.

mod operation;
mod wrapping;

pub use operation::{Fault, Operation, check, value};
pub use wrapping::{AddedEffect, COORDINATES, Own, Port, SETTINGS_FILE, Settings, SettingsError};
