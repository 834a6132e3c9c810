//! Functions of FMI 2 for co-simulation.
#![allow(non_snake_case, reason = "the standard names its functions so")]

use super::types::{
    Boolean, DO_STEP_STATUS, Integer, LAST_SUCCESSFUL_TIME, PENDING_STATUS, Real, StatusKind,
    TERMINATED, Text, ValueReference,
};
use crate::ffi::guard::{exports, unsupported};
use crate::ffi::pointers::{input, output, place};
use crate::ffi::status::{Interface, Outcome, Phase, Phases, Refusal, Status};

const SETTABLE: Phases = Phases::of(&[Phase::Instantiated, Phase::Initialization, Phase::Step]);
const STEP: Phases = Phases::of(&[Phase::Step]);
const STEPPED: Phases = Phases::of(&[Phase::Step, Phase::Terminated, Phase::Failed]);

/// The standard wants a discard for status information that a component does not have.
fn no_status(kind: StatusKind, what: &str) -> Outcome {
    Err(Refusal::discard(match kind {
        PENDING_STATUS => "every step is synchronous: there is no pending status".to_owned(),
        DO_STEP_STATUS | LAST_SUCCESSFUL_TIME | TERMINATED => {
            format!("status kind {kind} is not {what}")
        }
        _ => format!("there is no status kind {kind}; the standard has 0 to 3"),
    }))
}

unsupported! { Interface::Fmi2;
    fn fmi2CancelStep() because "canRunAsynchronuously is false: a step is over when fmi2DoStep returns, and there is none to cancel";
}

exports! { Interface::Fmi2;
    fn fmi2SetRealInputDerivatives(|instance| references: *const ValueReference, count: usize, orders: *const Integer, values: *const Real) in SETTABLE =>
        instance.set_input_derivatives(input(references, count, "vr")?, input(orders, count, "order")?, input(values, count, "value")?);
    fn fmi2GetRealOutputDerivatives(|instance| references: *const ValueReference, count: usize, orders: *const Integer, values: *mut Real) in STEPPED =>
        instance.output_derivatives(input(references, count, "vr")?, input(orders, count, "order")?, &mut output(values, count, "value")?);

    #[often]
    fn fmi2DoStep(|instance| point: Real, size: Real, _no_set_state_before_point: Boolean) in STEP =>
        instance.do_step(point, size).map(|_| ());

    fn fmi2GetStatus(|instance| kind: StatusKind, value: *mut Status) in STEPPED => {
        let mut value = place(value, "value")?;
        if kind != DO_STEP_STATUS {
            return no_status(kind, "a status");
        }
        value.write(0, instance.last_step);
        Ok(())
    };
    fn fmi2GetRealStatus(|instance| kind: StatusKind, value: *mut Real) in STEPPED => {
        let mut value = place(value, "value")?;
        if kind != LAST_SUCCESSFUL_TIME {
            return no_status(kind, "a real");
        }
        value.write(0, instance.time);
        Ok(())
    };
    fn fmi2GetBooleanStatus(|_instance| kind: StatusKind, value: *mut Boolean) in STEPPED => {
        let mut value = place(value, "value")?;
        if kind != TERMINATED {
            return no_status(kind, "a Boolean");
        }
        value.write(0, 0);
        Ok(())
    };
    fn fmi2GetIntegerStatus(|_instance| kind: StatusKind, _value: *mut Integer) in STEPPED => no_status(kind, "an integer");
    fn fmi2GetStringStatus(|_instance| kind: StatusKind, _value: *mut Text) in STEPPED => no_status(kind, "a string");
}
