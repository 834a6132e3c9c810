//! A mass on a spring as a foreign exporter would write it: FMI 3.0, co-simulation, saved states. Exact under a constant force.
//! Compiled with rustc alone.
//!
//! mass·v' = force − stiffness·x.

use std::ffi::{c_char, c_int, c_void};

/// force, x, v, mass, stiffness.
const START: [f64; 5] = [0.0, 1.0, 0.0, 1.0, 1.0];

type Spring = [f64; 5];

fn stepped(spring: &mut Spring, length: f64) {
    let [force, x, v, mass, stiffness] = *spring;
    let frequency = (stiffness / mass).sqrt();
    let rest = force / stiffness;
    let (sine, cosine) = (frequency * length).sin_cos();
    spring[1] = rest + (x - rest) * cosine + v / frequency * sine;
    spring[2] = v * cosine - (x - rest) * frequency * sine;
}

#[unsafe(no_mangle)]
extern "C" fn fmi3InstantiateCoSimulation(
    _: *const c_char,
    token: *const c_char,
    _: *const c_char,
    _: u8,
    _: u8,
    _: u8,
    _: u8,
    _: *const u32,
    _: usize,
    _: *mut c_void,
    _: *const c_void,
    _: *const c_void,
) -> *mut c_void {
    let token = unsafe { std::ffi::CStr::from_ptr(token) };
    if token.to_bytes() != b"{spring}" {
        return std::ptr::null_mut();
    }
    Box::into_raw(Box::new(START)).cast()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3FreeInstance(spring: *mut c_void) {
    drop(unsafe { Box::from_raw(spring.cast::<Spring>()) });
}

#[unsafe(no_mangle)]
extern "C" fn fmi3EnterInitializationMode(_: *mut c_void, _: u8, _: f64, _: f64, _: u8, _: f64) -> c_int {
    0
}

#[unsafe(no_mangle)]
extern "C" fn fmi3ExitInitializationMode(_: *mut c_void) -> c_int {
    0
}

#[unsafe(no_mangle)]
extern "C" fn fmi3Terminate(_: *mut c_void) -> c_int {
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3Reset(spring: *mut c_void) -> c_int {
    unsafe { *spring.cast::<Spring>() = START };
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetFloat64(
    spring: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const f64,
    _: usize,
) -> c_int {
    for at in 0..count {
        unsafe { (*spring.cast::<Spring>())[*references.add(at) as usize] = *values.add(at) };
    }
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetFloat64(
    spring: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut f64,
    _: usize,
) -> c_int {
    for at in 0..count {
        unsafe { *values.add(at) = (*spring.cast::<Spring>())[*references.add(at) as usize] };
    }
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3DoStep(
    spring: *mut c_void,
    time: f64,
    length: f64,
    _: u8,
    event: *mut u8,
    terminate: *mut u8,
    early: *mut u8,
    last: *mut f64,
) -> c_int {
    unsafe {
        stepped(&mut *spring.cast::<Spring>(), length);
        (*event, *terminate, *early, *last) = (0, 0, 0, time + length);
    }
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetFMUState(spring: *mut c_void, state: *mut *mut c_void) -> c_int {
    unsafe {
        let now = *spring.cast::<Spring>();
        if (*state).is_null() {
            *state = Box::into_raw(Box::new(now)).cast();
        } else {
            *(*state).cast::<Spring>() = now;
        }
    }
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetFMUState(spring: *mut c_void, state: *mut c_void) -> c_int {
    unsafe { *spring.cast::<Spring>() = *state.cast::<Spring>() };
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3FreeFMUState(_: *mut c_void, state: *mut *mut c_void) -> c_int {
    unsafe {
        if !(*state).is_null() {
            drop(Box::from_raw((*state).cast::<Spring>()));
            *state = std::ptr::null_mut();
        }
    }
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SerializedFMUStateSize(_: *mut c_void, _: *mut c_void, size: *mut usize) -> c_int {
    unsafe { *size = size_of::<Spring>() };
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SerializeFMUState(
    _: *mut c_void,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    unsafe { std::ptr::copy_nonoverlapping(state.cast::<u8>(), bytes, size) };
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3DeserializeFMUState(
    _: *mut c_void,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> c_int {
    let mut now: Spring = START;
    unsafe {
        std::ptr::copy_nonoverlapping(bytes, (&raw mut now).cast::<u8>(), size);
        *state = Box::into_raw(Box::new(now)).cast();
    }
    0
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetBoolean(_: *mut c_void, _: *const u32, _: usize, _: *mut bool, _: usize) -> c_int {
    3
}
