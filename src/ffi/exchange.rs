//! Model exchange of an instance, the same for both standards.

use super::instance::Instance;
use super::pointers::Output;
use super::status::{Outcome, Phase, Refusal};
use super::values::discard;
use crate::cosim::{EventOutcome, ModelExchange};

/// A vector that a solver asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Vector {
    /// The continuous states.
    States,
    /// Their nominal values.
    Nominals,
    /// Their time derivatives.
    Derivatives,
    /// The event indicators.
    Indicators,
}

impl Instance {
    /// The model for a solver.
    pub(super) fn solver(&mut self) -> Result<&mut dyn ModelExchange, Refusal> {
        self.model.exchange().ok_or_else(|| {
            Refusal::error("this instance is for co-simulation; instantiate one for model exchange")
        })
    }

    /// From continuous time to events.
    pub(super) fn enter_event_mode(&mut self) -> Outcome {
        self.solver()?.enter_event_mode();
        self.enter(Phase::Event)
    }

    /// The time at which everything is evaluated.
    pub(super) fn set_time(&mut self, time: f64) -> Outcome {
        if !time.is_finite() {
            return Err(Refusal::discard(format_args!(
                "time = {time} must be finite"
            )));
        }
        self.solver()?.set_time(time);
        self.time = time;
        Ok(())
    }

    /// The continuous states at which everything is evaluated.
    pub(super) fn set_continuous_states(&mut self, states: &[f64]) -> Outcome {
        let count = self.solver()?.state_count();
        same_count(states.len(), count, "continuous states")?;
        if let Some(place) = states.iter().position(|state| !state.is_finite()) {
            return Err(Refusal::discard(format_args!(
                "continuous state {place} cannot be {}: it must be finite",
                states[place]
            )));
        }
        self.solver()?.set_states(states);
        Ok(())
    }

    /// Writes a vector into an array of `count`.
    pub(super) fn vector(
        &mut self,
        which: Vector,
        count: usize,
        values: &mut Output<f64>,
    ) -> Outcome {
        let solver = self.solver()?;
        let vector = match which {
            Vector::States => solver.states(),
            Vector::Nominals => Ok(solver.nominals()),
            Vector::Derivatives => solver.derivatives(),
            Vector::Indicators => solver.indicators(),
        }
        .map_err(discard)?;
        let what = match which {
            Vector::Indicators => "event indicators",
            _ => "continuous states",
        };
        same_count(count, vector.len(), what)?;
        if let Some(place) = vector.iter().position(|value| !value.is_finite()) {
            return Err(Refusal::discard(format_args!(
                "value {place} of the {what} is {}: with these states and inputs it cannot be calculated",
                vector[place]
            )));
        }
        for (place, value) in vector.iter().enumerate() {
            values.write(place, *value);
        }
        Ok(())
    }

    /// Changes modes until they are the right ones, and logs what happened.
    pub(super) fn update_discrete_states(&mut self) -> Result<EventOutcome, Refusal> {
        let outcome = self
            .solver()?
            .update_discrete_states()
            .map_err(Refusal::error)?;
        self.tell_notices();
        Ok(outcome)
    }

    /// Takes the present point as one of the solution; whether an event is due.
    pub(super) fn complete_step(&mut self) -> Result<bool, Refusal> {
        self.solver()?.complete_step().map_err(discard)
    }
}

fn same_count(given: usize, expected: usize, what: &str) -> Outcome {
    if given == expected {
        return Ok(());
    }
    Err(Refusal::error(format_args!(
        "an array of {given} was given, but there are {expected} {what}"
    )))
}
