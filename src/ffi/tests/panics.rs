//! A panic inside, wherever the model can have one: it ends at the C boundary as an error with one line, and a reset, or
//! the end of the instance, is still possible.

use super::harness::{Fmi2, Fmi3, Messages, NULL, Resources, logger2, logger3, token};
use crate::cosim::test_model::{
    ABOVE, GAIN, LAST_PANIC_GAIN, PANIC, PANIC_GAIN, PANIC_TOML, U, X, Y, open,
};
use crate::ffi::Status::{self, Error, Ok};
use crate::ffi::fmi2::{new_instance as new_fmi2, *};
use crate::ffi::fmi3::{new_instance as new_fmi3, *};
use std::ffi::{CString, c_void};
use std::{fs, ptr};

type Call = unsafe fn(*mut c_void) -> Status;

/// The line that a panic leaves, and none beside it.
#[track_caller]
fn told(log: &mut Messages) {
    let message = log.only();
    for part in ["internal error", PANIC, "can be reset or freed"] {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn in_any_call_of_fmi_2() {
    let calls: [Call; 8] = [
        |c| unsafe { fmi2DoStep(c, 0.0, 0.1, 1) },
        |c| unsafe { fmi2GetReal(c, &X, 1, &mut 0.0) },
        |c| unsafe { fmi2GetBoolean(c, &ABOVE, 1, &mut 0) },
        |c| unsafe { fmi2SetReal(c, &U, 1, &1.0) },
        |c| unsafe { fmi2SetRealInputDerivatives(c, &U, 1, &1, &1.0) },
        |c| unsafe { fmi2GetRealOutputDerivatives(c, &X, 1, &1, &mut 0.0) },
        |c| unsafe { fmi2GetDirectionalDerivative(c, &Y, 1, &U, 1, &1.0, &mut 0.0) },
        |c| unsafe { fmi2GetFMUstate(c, &mut ptr::null_mut()) },
    ];
    for (number, call) in calls.into_iter().enumerate() {
        let mut instance = Fmi2::running();
        assert_eq!(instance.set(GAIN, PANIC_GAIN), Ok);
        // SAFETY: all pointers are valid.
        unsafe {
            assert_eq!(call(instance.handle), Error, "call {number}");
            told(&mut instance.log);
            assert_eq!(instance.step(0.0, 0.1), Error);
            assert_eq!(fmi2Reset(instance.handle), Ok);
            assert_eq!(fmi2EnterInitializationMode(instance.handle), Ok);
            assert_eq!(fmi2ExitInitializationMode(instance.handle), Ok);
        }
        assert_eq!(instance.step(0.0, 0.1), Ok);
    }
    let before: [Call; 2] = [
        |c| unsafe { fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0) },
        |c| unsafe {
            assert_eq!(fmi2EnterInitializationMode(c), Ok);
            fmi2ExitInitializationMode(c)
        },
    ];
    for call in before {
        let mut instance = Fmi2::new();
        assert_eq!(instance.set(GAIN, PANIC_GAIN), Ok);
        // SAFETY: no pointers but the handle.
        unsafe {
            assert_eq!(call(instance.handle), Error);
            told(&mut instance.log);
            assert_eq!(fmi2Reset(instance.handle), Ok);
        }
    }
}

#[test]
fn in_any_call_of_fmi_3() {
    let calls: [Call; 7] = [
        |c| unsafe { fmi3DoStep(c, 0.0, 0.1, 1, &mut 0, &mut 0, &mut 0, &mut 0.0) },
        |c| unsafe { fmi3GetFloat64(c, &X, 1, &mut 0.0, 1) },
        |c| unsafe { fmi3GetBoolean(c, &ABOVE, 1, &mut 0, 1) },
        |c| unsafe { fmi3SetFloat64(c, &U, 1, &1.0, 1) },
        |c| unsafe { fmi3GetOutputDerivatives(c, &X, 1, &1, &mut 0.0, 1) },
        |c| unsafe { fmi3GetDirectionalDerivative(c, &Y, 1, &U, 1, &1.0, 1, &mut 0.0, 1) },
        |c| unsafe { fmi3GetFMUState(c, &mut ptr::null_mut()) },
    ];
    for (number, call) in calls.into_iter().enumerate() {
        let mut instance = Fmi3::running(false, false);
        assert_eq!(instance.set(GAIN, PANIC_GAIN), Ok);
        // SAFETY: all pointers are valid.
        unsafe {
            assert_eq!(call(instance.handle), Error, "call {number}");
            told(&mut instance.log);
            assert_eq!(fmi3Reset(instance.handle), Ok);
            let entered = fmi3EnterInitializationMode(instance.handle, 0, 0.0, 0.0, 0, 0.0);
            assert_eq!(entered, Ok);
            assert_eq!(fmi3ExitInitializationMode(instance.handle), Ok);
        }
        assert_eq!(instance.step(0.0, 0.1).status, Ok);
    }
    let mut instance = Fmi3::new(false, false, true);
    assert_eq!(instance.set(GAIN, PANIC_GAIN), Ok);
    // SAFETY: no pointers but the handle.
    let status = unsafe { fmi3EnterInitializationMode(instance.handle, 0, 0.0, 0.0, 0, 0.0) };
    assert_eq!(status, Error);
    told(&mut instance.log);
}

/// Restoring and resetting panic, and so does the end of the model: a handle that was freed is dead all the same.
#[test]
fn in_a_reset_and_at_the_end() {
    let mut two = Fmi2::running();
    let state = two.save();
    two.set(GAIN, LAST_PANIC_GAIN);
    let mut three = Fmi3::running(false, false);
    three.set(GAIN, LAST_PANIC_GAIN);
    // SAFETY: handles of this library.
    unsafe {
        assert_eq!(fmi2SetFMUstate(two.handle, state), Error);
        told(&mut two.log);
        assert_eq!(fmi2Reset(two.handle), Error);
        told(&mut two.log);
        fmi2FreeInstance(two.handle);
        assert_eq!(fmi2Reset(two.handle), Error);
        assert_eq!(fmi3Reset(three.handle), Error);
        told(&mut three.log);
        fmi3FreeInstance(three.handle);
        assert_eq!(fmi3Reset(three.handle), Error);
    }
    assert!(two.log.take().is_empty() && three.log.take().is_empty());
}

#[test]
fn while_an_instance_is_made() {
    let resources = Resources::new();
    fs::write(resources.0.join("model.toml"), PANIC_TOML).unwrap();
    let (mut log, token, name) = (Messages::default(), token(), c"test".as_ptr());
    let environment: *mut c_void = (&raw mut log).cast();
    let functions = CallbackFunctions {
        logger: Some(logger2()),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: environment,
    };
    let (uri, token) = (resources.uri(), token.as_ptr());
    let folder = CString::new(resources.0.to_str().unwrap()).unwrap();
    // SAFETY: all pointers are valid for the call.
    unsafe {
        let handle = new_fmi2(open, 1, [name, token, uri.as_ptr()], &functions, 0);
        assert_eq!(handle, NULL);
        assert!(log.only().contains(PANIC));
        let handle = new_fmi3(
            "fmi3InstantiateCoSimulation",
            open,
            [name, token, folder.as_ptr()],
            0,
            environment,
            Some(logger3),
            |_| Result::Ok(()),
        );
        assert_eq!(handle, NULL);
        assert!(log.only().contains(PANIC));
    }
}
