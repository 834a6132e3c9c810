//! Functions of FMI 2 for model exchange.
#![allow(non_snake_case, reason = "the standard names its functions so")]

use super::types::{Boolean, EventInfo, Real};
use crate::ffi::exchange::Vector;
use crate::ffi::guard::exports;
use crate::ffi::pointers::{input, output, place};
use crate::ffi::status::{Interface, Phase, Phases};

const EVENT: Phases = Phases::of(&[Phase::Event]);
const CONTINUOUS: Phases = Phases::of(&[Phase::ContinuousTime]);
const RUNNING: Phases = Phases::of(&[Phase::Event, Phase::ContinuousTime]);
const EVALUABLE: Phases = Phases::of(&[
    Phase::Initialization,
    Phase::Event,
    Phase::ContinuousTime,
    Phase::Terminated,
    Phase::Failed,
]);
const KNOWN: Phases = Phases::of(&[
    Phase::Instantiated,
    Phase::Initialization,
    Phase::Event,
    Phase::ContinuousTime,
    Phase::Terminated,
    Phase::Failed,
]);

exports! { Interface::Fmi2;
    fn fmi2EnterEventMode(|instance|) in CONTINUOUS => instance.enter_event_mode();
    fn fmi2NewDiscreteStates(|instance| info: *mut EventInfo) in EVENT => {
        let mut info = place(info, "fmi2eventInfo")?;
        let outcome = instance.update_discrete_states()?;
        info.write(0, EventInfo {
            new_discrete_states_needed: 0,
            terminate_simulation: 0,
            nominals_of_continuous_states_changed: 0,
            values_of_continuous_states_changed: outcome.states_changed.into(),
            next_event_time_defined: 0,
            next_event_time: 0.0,
        });
        Ok(())
    };
    fn fmi2EnterContinuousTimeMode(|instance|) in EVENT => {
        instance.solver()?.enter_continuous_time_mode();
        instance.enter(Phase::ContinuousTime)
    };
    fn fmi2CompletedIntegratorStep(|instance| _no_set_state_before_point: Boolean, enter_event_mode: *mut Boolean, terminate: *mut Boolean) in CONTINUOUS => {
        let mut enter_event_mode = place(enter_event_mode, "enterEventMode")?;
        place(terminate, "terminateSimulation")?.write(0, 0);
        enter_event_mode.write(0, instance.complete_step()?.into());
        Ok(())
    };
    fn fmi2SetTime(|instance| time: Real) in RUNNING => instance.set_time(time);
    fn fmi2SetContinuousStates(|instance| states: *const Real, count: usize) in CONTINUOUS =>
        instance.set_continuous_states(input(states, count, "x")?);
    fn fmi2GetDerivatives(|instance| values: *mut Real, count: usize) in EVALUABLE =>
        instance.vector(Vector::Derivatives, count, &mut output(values, count, "derivatives")?);
    fn fmi2GetEventIndicators(|instance| values: *mut Real, count: usize) in EVALUABLE =>
        instance.vector(Vector::Indicators, count, &mut output(values, count, "eventIndicators")?);
    fn fmi2GetContinuousStates(|instance| values: *mut Real, count: usize) in EVALUABLE =>
        instance.vector(Vector::States, count, &mut output(values, count, "x")?);
    fn fmi2GetNominalsOfContinuousStates(|instance| values: *mut Real, count: usize) in KNOWN =>
        instance.vector(Vector::Nominals, count, &mut output(values, count, "x_nominal")?);
}
