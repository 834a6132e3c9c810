//! The C interface of FMI 2.0 for co-simulation.
#![allow(non_snake_case, reason = "the standard names its functions so")]

use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::ptr;

use crate::guard::{contain, exports, forwarded, missing, slice, slice_mut, unsupported};
use crate::instance::{Instance, Log};
use crate::opening::{Opening, OpeningError, open};
use crate::original::{ERROR, Handle, Original, OriginalError, Text, symbol};
use crate::states;

type References = *const c_uint;
type Logger = unsafe extern "C" fn(Handle, Text, c_int, Text, Text, ...);

/// `fmi2CallbackFunctions`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CallbackFunctions {
    /// Takes messages.
    pub logger: Option<Logger>,
    /// For the original.
    pub allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// For the original.
    pub free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// For the original.
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, c_int)>,
    /// Handed back to the logger.
    pub component_environment: *mut c_void,
}

struct Messages {
    functions: CallbackFunctions,
    name: CString,
}

// SAFETY: the environment is only handed back, and an importer may move an instance between threads.
unsafe impl Send for Messages {}

impl Log for Messages {
    fn say(&self, status: c_int, message: &CString) {
        if let Some(logger) = self.functions.logger {
            // SAFETY: the importer gave this function for this purpose; the format has one text and gets one.
            unsafe {
                logger(
                    self.functions.component_environment,
                    self.name.as_ptr(),
                    status,
                    c"logStatusError".as_ptr(),
                    c"%s".as_ptr(),
                    message.as_ptr(),
                );
            }
        }
    }
}

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

/// `fmi2Instantiate`: an instance around a new one of the original, or NULL with a reason in the log.
///
/// # Safety
/// Pointers are NULL or as the standard describes them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: Text,
    kind: c_int,
    guid: Text,
    location: Text,
    functions: *const CallbackFunctions,
    visible: c_int,
    logging_on: c_int,
) -> Handle {
    contain(ptr::null_mut(), || {
        if functions.is_null() || !functions.is_aligned() || name.is_null() {
            return ptr::null_mut();
        }
        // SAFETY: the caller's promise about the pointers.
        unsafe {
            let messages = Messages {
                functions: functions.read(),
                name: CStr::from_ptr(name).to_owned(),
            };
            let made = if kind == 1 {
                open(optional(guid), optional(location), false).and_then(|opening| {
                    Ok(around(opening, name, functions, [visible, logging_on])?)
                })
            } else {
                Err(OpeningError::Interface)
            };
            match made {
                Ok((original, settings)) => {
                    match Instance::new(original, settings, Box::new(messages)) {
                        Ok(instance) => Box::into_raw(Box::new(instance)).cast(),
                        Err(_) => ptr::null_mut(),
                    }
                }
                Err(error) => {
                    let text = format!("fmi2Instantiate: {error}").replace('\0', " ");
                    messages.say(ERROR, &CString::new(text).unwrap_or_default());
                    ptr::null_mut()
                }
            }
        }
    })
}

unsafe fn optional<'a>(text: Text) -> Option<&'a CStr> {
    // SAFETY: the caller's text is NULL or ends in a null.
    (!text.is_null()).then(|| unsafe { CStr::from_ptr(text) })
}

unsafe fn around(
    opening: Opening,
    name: Text,
    functions: *const CallbackFunctions,
    [visible, logging_on]: [c_int; 2],
) -> Result<(Original, operations::Settings), OriginalError> {
    type Instantiate = unsafe extern "C" fn(
        Text,
        c_int,
        Text,
        Text,
        *const CallbackFunctions,
        c_int,
        c_int,
    ) -> Handle;
    let Opening {
        settings,
        library,
        token,
        resources,
    } = opening;
    // SAFETY: the type is that of the standard's header; the texts outlive the call.
    unsafe {
        let instantiate: Instantiate = symbol(&library, "fmi2Instantiate")?;
        let handle = instantiate(
            name,
            1,
            token.as_ptr(),
            resources.as_ptr(),
            functions,
            visible,
            logging_on,
        );
        if handle.is_null() {
            return Err(OriginalError::NoInstance);
        }
        Original::new(library, handle, false, settings.can_restore)
            .map(|original| (original, settings))
    }
}

/// `fmi2FreeInstance`.
///
/// # Safety
/// The instance is NULL or live, and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(instance: Handle) {
    contain((), || {
        if !instance.is_null() {
            // SAFETY: the caller's promise.
            drop(unsafe { Box::from_raw(instance.cast::<Instance>()) });
        }
    });
}

forwarded! {
    fn fmi2SetDebugLogging(on: c_int, count: usize, categories: *const Text);
    fn fmi2EnterInitializationMode();
    fn fmi2ExitInitializationMode();
    fn fmi2Terminate();
    fn fmi2GetInteger(references: References, count: usize, values: *mut c_int);
    fn fmi2GetBoolean(references: References, count: usize, values: *mut c_int);
    fn fmi2GetString(references: References, count: usize, values: *mut Text);
    fn fmi2SetInteger(references: References, count: usize, values: *const c_int);
    fn fmi2SetBoolean(references: References, count: usize, values: *const c_int);
    fn fmi2SetString(references: References, count: usize, values: *const Text);
    fn fmi2GetStatus(kind: c_int, value: *mut c_int);
    fn fmi2GetRealStatus(kind: c_int, value: *mut f64);
    fn fmi2GetIntegerStatus(kind: c_int, value: *mut c_int);
    fn fmi2GetBooleanStatus(kind: c_int, value: *mut c_int);
    fn fmi2GetStringStatus(kind: c_int, value: *mut Text);
}

const NOT_HERE: &str = "the effects change what the original would answer; modelDescription.xml says that this is not provided";
const EXCHANGE: &str = "this FMU is for co-simulation";

unsupported! {
    fn fmi2GetDirectionalDerivative(References, usize, References, usize, *const f64, *mut f64) because NOT_HERE;
    fn fmi2SetRealInputDerivatives(References, usize, *const c_int, *const f64) because NOT_HERE;
    fn fmi2GetRealOutputDerivatives(References, usize, *const c_int, *mut f64) because NOT_HERE;
    fn fmi2CancelStep() because "every step is synchronous: there is none to cancel";
    fn fmi2EnterEventMode() because EXCHANGE;
    fn fmi2NewDiscreteStates(*mut c_void) because EXCHANGE;
    fn fmi2EnterContinuousTimeMode() because EXCHANGE;
    fn fmi2CompletedIntegratorStep(c_int, *mut c_int, *mut c_int) because EXCHANGE;
    fn fmi2SetTime(f64) because EXCHANGE;
    fn fmi2SetContinuousStates(*const f64, usize) because EXCHANGE;
    fn fmi2GetDerivatives(*mut f64, usize) because EXCHANGE;
    fn fmi2GetEventIndicators(*mut f64, usize) because EXCHANGE;
    fn fmi2GetContinuousStates(*mut f64, usize) because EXCHANGE;
    fn fmi2GetNominalsOfContinuousStates(*mut f64, usize) because EXCHANGE;
}

exports! {
    fn fmi2SetupExperiment(|instance| has_tolerance: c_int, tolerance: f64, start: f64, has_stop: c_int, stop: f64) => {
        type SetUp = unsafe extern "C" fn(Handle, c_int, f64, f64, c_int, f64) -> c_int;
        instance.starts(start);
        let set_up: SetUp = instance.original.function("fmi2SetupExperiment").map_err(missing)?;
        Ok(set_up(instance.original.handle, has_tolerance, tolerance, start, has_stop, stop))
    };
    fn fmi2Reset(|instance|) => {
        let reset: unsafe extern "C" fn(Handle) -> c_int = instance.original.function("fmi2Reset").map_err(missing)?;
        let status = reset(instance.original.handle);
        instance.reset()?;
        Ok(status)
    };
    fn fmi2GetReal(|instance| references: References, count: usize, values: *mut f64) => {
        type Get = unsafe extern "C" fn(Handle, References, usize, *mut f64) -> c_int;
        let known = slice(references, count, "vr")?;
        if !instance.has_own(known) {
            let get: Get = instance.original.function("fmi2GetReal").map_err(missing)?;
            return Ok(get(instance.original.handle, references, count, values));
        }
        instance.reals(known, slice_mut(values, count, "value")?).map(|()| 0)
    };
    fn fmi2SetReal(|instance| references: References, count: usize, values: *const f64) => {
        type Set = unsafe extern "C" fn(Handle, References, usize, *const f64) -> c_int;
        let known = slice(references, count, "vr")?;
        if !instance.has_own(known) {
            let set: Set = instance.original.function("fmi2SetReal").map_err(missing)?;
            return Ok(set(instance.original.handle, references, count, values));
        }
        instance.set_reals(known, slice(values, count, "value")?).map(|()| 0)
    };
    fn fmi2DoStep(|instance| point: f64, size: f64, _no_set_state_before: c_int) =>
        instance.step(point, size).map(|stepped| stepped.status);
    fn fmi2GetFMUstate(|instance| state: *mut Handle) => states::get(instance, state);
    fn fmi2SetFMUstate(|instance| state: Handle) => states::set(instance, state);
    fn fmi2FreeFMUstate(|instance| state: *mut Handle) => states::free(instance, state);
    fn fmi2SerializedFMUstateSize(|instance| state: Handle, size: *mut usize) =>
        states::size(instance, "fmi2SerializedFMUstateSize", state, size);
    fn fmi2SerializeFMUstate(|instance| state: Handle, bytes: *mut u8, count: usize) =>
        states::serialize(instance, "fmi2SerializeFMUstate", state, (bytes, count));
    fn fmi2DeSerializeFMUstate(|instance| bytes: *const u8, count: usize, state: *mut Handle) =>
        states::deserialize(instance, "fmi2DeSerializeFMUstate", (bytes, count), state);
}
