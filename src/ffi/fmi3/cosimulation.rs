//! Functions of FMI 3 for co-simulation, and event mode; the step itself stands in [`do_step`](super::do_step).
#![allow(non_snake_case, reason = "the standard names its functions so")]

use super::types::{Boolean, Float64, ValueReference};
use crate::ffi::guard::exports;
use crate::ffi::pointers::{input, output, place, same_length};
use crate::ffi::status::{Interface, Phase, Phases, Refusal};

const EVENT: Phases = Phases::of(&[Phase::Event]);
const CONTINUOUS_OR_STEP: Phases = Phases::of(&[Phase::Step, Phase::ContinuousTime]);
const STEPPED: Phases = Phases::of(&[Phase::Step, Phase::IntermediateUpdate, Phase::Terminated]);

exports! { Interface::Fmi3;
    fn fmi3EnterEventMode(|instance|) in CONTINUOUS_OR_STEP => {
        if instance.exchange {
            return instance.enter_event_mode();
        }
        if !instance.event_mode_used {
            return Err(Refusal::error("event mode was not asked for: eventModeUsed was false at instantiation"));
        }
        instance.enter(Phase::Event)
    };
    fn fmi3EvaluateDiscreteStates(|_instance|) in EVENT => Ok(());
    fn fmi3UpdateDiscreteStates(|instance| need_update: *mut Boolean, terminate: *mut Boolean, nominals_changed: *mut Boolean, values_changed: *mut Boolean, next_event_time_defined: *mut Boolean, next_event_time: *mut Float64) in EVENT => {
        let mut next_event_time = place(next_event_time, "nextEventTime")?;
        let mut values = place(values_changed, "valuesOfContinuousStatesChanged")?;
        for (flag, argument) in [
            (need_update, "discreteStatesNeedUpdate"),
            (terminate, "terminateSimulation"),
            (nominals_changed, "nominalsOfContinuousStatesChanged"),
            (next_event_time_defined, "nextEventTimeDefined"),
        ] {
            place(flag, argument)?.write(0, 0);
        }
        next_event_time.write(0, 0.0);
        // In co-simulation the switch itself happened inside the step: nothing is left to iterate.
        let changed = instance.exchange && instance.update_discrete_states()?.states_changed;
        values.write(0, changed.into());
        Ok(())
    };
    fn fmi3EnterStepMode(|instance|) in EVENT => {
        if instance.exchange {
            return Err(Refusal::error("step mode is for co-simulation; this instance is for model exchange"));
        }
        instance.enter(Phase::Step)
    };

    fn fmi3GetOutputDerivatives(|instance| references: *const ValueReference, count: usize, orders: *const i32, values: *mut Float64, value_count: usize) in STEPPED => {
        same_length(("nValues", value_count), ("nValueReferences", count))?;
        instance.output_derivatives(input(references, count, "valueReferences")?, input(orders, count, "orders")?, &mut output(values, count, "values")?)
    };
}
