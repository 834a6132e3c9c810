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
    Terminated,
    /// FMI 2 only; in FMI 3 an error terminates.
    Failed,
}
use State::{Configuration, Event, Failed, Initialization, Instantiated, Step, Terminated};

const STATES_2: [State; 5] = [Instantiated, Initialization, Step, Terminated, Failed];
const STATES_3: [State; 6] = [
    Instantiated,
    Configuration,
    Initialization,
    Event,
    Step,
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
            (Terminated, Fmi3) => "Terminated",
        }
    }
}

/// An instance that legal calls took to a state.
fn in_state(component: &Component, version: Version, state: State) -> Instance<'_> {
    let instance = component.instantiate_with(version, true, true);
    let path: &[State] = match state {
        Instantiated => &[],
        Configuration => &[Configuration],
        Initialization => &[Initialization],
        Event => &[Initialization, Event],
        Step | Failed => &[Initialization, Event, Step],
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
            Terminated => instance.terminate(),
            Instantiated | Failed => Ok,
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
const READ_3: &[State] = &[Instantiated, Initialization, Event, Step, Terminated];
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
    ("fmi3GetOutputDerivatives", &[Step, Terminated], |c, _| unsafe { fmi3GetOutputDerivatives(c, &THETA, 1, &1, &mut 0.0, 1) }),
    ("fmi3GetDirectionalDerivative", &[Initialization, Event, Step, Terminated], |c, _| unsafe { fmi3GetDirectionalDerivative(c, &THETA, 1, &U, 1, &1.0, 1, &mut 0.0, 1) }),
    ("fmi3DoStep", &[Step], |c, _| unsafe { fmi3DoStep(c, 0.0, 0.1, 1, &mut 0, &mut 0, &mut 0, &mut 0.0) }),
    ("fmi3GetFMUState", ALWAYS_3, |c, _| unsafe { fmi3GetFMUState(c, &mut null_mut()) }),
    ("fmi3SetFMUState", ALWAYS_3, |c, state| unsafe { fmi3SetFMUState(c, state) }),
    ("fmi3SerializedFMUStateSize", ALWAYS_3, |c, state| unsafe { fmi3SerializedFMUStateSize(c, state, &mut 0) }),
    ("fmi3FreeFMUState", ALWAYS_3, |c, mut state| unsafe { fmi3FreeFMUState(c, &mut state) }),
];

fn every_call_in_every_state(version: Version, rows: &[Row], states: &[State]) {
    let component = Component::new(REDUCED_RIG);
    for (function, allowed, call) in rows {
        for state in states {
            let mut instance = in_state(&component, version, *state);
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
    every_call_in_every_state(Fmi2, FMI2, &STATES_2);
}

#[test]
fn every_function_of_fmi_3_in_every_state() {
    every_call_in_every_state(Fmi3, FMI3, &STATES_3);
}
