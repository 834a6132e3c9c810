//! NULL where the standards want a pointer: an error, one line that names function and argument, and a reset recovers.
//! NULL with a length of zero is an empty list, and nothing wrong.

use crate::importer::{Component, Fmi2, Fmi3, Instance, REDUCED_RIG, Version};
use std::ffi::c_void;
use std::ptr::{null, null_mut};
use stickslip::ffi::Status::{self, Error, Ok};
use stickslip::ffi::fmi2::*;
use stickslip::ffi::fmi3::*;

const CASE: [(&str, f64); 2] = [("u", 3.1), ("N2", 50.0)];

/// Value reference of the input `u`, and one value for it.
const U: u32 = 1;
/// Value reference of the output `theta`.
const THETA: u32 = 3;
/// Value reference of the Boolean `stuck`.
const STUCK: u32 = 9;

/// A call with one NULL on an instance and one of its saved states.
type Call = unsafe fn(*mut c_void, *mut c_void) -> Status;

/// Function, argument that is NULL, call.
type Row = (&'static str, &'static str, Call);

#[rustfmt::skip]
const FMI2: &[Row] = &[
    ("fmi2SetDebugLogging", "categories", |c, _| unsafe { fmi2SetDebugLogging(c, 1, 1, null()) }),
    ("fmi2SetDebugLogging", "categories", |c, _| unsafe { fmi2SetDebugLogging(c, 1, 1, &null()) }),
    ("fmi2GetReal", "vr", |c, _| unsafe { fmi2GetReal(c, null(), 1, &mut 0.0) }),
    ("fmi2GetReal", "value", |c, _| unsafe { fmi2GetReal(c, &U, 1, null_mut()) }),
    ("fmi2GetBoolean", "vr", |c, _| unsafe { fmi2GetBoolean(c, null(), 1, &mut 0) }),
    ("fmi2GetBoolean", "value", |c, _| unsafe { fmi2GetBoolean(c, &STUCK, 1, null_mut()) }),
    ("fmi2GetInteger", "vr", |c, _| unsafe { fmi2GetInteger(c, null(), 1, &mut 0) }),
    ("fmi2GetString", "vr", |c, _| unsafe { fmi2GetString(c, null(), 1, &mut null()) }),
    ("fmi2SetReal", "vr", |c, _| unsafe { fmi2SetReal(c, null(), 1, &1.0) }),
    ("fmi2SetReal", "value", |c, _| unsafe { fmi2SetReal(c, &U, 1, null()) }),
    ("fmi2SetBoolean", "vr", |c, _| unsafe { fmi2SetBoolean(c, null(), 1, &1) }),
    ("fmi2SetInteger", "vr", |c, _| unsafe { fmi2SetInteger(c, null(), 1, &1) }),
    ("fmi2SetString", "vr", |c, _| unsafe { fmi2SetString(c, null(), 1, &null()) }),
    ("fmi2SetRealInputDerivatives", "vr", |c, _| unsafe { fmi2SetRealInputDerivatives(c, null(), 1, &1, &1.0) }),
    ("fmi2SetRealInputDerivatives", "order", |c, _| unsafe { fmi2SetRealInputDerivatives(c, &U, 1, null(), &1.0) }),
    ("fmi2SetRealInputDerivatives", "value", |c, _| unsafe { fmi2SetRealInputDerivatives(c, &U, 1, &1, null()) }),
    ("fmi2GetRealOutputDerivatives", "vr", |c, _| unsafe { fmi2GetRealOutputDerivatives(c, null(), 1, &1, &mut 0.0) }),
    ("fmi2GetRealOutputDerivatives", "order", |c, _| unsafe { fmi2GetRealOutputDerivatives(c, &THETA, 1, null(), &mut 0.0) }),
    ("fmi2GetRealOutputDerivatives", "value", |c, _| unsafe { fmi2GetRealOutputDerivatives(c, &THETA, 1, &1, null_mut()) }),
    ("fmi2GetDirectionalDerivative", "vUnknown_ref", |c, _| unsafe { fmi2GetDirectionalDerivative(c, null(), 1, &U, 1, &1.0, &mut 0.0) }),
    ("fmi2GetDirectionalDerivative", "vKnown_ref", |c, _| unsafe { fmi2GetDirectionalDerivative(c, &THETA, 1, null(), 1, &1.0, &mut 0.0) }),
    ("fmi2GetDirectionalDerivative", "dvKnown", |c, _| unsafe { fmi2GetDirectionalDerivative(c, &THETA, 1, &U, 1, null(), &mut 0.0) }),
    ("fmi2GetDirectionalDerivative", "dvUnknown", |c, _| unsafe { fmi2GetDirectionalDerivative(c, &THETA, 1, &U, 1, &1.0, null_mut()) }),
    ("fmi2GetFMUstate", "FMUstate", |c, _| unsafe { fmi2GetFMUstate(c, null_mut()) }),
    ("fmi2SetFMUstate", "FMUstate", |c, _| unsafe { fmi2SetFMUstate(c, null_mut()) }),
    ("fmi2SerializedFMUstateSize", "FMUstate", |c, _| unsafe { fmi2SerializedFMUstateSize(c, null_mut(), &mut 0) }),
    ("fmi2SerializedFMUstateSize", "size", |c, state| unsafe { fmi2SerializedFMUstateSize(c, state, null_mut()) }),
    ("fmi2SerializeFMUstate", "FMUstate", |c, _| unsafe { fmi2SerializeFMUstate(c, null_mut(), [0; 8].as_mut_ptr(), 8) }),
    ("fmi2SerializeFMUstate", "serializedState", |c, state| unsafe { fmi2SerializeFMUstate(c, state, null_mut(), 1 << 20) }),
    ("fmi2DeSerializeFMUstate", "serializedState", |c, _| unsafe { fmi2DeSerializeFMUstate(c, null(), 8, &mut null_mut()) }),
    ("fmi2DeSerializeFMUstate", "FMUstate", |c, _| unsafe { fmi2DeSerializeFMUstate(c, [0; 8].as_ptr(), 8, null_mut()) }),
    ("fmi2GetStatus", "value", |c, _| unsafe { fmi2GetStatus(c, DO_STEP_STATUS, null_mut()) }),
    ("fmi2GetRealStatus", "value", |c, _| unsafe { fmi2GetRealStatus(c, LAST_SUCCESSFUL_TIME, null_mut()) }),
    ("fmi2GetBooleanStatus", "value", |c, _| unsafe { fmi2GetBooleanStatus(c, TERMINATED, null_mut()) }),
];

#[rustfmt::skip]
const FMI3: &[Row] = &[
    ("fmi3SetDebugLogging", "categories", |c, _| unsafe { fmi3SetDebugLogging(c, 1, 1, null()) }),
    ("fmi3SetDebugLogging", "categories", |c, _| unsafe { fmi3SetDebugLogging(c, 1, 1, &null()) }),
    ("fmi3GetFloat64", "valueReferences", |c, _| unsafe { fmi3GetFloat64(c, null(), 1, &mut 0.0, 1) }),
    ("fmi3GetFloat64", "values", |c, _| unsafe { fmi3GetFloat64(c, &U, 1, null_mut(), 1) }),
    ("fmi3SetFloat64", "valueReferences", |c, _| unsafe { fmi3SetFloat64(c, null(), 1, &1.0, 1) }),
    ("fmi3SetFloat64", "values", |c, _| unsafe { fmi3SetFloat64(c, &U, 1, null(), 1) }),
    ("fmi3GetBoolean", "valueReferences", |c, _| unsafe { fmi3GetBoolean(c, null(), 1, &mut 0, 1) }),
    ("fmi3GetBoolean", "values", |c, _| unsafe { fmi3GetBoolean(c, &STUCK, 1, null_mut(), 1) }),
    ("fmi3SetBoolean", "valueReferences", |c, _| unsafe { fmi3SetBoolean(c, null(), 1, &1, 1) }),
    ("fmi3GetFloat32", "valueReferences", |c, _| unsafe { fmi3GetFloat32(c, null(), 1, &mut 0.0, 1) }),
    ("fmi3GetInt8", "valueReferences", |c, _| unsafe { fmi3GetInt8(c, null(), 1, &mut 0, 1) }),
    ("fmi3GetUInt8", "valueReferences", |c, _| unsafe { fmi3GetUInt8(c, null(), 1, &mut 0, 1) }),
    ("fmi3GetInt16", "valueReferences", |c, _| unsafe { fmi3GetInt16(c, null(), 1, &mut 0, 1) }),
    ("fmi3GetUInt16", "valueReferences", |c, _| unsafe { fmi3GetUInt16(c, null(), 1, &mut 0, 1) }),
    ("fmi3GetInt32", "valueReferences", |c, _| unsafe { fmi3GetInt32(c, null(), 1, &mut 0, 1) }),
    ("fmi3GetUInt32", "valueReferences", |c, _| unsafe { fmi3GetUInt32(c, null(), 1, &mut 0, 1) }),
    ("fmi3GetInt64", "valueReferences", |c, _| unsafe { fmi3GetInt64(c, null(), 1, &mut 0, 1) }),
    ("fmi3GetUInt64", "valueReferences", |c, _| unsafe { fmi3GetUInt64(c, null(), 1, &mut 0, 1) }),
    ("fmi3GetString", "valueReferences", |c, _| unsafe { fmi3GetString(c, null(), 1, &mut null(), 1) }),
    ("fmi3GetBinary", "valueReferences", |c, _| unsafe { fmi3GetBinary(c, null(), 1, &mut 0, &mut null(), 1) }),
    ("fmi3GetClock", "valueReferences", |c, _| unsafe { fmi3GetClock(c, null(), 1, &mut 0) }),
    ("fmi3GetOutputDerivatives", "valueReferences", |c, _| unsafe { fmi3GetOutputDerivatives(c, null(), 1, &1, &mut 0.0, 1) }),
    ("fmi3GetOutputDerivatives", "orders", |c, _| unsafe { fmi3GetOutputDerivatives(c, &THETA, 1, null(), &mut 0.0, 1) }),
    ("fmi3GetOutputDerivatives", "values", |c, _| unsafe { fmi3GetOutputDerivatives(c, &THETA, 1, &1, null_mut(), 1) }),
    ("fmi3GetDirectionalDerivative", "unknowns", |c, _| unsafe { fmi3GetDirectionalDerivative(c, null(), 1, &U, 1, &1.0, 1, &mut 0.0, 1) }),
    ("fmi3GetDirectionalDerivative", "knowns", |c, _| unsafe { fmi3GetDirectionalDerivative(c, &THETA, 1, null(), 1, &1.0, 1, &mut 0.0, 1) }),
    ("fmi3GetDirectionalDerivative", "seed", |c, _| unsafe { fmi3GetDirectionalDerivative(c, &THETA, 1, &U, 1, null(), 1, &mut 0.0, 1) }),
    ("fmi3GetDirectionalDerivative", "sensitivity", |c, _| unsafe { fmi3GetDirectionalDerivative(c, &THETA, 1, &U, 1, &1.0, 1, null_mut(), 1) }),
    ("fmi3GetFMUState", "FMUState", |c, _| unsafe { fmi3GetFMUState(c, null_mut()) }),
    ("fmi3SetFMUState", "FMUState", |c, _| unsafe { fmi3SetFMUState(c, null_mut()) }),
    ("fmi3SerializedFMUStateSize", "FMUState", |c, _| unsafe { fmi3SerializedFMUStateSize(c, null_mut(), &mut 0) }),
    ("fmi3SerializedFMUStateSize", "size", |c, state| unsafe { fmi3SerializedFMUStateSize(c, state, null_mut()) }),
    ("fmi3SerializeFMUState", "FMUState", |c, _| unsafe { fmi3SerializeFMUState(c, null_mut(), [0; 8].as_mut_ptr(), 8) }),
    ("fmi3SerializeFMUState", "serializedState", |c, state| unsafe { fmi3SerializeFMUState(c, state, null_mut(), 1 << 20) }),
    ("fmi3DeserializeFMUState", "serializedState", |c, _| unsafe { fmi3DeserializeFMUState(c, null(), 8, &mut null_mut()) }),
    ("fmi3DeserializeFMUState", "FMUState", |c, _| unsafe { fmi3DeserializeFMUState(c, [0; 8].as_ptr(), 8, null_mut()) }),
    ("fmi3DoStep", "eventHandlingNeeded", |c, _| unsafe { fmi3DoStep(c, 0.1, 0.1, 1, null_mut(), &mut 0, &mut 0, &mut 0.0) }),
    ("fmi3DoStep", "terminateSimulation", |c, _| unsafe { fmi3DoStep(c, 0.1, 0.1, 1, &mut 0, null_mut(), &mut 0, &mut 0.0) }),
    ("fmi3DoStep", "earlyReturn", |c, _| unsafe { fmi3DoStep(c, 0.1, 0.1, 1, &mut 0, &mut 0, null_mut(), &mut 0.0) }),
    ("fmi3DoStep", "lastSuccessfulTime", |c, _| unsafe { fmi3DoStep(c, 0.1, 0.1, 1, &mut 0, &mut 0, &mut 0, null_mut()) }),
];

/// In event mode.
#[rustfmt::skip]
const FMI3_EVENTS: &[Row] = &[
    ("fmi3UpdateDiscreteStates", "discreteStatesNeedUpdate", |c, _| unsafe { fmi3UpdateDiscreteStates(c, null_mut(), &mut 0, &mut 0, &mut 0, &mut 0, &mut 0.0) }),
    ("fmi3UpdateDiscreteStates", "terminateSimulation", |c, _| unsafe { fmi3UpdateDiscreteStates(c, &mut 0, null_mut(), &mut 0, &mut 0, &mut 0, &mut 0.0) }),
    ("fmi3UpdateDiscreteStates", "nominalsOfContinuousStatesChanged", |c, _| unsafe { fmi3UpdateDiscreteStates(c, &mut 0, &mut 0, null_mut(), &mut 0, &mut 0, &mut 0.0) }),
    ("fmi3UpdateDiscreteStates", "valuesOfContinuousStatesChanged", |c, _| unsafe { fmi3UpdateDiscreteStates(c, &mut 0, &mut 0, &mut 0, null_mut(), &mut 0, &mut 0.0) }),
    ("fmi3UpdateDiscreteStates", "nextEventTimeDefined", |c, _| unsafe { fmi3UpdateDiscreteStates(c, &mut 0, &mut 0, &mut 0, &mut 0, null_mut(), &mut 0.0) }),
    ("fmi3UpdateDiscreteStates", "nextEventTime", |c, _| unsafe { fmi3UpdateDiscreteStates(c, &mut 0, &mut 0, &mut 0, &mut 0, &mut 0, null_mut()) }),
];

/// Every row on an instance of its own that `start` makes.
fn refused<'a>(rows: &[Row], start: impl Fn() -> Instance<'a>) {
    for (function, argument, call) in rows {
        let mut instance = start();
        let state = instance.save();
        instance.log.take();
        // SAFETY: the other pointers are valid, and NULL is what is tested.
        let status = unsafe { call(instance.handle, state) };
        assert_eq!(status, Error, "{function} {argument}");
        let line = instance.log.only(function);
        for part in [function, argument, &"NULL"] {
            assert!(line.text.contains(part), "{part} is not in {:?}", line.text);
        }
        assert_eq!(instance.step_from(instance.time, 0.1).status, Error);
        instance.reset();
        instance.initialize(0.0, &CASE);
        if instance.event_mode {
            assert_eq!(instance.enter_step_mode(), Ok);
        }
        instance.step(0.1);
    }
}

#[test]
fn null_is_an_error_that_names_the_argument() {
    let component = Component::new(REDUCED_RIG);
    for (name, reference) in [("u", U), ("theta", THETA), ("stuck", STUCK)] {
        assert_eq!(
            component.table.find(name).unwrap().value_reference,
            reference
        );
    }
    let start = |version: Version| {
        let mut instance = component.start(version, &CASE);
        instance.step(0.1);
        instance
    };
    refused(FMI2, || start(Fmi2));
    refused(FMI3, || start(Fmi3));
    refused(FMI3_EVENTS, || {
        let mut instance = component.instantiate_with(Fmi3, true, true);
        instance.initialize(0.0, &CASE);
        instance
    });
}

#[test]
fn null_with_nothing_to_pass_is_fine() {
    let component = Component::new(REDUCED_RIG);
    let two = component.start(Fmi2, &CASE);
    let three = component.start(Fmi3, &CASE);
    // SAFETY: lengths of zero.
    unsafe {
        let (c, d) = (two.handle, three.handle);
        assert_eq!(fmi2GetReal(c, null(), 0, null_mut()), Ok);
        assert_eq!(fmi2SetReal(c, null(), 0, null()), Ok);
        assert_eq!(fmi2SetInteger(c, null(), 0, null()), Ok);
        assert_eq!(
            fmi2SetRealInputDerivatives(c, null(), 0, null(), null()),
            Ok
        );
        assert_eq!(fmi2SetDebugLogging(c, 1, 0, null()), Ok);
        assert_eq!(fmi2FreeFMUstate(c, null_mut()), Ok);
        assert_eq!(fmi2FreeFMUstate(c, &mut null_mut()), Ok);
        assert_eq!(fmi3GetFloat64(d, null(), 0, null_mut(), 0), Ok);
        assert_eq!(fmi3SetFloat64(d, null(), 0, null(), 0), Ok);
        assert_eq!(fmi3GetBinary(d, null(), 0, null_mut(), null_mut(), 0), Ok);
        assert_eq!(fmi3SetDebugLogging(d, 1, 0, null()), Ok);
        assert_eq!(fmi3FreeFMUState(d, null_mut()), Ok);
        assert_eq!(fmi3FreeFMUState(d, &mut null_mut()), Ok);
    }
}
