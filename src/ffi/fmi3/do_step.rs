//! The step of FMI 3, and the importer's look at switches inside it.
#![allow(non_snake_case, reason = "the standard names its functions so")]

use super::types::{Boolean, Float64, Handle, IntermediateUpdateCallback, ValueReference};
use crate::cosim::{Causality, StepEnd};
use crate::ffi::Status;
use crate::ffi::guard::call_often;
use crate::ffi::instance::Instance;
use crate::ffi::pointers::{Output, place};
use crate::ffi::status::{Interface, Phase, Phases, Refusal};
use std::ffi::c_void;

const STEP: Phases = Phases::of(&[Phase::Step]);
const INTERMEDIATE: Phases = Phases::of(&[Phase::IntermediateUpdate]);

/// Whom to show the instants of switches.
#[derive(Clone, Copy)]
pub(in crate::ffi) struct IntermediateUpdate {
    pub(super) callback: IntermediateUpdateCallback,
    pub(super) environment: *mut c_void,
}

/// How far a part of a step went, and the switch that the importer may look at there.
type Part = Result<(StepEnd, Option<Stop>), Refusal>;

/// A switch inside a step, which the importer may look at.
struct Stop {
    update: IntermediateUpdate,
    /// When [s].
    time: f64,
    /// Where the step goes on to [s].
    until: f64,
    can_return_early: bool,
}

impl Stop {
    /// Calls the importer; the time \[s\] at which it wants the step to end, if it does.
    ///
    /// # Safety
    /// The callback is as the standard describes it.
    unsafe fn show(&self) -> Option<f64> {
        let (mut requested, mut time) = (Boolean::from(false), self.time);
        let early = Boolean::from(self.can_return_early);
        // SAFETY: the importer's own function with its own environment; places of the answers are ours.
        unsafe {
            (self.update.callback)(
                self.update.environment,
                self.time,
                false.into(),
                true.into(),
                true.into(),
                early,
                &mut requested,
                &mut time,
            );
        }
        (self.can_return_early && requested != 0).then_some(time)
    }
}

impl Instance {
    /// Refuses variables that cannot be read in the middle of a step.
    pub(super) fn require_intermediate(&self, required: &[ValueReference]) -> Result<(), String> {
        for reference in required {
            let variable = self
                .variable(*reference)
                .map_err(|refusal| refusal.message)?;
            if variable.causality != Causality::Output {
                return Err(format!(
                    "requiredIntermediateVariables names \"{}\", which is no output; in intermediate update mode outputs are read, and \
                     nothing is set",
                    variable.name
                ));
            }
        }
        Ok(())
    }

    /// Goes on to `until` \[s\]; a switch before it waits for the importer's look, if it wants one.
    fn go_on(&mut self, until: f64, end: Result<StepEnd, Refusal>) -> Part {
        let end = end?;
        let update = self.intermediate_update.filter(|_| end.time < until);
        if update.is_some() {
            self.phase = Phase::IntermediateUpdate;
        }
        let stop = update.map(|update| Stop {
            update,
            time: end.time,
            until,
            can_return_early: self.early_return_allowed,
        });
        Ok((end, stop))
    }

    /// Goes on after the importer's look at a switch, up to where it `wants` the step to end \[s\] if it does.
    fn resume(&mut self, stop: &Stop, wants: Option<f64>) -> Part {
        self.phase = Phase::Step;
        let until = match wants {
            // The event that asks for the importer's event mode ends the step.
            _ if self.event_mode_used && self.early_return_allowed => stop.time,
            None => stop.until,
            Some(wanted) if wanted >= stop.time => wanted.min(stop.until),
            Some(wanted) => {
                return Err(Refusal::error(format_args!(
                    "earlyReturnTime = {wanted} s must not be before the intermediate update at {} s",
                    stop.time
                )));
            }
        };
        let end = self.advance(until);
        self.go_on(until, end)
    }
}

/// Where the importer wants the results of a step.
struct Results {
    event_handling_needed: Output<Boolean>,
    terminate_simulation: Output<Boolean>,
    early_return: Output<Boolean>,
    last_successful_time: Output<Float64>,
}

impl Results {
    fn write(&mut self, event: bool, early: bool, time: f64) {
        self.event_handling_needed.write(0, event.into());
        self.terminate_simulation.write(0, false.into());
        self.early_return.write(0, early.into());
        self.last_successful_time.write(0, time);
    }
}

/// `fmi3DoStep` of the standard.
///
/// While the importer looks at a switch, the instance is free for its calls.
///
/// # Safety
/// Pointers are NULL or as the standard describes them.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments, reason = "the standard has as many")]
pub unsafe extern "C" fn fmi3DoStep(
    instance: Handle,
    point: Float64,
    size: Float64,
    _no_set_state_before_point: Boolean,
    event_handling_needed: *mut Boolean,
    terminate_simulation: *mut Boolean,
    early_return: *mut Boolean,
    last_successful_time: *mut Float64,
) -> Status {
    let results = || {
        // SAFETY: the caller's promise about the pointers.
        unsafe {
            Ok(Results {
                event_handling_needed: place(event_handling_needed, "eventHandlingNeeded")?,
                terminate_simulation: place(terminate_simulation, "terminateSimulation")?,
                early_return: place(early_return, "earlyReturn")?,
                last_successful_time: place(last_successful_time, "lastSuccessfulTime")?,
            })
        }
    };
    let mut switched = false;
    let mut part = |allowed, go: &dyn Fn(&mut Instance) -> Part| {
        let mut stop = None;
        let status = call_often(
            Interface::Fmi3,
            instance,
            "fmi3DoStep",
            allowed,
            |instance| {
                let mut results: Results = results()?;
                let end = go(instance);
                let reached = end.as_ref().ok().map(|(end, _)| *end);
                switched |= reached.is_some_and(|end| end.switched);
                let early = reached.is_some_and(|end| end.time < point + size);
                let event = reached.is_some() && switched && instance.event_mode_used;
                results.write(event, early, instance.time);
                stop = end?.1;
                Ok(())
            },
        );
        (status, stop)
    };
    let (mut status, mut stop) = part(STEP, &|instance| {
        let end = instance.do_step(point, size);
        instance.go_on(point + size, end)
    });
    while let Some(switch) = stop {
        // SAFETY: the caller's promise about the callback, which it passed at instantiation.
        let wants = unsafe { switch.show() };
        (status, stop) = part(INTERMEDIATE, &|instance| instance.resume(&switch, wants));
    }
    status
}
