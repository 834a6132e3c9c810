//! FMI 3 as an importer sees it.

use super::harness::{Fmi2, Fmi3, Messages, NULL, Resources, Step3, logger3, token};
use crate::cosim::open;
use crate::cosim::test_model::{ABOVE, GAIN, RATE, U, X, Y};
use crate::ffi::Status::{self, Discard, Error, Ok};
use crate::ffi::fmi2::fmi2Terminate;
use crate::ffi::fmi3::*;
use std::ffi::{CString, c_void};
use std::{fs, ptr};

#[test]
fn both_versions_give_the_same_bits() {
    let (two, three) = (Fmi2::running(), Fmi3::running(false, false));
    two.set(U, 3.0);
    three.set(U, 3.0);
    for n in 0..50 {
        let (point, size) = (0.07 * f64::from(n), 0.07);
        two.step(point, size);
        assert_eq!(three.step(point, size).status, Ok);
        assert_eq!(two.get(X).to_bits(), three.get(X).to_bits());
    }
}

#[test]
fn a_step_ends_at_the_switch_when_the_importer_asks_for_it() {
    let instance = Fmi3::running(true, true);
    instance.pass_event_mode();
    instance.set(U, 1.0);
    // x = 1 − e^−t passes 0.5 at ln 2.
    let switch = std::f64::consts::LN_2;
    let step = instance.step(0.0, 1.0);
    assert!((step.time - switch).abs() < 1e-11);
    assert_eq!(
        step,
        Step3 {
            status: Ok,
            event: true,
            early: true,
            time: step.time
        }
    );
    let mut above = 9;
    // SAFETY: one variable, one value.
    unsafe {
        assert_eq!(fmi3EnterEventMode(instance.handle), Ok);
        assert_eq!(
            fmi3GetBoolean(instance.handle, &ABOVE, 1, &mut above, 1),
            Ok
        );
        assert_eq!(above, 1);
        assert_eq!(instance.set(GAIN, 3.0), Ok);
    }
    instance.pass_event_mode();
    let rest = instance.step(step.time, 1.0 - step.time);
    assert_eq!(
        rest,
        Step3 {
            status: Ok,
            event: false,
            early: false,
            time: 1.0
        }
    );
}

/// As the standard has it of discrete variables: nobody sees them change but at communication points. What the switch made of
/// them is there when the step has ended, whether the importer then enters event mode or not.
#[test]
fn a_discrete_variable_is_behind_the_switch_before_in_and_after_event_mode() {
    for early_return in [false, true] {
        let instance = Fmi3::running(true, early_return);
        let above = || {
            let mut above = 9;
            // SAFETY: one variable, one value.
            let status = unsafe { fmi3GetBoolean(instance.handle, &ABOVE, 1, &mut above, 1) };
            assert_eq!(status, Ok);
            above
        };
        instance.pass_event_mode();
        instance.set(U, 1.0);
        assert!(!instance.step(0.0, 0.5).event);
        assert_eq!(above(), 0);
        assert!(instance.step(0.5, 0.5).event);
        assert_eq!(above(), 1);
        // SAFETY: no pointers but the handle.
        unsafe {
            assert_eq!(fmi3EnterEventMode(instance.handle), Ok);
            assert_eq!(above(), 1);
            assert_eq!(fmi3EvaluateDiscreteStates(instance.handle), Ok);
        }
        assert_eq!(above(), 1);
    }
}

#[test]
fn event_mode_without_early_return_steps_to_the_end_and_says_so() {
    let instance = Fmi3::running(true, false);
    instance.pass_event_mode();
    instance.set(U, 1.0);
    let step = instance.step(0.0, 1.0);
    assert_eq!(
        step,
        Step3 {
            status: Ok,
            event: true,
            early: false,
            time: 1.0
        }
    );
}

#[test]
fn an_importer_that_asks_for_nothing_gets_whole_steps() {
    let mut instance = Fmi3::running(false, false);
    instance.set(U, 1.0);
    let step = instance.step(0.0, 1.0);
    assert_eq!(
        step,
        Step3 {
            status: Ok,
            event: false,
            early: false,
            time: 1.0
        }
    );
    assert!(
        instance
            .log
            .take()
            .iter()
            .all(|(status, category, _)| { *status == 0 && category == "logEvents" })
    );
    // SAFETY: no pointers but the handle.
    assert_eq!(unsafe { fmi3EnterEventMode(instance.handle) }, Error);
    assert!(instance.log.only().contains("eventModeUsed"));
}

#[test]
fn tunable_parameters_wait_for_event_mode_only_where_it_is_used() {
    assert_eq!(Fmi3::running(false, false).set(GAIN, 3.0), Ok);
    let instance = Fmi3::running(true, false);
    instance.pass_event_mode();
    assert_eq!(instance.set(U, 3.0), Ok);
    assert_eq!(instance.set(GAIN, 3.0), Error);
}

#[test]
fn start_values_are_readable_and_settable_before_the_simulation() {
    let instance = Fmi3::new(false, false, true);
    assert_eq!(instance.get(RATE), 1.0);
    assert_eq!(instance.set(X, 0.25), Ok);
    assert_eq!(instance.set(RATE, 2.0), Ok);
    assert_eq!(instance.set(RATE, 0.0), Discard);
    // SAFETY: no pointers but the handle.
    unsafe {
        assert_eq!(
            fmi3EnterInitializationMode(instance.handle, 0, 7.0, 1.0, 0, 0.0),
            Ok
        );
        assert_eq!(instance.get(X), 0.25);
        assert_eq!(instance.set(U, 0.0), Ok);
        assert_eq!(fmi3ExitInitializationMode(instance.handle), Ok);
    }
    assert_eq!(instance.step(1.0, 1.0).status, Ok);
    assert!((instance.get(X) - 0.25 * (-2.0_f64).exp()).abs() < 1e-14);
}

#[test]
fn steps_that_cannot_be_are_discarded_and_the_next_one_goes_on() {
    let mut instance = Fmi3::running(false, false);
    for (point, size) in [(0.0, 0.0), (0.0, -1.0), (0.0, f64::NAN), (0.5, 0.1)] {
        let step = instance.step(point, size);
        assert_eq!((step.status, step.time), (Discard, 0.0));
        instance.log.only();
    }
    assert_eq!(instance.step(0.0, 0.1).status, Ok);
}

#[test]
fn nothing_is_logged_while_logging_is_off() {
    let mut instance = Fmi3::new(false, false, false);
    assert_eq!(instance.step(0.0, 0.1).status, Error);
    assert!(instance.log.take().is_empty());
}

#[test]
fn errors_end_in_terminated_and_a_reset_recovers() {
    let mut instance = Fmi3::running(false, false);
    assert_eq!(instance.set(99, 0.0), Error);
    instance.log.only();
    assert_eq!(instance.step(0.0, 0.1).status, Error);
    assert!(
        instance
            .log
            .only()
            .contains("\"Terminated\" after an error")
    );
    assert_eq!(instance.get(X), 0.0);
    // SAFETY: no pointers but the handle.
    unsafe {
        assert_eq!(fmi3Reset(instance.handle), Ok);
        assert_eq!(
            fmi3EnterInitializationMode(instance.handle, 0, 0.0, 0.0, 0, 0.0),
            Ok
        );
        assert_eq!(fmi3ExitInitializationMode(instance.handle), Ok);
    }
    assert_eq!(instance.step(0.0, 0.1).status, Ok);
}

#[test]
fn other_kinds_of_component_are_refused_with_a_reason() {
    let resources = Resources::new();
    let folder = CString::new(resources.0.to_str().unwrap()).unwrap();
    let token = token();
    let mut log = Messages::default();
    let (name, token, folder) = (c"test".as_ptr(), token.as_ptr(), folder.as_ptr());
    let env: *mut c_void = (&raw mut log).cast();
    // SAFETY: all pointers are valid for the call.
    unsafe {
        assert!(
            fmi3InstantiateModelExchange(name, token, folder, 0, 0, env, Some(logger3)).is_null()
        );
        assert!(log.only().contains("model.toml: "));
        const RIG: &str = include_str!("../../../modelDescription/reduced-rig.toml");
        fs::write(resources.0.join("model.toml"), RIG).unwrap();
        let token = open(RIG, "rig.toml").unwrap().token();
        let token = CString::new(token.to_string()).unwrap();
        let token = token.as_ptr();
        let logger = Some(logger3 as _);
        assert!(
            fmi3InstantiateScheduledExecution(
                name, token, folder, 0, 1, env, logger, None, None, None
            )
            .is_null()
        );
        assert!(log.only().contains("scheduled execution is not supported"));
        assert!(
            fmi3InstantiateCoSimulation(name, token, folder, 0, 1, 0, 0, &X, 1, env, logger, None)
                .is_null()
        );
        assert!(log.only().contains("requiredIntermediateVariables"));
    }
}

#[test]
fn everything_unsupported_is_an_error_with_one_message() {
    type Call = fn(*mut c_void) -> Status;
    let calls: [Call; 21] = [
        |c| fmi3GetNumberOfVariableDependencies(c, X, &mut 0),
        |c| {
            let null = ptr::null_mut();
            fmi3GetVariableDependencies(c, X, null, null.cast(), null, null.cast(), 0)
        },
        |c| fmi3GetIntervalDecimal(c, &X, 1, &mut 0.0, &mut 0),
        |c| fmi3GetIntervalFraction(c, &X, 1, &mut 0, &mut 0, &mut 0),
        |c| fmi3GetShiftDecimal(c, &X, 1, &mut 0.0),
        |c| fmi3GetShiftFraction(c, &X, 1, &mut 0, &mut 0),
        |c| fmi3SetIntervalDecimal(c, &X, 1, &0.0),
        |c| fmi3SetIntervalFraction(c, &X, 1, &0, &0),
        |c| fmi3SetShiftDecimal(c, &X, 1, &0.0),
        |c| fmi3SetShiftFraction(c, &X, 1, &0, &0),
        |c| fmi3ActivateModelPartition(c, 0, 0.0),
        // SAFETY: no more values than places.
        |c| unsafe { fmi3EnterContinuousTimeMode(c) },
        // SAFETY: no more values than places.
        |c| unsafe { fmi3CompletedIntegratorStep(c, 0, &mut 0, &mut 0) },
        // SAFETY: no more values than places.
        |c| unsafe { fmi3SetTime(c, 0.0) },
        // SAFETY: no more values than places.
        |c| unsafe { fmi3SetContinuousStates(c, &0.0, 1) },
        // SAFETY: no more values than places.
        |c| unsafe { fmi3GetContinuousStateDerivatives(c, &mut 0.0, 1) },
        // SAFETY: no more values than places.
        |c| unsafe { fmi3GetEventIndicators(c, &mut 0.0, 1) },
        // SAFETY: no more values than places.
        |c| unsafe { fmi3GetContinuousStates(c, &mut 0.0, 1) },
        // SAFETY: no more values than places.
        |c| unsafe { fmi3GetNominalsOfContinuousStates(c, &mut 0.0, 1) },
        // SAFETY: no more values than places.
        |c| unsafe { fmi3GetNumberOfEventIndicators(c, &mut 0) },
        // SAFETY: no more values than places.
        |c| unsafe { fmi3GetNumberOfContinuousStates(c, &mut 0) },
    ];
    for (number, call) in calls.into_iter().enumerate() {
        let mut instance = Fmi3::running(false, false);
        assert_eq!(call(instance.handle), Error, "call {number}");
        instance.log.only();
    }
}

#[test]
fn the_adjoint_derivative_is_the_transposed_jacobian() {
    let instance = Fmi3::running(false, false);
    let (mut directional, mut adjoint) = ([0.0; 2], [0.0]);
    // SAFETY: lengths as given.
    unsafe {
        let c = instance.handle;
        let unknowns = [X, Y];
        let (unknowns, knowns) = (unknowns.as_ptr(), &U);
        assert_eq!(
            fmi3GetDirectionalDerivative(
                c,
                unknowns,
                2,
                knowns,
                1,
                &1.0,
                1,
                directional.as_mut_ptr(),
                2
            ),
            Ok
        );
        let seed = [3.0, 5.0];
        assert_eq!(
            fmi3GetAdjointDerivative(
                c,
                unknowns,
                2,
                knowns,
                1,
                seed.as_ptr(),
                2,
                adjoint.as_mut_ptr(),
                1
            ),
            Ok
        );
        assert_eq!(
            fmi3GetAdjointDerivative(
                c,
                unknowns,
                2,
                knowns,
                1,
                seed.as_ptr(),
                1,
                adjoint.as_mut_ptr(),
                1
            ),
            Error
        );
    }
    assert_ne!(directional, [0.0, 0.0]);
    assert_eq!(adjoint[0], 3.0 * directional[0] + 5.0 * directional[1]);
}

#[test]
fn types_that_no_variable_has_are_errors_but_empty_lists_are_fine() {
    macro_rules! check {
        ($($get:ident: $type:ty),*) => { $(
            let mut instance = Fmi3::running(false, false);
            let mut value: $type = Default::default();
            // SAFETY: one variable, one value.
            unsafe {
                assert_eq!($get(instance.handle, ptr::null(), 0, ptr::null_mut(), 0), Ok);
                assert_eq!($get(instance.handle, &X, 1, &mut value, 1), Error);
            }
            assert!(instance.log.only().contains("\"x\" (value reference 2) is a real"));
        )* };
    }
    check!(
        fmi3GetFloat32: f32, fmi3GetInt8: i8, fmi3GetUInt8: u8, fmi3GetInt16: i16,
        fmi3GetUInt16: u16, fmi3GetInt32: i32, fmi3GetUInt32: u32, fmi3GetInt64: i64,
        fmi3GetUInt64: u64, fmi3GetBoolean: u8
    );
    // SAFETY: empty lists.
    unsafe {
        let c = Fmi3::running(false, false);
        assert_eq!(
            fmi3GetString(c.handle, ptr::null(), 0, ptr::null_mut(), 0),
            Ok
        );
        let null: *mut *const u8 = ptr::null_mut();
        assert_eq!(
            fmi3GetBinary(c.handle, ptr::null(), 0, null.cast(), null, 0),
            Ok
        );
        assert_eq!(fmi3GetClock(c.handle, &X, 1, &mut 0), Error);
    }
}

#[test]
fn array_lengths_must_agree() {
    let mut instance = Fmi3::running(false, false);
    // SAFETY: the shorter of the lengths is valid.
    let status = unsafe { fmi3GetFloat64(instance.handle, &X, 1, [0.0; 2].as_mut_ptr(), 2) };
    assert_eq!(status, Error);
    assert!(
        instance
            .log
            .only()
            .contains("nValues = 2 must equal nValueReferences = 1")
    );
}

#[test]
fn a_saved_state_brings_back_its_mode() {
    let instance = Fmi3::running(true, true);
    let mut state = NULL;
    // SAFETY: handles of this library.
    unsafe {
        assert_eq!(fmi3GetFMUState(instance.handle, &mut state), Ok);
        instance.pass_event_mode();
        instance.set(U, 1.0);
        assert!(instance.step(0.0, 1.0).early);
        assert_eq!(fmi3SetFMUState(instance.handle, state), Ok);
        instance.pass_event_mode();
        assert_eq!((instance.get(U), instance.get(X)), (0.0, 0.0));
        let other = Fmi3::running(false, false);
        assert_eq!(fmi3SetFMUState(other.handle, state), Error);
        assert_eq!(fmi3FreeFMUState(instance.handle, &mut state), Ok);
    }
}

#[test]
fn handles_of_one_version_are_refused_by_the_other() {
    let mut instance = Fmi3::running(false, false);
    // SAFETY: no pointers but the handle.
    assert_eq!(unsafe { fmi2Terminate(instance.handle) }, Error);
    assert!(instance.log.only().contains("other FMI version"));
}

#[test]
fn configuration_mode_opens_and_closes() {
    let instance = Fmi3::new(false, false, true);
    // SAFETY: no pointers but the handle.
    unsafe {
        assert_eq!(fmi3EnterConfigurationMode(instance.handle), Ok);
        assert_eq!(fmi3ExitConfigurationMode(instance.handle), Ok);
        assert_eq!(
            fmi3EnterInitializationMode(instance.handle, 0, 0.0, 0.0, 0, 0.0),
            Ok
        );
        assert_eq!(fmi3EnterConfigurationMode(instance.handle), Error);
    }
}
