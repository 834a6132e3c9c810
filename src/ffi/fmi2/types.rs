//! Types of `fmi2TypesPlatform.h` and `fmi2FunctionTypes.h`.

use crate::ffi::Fmi2Logger;
use crate::ffi::status::Status;
use std::ffi::{c_char, c_double, c_int, c_uint, c_void};

/// `fmi2ValueReference`.
pub type ValueReference = c_uint;
/// `fmi2Real`.
pub type Real = c_double;
/// `fmi2Integer`.
pub type Integer = c_int;
/// `fmi2Boolean`: 0 is false.
pub type Boolean = c_int;
/// `fmi2String`.
pub type Text = *const c_char;
/// `fmi2FMUstate` and `fmi2Component`: handles.
pub type Handle = *mut c_void;

/// `fmi2Type`: model exchange 0, co-simulation 1.
pub type Type = c_int;
/// The importer brings the solver.
pub const MODEL_EXCHANGE: Type = 0;
/// The component brings the solver.
pub const CO_SIMULATION: Type = 1;

/// `fmi2StatusKind`.
pub type StatusKind = c_int;
/// `fmi2DoStepStatus`.
pub const DO_STEP_STATUS: StatusKind = 0;
/// `fmi2PendingStatus`.
pub const PENDING_STATUS: StatusKind = 1;
/// `fmi2LastSuccessfulTime`.
pub const LAST_SUCCESSFUL_TIME: StatusKind = 2;
/// `fmi2Terminated`.
pub const TERMINATED: StatusKind = 3;

/// `fmi2CallbackFunctions`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CallbackFunctions {
    /// Takes the log.
    pub logger: Option<Fmi2Logger>,
    /// Not used: the library has its own memory.
    pub allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Not used.
    pub free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// Not used: every step is synchronous.
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, Status)>,
    /// Handed back to the logger untouched.
    pub component_environment: *mut c_void,
}

/// `fmi2EventInfo`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EventInfo {
    /// `newDiscreteStatesNeeded`.
    pub new_discrete_states_needed: Boolean,
    /// `terminateSimulation`.
    pub terminate_simulation: Boolean,
    /// `nominalsOfContinuousStatesChanged`.
    pub nominals_of_continuous_states_changed: Boolean,
    /// `valuesOfContinuousStatesChanged`.
    pub values_of_continuous_states_changed: Boolean,
    /// `nextEventTimeDefined`.
    pub next_event_time_defined: Boolean,
    /// `nextEventTime`.
    pub next_event_time: Real,
}
