//! Functions of FMI 3 for model exchange; those of event mode stand with [`cosimulation`](super::cosimulation).
#![allow(non_snake_case, reason = "the standard names its functions so")]

use super::types::{Boolean, Float64};
use crate::ffi::exchange::Vector;
use crate::ffi::guard::exports;
use crate::ffi::pointers::{input, output, place};
use crate::ffi::status::{ANY, Interface, Phase, Phases};

const EVENT: Phases = Phases::of(&[Phase::Event]);
const CONTINUOUS: Phases = Phases::of(&[Phase::ContinuousTime]);
const RUNNING: Phases = Phases::of(&[Phase::Event, Phase::ContinuousTime]);
const EVALUABLE: Phases = Phases::of(&[
    Phase::Initialization,
    Phase::Event,
    Phase::ContinuousTime,
    Phase::Terminated,
]);

exports! { Interface::Fmi3;
    fn fmi3EnterContinuousTimeMode(|instance|) in EVENT => {
        instance.solver()?.enter_continuous_time_mode();
        instance.enter(Phase::ContinuousTime)
    };
    fn fmi3CompletedIntegratorStep(|instance| _no_set_state_before_point: Boolean, enter_event_mode: *mut Boolean, terminate: *mut Boolean) in CONTINUOUS => {
        let mut enter_event_mode = place(enter_event_mode, "enterEventMode")?;
        place(terminate, "terminateSimulation")?.write(0, 0);
        enter_event_mode.write(0, instance.complete_step()?.into());
        Ok(())
    };
    fn fmi3SetTime(|instance| time: Float64) in RUNNING => instance.set_time(time);
    fn fmi3SetContinuousStates(|instance| states: *const Float64, count: usize) in CONTINUOUS =>
        instance.set_continuous_states(input(states, count, "continuousStates")?);
    fn fmi3GetContinuousStateDerivatives(|instance| values: *mut Float64, count: usize) in EVALUABLE =>
        instance.vector(Vector::Derivatives, count, &mut output(values, count, "derivatives")?);
    fn fmi3GetEventIndicators(|instance| values: *mut Float64, count: usize) in EVALUABLE =>
        instance.vector(Vector::Indicators, count, &mut output(values, count, "eventIndicators")?);
    fn fmi3GetContinuousStates(|instance| values: *mut Float64, count: usize) in EVALUABLE =>
        instance.vector(Vector::States, count, &mut output(values, count, "continuousStates")?);
    fn fmi3GetNominalsOfContinuousStates(|instance| values: *mut Float64, count: usize) in EVALUABLE =>
        instance.vector(Vector::Nominals, count, &mut output(values, count, "nominals")?);
    fn fmi3GetNumberOfEventIndicators(|instance| count: *mut usize) in ANY => {
        place(count, "nEventIndicators")?.write(0, instance.solver()?.indicator_count());
        Ok(())
    };
    fn fmi3GetNumberOfContinuousStates(|instance| count: *mut usize) in ANY => {
        place(count, "nContinuousStates")?.write(0, instance.solver()?.state_count());
        Ok(())
    };
}
