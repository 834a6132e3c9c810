//! Effects that a file describes by an equation: where each acts, on what it may depend, and its numbers.

mod definition;
mod effect;
mod file;
mod port;
mod series;

pub use definition::{Definition, DefinitionError};
use effect::MOST_PARAMETERS;
pub use effect::{EquationEffect, EquationEffects, SiUnits};
pub use file::definition_from_toml;
pub(super) use file::{read_effects, write_effect};
pub use port::Port;
pub(super) use series::{EquationJet, coordinates};
