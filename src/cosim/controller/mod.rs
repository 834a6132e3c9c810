//! A controller as a component for co-simulation.

mod course;
mod identity;
mod part;
mod state;
mod variables;

use super::component::Component;
use crate::controller::INPUTS;

/// A controller behind the one model interface.
pub(super) type ControllerModel = Component<course::Course, INPUTS, { part::STARTS }>;
