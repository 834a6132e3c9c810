//! An instance: a model with its phase, its log and its place in time, the same for both standards.

use super::fmi3::IntermediateUpdate;
use super::handles::Registry;
use super::log::Log;
use super::status::{Interface, Outcome, Phase, Phases, Refusal, Status};
use crate::cosim::{CoSimulationModel, ModelError, StepEnd};
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
    /// Whether the importer brings the solver.
    pub(super) exchange: bool,
    /// FMI 3: whether the importer handles events.
    pub(super) event_mode_used: bool,
    /// FMI 3: whether a step may end before its end.
    pub(super) early_return_allowed: bool,
    /// FMI 3: whom to show the instants of switches inside a step.
    pub(super) intermediate_update: Option<IntermediateUpdate>,
    /// Status of the last step.
    pub(super) last_step: Status,
    /// Handles of the states saved through this instance; they end with it.
    pub(super) saved_states: Vec<*mut c_void>,
}

// SAFETY: the pointers are handles of the registry of saved states, which are numbers, and the importer's environment, which is
// only handed back.
unsafe impl Send for Instance {}

impl Instance {
    pub(super) fn new(mut model: Box<dyn CoSimulationModel>, log: Log) -> Self {
        let exchange = model.exchange().is_some();
        let time = model.identity().default_experiment.start_time;
        Self {
            model,
            interface: log.interface(),
            log,
            phase: Phase::Instantiated,
            after_error: false,
            time,
            stop_time: None,
            exchange,
            event_mode_used: false,
            early_return_allowed: false,
            intermediate_update: None,
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
        let phases = allowed.names(self.interface, self.exchange);
        if phases.is_empty() {
            let (other, this) = match self.exchange {
                true => ("co-simulation", "model exchange"),
                false => ("model exchange", "co-simulation"),
            };
            return Refusal::error(format_args!(
                "is for {other}; this instance was made for {this}"
            ));
        }
        Refusal::error(format_args!(
            "must not be called in the state \"{}\"{error}; it is allowed in: {phases}",
            self.phase.name(self.interface),
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
        self.phase = if self.event_mode_used || self.exchange {
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
        let distance = (point - self.time).abs();
        if distance.is_nan() || distance > time_tolerance(self.time) {
            return Err(Refusal::discard(format_args!(
                "currentCommunicationPoint = {point} s is not where the last step ended, {} s (within {:.1e} s)",
                self.time,
                time_tolerance(self.time)
            )));
        }
        let until = point + size;
        if !(size > 0.0 && until.is_finite()) {
            return Err(Refusal::discard(format_args!(
                "communicationStepSize = {size} s from {point} s: the step must be finite and above 0"
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
        // A tiny step from a point that lies a rounding error behind must not go back.
        self.advance(until.max(self.time))
    }

    /// Goes on to `until` \[s\], or to the first switch where somebody wants to know of it.
    #[inline]
    pub(super) fn advance(&mut self, until: f64) -> Result<StepEnd, Refusal> {
        self.last_step = Status::Error;
        let stop_at_switch = self.early_return_allowed || self.intermediate_update.is_some();
        let end = match self.model.step(until, stop_at_switch) {
            Ok(end) => end,
            Err(error) => {
                self.time = self.model.time();
                return Err(failure(error));
            }
        };
        self.last_step = Status::Ok;
        self.time = end.time;
        if end.switched {
            self.tell_notices();
        }
        Ok(end)
    }

    /// Writes what the model has to tell into the log.
    pub(super) fn tell_notices(&mut self) {
        let log = &self.log;
        self.model.drain_notices(&mut |notice| log.inform(&notice));
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

fn failure(error: ModelError) -> Refusal {
    Refusal::error(error)
}
