//! A control law as what a component is made of.

use super::identity::identity;
use super::variables::{Signal, controller_table};
use crate::controller::ControlLaw;
use crate::cosim::part::{Part, Rows};
use crate::cosim::{Identity, TableError};
use crate::parameter::{ParameterError, Section};

/// Places of the start values.
pub(super) const INTEGRAL: usize = 0;
pub(super) const FILTERED_TORQUE: usize = 1;
/// Number of start values.
pub(super) const STARTS: usize = 2;

impl Part for ControlLaw<f64> {
    type Signal = Signal;

    fn identity(&self) -> &'static Identity {
        identity(self)
    }

    fn rows(&self) -> Result<Rows<Signal>, TableError> {
        controller_table(self)
    }

    fn start_place(signal: Signal) -> Option<usize> {
        match signal {
            Signal::Integral => Some(INTEGRAL),
            Signal::FilteredTorque => Some(FILTERED_TORQUE),
            _ => None,
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
