//! Every function in every state of an instance, against the standards' tables of allowed calls (FMI 2.0.5, section
//! 4.2.4; FMI 3.0.2, sections 2.3 and 4.2): done where the standard allows it, else an error and one line that names
//! function, state and where it is allowed.

use crate::importer::{Component, Fmi2, Fmi3, Instance, REDUCED_RIG, Version};
use std::ffi::c_void;
use std::ptr::{null, null_mut};
use stickslip::ffi::Status::{self, Error, Ok};
use stickslip::ffi::fmi2::*;
use stickslip::ffi::fmi3::*;

/// States by the standards' names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Instantiated,
    Configuration,
    Initialization,
    Event,
    Step,
    /// Model exchange only.
    Continuous,
    /// Inside a callback of a step of FMI 3 only.
    Intermediate,
    Terminated,
    /// FMI 2 only; in FMI 3 an error terminates.
    Failed,
}
use State::{
    Configuration, Continuous, Event, Failed, Initialization, Instantiated, Intermediate, Step,
    Terminated,
};

const STATES_2: [State; 5] = [Instantiated, Initialization, Step, Terminated, Failed];
const STATES_3: [State; 6] = [
    Instantiated,
    Configuration,
    Initialization,
    Event,
    Step,
    Terminated,
];

const EXCHANGE_2: [State; 6] = [
    Instantiated,
    Initialization,
    Event,
    Continuous,
    Terminated,
    Failed,
];
const EXCHANGE_3: [State; 6] = [
    Instantiated,
    Configuration,
    Initialization,
    Event,
    Continuous,
    Terminated,
];

impl State {
    fn name(self, version: Version) -> &'static str {
        match (self, version) {
            (Instantiated, Fmi2) => "instantiated",
            (Step, Fmi2) => "stepComplete",
            (Terminated, Fmi2) => "terminated",
            (Failed, _) => "error",
            (Instantiated, Fmi3) => "Instantiated",
            (Configuration, _) => "Configuration Mode",
            (Initialization, _) => "Initialization Mode",
            (Event, _) => "Event Mode",
            (Step, Fmi3) => "Step Mode",
            (Continuous, _) => "Continuous-Time Mode",
            (Intermediate, _) => "Intermediate Update Mode",
            (Terminated, Fmi3) => "Terminated",
        }
    }
}

/// An instance that legal calls took to a state.
fn in_state(component: &Component, version: Version, exchange: bool, state: State) -> Instance<'_> {
    let instance = if exchange {
        component.instantiate_for_exchange(version)
    } else {
        component.instantiate_with(version, true, true)
    };
    let path: &[State] = match state {
        Instantiated => &[],
        Configuration => &[Configuration],
        Initialization => &[Initialization],
        Event => &[Initialization, Event],
        Continuous => &[Initialization, Event, Continuous],
        Failed if exchange => &[Initialization, Event, Continuous],
        Terminated if exchange => &[Initialization, Event, Continuous, Terminated],
        Step | Intermediate | Failed => &[Initialization, Event, Step],
        Terminated => &[Initialization, Event, Step, Terminated],
    };
    for next in path {
        let status = match next {
            // SAFETY: no pointers but the handle.
            Configuration => unsafe { fmi3EnterConfigurationMode(instance.handle) },
            Initialization => instance.enter_initialization(None, 0.0, None),
            Event => instance.exit_initialization(),
            Step if version == Fmi3 => instance.enter_step_mode(),
            Step => Ok,
            Continuous => instance.enter_continuous_time(),
            Terminated => instance.terminate(),
            Instantiated | Intermediate | Failed => Ok,
        };
        assert_eq!(status, Ok);
    }
    if state == Failed {
        assert_eq!(instance.get_reference(u32::MAX), Err(Error));
    }
    instance.log.take();
    instance
}

/// Name, states in which the standard allows it, a call with sound arguments on an instance and one of its states.
type Row = (
    &'static str,
    &'static [State],
    unsafe fn(*mut c_void, *mut c_void) -> Status,
);

const ALWAYS_2: &[State] = &STATES_2;
const READ_2: &[State] = &[Initialization, Step, Terminated, Failed];
const SET_2: &[State] = &[Instantiated, Initialization, Step];
const STEPPED_2: &[State] = &[Step, Terminated, Failed];

/// Value reference of the output `theta`.
const THETA: u32 = 3;
/// Value reference of the input `u`.
const U: u32 = 1;

#[rustfmt::skip]
const FMI2: &[Row] = &[
    ("fmi2SetDebugLogging", ALWAYS_2, |c, _| unsafe { fmi2SetDebugLogging(c, 1, 0, null()) }),
    ("fmi2SetupExperiment", &[Instantiated], |c, _| unsafe { fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0) }),
    ("fmi2EnterInitializationMode", &[Instantiated], |c, _| unsafe { fmi2EnterInitializationMode(c) }),
    ("fmi2ExitInitializationMode", &[Initialization], |c, _| unsafe { fmi2ExitInitializationMode(c) }),
    ("fmi2Terminate", &[Step], |c, _| unsafe { fmi2Terminate(c) }),
    ("fmi2Reset", ALWAYS_2, |c, _| unsafe { fmi2Reset(c) }),
    ("fmi2GetReal", READ_2, |c, _| unsafe { fmi2GetReal(c, &THETA, 1, &mut 0.0) }),
    ("fmi2GetBoolean", READ_2, |c, _| unsafe { fmi2GetBoolean(c, null(), 0, null_mut()) }),
    ("fmi2GetInteger", READ_2, |c, _| unsafe { fmi2GetInteger(c, null(), 0, null_mut()) }),
    ("fmi2GetString", READ_2, |c, _| unsafe { fmi2GetString(c, null(), 0, null_mut()) }),
    ("fmi2SetReal", SET_2, |c, _| unsafe { fmi2SetReal(c, &U, 1, &1.0) }),
    ("fmi2SetBoolean", SET_2, |c, _| unsafe { fmi2SetBoolean(c, null(), 0, null()) }),
    ("fmi2SetInteger", SET_2, |c, _| unsafe { fmi2SetInteger(c, null(), 0, null()) }),
    ("fmi2SetString", SET_2, |c, _| unsafe { fmi2SetString(c, null(), 0, null()) }),
    ("fmi2SetRealInputDerivatives", SET_2, |c, _| unsafe { fmi2SetRealInputDerivatives(c, &U, 1, &1, &1.0) }),
    ("fmi2GetRealOutputDerivatives", STEPPED_2, |c, _| unsafe { fmi2GetRealOutputDerivatives(c, &THETA, 1, &1, &mut 0.0) }),
    ("fmi2GetDirectionalDerivative", READ_2, |c, _| unsafe { fmi2GetDirectionalDerivative(c, &THETA, 1, &U, 1, &1.0, &mut 0.0) }),
    ("fmi2DoStep", &[Step], |c, _| unsafe { fmi2DoStep(c, 0.0, 0.1, 1) }),
    ("fmi2GetStatus", STEPPED_2, |c, _| unsafe { fmi2GetStatus(c, DO_STEP_STATUS, &mut Ok) }),
    ("fmi2GetRealStatus", STEPPED_2, |c, _| unsafe { fmi2GetRealStatus(c, LAST_SUCCESSFUL_TIME, &mut 0.0) }),
    ("fmi2GetBooleanStatus", STEPPED_2, |c, _| unsafe { fmi2GetBooleanStatus(c, TERMINATED, &mut 0) }),
    ("fmi2GetFMUstate", ALWAYS_2, |c, _| unsafe { fmi2GetFMUstate(c, &mut null_mut()) }),
    ("fmi2SetFMUstate", ALWAYS_2, |c, state| unsafe { fmi2SetFMUstate(c, state) }),
    ("fmi2SerializedFMUstateSize", ALWAYS_2, |c, state| unsafe { fmi2SerializedFMUstateSize(c, state, &mut 0) }),
    ("fmi2FreeFMUstate", ALWAYS_2, |c, mut state| unsafe { fmi2FreeFMUstate(c, &mut state) }),
];

const ALWAYS_3: &[State] = &STATES_3;
const READ_3: &[State] = &[
    Instantiated,
    Initialization,
    Event,
    Step,
    Intermediate,
    Terminated,
];
const SET_3: &[State] = &[Instantiated, Configuration, Initialization, Event, Step];

#[rustfmt::skip]
const FMI3: &[Row] = &[
    ("fmi3SetDebugLogging", ALWAYS_3, |c, _| unsafe { fmi3SetDebugLogging(c, 1, 0, null()) }),
    ("fmi3EnterInitializationMode", &[Instantiated], |c, _| unsafe { fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0) }),
    ("fmi3ExitInitializationMode", &[Initialization], |c, _| unsafe { fmi3ExitInitializationMode(c) }),
    ("fmi3EnterConfigurationMode", &[Instantiated], |c, _| unsafe { fmi3EnterConfigurationMode(c) }),
    ("fmi3ExitConfigurationMode", &[Configuration], |c, _| unsafe { fmi3ExitConfigurationMode(c) }),
    ("fmi3EnterEventMode", &[Step], |c, _| unsafe { fmi3EnterEventMode(c) }),
    ("fmi3EvaluateDiscreteStates", &[Event], |c, _| unsafe { fmi3EvaluateDiscreteStates(c) }),
    ("fmi3UpdateDiscreteStates", &[Event], |c, _| unsafe { fmi3UpdateDiscreteStates(c, &mut 0, &mut 0, &mut 0, &mut 0, &mut 0, &mut 0.0) }),
    ("fmi3EnterStepMode", &[Event], |c, _| unsafe { fmi3EnterStepMode(c) }),
    ("fmi3Terminate", &[Event, Step], |c, _| unsafe { fmi3Terminate(c) }),
    ("fmi3Reset", ALWAYS_3, |c, _| unsafe { fmi3Reset(c) }),
    ("fmi3GetFloat64", READ_3, |c, _| unsafe { fmi3GetFloat64(c, &THETA, 1, &mut 0.0, 1) }),
    ("fmi3GetBoolean", READ_3, |c, _| unsafe { fmi3GetBoolean(c, null(), 0, null_mut(), 0) }),
    ("fmi3GetInt32", READ_3, |c, _| unsafe { fmi3GetInt32(c, null(), 0, null_mut(), 0) }),
    ("fmi3GetString", READ_3, |c, _| unsafe { fmi3GetString(c, null(), 0, null_mut(), 0) }),
    ("fmi3GetBinary", READ_3, |c, _| unsafe { fmi3GetBinary(c, null(), 0, null_mut(), null_mut(), 0) }),
    // In configuration mode structural parameters may be set, of which there are none.
    ("fmi3SetFloat64", SET_3, |c, _| unsafe { fmi3SetFloat64(c, null(), 0, null(), 0) }),
    ("fmi3SetBoolean", SET_3, |c, _| unsafe { fmi3SetBoolean(c, null(), 0, null(), 0) }),
    ("fmi3SetInt32", SET_3, |c, _| unsafe { fmi3SetInt32(c, null(), 0, null(), 0) }),
    ("fmi3SetString", SET_3, |c, _| unsafe { fmi3SetString(c, null(), 0, null(), 0) }),
    ("fmi3GetOutputDerivatives", &[Step, Intermediate, Terminated], |c, _| unsafe { fmi3GetOutputDerivatives(c, &THETA, 1, &1, &mut 0.0, 1) }),
    ("fmi3GetDirectionalDerivative", &[Initialization, Event, Step, Intermediate, Terminated], |c, _| unsafe { fmi3GetDirectionalDerivative(c, &THETA, 1, &U, 1, &1.0, 1, &mut 0.0, 1) }),
    ("fmi3DoStep", &[Step], |c, _| unsafe { fmi3DoStep(c, 0.0, 0.1, 1, &mut 0, &mut 0, &mut 0, &mut 0.0) }),
    ("fmi3GetFMUState", ALWAYS_3, |c, _| unsafe { fmi3GetFMUState(c, &mut null_mut()) }),
    ("fmi3SetFMUState", ALWAYS_3, |c, state| unsafe { fmi3SetFMUState(c, state) }),
    ("fmi3SerializedFMUStateSize", ALWAYS_3, |c, state| unsafe { fmi3SerializedFMUStateSize(c, state, &mut 0) }),
    ("fmi3FreeFMUState", ALWAYS_3, |c, mut state| unsafe { fmi3FreeFMUState(c, &mut state) }),
];

const EXCHANGE_READ_2: &[State] = &[Initialization, Event, Continuous, Terminated, Failed];
const EXCHANGE_SET_2: &[State] = &[Instantiated, Initialization, Event, Continuous];

/// Functions of FMI 2 on instances for model exchange.
#[rustfmt::skip]
const EXCHANGE_FMI2: &[Row] = &[
    ("fmi2SetDebugLogging", &EXCHANGE_2, |c, _| unsafe { fmi2SetDebugLogging(c, 1, 0, null()) }),
    ("fmi2SetupExperiment", &[Instantiated], |c, _| unsafe { fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0) }),
    ("fmi2EnterInitializationMode", &[Instantiated], |c, _| unsafe { fmi2EnterInitializationMode(c) }),
    ("fmi2ExitInitializationMode", &[Initialization], |c, _| unsafe { fmi2ExitInitializationMode(c) }),
    ("fmi2Terminate", &[Event, Continuous], |c, _| unsafe { fmi2Terminate(c) }),
    ("fmi2Reset", &EXCHANGE_2, |c, _| unsafe { fmi2Reset(c) }),
    ("fmi2GetReal", EXCHANGE_READ_2, |c, _| unsafe { fmi2GetReal(c, &THETA, 1, &mut 0.0) }),
    ("fmi2GetBoolean", EXCHANGE_READ_2, |c, _| unsafe { fmi2GetBoolean(c, null(), 0, null_mut()) }),
    ("fmi2SetReal", EXCHANGE_SET_2, |c, _| unsafe { fmi2SetReal(c, &U, 1, &1.0) }),
    ("fmi2EnterEventMode", &[Continuous], |c, _| unsafe { fmi2EnterEventMode(c) }),
    ("fmi2NewDiscreteStates", &[Event], |c, _| unsafe { fmi2NewDiscreteStates(c, std::mem::MaybeUninit::uninit().as_mut_ptr()) }),
    ("fmi2EnterContinuousTimeMode", &[Event], |c, _| unsafe { fmi2EnterContinuousTimeMode(c) }),
    ("fmi2CompletedIntegratorStep", &[Continuous], |c, _| unsafe { fmi2CompletedIntegratorStep(c, 1, &mut 0, &mut 0) }),
    ("fmi2SetTime", &[Event, Continuous], |c, _| unsafe { fmi2SetTime(c, 0.0) }),
    ("fmi2SetContinuousStates", &[Continuous], |c, _| unsafe { fmi2SetContinuousStates(c, [0.0; 5].as_ptr(), 5) }),
    ("fmi2GetDerivatives", EXCHANGE_READ_2, |c, _| unsafe { fmi2GetDerivatives(c, [0.0; 5].as_mut_ptr(), 5) }),
    ("fmi2GetEventIndicators", EXCHANGE_READ_2, |c, _| unsafe { fmi2GetEventIndicators(c, [0.0; 5].as_mut_ptr(), 5) }),
    ("fmi2GetContinuousStates", EXCHANGE_READ_2, |c, _| unsafe { fmi2GetContinuousStates(c, [0.0; 5].as_mut_ptr(), 5) }),
    ("fmi2GetNominalsOfContinuousStates", &EXCHANGE_2, |c, _| unsafe { fmi2GetNominalsOfContinuousStates(c, [0.0; 5].as_mut_ptr(), 5) }),
    ("fmi2GetDirectionalDerivative", EXCHANGE_READ_2, |c, _| unsafe { fmi2GetDirectionalDerivative(c, &THETA, 1, &U, 1, &1.0, &mut 0.0) }),
    ("fmi2GetFMUstate", &EXCHANGE_2, |c, _| unsafe { fmi2GetFMUstate(c, &mut null_mut()) }),
    ("fmi2SetFMUstate", &EXCHANGE_2, |c, state| unsafe { fmi2SetFMUstate(c, state) }),
];

const EXCHANGE_READ_3: &[State] = &[Instantiated, Initialization, Event, Continuous, Terminated];
const EXCHANGE_SET_3: &[State] = &[
    Instantiated,
    Configuration,
    Initialization,
    Event,
    Continuous,
];
const EXCHANGE_VECTORS_3: &[State] = &[Initialization, Event, Continuous, Terminated];

/// Functions of FMI 3 on instances for model exchange.
#[rustfmt::skip]
const EXCHANGE_FMI3: &[Row] = &[
    ("fmi3EnterInitializationMode", &[Instantiated], |c, _| unsafe { fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0) }),
    ("fmi3ExitInitializationMode", &[Initialization], |c, _| unsafe { fmi3ExitInitializationMode(c) }),
    ("fmi3EnterConfigurationMode", &[Instantiated], |c, _| unsafe { fmi3EnterConfigurationMode(c) }),
    ("fmi3ExitConfigurationMode", &[Configuration], |c, _| unsafe { fmi3ExitConfigurationMode(c) }),
    ("fmi3EnterEventMode", &[Continuous], |c, _| unsafe { fmi3EnterEventMode(c) }),
    ("fmi3EvaluateDiscreteStates", &[Event], |c, _| unsafe { fmi3EvaluateDiscreteStates(c) }),
    ("fmi3UpdateDiscreteStates", &[Event], |c, _| unsafe { fmi3UpdateDiscreteStates(c, &mut 0, &mut 0, &mut 0, &mut 0, &mut 0, &mut 0.0) }),
    ("fmi3EnterContinuousTimeMode", &[Event], |c, _| unsafe { fmi3EnterContinuousTimeMode(c) }),
    ("fmi3CompletedIntegratorStep", &[Continuous], |c, _| unsafe { fmi3CompletedIntegratorStep(c, 1, &mut 0, &mut 0) }),
    ("fmi3SetTime", &[Event, Continuous], |c, _| unsafe { fmi3SetTime(c, 0.0) }),
    ("fmi3SetContinuousStates", &[Continuous], |c, _| unsafe { fmi3SetContinuousStates(c, [0.0; 5].as_ptr(), 5) }),
    ("fmi3GetContinuousStateDerivatives", EXCHANGE_VECTORS_3, |c, _| unsafe { fmi3GetContinuousStateDerivatives(c, [0.0; 5].as_mut_ptr(), 5) }),
    ("fmi3GetEventIndicators", EXCHANGE_VECTORS_3, |c, _| unsafe { fmi3GetEventIndicators(c, [0.0; 5].as_mut_ptr(), 5) }),
    ("fmi3GetContinuousStates", EXCHANGE_VECTORS_3, |c, _| unsafe { fmi3GetContinuousStates(c, [0.0; 5].as_mut_ptr(), 5) }),
    ("fmi3GetNominalsOfContinuousStates", EXCHANGE_VECTORS_3, |c, _| unsafe { fmi3GetNominalsOfContinuousStates(c, [0.0; 5].as_mut_ptr(), 5) }),
    ("fmi3GetNumberOfContinuousStates", &EXCHANGE_3, |c, _| unsafe { fmi3GetNumberOfContinuousStates(c, &mut 0) }),
    ("fmi3GetNumberOfEventIndicators", &EXCHANGE_3, |c, _| unsafe { fmi3GetNumberOfEventIndicators(c, &mut 0) }),
    ("fmi3Terminate", &[Event, Continuous], |c, _| unsafe { fmi3Terminate(c) }),
    ("fmi3Reset", &EXCHANGE_3, |c, _| unsafe { fmi3Reset(c) }),
    ("fmi3GetFloat64", EXCHANGE_READ_3, |c, _| unsafe { fmi3GetFloat64(c, &THETA, 1, &mut 0.0, 1) }),
    ("fmi3SetFloat64", EXCHANGE_SET_3, |c, _| unsafe { fmi3SetFloat64(c, null(), 0, null(), 0) }),
    ("fmi3GetDirectionalDerivative", EXCHANGE_VECTORS_3, |c, _| unsafe { fmi3GetDirectionalDerivative(c, &THETA, 1, &U, 1, &1.0, 1, &mut 0.0, 1) }),
    ("fmi3GetAdjointDerivative", EXCHANGE_VECTORS_3, |c, _| unsafe { fmi3GetAdjointDerivative(c, &THETA, 1, &U, 1, &1.0, 1, &mut 0.0, 1) }),
    ("fmi3GetFMUState", &EXCHANGE_3, |c, _| unsafe { fmi3GetFMUState(c, &mut null_mut()) }),
    ("fmi3SetFMUState", &EXCHANGE_3, |c, state| unsafe { fmi3SetFMUState(c, state) }),
];

fn every_call_in_every_state(version: Version, exchange: bool, rows: &[Row], states: &[State]) {
    let component = Component::new(REDUCED_RIG);
    for (function, allowed, call) in rows {
        for state in states {
            let mut instance = in_state(&component, version, exchange, *state);
            let saved = instance.save();
            // SAFETY: all pointers are valid.
            let status = unsafe { call(instance.handle, saved) };
            if allowed.contains(state) {
                assert_eq!(
                    status,
                    Ok,
                    "{function} in {state:?}: {:?}",
                    instance.log.take()
                );
                continue;
            }
            assert_eq!(status, Error, "{function} in {state:?}");
            let line = instance.log.only(function);
            let place = format!("in the state \"{}\"", state.name(version));
            let names: Vec<_> = allowed.iter().map(|state| state.name(version)).collect();
            assert!(
                line.text.starts_with(&format!("{function}: ")) && line.text.contains(&place),
                "{}",
                line.text
            );
            let (_, listed) = line.text.split_once("it is allowed in: ").unwrap();
            let mut listed: Vec<_> = listed.split(", ").collect();
            listed.sort_by_key(|name| names.iter().position(|known| known == name));
            assert_eq!(listed, names, "{function}");
            instance.reset();
            assert_eq!(instance.enter_initialization(None, 0.0, None), Ok);
            assert_eq!(instance.exit_initialization(), Ok);
        }
    }
}

#[test]
fn every_function_of_fmi_2_in_every_state() {
    every_call_in_every_state(Fmi2, false, FMI2, &STATES_2);
}

#[test]
fn every_function_of_fmi_3_in_every_state() {
    every_call_in_every_state(Fmi3, false, FMI3, &STATES_3);
}

#[test]
fn every_function_of_model_exchange_in_every_state() {
    every_call_in_every_state(Fmi2, true, EXCHANGE_FMI2, &EXCHANGE_2);
    every_call_in_every_state(Fmi3, true, EXCHANGE_FMI3, &EXCHANGE_3);
}

#[test]
fn functions_of_the_other_kind_say_so() {
    let component = Component::new(REDUCED_RIG);
    let mut exchange = in_state(&component, Fmi2, true, Continuous);
    assert_eq!(exchange.step_from(0.0, 0.1).status, Error);
    let line = exchange.log.only("fmi2DoStep");
    assert!(
        line.text
            .contains("is for co-simulation; this instance was made for model exchange")
    );
    exchange.reset();
    let stepper = in_state(&component, Fmi3, false, Step);
    assert_eq!(stepper.set_states(&[0.0; 5]), Error);
    let line = stepper.log.only("fmi3SetContinuousStates");
    assert!(
        line.text
            .contains("is for model exchange; this instance was made for co-simulation")
    );
}
