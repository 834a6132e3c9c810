//! The C interface of FMI 3.0 for co-simulation.
#![allow(non_snake_case, reason = "the standard names its functions so")]

use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::ptr;

use crate::guard::{contain, exports, forwarded, missing, place, slice, slice_mut, unsupported};
use crate::instance::{Instance, Log, Refused};
use crate::opening::{Opening, OpeningError, open};
use crate::original::{ERROR, Handle, Original, OriginalError, Text, symbol};
use crate::states;

type References = *const c_uint;
type Logger = unsafe extern "C" fn(Handle, c_int, Text, Text);
type Callback = *const c_void;

struct Messages {
    logger: Option<Logger>,
    environment: Handle,
    is_on: bool,
}

// SAFETY: the environment is only handed back, and an importer may move an instance between threads.
unsafe impl Send for Messages {}

impl Log for Messages {
    fn say(&self, status: c_int, message: &CString) {
        if let Some(logger) = self.logger
            && self.is_on
        {
            // SAFETY: the importer gave this function for this purpose.
            unsafe {
                logger(
                    self.environment,
                    status,
                    c"logStatusError".as_ptr(),
                    message.as_ptr(),
                );
            }
        }
    }
}

/// `fmi3GetVersion`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// `fmi3InstantiateCoSimulation`: an instance around a new one of the original, or NULL with a reason in the log. Event mode, early
/// return and intermediate update are not provided, whatever the original has.
///
/// # Safety
/// Pointers are NULL or as the standard describes them.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments, reason = "the standard has as many")]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    name: Text,
    token: Text,
    resource_path: Text,
    visible: u8,
    logging_on: u8,
    _event_mode_used: u8,
    _early_return_allowed: u8,
    _required: References,
    _required_count: usize,
    environment: Handle,
    logger: Option<Logger>,
    _intermediate_update: Callback,
) -> Handle {
    contain(ptr::null_mut(), || {
        let messages = Messages {
            logger,
            environment,
            is_on: logging_on != 0,
        };
        // SAFETY: the caller's promise about the pointers.
        unsafe {
            let text = |text: Text| (!text.is_null()).then(|| CStr::from_ptr(text));
            let made = open(text(token), text(resource_path), true).and_then(|opening| {
                Ok(around(
                    opening,
                    name,
                    [visible, logging_on],
                    environment,
                    logger,
                )?)
            });
            match made {
                Ok((original, settings)) => {
                    match Instance::new(original, settings, Box::new(messages)) {
                        Ok(instance) => Box::into_raw(Box::new(instance)).cast(),
                        Err(_) => ptr::null_mut(),
                    }
                }
                Err(error) => {
                    let text = format!("fmi3InstantiateCoSimulation: {error}").replace('\0', " ");
                    messages.say(ERROR, &CString::new(text).unwrap_or_default());
                    ptr::null_mut()
                }
            }
        }
    })
}

unsafe fn around(
    opening: Opening,
    name: Text,
    [visible, logging_on]: [u8; 2],
    environment: Handle,
    logger: Option<Logger>,
) -> Result<(Original, operations::Settings), OriginalError> {
    type Instantiate = unsafe extern "C" fn(
        Text,
        Text,
        Text,
        u8,
        u8,
        u8,
        u8,
        References,
        usize,
        Handle,
        Option<Logger>,
        Callback,
    ) -> Handle;
    let Opening {
        settings,
        library,
        token,
        resources,
    } = opening;
    // SAFETY: the type is that of the standard's header; the texts outlive the call.
    unsafe {
        let instantiate: Instantiate = symbol(&library, "fmi3InstantiateCoSimulation")?;
        let handle = instantiate(
            name,
            token.as_ptr(),
            resources.as_ptr(),
            visible,
            logging_on,
            0,
            0,
            ptr::null(),
            0,
            environment,
            logger,
            ptr::null(),
        );
        if handle.is_null() {
            return Err(OriginalError::NoInstance);
        }
        Original::new(library, handle, true, settings.can_restore)
            .map(|original| (original, settings))
    }
}

/// Says that there is no instance of another interface.
fn refused(function: &str, logging_on: u8, environment: Handle, logger: Option<Logger>) {
    contain((), || {
        let messages = Messages {
            logger,
            environment,
            is_on: logging_on != 0,
        };
        let text = format!("{function}: {}", OpeningError::Interface);
        messages.say(ERROR, &CString::new(text).unwrap_or_default());
    });
}

/// `fmi3InstantiateModelExchange`: not provided, always NULL.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateModelExchange(
    _name: Text,
    _token: Text,
    _resource_path: Text,
    _visible: u8,
    logging_on: u8,
    environment: Handle,
    logger: Option<Logger>,
) -> Handle {
    refused(
        "fmi3InstantiateModelExchange",
        logging_on,
        environment,
        logger,
    );
    ptr::null_mut()
}

/// `fmi3InstantiateScheduledExecution`: not provided, always NULL.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments, reason = "the standard has as many")]
pub extern "C" fn fmi3InstantiateScheduledExecution(
    _name: Text,
    _token: Text,
    _resource_path: Text,
    _visible: u8,
    logging_on: u8,
    environment: Handle,
    logger: Option<Logger>,
    _clock_update: Callback,
    _lock_preemption: Callback,
    _unlock_preemption: Callback,
) -> Handle {
    refused(
        "fmi3InstantiateScheduledExecution",
        logging_on,
        environment,
        logger,
    );
    ptr::null_mut()
}

/// `fmi3FreeInstance`.
///
/// # Safety
/// The instance is NULL or live, and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: Handle) {
    contain((), || {
        if !instance.is_null() {
            // SAFETY: the caller's promise.
            drop(unsafe { Box::from_raw(instance.cast::<Instance>()) });
        }
    });
}

forwarded! {
    fn fmi3SetDebugLogging(on: u8, count: usize, categories: *const Text);
    fn fmi3ExitInitializationMode();
    fn fmi3EnterConfigurationMode();
    fn fmi3ExitConfigurationMode();
    fn fmi3Terminate();
    fn fmi3GetFloat32(references: References, count: usize, values: *mut f32, value_count: usize);
    fn fmi3SetFloat32(references: References, count: usize, values: *const f32, value_count: usize);
    fn fmi3GetInt8(references: References, count: usize, values: *mut i8, value_count: usize);
    fn fmi3SetInt8(references: References, count: usize, values: *const i8, value_count: usize);
    fn fmi3GetUInt8(references: References, count: usize, values: *mut u8, value_count: usize);
    fn fmi3SetUInt8(references: References, count: usize, values: *const u8, value_count: usize);
    fn fmi3GetInt16(references: References, count: usize, values: *mut i16, value_count: usize);
    fn fmi3SetInt16(references: References, count: usize, values: *const i16, value_count: usize);
    fn fmi3GetUInt16(references: References, count: usize, values: *mut u16, value_count: usize);
    fn fmi3SetUInt16(references: References, count: usize, values: *const u16, value_count: usize);
    fn fmi3GetInt32(references: References, count: usize, values: *mut i32, value_count: usize);
    fn fmi3SetInt32(references: References, count: usize, values: *const i32, value_count: usize);
    fn fmi3GetUInt32(references: References, count: usize, values: *mut u32, value_count: usize);
    fn fmi3SetUInt32(references: References, count: usize, values: *const u32, value_count: usize);
    fn fmi3GetInt64(references: References, count: usize, values: *mut i64, value_count: usize);
    fn fmi3SetInt64(references: References, count: usize, values: *const i64, value_count: usize);
    fn fmi3GetUInt64(references: References, count: usize, values: *mut u64, value_count: usize);
    fn fmi3SetUInt64(references: References, count: usize, values: *const u64, value_count: usize);
    fn fmi3GetBoolean(references: References, count: usize, values: *mut u8, value_count: usize);
    fn fmi3SetBoolean(references: References, count: usize, values: *const u8, value_count: usize);
    fn fmi3GetString(references: References, count: usize, values: *mut Text, value_count: usize);
    fn fmi3SetString(references: References, count: usize, values: *const Text, value_count: usize);
    fn fmi3GetBinary(references: References, count: usize, sizes: *mut usize, values: *mut *const u8, value_count: usize);
    fn fmi3SetBinary(references: References, count: usize, sizes: *const usize, values: *const *const u8, value_count: usize);
    fn fmi3GetClock(references: References, count: usize, values: *mut u8);
    fn fmi3SetClock(references: References, count: usize, values: *const u8);
    fn fmi3GetIntervalDecimal(references: References, count: usize, intervals: *mut f64, qualifiers: *mut c_int);
    fn fmi3GetIntervalFraction(references: References, count: usize, counters: *mut u64, resolutions: *mut u64, qualifiers: *mut c_int);
    fn fmi3GetShiftDecimal(references: References, count: usize, shifts: *mut f64);
    fn fmi3GetShiftFraction(references: References, count: usize, counters: *mut u64, resolutions: *mut u64);
    fn fmi3SetIntervalDecimal(references: References, count: usize, intervals: *const f64);
    fn fmi3SetIntervalFraction(references: References, count: usize, counters: *const u64, resolutions: *const u64);
    fn fmi3SetShiftDecimal(references: References, count: usize, shifts: *const f64);
    fn fmi3SetShiftFraction(references: References, count: usize, counters: *const u64, resolutions: *const u64);
}

const NOT_HERE: &str = "the effects change what the original would answer; modelDescription.xml says that this is not provided";
const EXCHANGE: &str = "this FMU is for co-simulation";
const EVENTS: &str = "modelDescription.xml says that event mode is not provided: the original handles its events inside its steps";

unsupported! {
    fn fmi3GetDirectionalDerivative(References, usize, References, usize, *const f64, usize, *mut f64, usize) because NOT_HERE;
    fn fmi3GetAdjointDerivative(References, usize, References, usize, *const f64, usize, *mut f64, usize) because NOT_HERE;
    fn fmi3GetOutputDerivatives(References, usize, *const i32, *mut f64, usize) because NOT_HERE;
    fn fmi3GetNumberOfVariableDependencies(c_uint, *mut usize) because NOT_HERE;
    fn fmi3GetVariableDependencies(c_uint, *mut usize, *mut c_uint, *mut usize, *mut c_int, usize) because NOT_HERE;
    fn fmi3EnterEventMode() because EVENTS;
    fn fmi3EvaluateDiscreteStates() because EVENTS;
    fn fmi3UpdateDiscreteStates(*mut u8, *mut u8, *mut u8, *mut u8, *mut u8, *mut f64) because EVENTS;
    fn fmi3EnterStepMode() because EVENTS;
    fn fmi3EnterContinuousTimeMode() because EXCHANGE;
    fn fmi3CompletedIntegratorStep(u8, *mut u8, *mut u8) because EXCHANGE;
    fn fmi3SetTime(f64) because EXCHANGE;
    fn fmi3SetContinuousStates(*const f64, usize) because EXCHANGE;
    fn fmi3GetContinuousStateDerivatives(*mut f64, usize) because EXCHANGE;
    fn fmi3GetEventIndicators(*mut f64, usize) because EXCHANGE;
    fn fmi3GetContinuousStates(*mut f64, usize) because EXCHANGE;
    fn fmi3GetNominalsOfContinuousStates(*mut f64, usize) because EXCHANGE;
    fn fmi3GetNumberOfEventIndicators(*mut usize) because EXCHANGE;
    fn fmi3GetNumberOfContinuousStates(*mut usize) because EXCHANGE;
    fn fmi3ActivateModelPartition(c_uint, f64) because "this FMU is for co-simulation, not for scheduled execution";
}

exports! {
    fn fmi3EnterInitializationMode(|instance| has_tolerance: u8, tolerance: f64, start: f64, has_stop: u8, stop: f64) => {
        type Enter = unsafe extern "C" fn(Handle, u8, f64, f64, u8, f64) -> c_int;
        instance.starts(start);
        let enter: Enter = instance.original.function("fmi3EnterInitializationMode").map_err(missing)?;
        Ok(enter(instance.original.handle, has_tolerance, tolerance, start, has_stop, stop))
    };
    fn fmi3Reset(|instance|) => {
        let reset: unsafe extern "C" fn(Handle) -> c_int = instance.original.function("fmi3Reset").map_err(missing)?;
        let status = reset(instance.original.handle);
        instance.reset()?;
        Ok(status)
    };
    fn fmi3GetFloat64(|instance| references: References, count: usize, values: *mut f64, value_count: usize) => {
        type Get = unsafe extern "C" fn(Handle, References, usize, *mut f64, usize) -> c_int;
        let known = slice(references, count, "valueReferences")?;
        if !instance.has_own(known) {
            let get: Get = instance.original.function("fmi3GetFloat64").map_err(missing)?;
            return Ok(get(instance.original.handle, references, count, values, value_count));
        }
        if count != value_count {
            return Err(apart());
        }
        instance.reals(known, slice_mut(values, count, "values")?).map(|()| 0)
    };
    fn fmi3SetFloat64(|instance| references: References, count: usize, values: *const f64, value_count: usize) => {
        type Set = unsafe extern "C" fn(Handle, References, usize, *const f64, usize) -> c_int;
        let known = slice(references, count, "valueReferences")?;
        if !instance.has_own(known) {
            let set: Set = instance.original.function("fmi3SetFloat64").map_err(missing)?;
            return Ok(set(instance.original.handle, references, count, values, value_count));
        }
        if count != value_count {
            return Err(apart());
        }
        instance.set_reals(known, slice(values, count, "values")?).map(|()| 0)
    };
    fn fmi3DoStep(|instance| point: f64, size: f64, _no_set_state_before: u8, event_needed: *mut u8, terminate: *mut u8, early_return: *mut u8, last_time: *mut f64) => {
        let (event_needed, terminate) = (place(event_needed)?, place(terminate)?);
        let (early_return, last_time) = (place(early_return)?, place(last_time)?);
        (*event_needed, *terminate, *early_return, *last_time) = (0, 0, 0, point);
        let stepped = instance.step(point, size)?;
        *terminate = u8::from(stepped.ends);
        *early_return = u8::from(stepped.time < point + size);
        *last_time = stepped.time;
        Ok(stepped.status)
    };
    fn fmi3GetFMUState(|instance| state: *mut Handle) => states::get(instance, state);
    fn fmi3SetFMUState(|instance| state: Handle) => states::set(instance, state);
    fn fmi3FreeFMUState(|instance| state: *mut Handle) => states::free(instance, state);
    fn fmi3SerializedFMUStateSize(|instance| state: Handle, size: *mut usize) =>
        states::size(instance, "fmi3SerializedFMUStateSize", state, size);
    fn fmi3SerializeFMUState(|instance| state: Handle, bytes: *mut u8, count: usize) =>
        states::serialize(instance, "fmi3SerializeFMUState", state, (bytes, count));
    fn fmi3DeserializeFMUState(|instance| bytes: *const u8, count: usize, state: *mut Handle) =>
        states::deserialize(instance, "fmi3DeserializeFMUState", (bytes, count), state);
}

fn apart() -> Refused {
    Refused::error(
        "arrays must be read and set apart from the effects' variables and the port's input",
    )
}
