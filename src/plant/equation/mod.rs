//! Effects that a file describes by an equation: where each acts, on what it may depend, and its numbers.

mod definition;
mod effect;
mod port;
mod read;
mod series;
mod write;

pub use definition::Definition;
pub use effect::{EquationEffect, EquationEffects, SiUnits};
pub use port::Port;
pub use read::Supposition;
pub(super) use read::read_effects;
pub(super) use series::{EquationJet, coordinates};
pub(super) use write::write_effect;
