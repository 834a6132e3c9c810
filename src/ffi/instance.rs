//! An instance: a model with its phase, its log and its place in time, the same for both standards.

use super::handles::Registry;
use super::log::Log;
use super::pointers::Output;
use super::status::{Interface, Outcome, Phase, Phases, Refusal, Status};
use crate::cosim::{
    Causality, CoSimulationModel, MAX_INPUT_DERIVATIVE_ORDER, MAX_OUTPUT_DERIVATIVE_ORDER,
    ModelError, StepEnd, Variability, Variable, VariableType,
};
use std::ffi::{CStr, c_void};

/// All instances of this process.
pub(super) static INSTANCES: Registry<Instance> = Registry::new(0b0101);

/// How far a communication point may lie from where the last step ended [s]: importers add up steps
/// and their sums drift by rounding. Below a nanosecond, or below 64 units in the last place of
/// times beyond some 70,000 s.
pub(super) fn time_tolerance(time: f64) -> f64 {
    (64.0 * f64::EPSILON * time.abs()).max(1e-9)
}

/// A live instance.
pub(super) struct Instance {
    pub(super) model: Box<dyn CoSimulationModel>,
    pub(super) log: Log,
    pub(super) interface: Interface,
    pub(super) phase: Phase,
    /// Whether the phase is due to a call that returned an error.
    pub(super) after_error: bool,
    /// Communication point [s].
    pub(super) time: f64,
    /// Time [s] beyond which no step may go.
    pub(super) stop_time: Option<f64>,
    /// FMI 3: whether the importer handles events.
    pub(super) event_mode_used: bool,
    /// FMI 3: whether a step may end before its end.
    pub(super) early_return_allowed: bool,
    /// Status of the last step.
    pub(super) last_step: Status,
    /// Handles of the states saved through this instance; they end with it.
    pub(super) saved_states: Vec<*mut c_void>,
}

// SAFETY: the pointers are handles of the registry of saved states, which are numbers.
unsafe impl Send for Instance {}

impl Instance {
    pub(super) fn new(model: Box<dyn CoSimulationModel>, log: Log) -> Self {
        let time = model.identity().default_experiment.start_time;
        Self {
            model,
            interface: log.interface(),
            log,
            phase: Phase::Instantiated,
            after_error: false,
            time,
            stop_time: None,
            event_mode_used: false,
            early_return_allowed: false,
            last_step: Status::Ok,
            saved_states: Vec::new(),
        }
    }

    /// Refuses the call if the standard does not allow it in the present phase.
    #[inline]
    pub(super) fn require(&self, allowed: Phases) -> Outcome {
        if allowed.contains(self.phase) {
            Ok(())
        } else {
            Err(self.wrong_phase(allowed))
        }
    }

    #[cold]
    fn wrong_phase(&self, allowed: Phases) -> Refusal {
        let error = if self.after_error {
            " after an error"
        } else {
            ""
        };
        Refusal::error(format_args!(
            "must not be called in the state \"{}\"{error}; it is allowed in: {}",
            self.phase.name(self.interface),
            allowed.names(self.interface)
        ))
    }

    /// Logs why a call was refused, and moves on an error to the phase that the standard asks for.
    #[cold]
    pub(super) fn refuse(&mut self, function: &str, refusal: &Refusal) -> Status {
        self.log
            .write(refusal.status, &format!("{function}: {}", refusal.message));
        if refusal.status == Status::Error {
            self.after_error = true;
            self.phase = match self.interface {
                Interface::Fmi2 => Phase::Failed,
                Interface::Fmi3 => Phase::Terminated,
            };
        }
        refusal.status
    }

    fn variable(&self, value_reference: u32) -> Result<&Variable, Refusal> {
        self.model.table().get(value_reference).ok_or_else(|| {
            Refusal::error(format_args!(
                "there is no variable with value reference {value_reference}; the largest is {}",
                self.model.table().variables().len().saturating_sub(1)
            ))
        })
    }

    fn typed(&self, value_reference: u32, asked: VariableType) -> Result<&Variable, Refusal> {
        let variable = self.variable(value_reference)?;
        if variable.variable_type == asked {
            return Ok(variable);
        }
        Err(Refusal::error(format_args!(
            "\"{}\" (value reference {value_reference}) is {}, not {asked}",
            variable.name, variable.variable_type
        )))
    }

    /// Reads real variables.
    pub(super) fn get_reals(&mut self, references: &[u32], values: &mut Output<f64>) -> Outcome {
        for (place, reference) in references.iter().enumerate() {
            self.typed(*reference, VariableType::Real)?;
            values.write(place, self.model.real(*reference).map_err(discard)?);
        }
        Ok(())
    }

    /// Reads Boolean variables.
    pub(super) fn get_booleans<T: From<bool>>(
        &mut self,
        references: &[u32],
        values: &mut Output<T>,
    ) -> Outcome {
        for (place, reference) in references.iter().enumerate() {
            self.typed(*reference, VariableType::Boolean)?;
            values.write(
                place,
                self.model.boolean(*reference).map_err(discard)?.into(),
            );
        }
        Ok(())
    }

    /// Sets real variables: all of them, or none if one cannot be set.
    pub(super) fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Outcome {
        for (reference, value) in references.iter().zip(values) {
            let variable = self.typed(*reference, VariableType::Real)?;
            self.settable(variable)?;
            if !variable.allows(*value) {
                return Err(Refusal::discard(format_args!(
                    "\"{}\" cannot be {value}: it must be {}",
                    variable.name,
                    variable.allowed()
                )));
            }
        }
        for (reference, value) in references.iter().zip(values) {
            self.model.set_real(*reference, *value).map_err(discard)?;
        }
        Ok(())
    }

    /// Refuses to set variables of a type that no settable variable has.
    pub(super) fn set_none(&mut self, references: &[u32], asked: VariableType) -> Outcome {
        for reference in references {
            let variable = self.typed(*reference, asked)?;
            self.settable(variable)?;
        }
        Ok(())
    }

    /// Refuses to read or set variables of a type that no variable has.
    pub(super) fn no_variable_of_type(&self, references: &[u32], asked: &str) -> Outcome {
        let Some(reference) = references.first() else {
            return Ok(());
        };
        let variable = self.variable(*reference)?;
        Err(Refusal::error(format_args!(
            "\"{}\" (value reference {reference}) is {}, not {asked}",
            variable.name, variable.variable_type
        )))
    }

    fn settable(&self, variable: &Variable) -> Outcome {
        let events_apart = self.event_mode_used && variable.causality != Causality::Input;
        let allowed = match self.phase {
            Phase::Instantiated | Phase::Initialization => variable.settable_before_start(),
            Phase::Step => variable.settable_between_steps() && !events_apart,
            Phase::Event => variable.settable_between_steps(),
            _ => false,
        };
        if allowed {
            return Ok(());
        }
        let when = match (variable.settable_before_start(), variable.variability) {
            (false, _) => "it is computed and can never be set",
            (true, Variability::Tunable) => {
                "a tunable parameter is set before the simulation or at communication points (with \
                 event mode in use, in event mode)"
            }
            (true, _) => "it can be set before the simulation only",
        };
        Err(Refusal::error(format_args!(
            "\"{}\" must not be set in the state \"{}\": {when}",
            variable.name,
            self.phase.name(self.interface)
        )))
    }

    /// Sets time derivatives of inputs at the present communication point.
    pub(super) fn set_input_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &[f64],
    ) -> Outcome {
        let checked = |(reference, order): (&u32, &i32)| {
            let variable = self.typed(*reference, VariableType::Real)?;
            if variable.causality != Causality::Input {
                return Err(Refusal::error(format_args!(
                    "\"{}\" is not an input; only inputs have derivatives to be set",
                    variable.name
                )));
            }
            order_within(*order, MAX_INPUT_DERIVATIVE_ORDER, &variable.name)
        };
        let orders = references
            .iter()
            .zip(orders)
            .map(checked)
            .collect::<Result<Vec<_>, Refusal>>()?;
        for (reference, value) in references.iter().zip(values) {
            if !value.is_finite() {
                return Err(Refusal::discard(format_args!(
                    "the derivative of \"{}\" cannot be {value}: it must be a finite number",
                    self.variable(*reference)?.name
                )));
            }
        }
        for ((reference, order), value) in references.iter().zip(orders).zip(values) {
            self.model
                .set_input_derivative(*reference, order, *value)
                .map_err(discard)?;
        }
        Ok(())
    }

    /// Reads time derivatives of outputs at the present communication point.
    pub(super) fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut Output<f64>,
    ) -> Outcome {
        for (place, (reference, order)) in references.iter().zip(orders).enumerate() {
            let variable = self.typed(*reference, VariableType::Real)?;
            if variable.causality != Causality::Output {
                return Err(Refusal::error(format_args!(
                    "\"{}\" is not an output",
                    variable.name
                )));
            }
            let order = order_within(*order, MAX_OUTPUT_DERIVATIVE_ORDER, &variable.name)?;
            values.write(
                place,
                self.model
                    .output_derivative(*reference, order)
                    .map_err(discard)?,
            );
        }
        Ok(())
    }

    /// Directional derivative: Jacobian of the unknowns with respect to the knowns, times `seed`.
    pub(super) fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivity: &mut Output<f64>,
    ) -> Outcome {
        for known in knowns {
            let variable = self.typed(*known, VariableType::Real)?;
            if !matches!(variable.causality, Causality::Input | Causality::Parameter) {
                return Err(Refusal::error(format_args!(
                    "\"{}\" cannot be a known of a directional derivative; inputs and parameters can",
                    variable.name
                )));
            }
        }
        for (place, unknown) in unknowns.iter().enumerate() {
            let variable = self.typed(*unknown, VariableType::Real)?;
            if !matches!(variable.causality, Causality::Output | Causality::Local) {
                return Err(Refusal::error(format_args!(
                    "\"{}\" cannot be an unknown of a directional derivative; outputs and locals can",
                    variable.name
                )));
            }
            let mut sum = 0.0;
            for (known, seed) in knowns.iter().zip(seed) {
                sum += seed
                    * self
                        .model
                        .partial_derivative(*unknown, *known)
                        .map_err(discard)?;
            }
            sensitivity.write(place, sum);
        }
        Ok(())
    }

    /// Start time, stop time and tolerance of the run to come.
    pub(super) fn set_up(
        &mut self,
        tolerance: Option<f64>,
        start_time: f64,
        stop_time: Option<f64>,
    ) -> Outcome {
        if !start_time.is_finite() {
            return Err(Refusal::error(format_args!(
                "startTime = {start_time} must be finite"
            )));
        }
        if let Some(stop) = stop_time
            && !(stop.is_finite() && stop > start_time)
        {
            return Err(Refusal::error(format_args!(
                "stopTime = {stop} must be finite and after startTime = {start_time}"
            )));
        }
        if let Some(tolerance) = tolerance
            && !(tolerance > 0.0 && tolerance < 1.0)
        {
            return Err(Refusal::error(format_args!(
                "tolerance = {tolerance} must lie between 0 and 1"
            )));
        }
        self.model.set_up(start_time, tolerance);
        self.time = start_time;
        self.stop_time = stop_time;
        Ok(())
    }

    /// Ends the initialisation.
    pub(super) fn initialise(&mut self) -> Outcome {
        self.model.initialise().map_err(failure)?;
        self.phase = if self.event_mode_used {
            Phase::Event
        } else {
            Phase::Step
        };
        Ok(())
    }

    /// Takes a communication step from `point` of length `size`, both in seconds.
    #[inline]
    pub(super) fn do_step(&mut self, point: f64, size: f64) -> Result<StepEnd, Refusal> {
        self.last_step = Status::Discard;
        let until = point + size;
        if !(size > 0.0 && until.is_finite()) {
            return Err(Refusal::discard(format_args!(
                "communicationStepSize = {size} s from {point} s: the step must be finite and above 0"
            )));
        }
        let distance = (point - self.time).abs();
        if distance.is_nan() || distance > time_tolerance(self.time) {
            return Err(Refusal::discard(format_args!(
                "currentCommunicationPoint = {point} s is not where the last step ended, {} s (within {:.1e} s)",
                self.time,
                time_tolerance(self.time)
            )));
        }
        if let Some(stop) = self.stop_time
            && until > stop + time_tolerance(stop)
        {
            self.last_step = Status::Error;
            return Err(Refusal::error(format_args!(
                "the step to {until} s would pass the stop time {stop} s that was set before the simulation"
            )));
        }
        self.last_step = Status::Error;
        // A tiny step from a point that lies a rounding error behind must not go back.
        let until = until.max(self.time);
        let end = match self.model.step(until, self.early_return_allowed) {
            Ok(end) => end,
            Err(error) => {
                self.time = self.model.time();
                return Err(failure(error));
            }
        };
        self.last_step = Status::Ok;
        self.time = end.time;
        if end.switched {
            let log = &self.log;
            self.model.drain_notices(&mut |notice| log.inform(notice));
        }
        Ok(end)
    }

    /// Back to the phase after instantiation.
    pub(super) fn reset(&mut self) -> Outcome {
        self.model.reset();
        self.phase = Phase::Instantiated;
        self.after_error = false;
        self.time = self.model.identity().default_experiment.start_time;
        self.stop_time = None;
        self.last_step = Status::Ok;
        Ok(())
    }

    /// Follows the importer's choice of log messages.
    pub(super) fn set_debug_logging(&mut self, on: bool, categories: &[&CStr]) -> Outcome {
        let unknown = self.log.configure(on, categories);
        if unknown.is_empty() {
            return Ok(());
        }
        Err(Refusal::warning(format_args!(
            "no such log category: {}; there are: {}",
            unknown.join(", "),
            super::log::category_names()
        )))
    }

    /// Moves on to another phase.
    pub(super) fn enter(&mut self, phase: Phase) -> Outcome {
        self.phase = phase;
        Ok(())
    }
}

fn order_within(order: i32, maximum: u32, name: &str) -> Result<u32, Refusal> {
    u32::try_from(order)
        .ok()
        .filter(|order| (1..=maximum).contains(order))
        .ok_or_else(|| {
            Refusal::error(format_args!(
                "order {order} of the derivative of \"{name}\" must be from 1 to {maximum}"
            ))
        })
}

fn discard(error: ModelError) -> Refusal {
    Refusal::discard(error)
}

fn failure(error: ModelError) -> Refusal {
    Refusal::error(error)
}
