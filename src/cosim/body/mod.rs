//! A drive, a pendulum or a joint as a component for co-simulation.

mod course;
mod identity;
mod part;
mod state;
mod variables;

use super::component::Component;
use crate::body::INPUTS;

/// A body behind the one model interface.
pub(super) type BodyModel = Component<course::Course, INPUTS, { part::STARTS }>;
