//! The one interface between a model and the two C interfaces.

use super::exchange::ModelExchange;
use super::identity::Identity;
use super::state::{StateError, StateReader, StateWriter};
use super::token::Token;
use super::variables::VariableTable;
use std::fmt;
use std::sync::Arc;
use thiserror::Error;

/// How a step ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepEnd {
    /// The time that was reached [s]: the requested one, or that of the first switch if the step was
    /// told to stop there.
    pub time: f64,
    /// Whether a mode changed after the start of the step and up to `time`.
    pub switched: bool,
}

/// Something that happened at an instant and that people may want to read: as text with the time, for a log.
pub trait Notice: fmt::Display {
    /// When [s].
    fn time(&self) -> f64;

    /// What happened, without the time.
    fn what(&self) -> String;
}

/// A component for co-simulation, as narrow as both standards allow.
///
/// Variables are addressed by their value reference in [`table`](Self::table). The caller has checked
/// that a variable may be read or set in the present phase and that a value is finite and within the
/// variable's limits.
pub trait CoSimulationModel: Send {
    /// Constants of the component.
    fn identity(&self) -> &'static Identity;

    /// All variables.
    fn table(&self) -> &Arc<VariableTable>;

    /// Hash of the table and of the resource from which the model was made.
    fn token(&self) -> Token;

    /// Time that was reached [s].
    fn time(&self) -> f64;

    /// Start time [s] and relative tolerance of the run to come; `None` leaves the default tolerance.
    fn set_up(&mut self, start_time: f64, tolerance: Option<f64>);

    /// Ends the initialisation: from here on only inputs and tunable parameters change.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    fn initialise(&mut self) -> Result<(), ModelError>;

    /// Current value of a real variable.
    ///
    /// # Errors
    /// The value cannot be computed with the present parameters.
    fn real(&mut self, value_reference: u32) -> Result<f64, ModelError>;

    /// Current value of a Boolean variable.
    ///
    /// # Errors
    /// The value cannot be computed with the present parameters.
    fn boolean(&mut self, value_reference: u32) -> Result<bool, ModelError>;

    /// Sets a real variable at the current time.
    ///
    /// # Errors
    /// The model refuses the value; it is left as it was.
    fn set_real(&mut self, value_reference: u32, value: f64) -> Result<(), ModelError>;

    /// Sets the time derivative of the given order (1 or more) of an input at the current time.
    ///
    /// # Errors
    /// The model refuses the value; it is left as it was.
    fn set_input_derivative(
        &mut self,
        value_reference: u32,
        order: u32,
        value: f64,
    ) -> Result<(), ModelError>;

    /// Time derivative of the given order (1 or more) of an output at the current time.
    ///
    /// # Errors
    /// The value cannot be computed with the present parameters.
    fn output_derivative(&mut self, value_reference: u32, order: u32) -> Result<f64, ModelError>;

    /// Partial derivative of `unknown` (an output or local) with respect to `known` (an input or
    /// parameter) at the current time, the state held.
    ///
    /// # Errors
    /// The derivative does not exist or cannot be computed.
    fn partial_derivative(&mut self, unknown: u32, known: u32) -> Result<f64, ModelError>;

    /// Derivatives of the `unknowns` along a direction, given as knowns with their shares, states and modes held.
    ///
    /// # Errors
    /// One of them does not exist or cannot be computed.
    fn directional_derivatives(
        &mut self,
        unknowns: &[u32],
        direction: &[(u32, f64)],
    ) -> Result<Vec<f64>, ModelError> {
        let mut sums = vec![0.0; unknowns.len()];
        for (unknown, sum) in unknowns.iter().zip(&mut sums) {
            for (known, share) in direction {
                *sum += share * self.partial_derivative(*unknown, *known)?;
            }
        }
        Ok(sums)
    }

    /// Advances to the time `until` [s], or with `stop_at_switch` to the first switch if that comes
    /// earlier. Not later than the current time: nothing happens.
    ///
    /// # Errors
    /// The integrator gives up; the time stays where it got to.
    fn step(&mut self, until: f64, stop_at_switch: bool) -> Result<StepEnd, ModelError>;

    /// Hands on, and forgets, what happened.
    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn Notice));

    /// Writes all that the future depends on, so that a restored model continues bit for bit.
    fn save(&self, state: &mut StateWriter);

    /// The opposite of [`save`](Self::save).
    ///
    /// # Errors
    /// The bytes are not those of a model with this token. The model is then as it was.
    fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), StateError>;

    /// Back to the state after construction.
    fn reset(&mut self);

    /// The same model for an importer that brings the solver, if it was opened for model exchange.
    fn exchange(&mut self) -> Option<&mut dyn ModelExchange> {
        None
    }
}

/// A model that cannot do what it was asked for.
#[derive(Debug, Error)]
#[error("{0}")]
pub struct ModelError(pub String);

impl ModelError {
    /// The error that an inner layer explains.
    pub(crate) fn from_display(reason: impl fmt::Display) -> Self {
        Self(reason.to_string())
    }
}
