//! FMI 2 as an importer sees it: life of an instance, order of calls, log.

use super::harness::{Fmi2, Messages, NULL, Resources, logger2, token};
use crate::cosim::test_model::{TIME, U, X, open};
use crate::ffi::Status::{self, Discard, Error, Ok, Warning};
use crate::ffi::fmi2::*;
use std::ffi::{CStr, c_char, c_void};
use std::ptr;

/// Instantiates with these arguments; `None` becomes NULL.
fn instantiate(
    name: Option<&CStr>,
    kind: Type,
    token: Option<&CStr>,
    resources: Option<&CStr>,
) -> (*mut c_void, Messages) {
    let mut log = Messages::default();
    let functions = CallbackFunctions {
        logger: Some(logger2()),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: (&raw mut log).cast(),
    };
    let pointer = |text: Option<&CStr>| text.map_or(ptr::null(), CStr::as_ptr);
    // SAFETY: pointers are NULL or valid for the call.
    let handle = unsafe {
        let texts = [pointer(name), pointer(token), pointer(resources)];
        new_instance(open, kind, texts, &functions, 0)
    };
    (handle, log)
}

#[test]
fn instantiation_is_refused_with_its_reason() {
    let resources = Resources::new();
    let (uri, token) = (resources.uri(), token());
    let name = Some(c"test");
    let (good_uri, good_token) = (Some(uri.as_c_str()), Some(token.as_c_str()));
    for (arguments, reason) in [
        (
            (name, 2, good_token, good_uri),
            "fmuType = 2, but there are only model exchange (0)",
        ),
        ((name, 1, None, good_uri), "token (GUID) is NULL"),
        ((name, 1, Some(c"{1}"), good_uri), "does not match"),
        ((name, 1, good_token, None), "resource location is NULL"),
        (
            (name, 1, good_token, Some(c"file:///nowhere")),
            "cannot read /nowhere/model.toml",
        ),
        ((name, 1, good_token, Some(c"http://x/y")), "scheme http"),
    ] {
        let (kind, token, uri) = (arguments.1, arguments.2, arguments.3);
        let (handle, mut log) = instantiate(arguments.0, kind, token, uri);
        assert!(handle.is_null());
        let message = log.only();
        assert!(message.contains(reason), "{message}");
    }
}

#[test]
fn loggers_and_callbacks_may_be_null() {
    let resources = Resources::new();
    let (uri, token) = (resources.uri(), token());
    let functions = CallbackFunctions {
        logger: None,
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: NULL,
    };
    // SAFETY: pointers are NULL or valid for the call.
    unsafe {
        let name = c"a/b.fmu".as_ptr();
        let (token, uri) = (token.as_ptr(), uri.as_ptr());
        let texts = [name, token, uri];
        assert!(new_instance(open, 1, texts, ptr::null(), 1).is_null());
        let handle = new_instance(open, 1, texts, &functions, 1);
        assert!(!handle.is_null());
        assert_eq!(fmi2DoStep(handle, 0.0, 0.1, 1), Error);
        fmi2FreeInstance(handle);
    }
}

#[test]
fn calls_in_the_wrong_state_are_errors_that_name_state_and_remedy() {
    let mut instance = Fmi2::new();
    assert_eq!(instance.step(0.0, 0.1), Error);
    let message = instance.log.only();
    assert!(
        message.contains("fmi2DoStep") && message.contains("\"instantiated\""),
        "{message}"
    );
    assert!(message.contains("stepComplete"), "{message}");
    // After an error the standard allows a reset.
    // SAFETY: no pointers but the handle.
    unsafe {
        assert_eq!(fmi2EnterInitializationMode(instance.handle), Error);
        assert_eq!(fmi2Reset(instance.handle), Ok);
        assert_eq!(fmi2EnterInitializationMode(instance.handle), Ok);
        assert_eq!(fmi2ExitInitializationMode(instance.handle), Ok);
        assert_eq!(instance.step(0.0, 0.1), Ok);
        assert_eq!(fmi2Terminate(instance.handle), Ok);
    }
    assert_eq!(instance.get(TIME), 0.1);
    assert_eq!(instance.step(0.1, 0.1), Error);
}

#[test]
fn everything_unsupported_is_an_error_with_one_message() {
    type Call = unsafe fn(*mut c_void) -> Status;
    let calls: [Call; 12] = [
        // SAFETY: vectors are NULL.
        |c| unsafe { fmi2EnterEventMode(c) },
        // SAFETY: vectors are NULL.
        |c| unsafe { fmi2NewDiscreteStates(c, ptr::null_mut()) },
        // SAFETY: vectors are NULL.
        |c| unsafe { fmi2EnterContinuousTimeMode(c) },
        // SAFETY: vectors are NULL.
        |c| unsafe { fmi2CompletedIntegratorStep(c, 0, ptr::null_mut(), ptr::null_mut()) },
        // SAFETY: vectors are NULL.
        |c| unsafe { fmi2SetTime(c, 0.0) },
        // SAFETY: vectors are NULL.
        |c| unsafe { fmi2SetContinuousStates(c, ptr::null(), 0) },
        // SAFETY: vectors are NULL.
        |c| unsafe { fmi2GetDerivatives(c, ptr::null_mut(), 0) },
        // SAFETY: vectors are NULL.
        |c| unsafe { fmi2GetEventIndicators(c, ptr::null_mut(), 0) },
        // SAFETY: vectors are NULL.
        |c| unsafe { fmi2GetContinuousStates(c, ptr::null_mut(), 0) },
        // SAFETY: vectors are NULL.
        |c| unsafe { fmi2GetNominalsOfContinuousStates(c, ptr::null_mut(), 0) },
        |c| fmi2CancelStep(c),
        // SAFETY: the vector is NULL and its length is not zero.
        |c| unsafe { fmi2GetInteger(c, &X, 1, ptr::null_mut()) },
    ];
    for (number, call) in calls.into_iter().enumerate() {
        let mut instance = Fmi2::running();
        // SAFETY: as above.
        assert_eq!(unsafe { call(instance.handle) }, Error, "call {number}");
        instance.log.only();
    }
}

#[test]
fn impossible_experiments_are_errors() {
    for (defined, tolerance, start, stop) in [
        (1, 0.0, 0.0, 1.0),
        (1, f64::NAN, 0.0, 1.0),
        (0, 0.0, f64::NAN, 1.0),
        (0, 0.0, 2.0, 1.0),
    ] {
        let mut instance = Fmi2::new();
        // SAFETY: no pointers but the handle.
        let status =
            unsafe { fmi2SetupExperiment(instance.handle, defined, tolerance, start, 1, stop) };
        assert_eq!(status, Error);
        instance.log.only();
    }
}

#[test]
fn freed_instances_stay_dead() {
    let instance = Fmi2::running();
    fmi2FreeInstance(instance.handle);
    fmi2FreeInstance(instance.handle);
    fmi2FreeInstance(NULL);
    assert_eq!(instance.step(0.0, 0.1), Error);
    assert_eq!(instance.set(U, 1.0), Error);
}

#[test]
fn status_queries_answer_what_a_synchronous_component_knows() {
    let mut instance = Fmi2::running();
    instance.step(0.0, 0.25);
    let (mut time, mut terminated, mut status) = (0.0, 9, Error);
    // SAFETY: places of the results.
    unsafe {
        let c = instance.handle;
        assert_eq!(fmi2GetRealStatus(c, LAST_SUCCESSFUL_TIME, &mut time), Ok);
        assert_eq!(fmi2GetBooleanStatus(c, TERMINATED, &mut terminated), Ok);
        assert_eq!(fmi2GetStatus(c, DO_STEP_STATUS, &mut status), Ok);
        assert_eq!((time, terminated, status), (0.25, 0, Ok));
        assert_eq!(
            fmi2GetStringStatus(c, PENDING_STATUS, ptr::null_mut()),
            Discard
        );
        assert!(instance.log.only().contains("synchronous"));
        assert_eq!(fmi2GetIntegerStatus(c, 17, ptr::null_mut()), Discard);
        instance.log.only();
    }
    assert_eq!(instance.step(0.25, 0.1), Ok);
}

#[test]
fn logging_follows_its_switch_but_errors_are_always_said() {
    let mut instance = Fmi2::running();
    instance.set(U, 3.0);
    instance.step(0.0, 1.0);
    assert!(instance.log.take().is_empty());
    let events: [*const c_char; 1] = [c"logEvents".as_ptr()];
    // SAFETY: one category.
    unsafe {
        assert_eq!(
            fmi2SetDebugLogging(instance.handle, 1, 1, events.as_ptr()),
            Ok
        );
        instance.set(U, -3.0);
        instance.step(1.0, 5.0);
        let (status, category, message) = instance.log.take().remove(0);
        assert_eq!((status, category.as_str()), (0, "logEvents"));
        assert!(message.contains("x passed"));
        let unknown: [*const c_char; 1] = [c"100% #1".as_ptr()];
        assert_eq!(
            fmi2SetDebugLogging(instance.handle, 1, 1, unknown.as_ptr()),
            Warning
        );
        assert!(instance.log.only().contains("100%% ##1"));
        let null: [*const c_char; 1] = [ptr::null()];
        assert_eq!(
            fmi2SetDebugLogging(instance.handle, 1, 1, null.as_ptr()),
            Error
        );
    }
}

#[test]
fn thousands_of_instances_come_and_go() {
    for _ in 0..2_000 {
        let instance = Fmi2::running();
        assert_eq!(instance.step(0.0, 0.1), Ok);
    }
}
