//! What model exchange asks of a model beyond [`CoSimulationModel`](super::CoSimulationModel): the importer brings the solver.

use super::model::ModelError;

/// What an event changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EventOutcome {
    /// Whether continuous states have other values than before.
    pub states_changed: bool,
}

/// A model as a system of ordinary differential equations with events.
///
/// Modes change in [`update_discrete_states`](Self::update_discrete_states) only; between two calls of it, derivatives and
/// indicators are functions of time, states and inputs. The caller has checked lengths and phases.
pub trait ModelExchange {
    /// Number of continuous states.
    fn state_count(&self) -> usize;

    /// Number of event indicators.
    fn indicator_count(&self) -> usize;

    /// The present time \[s\].
    fn set_time(&mut self, time: f64);

    /// The continuous states, in the order of the table's derivatives.
    fn set_states(&mut self, states: &[f64]);

    /// Their present values.
    ///
    /// # Errors
    /// They cannot be computed with the present parameters.
    fn states(&mut self) -> Result<&[f64], ModelError>;

    /// Their typical sizes, above zero.
    fn nominals(&self) -> &[f64];

    /// Their time derivatives.
    ///
    /// # Errors
    /// They cannot be computed with the present parameters.
    fn derivatives(&mut self) -> Result<&[f64], ModelError>;

    /// The event indicators: positive as long as the modes are the right ones.
    ///
    /// # Errors
    /// They cannot be computed with the present parameters.
    fn indicators(&mut self) -> Result<&[f64], ModelError>;

    /// From here on inputs and parameters may jump.
    fn enter_event_mode(&mut self);

    /// From here on they change continuously.
    fn enter_continuous_time_mode(&mut self);

    /// Changes modes until they are the right ones: simultaneous switches follow each other here.
    ///
    /// # Errors
    /// Modes that change without end, or parameters that contradict each other.
    fn update_discrete_states(&mut self) -> Result<EventOutcome, ModelError>;

    /// Takes the present point as one of the solution; whether it asks for an event.
    ///
    /// # Errors
    /// The point cannot be computed with the present parameters.
    fn complete_step(&mut self) -> Result<bool, ModelError>;
}
