//! A controller as a component for co-simulation and model exchange.

mod course;
mod exchange;
mod identity;
mod notice;
mod part;
mod state;
mod variables;

use super::component::Component;
use super::exchange_component::ExchangeComponent;
use crate::controller::INPUTS;

/// A controller behind the one model interface.
pub(super) type ControllerModel = Component<course::Course, INPUTS, { part::STARTS }>;

/// A controller for an importer that brings the solver.
pub(super) type ControllerExchange = ExchangeComponent<exchange::Run, INPUTS, { part::STARTS }>;
