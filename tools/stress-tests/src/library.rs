//! The built library as an importer holds it: loaded from a file, functions found by name.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::ffi::{c_char, c_int, c_void};
use std::path::{Path, PathBuf};
use std::ptr;

use anyhow::{Context, Result};
use stickslip::ffi::Fmi3Logger;
use stickslip::ffi::fmi2::CallbackFunctions;

use crate::log::{logger_2, logger_3};
use crate::program::beside;
use crate::standard::Version;

/// A handle of the library, or what a hostile caller passes in its place.
pub type Handle = *mut c_void;

macro_rules! functions {
    ($(#[$doc:meta])* $name:ident { $($field:ident = $($symbol:literal)|+: fn($($argument:ty),*) $(-> $result:ty)?;)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        #[allow(missing_docs, reason = "named and described by the standard")]
        pub struct $name { $(pub $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)* }

        impl $name {
            /// Finds them by the names that stand at `place` among their names.
            fn find(library: &libloading::Library, place: usize) -> Result<Self> {
                Ok(Self { $($field: {
                    let name = [$($symbol),+][place];
                    // SAFETY: the type is that of the standard's header for this name.
                    *unsafe { library.get(name.as_bytes()) }
                        .with_context(|| format!("the library lacks {name}"))?
                },)* })
            }
        }
    };
}

functions! {
    /// Functions with the same arguments in both versions.
    Both {
        free = "fmi2FreeInstance" | "fmi3FreeInstance": fn(Handle);
        exit_initialization = "fmi2ExitInitializationMode" | "fmi3ExitInitializationMode": fn(Handle) -> c_int;
        terminate = "fmi2Terminate" | "fmi3Terminate": fn(Handle) -> c_int;
        reset = "fmi2Reset" | "fmi3Reset": fn(Handle) -> c_int;
        get_state = "fmi2GetFMUstate" | "fmi3GetFMUState": fn(Handle, *mut Handle) -> c_int;
        set_state = "fmi2SetFMUstate" | "fmi3SetFMUState": fn(Handle, Handle) -> c_int;
        free_state = "fmi2FreeFMUstate" | "fmi3FreeFMUState": fn(Handle, *mut Handle) -> c_int;
        state_size = "fmi2SerializedFMUstateSize" | "fmi3SerializedFMUStateSize": fn(Handle, Handle, *mut usize) -> c_int;
        serialize = "fmi2SerializeFMUstate" | "fmi3SerializeFMUState": fn(Handle, Handle, *mut u8, usize) -> c_int;
        deserialize = "fmi2DeSerializeFMUstate" | "fmi3DeserializeFMUState": fn(Handle, *const u8, usize, *mut Handle) -> c_int;
        set_time = "fmi2SetTime" | "fmi3SetTime": fn(Handle, f64) -> c_int;
    }
}

functions! {
    /// Further functions of FMI 2.
    Fmi2 {
        instantiate = "fmi2Instantiate": fn(*const c_char, c_int, *const c_char, *const c_char, *const CallbackFunctions, c_int, c_int) -> Handle;
        debug = "fmi2SetDebugLogging": fn(Handle, c_int, usize, *const *const c_char) -> c_int;
        set_up = "fmi2SetupExperiment": fn(Handle, c_int, f64, f64, c_int, f64) -> c_int;
        enter_initialization = "fmi2EnterInitializationMode": fn(Handle) -> c_int;
        get_real = "fmi2GetReal": fn(Handle, *const u32, usize, *mut f64) -> c_int;
        get_boolean = "fmi2GetBoolean": fn(Handle, *const u32, usize, *mut c_int) -> c_int;
        get_integer = "fmi2GetInteger": fn(Handle, *const u32, usize, *mut c_int) -> c_int;
        get_string = "fmi2GetString": fn(Handle, *const u32, usize, *mut *const c_char) -> c_int;
        set_real = "fmi2SetReal": fn(Handle, *const u32, usize, *const f64) -> c_int;
        set_boolean = "fmi2SetBoolean": fn(Handle, *const u32, usize, *const c_int) -> c_int;
        set_integer = "fmi2SetInteger": fn(Handle, *const u32, usize, *const c_int) -> c_int;
        set_string = "fmi2SetString": fn(Handle, *const u32, usize, *const *const c_char) -> c_int;
        directional = "fmi2GetDirectionalDerivative": fn(Handle, *const u32, usize, *const u32, usize, *const f64, *mut f64) -> c_int;
        input_derivatives = "fmi2SetRealInputDerivatives": fn(Handle, *const u32, usize, *const c_int, *const f64) -> c_int;
        output_derivatives = "fmi2GetRealOutputDerivatives": fn(Handle, *const u32, usize, *const c_int, *mut f64) -> c_int;
        step = "fmi2DoStep": fn(Handle, f64, f64, c_int) -> c_int;
        cancel = "fmi2CancelStep": fn(Handle) -> c_int;
        get_status = "fmi2GetStatus": fn(Handle, c_int, *mut c_int) -> c_int;
        get_real_status = "fmi2GetRealStatus": fn(Handle, c_int, *mut f64) -> c_int;
        get_integer_status = "fmi2GetIntegerStatus": fn(Handle, c_int, *mut c_int) -> c_int;
        get_boolean_status = "fmi2GetBooleanStatus": fn(Handle, c_int, *mut c_int) -> c_int;
        get_string_status = "fmi2GetStringStatus": fn(Handle, c_int, *mut *const c_char) -> c_int;
        get_derivatives = "fmi2GetDerivatives": fn(Handle, *mut f64, usize) -> c_int;
    }
}

functions! {
    /// Further functions of FMI 3.
    Fmi3 {
        instantiate = "fmi3InstantiateCoSimulation": fn(*const c_char, *const c_char, *const c_char, u8, u8, u8, u8, *const u32, usize, *mut c_void, Option<Fmi3Logger>, *const c_void) -> Handle;
        debug = "fmi3SetDebugLogging": fn(Handle, u8, usize, *const *const c_char) -> c_int;
        enter_initialization = "fmi3EnterInitializationMode": fn(Handle, u8, f64, f64, u8, f64) -> c_int;
        enter_configuration = "fmi3EnterConfigurationMode": fn(Handle) -> c_int;
        exit_configuration = "fmi3ExitConfigurationMode": fn(Handle) -> c_int;
        enter_event = "fmi3EnterEventMode": fn(Handle) -> c_int;
        evaluate = "fmi3EvaluateDiscreteStates": fn(Handle) -> c_int;
        update = "fmi3UpdateDiscreteStates": fn(Handle, *mut u8, *mut u8, *mut u8, *mut u8, *mut u8, *mut f64) -> c_int;
        enter_step = "fmi3EnterStepMode": fn(Handle) -> c_int;
        get_real = "fmi3GetFloat64": fn(Handle, *const u32, usize, *mut f64, usize) -> c_int;
        get_boolean = "fmi3GetBoolean": fn(Handle, *const u32, usize, *mut u8, usize) -> c_int;
        get_integer = "fmi3GetInt32": fn(Handle, *const u32, usize, *mut i32, usize) -> c_int;
        get_string = "fmi3GetString": fn(Handle, *const u32, usize, *mut *const c_char, usize) -> c_int;
        set_real = "fmi3SetFloat64": fn(Handle, *const u32, usize, *const f64, usize) -> c_int;
        set_boolean = "fmi3SetBoolean": fn(Handle, *const u32, usize, *const u8, usize) -> c_int;
        set_integer = "fmi3SetInt32": fn(Handle, *const u32, usize, *const i32, usize) -> c_int;
        set_string = "fmi3SetString": fn(Handle, *const u32, usize, *const *const c_char, usize) -> c_int;
        directional = "fmi3GetDirectionalDerivative": fn(Handle, *const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize) -> c_int;
        output_derivatives = "fmi3GetOutputDerivatives": fn(Handle, *const u32, usize, *const c_int, *mut f64, usize) -> c_int;
        step = "fmi3DoStep": fn(Handle, f64, f64, u8, *mut u8, *mut u8, *mut u8, *mut f64) -> c_int;
        get_interval = "fmi3GetIntervalDecimal": fn(Handle, *const u32, usize, *mut f64, *mut c_int) -> c_int;
    }
}

/// The library, loaded.
pub struct Library {
    both: [Both; 2],
    /// Further functions of FMI 2.
    pub fmi2: Fmi2,
    /// Further functions of FMI 3.
    pub fmi3: Fmi3,
    _loaded: libloading::Library,
}

/// Arguments of an instantiation.
pub(crate) struct Birth {
    pub(crate) name: *const c_char,
    pub(crate) token: *const c_char,
    pub(crate) resources: *const c_char,
    pub(crate) event_mode: bool,
    pub(crate) early_return: bool,
    pub(crate) logging: bool,
    pub(crate) logger: bool,
    pub(crate) environment: *mut c_void,
    /// FMI 2: no callbacks. FMI 3: intermediate variables, which the component does not provide.
    pub(crate) wrong_interface: bool,
}

impl Library {
    /// Loads the library file `path`.
    ///
    /// # Errors
    /// It cannot be loaded, or a function is missing.
    pub fn load(path: &Path) -> Result<Self> {
        // SAFETY: the library's initialisers run; it is our own, or named by the user to be run.
        let loaded = unsafe { libloading::Library::new(path) }
            .with_context(|| format!("{} cannot be loaded", path.display()))?;
        Ok(Self {
            both: [Both::find(&loaded, 0)?, Both::find(&loaded, 1)?],
            fmi2: Fmi2::find(&loaded, 0)?,
            fmi3: Fmi3::find(&loaded, 0)?,
            _loaded: loaded,
        })
    }

    /// The functions of `version` that both versions have alike.
    #[must_use]
    pub fn of(&self, version: Version) -> &Both {
        &self.both[version as usize]
    }

    /// # Safety
    /// The texts end with a zero byte or are NULL; with a logger the environment is that of a live inbox.
    pub(crate) unsafe fn instantiate(&self, version: Version, with: &Birth) -> Handle {
        let (name, token, resources) = (with.name, with.token, with.resources);
        match version {
            Version::Two => {
                let functions = CallbackFunctions {
                    logger: with.logger.then(logger_2),
                    allocate_memory: None,
                    free_memory: None,
                    step_finished: None,
                    component_environment: with.environment,
                };
                let functions = if with.wrong_interface {
                    ptr::null()
                } else {
                    &raw const functions
                };
                let logging = with.logging.into();
                // SAFETY: the caller's promise; the callbacks are copied, or NULL.
                unsafe { (self.fmi2.instantiate)(name, 1, token, resources, functions, 0, logging) }
            }
            // SAFETY: the caller's promise.
            Version::Three => unsafe {
                (self.fmi3.instantiate)(
                    name,
                    token,
                    resources,
                    0,
                    with.logging.into(),
                    with.event_mode.into(),
                    with.early_return.into(),
                    &0,
                    with.wrong_interface.into(),
                    with.environment,
                    with.logger.then(logger_3),
                    ptr::null(),
                )
            },
        }
    }
}

/// The library beside the running program, or one folder up for a test.
///
/// # Errors
/// It is in neither place.
pub fn beside_program() -> Result<PathBuf> {
    beside(&format!("{DLL_PREFIX}stickslip{DLL_SUFFIX}"))
        .context("the library is not there; --library names another")
}
