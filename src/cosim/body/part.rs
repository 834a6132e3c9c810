//! A body as what a component is made of.

use super::identity::identity;
use super::variables::{Signal, body_table};
use crate::body::Body;
use crate::cosim::part::{Part, Rows};
use crate::cosim::{Identity, TableError};
use crate::parameter::{ParameterError, Section};

/// Number of start values: position and velocity.
pub(super) const STARTS: usize = 2;

impl Part for Body<f64> {
    type Signal = Signal;

    fn identity(&self) -> &'static Identity {
        identity(self.kind)
    }

    fn rows(&self) -> Result<Rows<Signal>, TableError> {
        body_table(self)
    }

    fn start_place(signal: Signal) -> Option<usize> {
        match signal {
            Signal::Position => Some(0),
            Signal::Velocity => Some(1),
            Signal::Friction | Signal::Acceleration | Signal::Stuck => None,
        }
    }

    fn sections(&self) -> Vec<(&'static str, &dyn Section<f64>)> {
        Self::sections(self)
    }

    fn set_parameter_at(&mut self, position: usize, value: f64) -> Result<(), ParameterError> {
        Self::set_parameter_at(self, position, value)
    }

    fn check(&self) -> Result<(), ParameterError> {
        Self::check(self)
    }
}
