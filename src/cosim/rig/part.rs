//! A rig as what a component is made of.

use super::identity::identity;
use super::variables::{Signal, rig_table};
use crate::cosim::part::{Part, Rows};
use crate::cosim::{Identity, TableError};
use crate::parameter::{ParameterError, Section};
use crate::plant::Rig;

impl Part for Rig<f64> {
    type Signal = Signal;

    fn identity(&self) -> &'static Identity {
        identity(self.kind())
    }

    fn rows(&self) -> Result<Rows<Signal>, TableError> {
        rig_table(self)
    }

    fn start_place(signal: Signal) -> Option<usize> {
        match signal {
            Signal::State(place) => Some(place),
            _ => None,
        }
    }

    fn co_simulation_only(&self) -> Option<&'static str> {
        (self.effects.sensor_delay.is_some()).then_some(
            "a rig with [sensor_delay] is for co-simulation only: what its sensors show is no function of its state",
        )
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
