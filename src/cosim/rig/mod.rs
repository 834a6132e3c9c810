//! The rig as a component for co-simulation.

mod course;
mod delay_line;
mod derivatives;
pub(super) mod exchange;
mod exchange_rows;
mod identity;
mod input_signals;
mod notice;
mod part;
mod state;
mod variables;

use super::component::Component;
use crate::plant::STATES;

/// A rig behind the one model interface.
pub(super) type RigModel = Component<course::Course, { variables::CHANNELS }, STATES>;
