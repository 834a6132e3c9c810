//! Small plants: a body that moves along one coordinate, and the effects that act on it.
//!
//! A drive, a pendulum or a joint is read from the model file that a diagnosis reads too, with the same effects by equation, and is
//! a hybrid system: it slides forward or backward, or sticks.

mod base;
pub mod coordinate;
mod definition;
mod dimension;
mod effect;
mod file;
mod kind;
mod kinks;
mod motion;
mod plant;
mod system;

pub use base::{DRIVE, JOINT, PENDULUM, Parameter, base, parameter};
pub use definition::Definition;
pub use dimension::{Dimension, plain};
pub use effect::{Described, Effect, Port, read as read_effects};
pub use file::{CATALOGUE_FILE, FileError, OWN_EFFECTS, Plant, Reader, catalogue, is_small_plant};
pub use kind::{Kind, Path};
pub use motion::{
    BodyJet, Branches, CONNECTED, FORCE, GuardKind, INPUTS, Inputs, Mode, Motion, VOLTAGE,
};
pub use plant::{Body, Term};
