//! An axis as a foreign exporter would write it: FMI 2.0, co-simulation, a fixed inner step, no saved states. Compiled with rustc alone.
//!
//! J·w' = k·(voltage − k·w)/R − d·w − m·sin(phi) + torque − friction·sign(w).
//! `crash_at` and `nan_at` make it do what bad FMUs do.

use std::ffi::{c_char, c_int, c_uint, c_void};

const COUNT: usize = 12;
const START: [f64; COUNT] = [0.0, 0.0, 0.0, 0.0, 0.02, 2.0, 0.5, 0.01, 0.6, 0.0, 1e9, 1e9];
const INNER_STEP: f64 = 1e-4;

struct Axis {
    values: [f64; COUNT],
}

impl Axis {
    fn step(&mut self, time: f64, length: f64) {
        let count = (length / INNER_STEP - 1e-9).ceil().max(1.0);
        let step = length / count;
        for _ in 0..count as usize {
            let [voltage, torque, phi, w, inertia, resistance, k, d, m, friction, ..] = self.values;
            let drive = |phi: f64, w: f64| k * (voltage - k * w) / resistance - d * w - m * phi.sin() + torque;
            let halfway = w + 0.5 * step * drive(phi, w) / inertia;
            let free = w + step * drive(phi + 0.5 * step * w, halfway) / inertia;
            let braked = step * friction / inertia;
            let next = if free.abs() <= braked { 0.0 } else { free - braked.copysign(free) };
            self.values[2] += 0.5 * step * (w + next);
            self.values[3] = next;
        }
        if time > self.values[10] {
            eprintln!("axis: out of licences");
            std::process::abort();
        }
        if time > self.values[11] {
            self.values[3] = f64::NAN;
        }
    }
}

#[unsafe(no_mangle)]
extern "C" fn fmi2Instantiate(
    _: *const c_char,
    _: c_int,
    _: *const c_char,
    _: *const c_char,
    _: *const c_void,
    _: c_int,
    _: c_int,
) -> *mut c_void {
    Box::into_raw(Box::new(Axis { values: START })).cast()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2FreeInstance(axis: *mut c_void) {
    drop(unsafe { Box::from_raw(axis.cast::<Axis>()) });
}

#[unsafe(no_mangle)]
extern "C" fn fmi2Terminate(_: *mut c_void) -> c_int {
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2Reset(axis: *mut c_void) -> c_int {
    unsafe { (*axis.cast::<Axis>()).values = START };
    0
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SetupExperiment(_: *mut c_void, _: c_int, _: f64, _: f64, _: c_int, _: f64) -> c_int {
    0
}

#[unsafe(no_mangle)]
extern "C" fn fmi2EnterInitializationMode(_: *mut c_void) -> c_int {
    0
}

#[unsafe(no_mangle)]
extern "C" fn fmi2ExitInitializationMode(_: *mut c_void) -> c_int {
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2SetReal(axis: *mut c_void, at: *const c_uint, count: usize, from: *const f64) -> c_int {
    for index in 0..count {
        unsafe { (*axis.cast::<Axis>()).values[*at.add(index) as usize] = *from.add(index) };
    }
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2GetReal(axis: *mut c_void, at: *const c_uint, count: usize, to: *mut f64) -> c_int {
    for index in 0..count {
        unsafe { *to.add(index) = (*axis.cast::<Axis>()).values[*at.add(index) as usize] };
    }
    0
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetBoolean(_: *mut c_void, _: *const c_uint, _: usize, _: *mut c_int) -> c_int {
    3
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi2DoStep(axis: *mut c_void, time: f64, length: f64, _: c_int) -> c_int {
    unsafe { (*axis.cast::<Axis>()).step(time, length) };
    0
}
