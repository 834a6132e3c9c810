//! Functions of FMI 2 that model exchange and co-simulation share.
#![allow(non_snake_case, reason = "the standard names its functions so")]

use super::types::{
    Boolean, CO_SIMULATION, CallbackFunctions, Handle, Integer, MODEL_EXCHANGE, Real, Text, Type,
    ValueReference,
};
use crate::cosim::{VariableType, open, open_for_exchange};
use crate::ffi::guard::{contain, exports, free};
use crate::ffi::instantiate::{Open, Request, instantiate};
use crate::ffi::log::Callback;
use crate::ffi::pointers::{input, output, place, text, texts};
use crate::ffi::status::{ANY, Interface, Phase, Phases};
use std::ffi::c_char;
use std::ptr;

const INSTANTIATED: Phases = Phases::of(&[Phase::Instantiated]);
const INITIALIZATION: Phases = Phases::of(&[Phase::Initialization]);
const INITIALIZED: Phases = Phases::of(&[Phase::Step, Phase::Event, Phase::ContinuousTime]);
pub(super) const READABLE: Phases = Phases::of(&[
    Phase::Initialization,
    Phase::Step,
    Phase::Event,
    Phase::ContinuousTime,
    Phase::Terminated,
    Phase::Failed,
]);
const SETTABLE: Phases = Phases::of(&[
    Phase::Instantiated,
    Phase::Initialization,
    Phase::Step,
    Phase::Event,
    Phase::ContinuousTime,
]);

/// `fmi2GetTypesPlatform`: the standard's default types.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// `fmi2GetVersion`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// `fmi2Instantiate`: a new instance for model exchange or co-simulation, or NULL with a reason in the log.
///
/// # Safety
/// Pointers are NULL or as the standard describes them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instance_name: Text,
    kind: Type,
    guid: Text,
    resource_location: Text,
    functions: *const CallbackFunctions,
    _visible: Boolean,
    logging_on: Boolean,
) -> Handle {
    let open = if kind == MODEL_EXCHANGE {
        open_for_exchange
    } else {
        open
    };
    let texts = [instance_name, guid, resource_location];
    // SAFETY: the caller's promise about the pointers.
    unsafe { new_instance(open, kind, texts, functions, logging_on) }
}

/// A new instance of the model that `open` makes, or NULL with a reason in the log.
///
/// # Safety
/// Pointers are NULL or as the standard describes them.
pub(in crate::ffi) unsafe fn new_instance(
    open: Open,
    kind: Type,
    texts: [Text; 3],
    functions: *const CallbackFunctions,
    logging_on: Boolean,
) -> Handle {
    contain(ptr::null_mut(), || {
        if functions.is_null() || !functions.is_aligned() {
            return ptr::null_mut();
        }
        // SAFETY: the caller's promise about the pointers.
        let functions = unsafe { functions.read() };
        // SAFETY: as above.
        let [instance_name, token, resources] = texts.map(|pointer| unsafe { text(pointer) });
        let request = Request {
            function: "fmi2Instantiate",
            open,
            instance_name,
            token,
            resources,
            logging_on: logging_on != 0,
            environment: functions.component_environment,
            callback: Callback::Fmi2(functions.logger),
        };
        instantiate(&request, |_| {
            if kind == CO_SIMULATION || kind == MODEL_EXCHANGE {
                return Ok(());
            }
            Err(format!(
                "fmuType = {kind}, but there are only model exchange ({MODEL_EXCHANGE}) and co-simulation ({CO_SIMULATION})"
            ))
        })
    })
}

/// `fmi2FreeInstance`: NULL and handles that were freed before are left alone.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2FreeInstance(instance: Handle) {
    free(Interface::Fmi2, instance);
}

exports! { Interface::Fmi2;
    fn fmi2SetDebugLogging(|instance| on: Boolean, count: usize, categories: *const Text) in ANY =>
        instance.set_debug_logging(on != 0, &texts(categories, count, "categories")?);

    fn fmi2SetupExperiment(|instance| tolerance_defined: Boolean, tolerance: Real, start: Real, stop_defined: Boolean, stop: Real) in INSTANTIATED =>
        instance.set_up((tolerance_defined != 0).then_some(tolerance), start, (stop_defined != 0).then_some(stop));
    fn fmi2EnterInitializationMode(|instance|) in INSTANTIATED => instance.enter(Phase::Initialization);
    fn fmi2ExitInitializationMode(|instance|) in INITIALIZATION => instance.initialise();
    fn fmi2Terminate(|instance|) in INITIALIZED => instance.enter(Phase::Terminated);
    fn fmi2Reset(|instance|) in ANY => instance.reset();

    #[often]
    fn fmi2GetReal(|instance| references: *const ValueReference, count: usize, values: *mut Real) in READABLE =>
        instance.get_reals(input(references, count, "vr")?, &mut output(values, count, "value")?);
    fn fmi2GetBoolean(|instance| references: *const ValueReference, count: usize, values: *mut Boolean) in READABLE =>
        instance.get_booleans(input(references, count, "vr")?, &mut output(values, count, "value")?);
    fn fmi2GetInteger(|instance| references: *const ValueReference, count: usize, _values: *mut Integer) in READABLE =>
        instance.no_variable_of_type(input(references, count, "vr")?, "an integer");
    fn fmi2GetString(|instance| references: *const ValueReference, count: usize, _values: *mut Text) in READABLE =>
        instance.no_variable_of_type(input(references, count, "vr")?, "a string");

    #[often]
    fn fmi2SetReal(|instance| references: *const ValueReference, count: usize, values: *const Real) in SETTABLE =>
        instance.set_reals(input(references, count, "vr")?, input(values, count, "value")?);
    fn fmi2SetBoolean(|instance| references: *const ValueReference, count: usize, _values: *const Boolean) in SETTABLE =>
        instance.set_none(input(references, count, "vr")?, VariableType::Boolean);
    fn fmi2SetInteger(|instance| references: *const ValueReference, count: usize, _values: *const Integer) in SETTABLE =>
        instance.no_variable_of_type(input(references, count, "vr")?, "an integer");
    fn fmi2SetString(|instance| references: *const ValueReference, count: usize, _values: *const Text) in SETTABLE =>
        instance.no_variable_of_type(input(references, count, "vr")?, "a string");

    fn fmi2GetFMUstate(|instance| state: *mut Handle) in ANY => {
        let mut state_out = place(state, "FMUstate")?;
        state_out.write(0, instance.get_state(state.read())?);
        Ok(())
    };
    fn fmi2SetFMUstate(|instance| state: Handle) in ANY => instance.set_state(state);
    fn fmi2FreeFMUstate(|instance| state: *mut Handle) in ANY => instance.free_state(state);
    fn fmi2SerializedFMUstateSize(|instance| state: Handle, size: *mut usize) in ANY => {
        place(size, "size")?.write(0, instance.serialized_size(state)?);
        Ok(())
    };
    fn fmi2SerializeFMUstate(|instance| state: Handle, bytes: *mut u8, size: usize) in ANY =>
        instance.serialize(state, &mut output(bytes, size, "serializedState")?, size);
    fn fmi2DeSerializeFMUstate(|instance| bytes: *const u8, size: usize, state: *mut Handle) in ANY => {
        let mut state = place(state, "FMUstate")?;
        state.write(0, instance.deserialize(input(bytes, size, "serializedState")?)?);
        Ok(())
    };

    fn fmi2GetDirectionalDerivative(|instance| unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize, seed: *const Real, sensitivity: *mut Real) in READABLE =>
        instance.directional_derivative(
            input(unknowns, unknown_count, "vUnknown_ref")?,
            input(knowns, known_count, "vKnown_ref")?,
            input(seed, known_count, "dvKnown")?,
            &mut output(sensitivity, unknown_count, "dvUnknown")?,
        );
}
