//! Equations as lists of operations, each on the results of earlier ones: the form in which programs and FMUs hand equations on; and
//! the force that what they oppose to a motion comes to over a step.

mod coupling;
mod linear;
mod operation;
mod wrapping;

pub use coupling::{Coupling, Guess, Moment};
pub use linear::linear;
pub use operation::{Fault, Operation, check, value, values};
pub use wrapping::{AddedEffect, COORDINATES, Own, Port, SETTINGS_FILE, Settings, SettingsError};
