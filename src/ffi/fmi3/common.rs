//! Functions of FMI 3 that all interface types share, values apart.
#![allow(non_snake_case, reason = "the standard names its functions so")]

use super::do_step::IntermediateUpdate;
use super::types::{
    Boolean, ClockUpdateCallback, Float64, Handle, IntermediateUpdateCallback, PreemptionCallback,
    Text, ValueReference,
};
use crate::cosim::{open, open_for_exchange};
use crate::ffi::Fmi3Logger;
use crate::ffi::guard::{contain, exports, free};
use crate::ffi::instance::Instance;
use crate::ffi::instantiate::{Open, Request, instantiate};
use crate::ffi::log::Callback;
use crate::ffi::pointers::{input, output, place, same_length, text, texts};
use crate::ffi::status::{ANY, Interface, Phase, Phases};
use std::ffi::{c_char, c_void};
use std::ptr;

const INSTANTIATED: Phases = Phases::of(&[Phase::Instantiated]);
const CONFIGURATION: Phases = Phases::of(&[Phase::Configuration]);
const INITIALIZATION: Phases = Phases::of(&[Phase::Initialization]);
const INITIALIZED: Phases = Phases::of(&[Phase::Step, Phase::Event, Phase::ContinuousTime]);
const EVALUABLE: Phases = Phases::of(&[
    Phase::Initialization,
    Phase::Step,
    Phase::Event,
    Phase::ContinuousTime,
    Phase::IntermediateUpdate,
    Phase::Terminated,
]);

/// `fmi3GetVersion`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// A new instance, or NULL with a reason in the log.
///
/// # Safety
/// Pointers are NULL or as the standard describes them.
pub(in crate::ffi) unsafe fn new_instance(
    function: &'static str,
    open: Open,
    texts: [Text; 3],
    logging_on: Boolean,
    environment: *mut c_void,
    logger: Option<Fmi3Logger>,
    configure: impl FnOnce(&mut Instance) -> Result<(), String>,
) -> Handle {
    contain(ptr::null_mut(), || {
        // SAFETY: the caller's promise about the pointers.
        let [instance_name, token, resources] = texts.map(|pointer| unsafe { text(pointer) });
        let request = Request {
            function,
            open,
            instance_name,
            token,
            resources,
            logging_on: logging_on != 0,
            environment,
            callback: Callback::Fmi3(logger),
        };
        instantiate(&request, configure)
    })
}

/// NULL, with the reason in the log.
///
/// # Safety
/// Pointers are NULL or as the standard describes them.
unsafe fn no_instance(
    function: &'static str,
    reason: String,
    texts: [Text; 3],
    logging_on: Boolean,
    environment: *mut c_void,
    logger: Option<Fmi3Logger>,
) -> Handle {
    // SAFETY: the caller's promise about the pointers.
    unsafe {
        new_instance(
            function,
            open,
            texts,
            logging_on,
            environment,
            logger,
            |_| Err(reason),
        )
    }
}

/// `fmi3InstantiateCoSimulation`.
///
/// # Safety
/// Pointers are NULL or as the standard describes them.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments, reason = "the standard has as many")]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    instance_name: Text,
    token: Text,
    resource_path: Text,
    _visible: Boolean,
    logging_on: Boolean,
    event_mode_used: Boolean,
    early_return_allowed: Boolean,
    required_intermediate_variables: *const ValueReference,
    required_intermediate_variable_count: usize,
    environment: *mut c_void,
    logger: Option<Fmi3Logger>,
    intermediate_update: Option<IntermediateUpdateCallback>,
) -> Handle {
    let texts = [instance_name, token, resource_path];
    // SAFETY: the caller's promise about the pointers.
    unsafe {
        new_instance(
            "fmi3InstantiateCoSimulation",
            open,
            texts,
            logging_on,
            environment,
            logger,
            |instance| {
                let required = input(
                    required_intermediate_variables,
                    required_intermediate_variable_count,
                    "requiredIntermediateVariables",
                );
                instance.require_intermediate(required.map_err(|refusal| refusal.message)?)?;
                instance.intermediate_update =
                    intermediate_update.map(|callback| IntermediateUpdate {
                        callback,
                        environment,
                    });
                instance.event_mode_used = event_mode_used != 0;
                instance.early_return_allowed = early_return_allowed != 0;
                Ok(())
            },
        )
    }
}

/// `fmi3InstantiateModelExchange`.
///
/// # Safety
/// Pointers are NULL or as the standard describes them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    instance_name: Text,
    token: Text,
    resource_path: Text,
    _visible: Boolean,
    logging_on: Boolean,
    environment: *mut c_void,
    logger: Option<Fmi3Logger>,
) -> Handle {
    let texts = [instance_name, token, resource_path];
    // SAFETY: the caller's promise about the pointers.
    unsafe {
        new_instance(
            "fmi3InstantiateModelExchange",
            open_for_exchange,
            texts,
            logging_on,
            environment,
            logger,
            |_| Ok(()),
        )
    }
}

/// `fmi3InstantiateScheduledExecution`: not supported, always NULL.
///
/// # Safety
/// Pointers are NULL or as the standard describes them.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments, reason = "the standard has as many")]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    instance_name: Text,
    token: Text,
    resource_path: Text,
    _visible: Boolean,
    logging_on: Boolean,
    environment: *mut c_void,
    logger: Option<Fmi3Logger>,
    _clock_update: Option<ClockUpdateCallback>,
    _lock_preemption: Option<PreemptionCallback>,
    _unlock_preemption: Option<PreemptionCallback>,
) -> Handle {
    let texts = [instance_name, token, resource_path];
    // SAFETY: the caller's promise about the pointers.
    unsafe {
        no_instance(
            "fmi3InstantiateScheduledExecution",
            "scheduled execution is not supported; this component is for co-simulation and model exchange".into(),
            texts,
            logging_on,
            environment,
            logger,
        )
    }
}

/// `fmi3FreeInstance`: NULL and handles that were freed before are left alone.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3FreeInstance(instance: Handle) {
    free(Interface::Fmi3, instance);
}

exports! { Interface::Fmi3;
    fn fmi3SetDebugLogging(|instance| on: Boolean, count: usize, categories: *const Text) in ANY =>
        instance.set_debug_logging(on != 0, &texts(categories, count, "categories")?);

    fn fmi3EnterInitializationMode(|instance| tolerance_defined: Boolean, tolerance: Float64, start: Float64, stop_defined: Boolean, stop: Float64) in INSTANTIATED => {
        instance.set_up((tolerance_defined != 0).then_some(tolerance), start, (stop_defined != 0).then_some(stop))?;
        instance.enter(Phase::Initialization)
    };
    fn fmi3ExitInitializationMode(|instance|) in INITIALIZATION => instance.initialise();
    fn fmi3EnterConfigurationMode(|instance|) in INSTANTIATED => instance.enter(Phase::Configuration);
    fn fmi3ExitConfigurationMode(|instance|) in CONFIGURATION => instance.enter(Phase::Instantiated);
    fn fmi3Terminate(|instance|) in INITIALIZED => instance.enter(Phase::Terminated);
    fn fmi3Reset(|instance|) in ANY => instance.reset();

    fn fmi3GetFMUState(|instance| state: *mut Handle) in ANY => {
        let mut state_out = place(state, "FMUState")?;
        state_out.write(0, instance.get_state(state.read())?);
        Ok(())
    };
    fn fmi3SetFMUState(|instance| state: Handle) in ANY => instance.set_state(state);
    fn fmi3FreeFMUState(|instance| state: *mut Handle) in ANY => instance.free_state(state);
    fn fmi3SerializedFMUStateSize(|instance| state: Handle, size: *mut usize) in ANY => {
        place(size, "size")?.write(0, instance.serialized_size(state)?);
        Ok(())
    };
    fn fmi3SerializeFMUState(|instance| state: Handle, bytes: *mut u8, size: usize) in ANY =>
        instance.serialize(state, &mut output(bytes, size, "serializedState")?, size);
    fn fmi3DeserializeFMUState(|instance| bytes: *const u8, size: usize, state: *mut Handle) in ANY => {
        let mut state = place(state, "FMUState")?;
        state.write(0, instance.deserialize(input(bytes, size, "serializedState")?)?);
        Ok(())
    };

    fn fmi3GetAdjointDerivative(|instance| unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize, seed: *const Float64, seed_count: usize, sensitivity: *mut Float64, sensitivity_count: usize) in EVALUABLE => {
        same_length(("nSeed", seed_count), ("nUnknowns", unknown_count))?;
        same_length(("nSensitivity", sensitivity_count), ("nKnowns", known_count))?;
        instance.adjoint_derivative(
            input(unknowns, unknown_count, "unknowns")?,
            input(knowns, known_count, "knowns")?,
            input(seed, seed_count, "seed")?,
            &mut output(sensitivity, sensitivity_count, "sensitivity")?,
        )
    };
    fn fmi3GetDirectionalDerivative(|instance| unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize, seed: *const Float64, seed_count: usize, sensitivity: *mut Float64, sensitivity_count: usize) in EVALUABLE => {
        same_length(("nSeed", seed_count), ("nKnowns", known_count))?;
        same_length(("nSensitivity", sensitivity_count), ("nUnknowns", unknown_count))?;
        instance.directional_derivative(
            input(unknowns, unknown_count, "unknowns")?,
            input(knowns, known_count, "knowns")?,
            input(seed, seed_count, "seed")?,
            &mut output(sensitivity, sensitivity_count, "sensitivity")?,
        )
    };
}
