//! The rig as a component for co-simulation.

mod course;
mod delay_line;
mod derivatives;
mod exchange;
mod exchange_rows;
mod identity;
mod input_signals;
mod notice;
mod part;
mod state;
mod variables;

use super::component::Component;
use super::exchange_component::ExchangeComponent;
use crate::plant::STATES;

/// A rig behind the one model interface.
pub(super) type RigModel = Component<course::Course, { variables::CHANNELS }, STATES>;

/// A rig for an importer that brings the solver.
pub(super) type RigExchange = ExchangeComponent<exchange::Run, { variables::CHANNELS }, STATES>;
