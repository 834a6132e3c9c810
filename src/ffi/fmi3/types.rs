//! Types of `fmi3PlatformTypes.h` and `fmi3FunctionTypes.h`.

use std::ffi::{c_char, c_int, c_void};

/// `fmi3ValueReference`.
pub type ValueReference = u32;
/// `fmi3Float64`.
pub type Float64 = f64;
/// `fmi3Boolean`, a C `bool`: read as a byte, because C does not promise that it is 0 or 1.
pub type Boolean = u8;
/// `fmi3Clock`, a C `bool`.
pub type Clock = u8;
/// `fmi3String`.
pub type Text = *const c_char;
/// `fmi3Binary`.
pub type Binary = *const u8;
/// `fmi3Instance` and `fmi3FMUState`: handles.
pub type Handle = *mut c_void;
/// `fmi3DependencyKind`.
pub type DependencyKind = c_int;
/// `fmi3IntervalQualifier`.
pub type IntervalQualifier = c_int;

/// `fmi3IntermediateUpdateCallback`.
pub type IntermediateUpdateCallback = unsafe extern "C" fn(
    *mut c_void,
    Float64,
    Boolean,
    Boolean,
    Boolean,
    Boolean,
    *mut Boolean,
    *mut Float64,
);
/// `fmi3ClockUpdateCallback`.
pub type ClockUpdateCallback = unsafe extern "C" fn(*mut c_void);
/// `fmi3LockPreemptionCallback` and `fmi3UnlockPreemptionCallback`.
pub type PreemptionCallback = unsafe extern "C" fn();
