//! The rig behind the one model interface.

use super::course::Course;
use super::derivatives::{partial_derivative, time_derivative};
use super::identity::identity;
use super::input_signals::InputSignals;
use super::state::{read_rig, write_rig};
use super::variables::{Friction, Quantity, rig_table};
use crate::cosim::{
    CoSimulationModel, Identity, ModelError, StateError, StateReader, StateWriter, StepEnd,
    TableError, Token, VariableTable,
};
use crate::integrator::Options;
use crate::plant::{Coupling, Rig, RigState, STATES};
use std::fmt;
use std::sync::Arc;

/// A rig with its place in time, its inputs and the course that it takes.
///
/// The run goes ahead of the communication points; the present is read from its polynomials. Inputs
/// and parameters that the importer sets are collected here and reach the run with the next step, or
/// when a quantity that depends on them is read: setting a value that is already in force costs
/// nothing.
pub struct RigModel {
    table: Arc<VariableTable>,
    quantities: Vec<Quantity>,
    token: Token,
    /// The rig of `model.toml`.
    original: Rig<f64>,
    /// The rig with the parameters that are set.
    rig: Rig<f64>,
    signals: InputSignals,
    initial_state: RigState<f64>,
    tolerance: Option<f64>,
    time: f64,
    initialised: bool,
    /// Whether something was set that the course does not know yet.
    pending: bool,
    /// Whether what was set at the present point made a contact stick or slip at once.
    switched_at_once: bool,
    course: Option<Box<Course>>,
}

impl RigModel {
    /// The component that `rig`, read from `model_toml`, is.
    ///
    /// # Errors
    /// A parameter's unit cannot be expressed in SI base units.
    pub fn new(rig: Rig<f64>, model_toml: &str) -> Result<Self, TableError> {
        let (table, quantities) = rig_table(&rig)?;
        let token = Token::new(&table, model_toml);
        Ok(Self {
            table: Arc::new(table),
            quantities,
            token,
            original: rig,
            rig,
            signals: InputSignals::default(),
            initial_state: [0.0; STATES],
            tolerance: None,
            time: identity(rig.kind()).default_experiment.start_time,
            initialised: false,
            pending: false,
            switched_at_once: false,
            course: None,
        })
    }

    fn quantity(&self, value_reference: u32) -> Result<Quantity, ModelError> {
        self.quantities
            .get(value_reference as usize)
            .copied()
            .ok_or_else(|| ModelError(format!("there is no value reference {value_reference}")))
    }

    fn options(&self) -> Options {
        let default = Options::default();
        Options {
            tolerance: self.tolerance.unwrap_or(default.tolerance),
            ..default
        }
    }

    /// The course with everything that was set.
    fn course(&mut self) -> Result<&mut Course, ModelError> {
        if self.pending && self.initialised {
            self.catch_up()?;
        } else if self.pending {
            // Nothing has moved yet: start afresh, so that modes fit the new values.
            self.course = None;
        }
        if self.course.is_none() {
            self.rig.check().map_err(ModelError::from_display)?;
            let inputs = self.signals.rig_inputs(self.time);
            let (state, options) = (self.initial_state, self.options());
            let course = Course::start(self.rig, options, self.time, state, inputs)?;
            self.course = Some(Box::new(course));
        }
        self.pending = false;
        self.course.as_deref_mut().ok_or_else(not_started)
    }

    /// Tells the course what was set since the last step.
    fn catch_up(&mut self) -> Result<(), ModelError> {
        let now = self.time;
        let course = self.course.as_deref_mut().ok_or_else(not_started)?;
        let inputs = (!self.signals.agree_with(course.run.inputs(), now))
            .then(|| self.signals.rig_inputs(now));
        self.switched_at_once |= course.change(&self.rig, inputs, now)?;
        Ok(())
    }

    #[cold]
    fn advance(&mut self, until: f64, stop_at_switch: bool) -> Result<StepEnd, ModelError> {
        let budget = segment_budget(until - self.time).min(self.options().budget);
        let course = self.course.as_deref_mut().ok_or_else(not_started)?;
        let outcome = course.advance(self.time, until, stop_at_switch, budget);
        self.time = match &outcome {
            Ok(end) => end.time,
            Err(_) => course.run.segment_start(),
        };
        outcome
    }

    fn no_series(&self, value_reference: u32) -> ModelError {
        let name = self
            .table
            .get(value_reference)
            .map_or("", |variable| &variable.name);
        ModelError(format!(
            "\"{name}\" is neither a state nor a friction torque"
        ))
    }
}

fn not_started() -> ModelError {
    ModelError("the run did not start".into())
}

impl CoSimulationModel for RigModel {
    fn identity(&self) -> &'static Identity {
        identity(self.original.kind())
    }

    fn table(&self) -> &Arc<VariableTable> {
        &self.table
    }

    fn token(&self) -> Token {
        self.token
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn set_up(&mut self, start_time: f64, tolerance: Option<f64>) {
        self.time = start_time;
        self.tolerance = tolerance;
        self.course = None;
    }

    fn initialise(&mut self) -> Result<(), ModelError> {
        self.course()?;
        self.initialised = true;
        self.signals.begin_step();
        Ok(())
    }

    fn real(&mut self, value_reference: u32) -> Result<f64, ModelError> {
        let time = self.time;
        match self.quantity(value_reference)? {
            Quantity::Time => Ok(time),
            Quantity::Input(channel) => Ok(self.signals.value(channel as usize, time)),
            Quantity::State(place) if !self.initialised => Ok(self.initial_state[place]),
            Quantity::Parameter(position) => self
                .rig
                .parameter_at(position)
                .ok_or_else(|| ModelError(format!("there is no parameter {position}"))),
            quantity => {
                let course = match (&self.course, quantity) {
                    // No input moves a state at once: no need to catch up.
                    (Some(course), Quantity::State(_)) => course,
                    _ => &*self.course()?,
                };
                course
                    .value(quantity, time)
                    .ok_or_else(|| self.no_series(value_reference))
            }
        }
    }

    fn boolean(&mut self, value_reference: u32) -> Result<bool, ModelError> {
        let quantity = self.quantity(value_reference)?;
        let mode = *self.course()?.run.mode();
        match quantity {
            Quantity::Stuck(Friction::Disc) => Ok(mode.disc.is_stuck()),
            Quantity::Stuck(Friction::Disc1) => Ok(mode.disc1.is_stuck()),
            Quantity::Stuck(Friction::Motor) => Ok(mode.motor.is_stuck()),
            Quantity::CouplingFree => Ok(mode.coupling == Coupling::Free),
            _ => Err(ModelError(format!(
                "value reference {value_reference} is not a Boolean"
            ))),
        }
    }

    fn set_real(&mut self, value_reference: u32, value: f64) -> Result<(), ModelError> {
        match self.quantity(value_reference)? {
            Quantity::Input(channel) => self.signals.set_value(channel as usize, value, self.time),
            Quantity::State(place) => self.initial_state[place] = value,
            Quantity::Parameter(position) => {
                self.rig
                    .set_parameter_at(position, value)
                    .map_err(ModelError::from_display)?;
            }
            _ => {
                return Err(ModelError(format!(
                    "value reference {value_reference} is computed"
                )));
            }
        }
        self.pending = true;
        Ok(())
    }

    fn set_input_derivative(
        &mut self,
        value_reference: u32,
        order: u32,
        value: f64,
    ) -> Result<(), ModelError> {
        let Quantity::Input(channel) = self.quantity(value_reference)? else {
            return Err(ModelError(format!(
                "value reference {value_reference} is not an input"
            )));
        };
        self.signals
            .set_derivative(channel as usize, order, value, self.time);
        self.pending = true;
        Ok(())
    }

    fn output_derivative(&mut self, value_reference: u32, order: u32) -> Result<f64, ModelError> {
        let (quantity, time) = (self.quantity(value_reference)?, self.time);
        self.course()?
            .polynomial(quantity, time, |series, tau| {
                time_derivative(series, order as usize, tau)
            })
            .ok_or_else(|| self.no_series(value_reference))
    }

    fn partial_derivative(&mut self, unknown: u32, known: u32) -> Result<f64, ModelError> {
        let (unknown_quantity, known) = (self.quantity(unknown)?, self.quantity(known)?);
        let (time, rig, signals) = (self.time, self.rig, self.signals);
        let run = &self.course()?.run;
        partial_derivative(run, &rig, &signals, time, unknown_quantity, known)?
            .ok_or_else(|| self.no_series(unknown))
    }

    #[inline]
    fn step(&mut self, until: f64, stop_at_switch: bool) -> Result<StepEnd, ModelError> {
        if self.pending || self.course.is_none() {
            self.course()?;
            self.signals.begin_step();
        }
        let switched = std::mem::take(&mut self.switched_at_once);
        if until <= self.time {
            return Ok(StepEnd {
                time: self.time,
                switched,
            });
        }
        if self
            .course
            .as_ref()
            .is_some_and(|course| until <= course.run.segment_end())
        {
            self.time = until;
            return Ok(StepEnd {
                time: until,
                switched,
            });
        }
        let end = self.advance(until, stop_at_switch)?;
        Ok(StepEnd {
            switched: end.switched || switched,
            ..end
        })
    }

    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn fmt::Display)) {
        if let Some(course) = &mut self.course {
            course.notices.drain(..).for_each(|notice| tell(&notice));
        }
    }

    fn save(&self, state: &mut StateWriter) {
        state.real(self.time);
        state.flag(self.initialised);
        state.flag(self.pending);
        state.flag(self.switched_at_once);
        state.flag(self.tolerance.is_some());
        state.real(self.tolerance.unwrap_or(0.0));
        self.initial_state
            .iter()
            .for_each(|value| state.real(*value));
        write_rig(&self.rig, state);
        self.signals.save(state);
        state.flag(self.course.is_some());
        if let Some(course) = &self.course {
            course.save(state);
        }
    }

    fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), StateError> {
        let mut restored = Self {
            table: Arc::clone(&self.table),
            quantities: self.quantities.clone(),
            time: state.real()?,
            initialised: state.flag()?,
            pending: state.flag()?,
            switched_at_once: state.flag()?,
            tolerance: read_optional(state)?,
            course: None,
            ..*self
        };
        for value in &mut restored.initial_state {
            *value = state.real()?;
        }
        restored.rig = read_rig(&self.original, state)?;
        restored.signals = InputSignals::restore(state)?;
        if state.flag()? {
            let course = Course::restore(&self.original, restored.options(), state)?;
            restored.course = Some(Box::new(course));
        }
        *self = restored;
        Ok(())
    }

    fn reset(&mut self) {
        self.rig = self.original;
        self.signals = InputSignals::default();
        self.initial_state = [0.0; STATES];
        self.tolerance = None;
        self.time = self.identity().default_experiment.start_time;
        self.initialised = false;
        self.pending = false;
        self.switched_at_once = false;
        self.course = None;
    }
}

/// Segments that a communication step of `length` seconds may spend.
///
/// The shipped rigs take some hundred a second, stiff ones some thousand. Without a bound that goes with the
/// length, a parameter that makes a time constant absurdly short would hold the importer's process for minutes in
/// a step of a millisecond.
fn segment_budget(length: f64) -> u64 {
    const BUDGET: f64 = 50_000.0;
    (BUDGET * (1.0 + length)) as u64
}

/// A real that may be absent; its place in the state is always there.
fn read_optional(state: &mut StateReader<'_>) -> Result<Option<f64>, StateError> {
    let present = state.flag()?;
    let value = state.real()?;
    Ok(present.then_some(value))
}
