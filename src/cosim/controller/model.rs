//! The controller behind the one model interface.

use super::identity::identity;
use super::state::{read_law, read_start, write_law, write_start};
use super::variables::{Quantity, controller_table};
use crate::controller::{ControlLaw, Course, INPUTS, Known, Start};
use crate::cosim::input_signals::InputSignals;
use crate::cosim::{
    CoSimulationModel, Identity, ModelError, StateError, StateReader, StateWriter, StepEnd,
    TableError, Token, VariableTable,
};
use std::fmt;
use std::sync::Arc;

/// A controller with its place in time, its inputs and the course that it takes.
///
/// Inputs and parameters that the importer sets are collected and reach the course with the next
/// step, or when something is read: setting a value that is already in force changes nothing.
pub struct ControllerModel {
    table: Arc<VariableTable>,
    quantities: Vec<Quantity>,
    token: Token,
    /// The law of `model.toml`.
    original: ControlLaw<f64>,
    /// The law with the parameters that are set.
    law: ControlLaw<f64>,
    signals: InputSignals<INPUTS>,
    initial_integral: f64,
    initial_torque: f64,
    time: f64,
    initialised: bool,
    /// Whether something was set that the course does not know yet.
    pending: bool,
    /// Whether what was set at the present point made the voltage reach or leave a limit at once.
    switched_at_once: bool,
    course: Option<Course>,
    notices: Vec<Notice>,
}

/// What a controller tells the log.
struct Notice {
    time: f64,
    saturated: bool,
    voltage: f64,
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verb = if self.saturated { "reaches" } else { "leaves" };
        write!(
            f,
            "t = {} s: the voltage {verb} its limit of {} V",
            self.time, self.voltage
        )
    }
}

impl ControllerModel {
    /// The component that `law`, read from `model_toml`, is.
    ///
    /// # Errors
    /// A parameter's unit cannot be expressed in SI base units.
    pub fn new(law: ControlLaw<f64>, model_toml: &str) -> Result<Self, TableError> {
        let (table, quantities) = controller_table(&law)?;
        let token = Token::new(&table, model_toml);
        Ok(Self {
            table: Arc::new(table),
            quantities,
            token,
            original: law,
            law,
            signals: InputSignals::default(),
            initial_integral: 0.0,
            initial_torque: 0.0,
            time: identity(&law).default_experiment.start_time,
            initialised: false,
            pending: false,
            switched_at_once: false,
            course: None,
            notices: Vec::new(),
        })
    }

    fn quantity(&self, value_reference: u32) -> Result<Quantity, ModelError> {
        self.quantities
            .get(value_reference as usize)
            .copied()
            .ok_or_else(|| ModelError(format!("there is no value reference {value_reference}")))
    }

    /// The course with everything that was set.
    fn course(&mut self) -> Result<Course, ModelError> {
        let now = self.time;
        let inputs = self.signals.centred(now).polynomials;
        let course = match self.course {
            Some(course) if !self.pending => return Ok(course),
            Some(course) if self.initialised => {
                let in_force = InputSignals::new(course.start().time, course.start().inputs);
                if self.law == *course.law() && in_force.centred(now).polynomials == inputs {
                    course
                } else {
                    self.law.check().map_err(ModelError::from_display)?;
                    let changed = course.changed(self.law, inputs, now);
                    self.switched_at_once |= self.note(&course, &changed, now);
                    changed
                }
            }
            _ => {
                self.law.check().map_err(ModelError::from_display)?;
                let start = Start {
                    time: now,
                    integral: self.initial_integral,
                    filtered_torque: self.initial_torque,
                    inputs,
                    mode: None,
                };
                Course::new(self.law, start)
            }
        };
        self.pending = false;
        self.course = Some(course);
        Ok(course)
    }

    /// Keeps for the log that the voltage reached or left a limit; whether it did.
    fn note(&mut self, before: &Course, after: &Course, time: f64) -> bool {
        let (was, is) = (before.mode().limit(), after.mode().limit());
        if was == is {
            return false;
        }
        let at_limit = if is.is_some() { after } else { before };
        self.notices.push(Notice {
            time,
            saturated: is.is_some(),
            voltage: at_limit.voltage(0, time),
        });
        true
    }

    /// The signal that a row stands for, or its derivative of the given order; `None` for what is no
    /// continuous signal.
    fn signal(&mut self, quantity: Quantity, order: u32) -> Result<Option<f64>, ModelError> {
        let (course, now) = (self.course()?, self.time);
        Ok(match quantity {
            Quantity::Voltage => Some(course.voltage(order, now)),
            Quantity::Integral => Some(course.integral(order, now)),
            Quantity::FilteredTorque => Some(course.filtered_torque(order, now)),
            _ => None,
        })
    }
}

impl CoSimulationModel for ControllerModel {
    fn identity(&self) -> &'static Identity {
        identity(&self.original)
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

    fn set_up(&mut self, start_time: f64, _tolerance: Option<f64>) {
        self.time = start_time;
        self.course = None;
    }

    fn initialise(&mut self) -> Result<(), ModelError> {
        self.course()?;
        self.initialised = true;
        self.signals.begin_step();
        Ok(())
    }

    fn real(&mut self, value_reference: u32) -> Result<f64, ModelError> {
        match self.quantity(value_reference)? {
            Quantity::Time => Ok(self.time),
            Quantity::Input(input) => Ok(self.signals.value(input as usize, self.time)),
            Quantity::Parameter(position) => self
                .law
                .parameter_at(position)
                .ok_or_else(|| ModelError(format!("there is no parameter {position}"))),
            quantity => self.signal(quantity, 0)?.ok_or_else(|| {
                ModelError(format!("value reference {value_reference} is not a real"))
            }),
        }
    }

    fn boolean(&mut self, value_reference: u32) -> Result<bool, ModelError> {
        match self.quantity(value_reference)? {
            Quantity::Saturated => Ok(self.course()?.mode().limit().is_some()),
            _ => Err(ModelError(format!(
                "value reference {value_reference} is not a Boolean"
            ))),
        }
    }

    fn set_real(&mut self, value_reference: u32, value: f64) -> Result<(), ModelError> {
        match self.quantity(value_reference)? {
            Quantity::Input(input) => self.signals.set_value(input as usize, value, self.time),
            Quantity::Integral => self.initial_integral = value,
            Quantity::FilteredTorque => self.initial_torque = value,
            Quantity::Parameter(position) => self
                .law
                .set_parameter_at(position, value)
                .map_err(ModelError::from_display)?,
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
        let Quantity::Input(input) = self.quantity(value_reference)? else {
            return Err(ModelError(format!(
                "value reference {value_reference} is not an input"
            )));
        };
        self.signals
            .set_derivative(input as usize, order, value, self.time);
        self.pending = true;
        Ok(())
    }

    fn output_derivative(&mut self, value_reference: u32, order: u32) -> Result<f64, ModelError> {
        let quantity = self.quantity(value_reference)?;
        self.signal(quantity, order)?.ok_or_else(|| {
            ModelError(format!(
                "value reference {value_reference} is not an output"
            ))
        })
    }

    fn partial_derivative(&mut self, unknown: u32, known: u32) -> Result<f64, ModelError> {
        let known = match self.quantity(known)? {
            Quantity::Input(input) => Known::Input(input as usize),
            Quantity::Parameter(position) => Known::Parameter(position),
            _ => return Err(ModelError("only inputs and parameters can be known".into())),
        };
        match self.quantity(unknown)? {
            Quantity::Voltage => self
                .course()?
                .voltage_derivative(known, self.time)
                .map_err(ModelError::from_display),
            // The controller's own state, which is held.
            Quantity::Integral | Quantity::FilteredTorque => Ok(0.0),
            _ => Err(ModelError(format!(
                "value reference {unknown} is neither an output nor a continuous local"
            ))),
        }
    }

    fn step(&mut self, until: f64, stop_at_switch: bool) -> Result<StepEnd, ModelError> {
        let mut course = self.course()?;
        self.signals.begin_step();
        let mut switched = std::mem::take(&mut self.switched_at_once);
        let begin = self.time;
        while until > self.time && course.has_event_until(until) {
            let before = course;
            let time = course.next_stretch().map_err(ModelError::from_display)?;
            self.course = Some(course);
            let switch = self.note(&before, &course, time);
            switched |= switch;
            if switch && stop_at_switch && time > begin {
                self.time = time;
                return Ok(StepEnd { time, switched });
            }
        }
        self.course = Some(course);
        self.time = self.time.max(until);
        Ok(StepEnd {
            time: self.time,
            switched,
        })
    }

    fn drain_notices(&mut self, tell: &mut dyn FnMut(&dyn fmt::Display)) {
        self.notices.drain(..).for_each(|notice| tell(&notice));
    }

    fn save(&self, state: &mut StateWriter) {
        state.real(self.time);
        state.flag(self.initialised);
        state.flag(self.pending);
        state.flag(self.switched_at_once);
        state.real(self.initial_integral);
        state.real(self.initial_torque);
        write_law(&self.law, state);
        self.signals.save(state);
        state.flag(self.course.is_some());
        if let Some(course) = &self.course {
            write_law(course.law(), state);
            write_start(course.start(), state);
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
            initial_integral: state.real()?,
            initial_torque: state.real()?,
            course: None,
            notices: Vec::new(),
            ..*self
        };
        restored.law = read_law(&self.original, state)?;
        restored.signals = InputSignals::restore(state)?;
        if state.flag()? {
            let law = read_law(&self.original, state)?;
            restored.course = Some(Course::new(law, read_start(state)?));
        }
        *self = restored;
        Ok(())
    }

    fn reset(&mut self) {
        self.law = self.original;
        self.signals = InputSignals::default();
        self.initial_integral = 0.0;
        self.initial_torque = 0.0;
        self.time = self.identity().default_experiment.start_time;
        self.initialised = false;
        self.pending = false;
        self.switched_at_once = false;
        self.course = None;
        self.notices.clear();
    }
}
