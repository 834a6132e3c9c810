//! A rig, a controller or a body behind the one model interface.

use super::identity::Identity;
use super::input_signals::InputSignals;
use super::model::{CoSimulationModel, ModelError, Notice, StepEnd};
use super::part::{Course, Known, Part, Quantity, Signal, read_parameters, write_parameters};
use super::state::{StateError, StateReader, StateWriter};
use super::token::Token;
use super::variables::{TableError, VariableTable};
use crate::parameter;
use std::mem;
use std::sync::Arc;

/// A part with its place in time, its inputs and the course that it takes.
///
/// The course goes ahead of the communication points; the present is read from it. Inputs and parameters that the
/// importer sets are collected here and reach the course with the next step, or when a quantity that depends on them is
/// read: setting a value that is already in force changes nothing.
pub(super) struct Component<C: Course<INPUTS, STARTS>, const INPUTS: usize, const STARTS: usize> {
    table: Arc<VariableTable>,
    quantities: Vec<Quantity<Signal<C, INPUTS, STARTS>>>,
    token: Token,
    /// The part of `model.toml`.
    original: C::Part,
    /// The part with the parameters that are set.
    part: C::Part,
    signals: InputSignals<INPUTS>,
    start_values: [f64; STARTS],
    tolerance: Option<f64>,
    time: f64,
    initialised: bool,
    /// Whether something was set that the course does not know yet.
    pending: bool,
    /// Whether what was set at the present point changed the mode at once.
    switched_at_once: bool,
    course: Option<Box<C>>,
}

impl<C: Course<INPUTS, STARTS>, const INPUTS: usize, const STARTS: usize>
    Component<C, INPUTS, STARTS>
{
    /// The component that `part`, read from `model_toml`, is.
    ///
    /// # Errors
    /// A parameter's unit cannot be expressed in SI base units.
    pub(super) fn new(part: C::Part, model_toml: &str) -> Result<Self, TableError> {
        let (table, quantities) = part.rows()?;
        let token = Token::new(&table, model_toml);
        let signals = signals_at_start(&quantities, &table);
        Ok(Self {
            table: Arc::new(table),
            quantities,
            token,
            original: part,
            part,
            signals,
            start_values: [0.0; STARTS],
            tolerance: None,
            time: part.identity().default_experiment.start_time,
            initialised: false,
            pending: false,
            switched_at_once: false,
            course: None,
        })
    }

    fn quantity(
        &self,
        value_reference: u32,
    ) -> Result<Quantity<Signal<C, INPUTS, STARTS>>, ModelError> {
        self.quantities
            .get(value_reference as usize)
            .copied()
            .ok_or_else(|| ModelError(format!("there is no value reference {value_reference}")))
    }

    /// The course with everything that was set.
    fn course(&mut self) -> Result<&mut C, ModelError> {
        match &mut self.course {
            Some(course) if self.pending && self.initialised => {
                self.switched_at_once |= course.change(&self.part, &self.signals, self.time)?;
            }
            Some(_) if !self.pending => {}
            // Nothing has moved yet: start afresh, so that modes fit the new values.
            _ => {
                self.part.check().map_err(ModelError::from_display)?;
                let (part, values) = (&self.part, &self.start_values);
                let course = C::start(part, self.tolerance, self.time, values, &self.signals)?;
                self.course = Some(Box::new(course));
            }
        }
        self.pending = false;
        self.course
            .as_deref_mut()
            .ok_or_else(|| ModelError("the run did not start".into()))
    }

    #[cold]
    fn advance(&mut self, until: f64, stop_at_switch: bool) -> Result<StepEnd, ModelError> {
        let begin = self.time;
        let course = self.course()?;
        let outcome = course.advance(begin, until, stop_at_switch);
        let reached = course.reached();
        self.time = outcome.as_ref().map_or(reached.max(begin), |end| end.time);
        outcome
    }

    /// The refusal of what only some kinds of variables can.
    fn not(&self, value_reference: u32, kind: &str) -> ModelError {
        let name = self
            .table
            .get(value_reference)
            .map_or("", |variable| &variable.name);
        ModelError(format!("\"{name}\" is not {kind}"))
    }
}

/// The inputs at the start values that the table gives.
fn signals_at_start<S: Copy, const INPUTS: usize>(
    quantities: &[Quantity<S>],
    table: &VariableTable,
) -> InputSignals<INPUTS> {
    let mut signals = InputSignals::default();
    for (quantity, variable) in quantities.iter().zip(table.variables()) {
        if let (Quantity::Input(place), Some(start)) = (quantity, variable.start) {
            signals.set_value(*place, start, signals.centre);
        }
    }
    signals
}

impl<C: Course<INPUTS, STARTS>, const INPUTS: usize, const STARTS: usize> CoSimulationModel
    for Component<C, INPUTS, STARTS>
{
    fn identity(&self) -> &'static Identity {
        self.original.identity()
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
            Quantity::Input(place) => Ok(self.signals.value(place, time)),
            Quantity::Parameter(position) => parameter::value_at(&self.part.sections(), position)
                .ok_or_else(|| self.not(value_reference, "a parameter")),
            Quantity::Signal(signal) => {
                let course = match (C::Part::start_place(signal), &self.course) {
                    (Some(place), _) if !self.initialised => return Ok(self.start_values[place]),
                    // No need to catch up.
                    (Some(_), Some(course)) => &**course,
                    _ => &*self.course()?,
                };
                course
                    .signal(signal, 0, time)
                    .ok_or_else(|| self.not(value_reference, "a real"))
            }
        }
    }

    fn boolean(&mut self, value_reference: u32) -> Result<bool, ModelError> {
        let quantity = self.quantity(value_reference)?;
        let course = self.course()?;
        let flag = match quantity {
            Quantity::Signal(signal) => course.flag(signal),
            _ => None,
        };
        flag.ok_or_else(|| self.not(value_reference, "a Boolean"))
    }

    fn set_real(&mut self, value_reference: u32, value: f64) -> Result<(), ModelError> {
        match self.quantity(value_reference)? {
            Quantity::Input(place) => self.signals.set_value(place, value, self.time),
            Quantity::Parameter(position) => self
                .part
                .set_parameter_at(position, value)
                .map_err(ModelError::from_display)?,
            Quantity::Signal(signal) => match C::Part::start_place(signal) {
                Some(place) => self.start_values[place] = value,
                None => return Err(self.not(value_reference, "to be set: it is computed")),
            },
            Quantity::Time => return Err(self.not(value_reference, "to be set")),
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
        let Quantity::Input(place) = self.quantity(value_reference)? else {
            return Err(self.not(value_reference, "an input"));
        };
        self.signals.set_derivative(place, order, value, self.time);
        self.pending = true;
        Ok(())
    }

    fn output_derivative(&mut self, value_reference: u32, order: u32) -> Result<f64, ModelError> {
        let (quantity, time) = (self.quantity(value_reference)?, self.time);
        let course = self.course()?;
        let derivative = match quantity {
            Quantity::Signal(signal) => course.signal(signal, order, time),
            _ => None,
        };
        derivative.ok_or_else(|| self.not(value_reference, "a real that is computed over time"))
    }

    fn partial_derivative(&mut self, unknown: u32, known: u32) -> Result<f64, ModelError> {
        let (quantity, time) = (self.quantity(unknown)?, self.time);
        let known = match self.quantity(known)? {
            Quantity::Input(place) => Known::Input(place),
            Quantity::Parameter(position) => Known::Parameter(position),
            _ => return Err(self.not(known, "an input or a parameter")),
        };
        let course = self.course()?;
        let derivative = match quantity {
            Quantity::Signal(signal) => course.partial(signal, known, time)?,
            _ => None,
        };
        derivative.ok_or_else(|| self.not(unknown, "a real that is computed over time"))
    }

    #[inline]
    fn step(&mut self, until: f64, stop_at_switch: bool) -> Result<StepEnd, ModelError> {
        if self.pending || self.course.is_none() {
            self.course()?;
        }
        self.signals.begin_step();
        let switched = mem::take(&mut self.switched_at_once);
        if until <= self.time {
            let time = self.time;
            return Ok(StepEnd { time, switched });
        }
        if (self.course.as_mut()).is_some_and(|course| course.covers(until)) {
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

    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn Notice)) {
        if let Some(course) = &mut self.course {
            course.drain_notices(tell);
        }
    }

    fn save(&self, state: &mut StateWriter) {
        state.real(self.time);
        state.flag(self.initialised);
        state.flag(self.pending);
        state.flag(self.switched_at_once);
        state.flag(self.tolerance.is_some());
        state.real(self.tolerance.unwrap_or(0.0));
        self.start_values
            .iter()
            .for_each(|value| state.real(*value));
        write_parameters(&self.part, state);
        self.signals.save(state);
        state.flag(self.course.is_some());
        if let Some(course) = &self.course {
            course.save(state);
        }
    }

    fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), StateError> {
        let time = state.real()?;
        let (initialised, pending) = (state.flag()?, state.flag()?);
        let switched_at_once = state.flag()?;
        let has_tolerance = state.flag()?;
        let tolerance = Some(state.real()?).filter(|_| has_tolerance);
        let mut start_values = [0.0; STARTS];
        for value in &mut start_values {
            *value = state.real()?;
        }
        let part = read_parameters(&self.original, state)?;
        let signals = InputSignals::restore(state)?;
        let course = if state.flag()? {
            let course = C::restore(&self.original, tolerance, state)?;
            Some(Box::new(course))
        } else {
            None
        };
        (self.part, self.signals, self.course) = (part, signals, course);
        (self.start_values, self.tolerance, self.time) = (start_values, tolerance, time);
        (self.initialised, self.pending) = (initialised, pending);
        self.switched_at_once = switched_at_once;
        Ok(())
    }

    fn reset(&mut self) {
        self.part = self.original;
        self.signals = signals_at_start(&self.quantities, &self.table);
        self.start_values = [0.0; STARTS];
        self.tolerance = None;
        self.time = self.identity().default_experiment.start_time;
        self.initialised = false;
        self.pending = false;
        self.switched_at_once = false;
        self.course = None;
    }
}
