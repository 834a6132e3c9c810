//! FMI 2 as an importer sees it: values, steps, states and derivatives.

use super::harness::{Fmi2, NULL};
use crate::cosim::test_model::{ABOVE, GAIN, RATE, TIME, U, X, Y};
use crate::ffi::Status::{Discard, Error, Ok, Warning};
use crate::ffi::fmi2::*;
use std::ptr;

#[test]
fn follows_the_closed_solution() {
    let instance = Fmi2::running();
    assert_eq!(instance.set(U, 3.0), Ok);
    for n in 0..10 {
        assert_eq!(instance.step(0.1 * f64::from(n), 0.1), Ok);
    }
    assert!((instance.get(X) - 3.0 * (1.0 - (-1.0_f64).exp())).abs() < 1e-12);
    assert_eq!(instance.get(Y), instance.get(X) + 2.0 * 3.0);
    assert!(instance.log.0.is_empty());
}

#[test]
fn values_that_cannot_be_are_discarded_and_nothing_changes() {
    let mut instance = Fmi2::running();
    assert_eq!(instance.set(U, 1.5), Ok);
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(instance.set(U, value), Discard);
        let message = instance.log.only();
        assert!(message.contains("\"u\""), "{message}");
    }
    // The first of the two would be fine: all or none.
    // SAFETY: two variables, two values.
    let status =
        unsafe { fmi2SetReal(instance.handle, [U, GAIN].as_ptr(), 2, [9.0, 1e9].as_ptr()) };
    assert_eq!(status, Discard);
    assert!(
        instance
            .log
            .only()
            .contains("\"gain\" cannot be 1000000000")
    );
    assert_eq!(instance.get(U), 1.5);
    assert_eq!(instance.step(0.0, 0.1), Ok);
}

#[test]
fn wrong_variables_are_errors() {
    for (reference, part) in [
        (99, "no variable with value reference 99"),
        (X, "\"x\" must not be set"),
        (TIME, "computed"),
        (RATE, "before the simulation only"),
        (ABOVE, "is a Boolean"),
    ] {
        let mut instance = Fmi2::running();
        assert_eq!(instance.set(reference, 1.0), Error);
        let message = instance.log.only();
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn null_arrays_are_errors() {
    let mut instance = Fmi2::running();
    // SAFETY: NULL is what is tested.
    unsafe {
        assert_eq!(
            fmi2GetReal(instance.handle, ptr::null(), 0, ptr::null_mut()),
            Ok
        );
        assert_eq!(
            fmi2GetReal(instance.handle, ptr::null(), 1, &mut 0.0),
            Error
        );
        assert!(instance.log.only().contains("'vr' is NULL"));
        assert_eq!(fmi2GetReal(instance.handle, &X, 1, ptr::null_mut()), Error);
        assert!(instance.log.only().contains("'value' is NULL"));
        assert_eq!(fmi2GetFMUstate(instance.handle, ptr::null_mut()), Error);
        instance.log.only();
        assert_eq!(
            fmi2GetReal(instance.handle, &X, usize::MAX, &mut 0.0),
            Error
        );
        assert!(instance.log.only().contains("cannot be an array"));
    }
}

#[test]
fn steps_that_cannot_be_are_discarded_and_the_next_one_goes_on() {
    let mut instance = Fmi2::running();
    for (point, size, part) in [
        (0.0, 0.0, "above 0"),
        (0.0, -0.1, "above 0"),
        (0.0, f64::NAN, "above 0"),
        (f64::NAN, 0.1, "not where the last step ended"),
        (0.0, f64::INFINITY, "above 0"),
        (0.2, 0.1, "not where the last step ended"),
        (-0.2, 0.1, "not where the last step ended"),
    ] {
        assert_eq!(instance.step(point, size), Discard);
        let message = instance.log.only();
        assert!(message.contains(part), "{message}");
        let mut status = Ok;
        // SAFETY: the place of one status.
        unsafe { fmi2GetStatus(instance.handle, DO_STEP_STATUS, &mut status) };
        assert_eq!(status, Discard);
    }
    assert_eq!(instance.step(0.0, 0.1), Ok);
    // Rounding of the importer's clock.
    assert_eq!(instance.step(0.1 + 7e-16, 0.1), Ok);
    assert_eq!(instance.step(0.2 - 5e-10, 1e-13), Ok);
    assert_eq!(instance.get(TIME), 0.2 + 7e-16);
}

#[test]
fn no_step_goes_beyond_the_stop_time() {
    let mut instance = Fmi2::new();
    // SAFETY: no pointers but the handle.
    unsafe {
        assert_eq!(
            fmi2SetupExperiment(instance.handle, 0, -1.0, 0.0, 1, 0.3),
            Ok
        );
        assert_eq!(fmi2EnterInitializationMode(instance.handle), Ok);
        assert_eq!(fmi2ExitInitializationMode(instance.handle), Ok);
    }
    assert_eq!(instance.step(0.0, 0.1), Ok);
    assert_eq!(instance.step(0.1, 0.2 + 1e-12), Ok);
    assert_eq!(instance.step(0.3, 0.1), Error);
    assert!(instance.log.only().contains("stop time 0.3 s"));
}

#[test]
fn a_saved_state_continues_bit_for_bit() {
    let instance = Fmi2::running();
    instance.set(U, 3.0);
    instance.step(0.0, 0.3);
    let state = instance.save();
    instance.step(0.3, 0.4);
    let expected = instance.get(X).to_bits();
    instance.set(U, -5.0);
    instance.set(GAIN, 7.0);
    // SAFETY: handles of this library and places of the results.
    unsafe {
        assert_eq!(fmi2SetFMUstate(instance.handle, state), Ok);
        assert_eq!(instance.get(GAIN), 2.0);
        instance.step(0.3, 0.4);
        assert_eq!(instance.get(X).to_bits(), expected);

        let mut size = 0;
        assert_eq!(
            fmi2SerializedFMUstateSize(instance.handle, state, &mut size),
            Ok
        );
        let mut bytes = vec![0_u8; size];
        assert_eq!(
            fmi2SerializeFMUstate(instance.handle, state, bytes.as_mut_ptr(), size),
            Ok
        );
        let other = Fmi2::new();
        let mut copy = NULL;
        assert_eq!(
            fmi2DeSerializeFMUstate(other.handle, bytes.as_ptr(), size, &mut copy),
            Ok
        );
        assert_eq!(fmi2SetFMUstate(other.handle, copy), Ok);
        other.step(0.3, 0.4);
        assert_eq!(other.get(X).to_bits(), expected);
    }
}

#[test]
fn states_may_be_freed_twice_or_never_and_are_overwritten_on_request() {
    let mut instance = Fmi2::running();
    let mut state = instance.save();
    let before = state;
    // SAFETY: handles of this library.
    unsafe {
        instance.step(0.0, 0.1);
        assert_eq!(fmi2GetFMUstate(instance.handle, &mut state), Ok);
        assert_eq!(state, before);
        let mut again = state;
        assert_eq!(fmi2FreeFMUstate(instance.handle, &mut state), Ok);
        assert!(state.is_null());
        assert_eq!(fmi2FreeFMUstate(instance.handle, &mut state), Ok);
        assert_eq!(fmi2FreeFMUstate(instance.handle, ptr::null_mut()), Ok);
        assert_eq!(fmi2FreeFMUstate(instance.handle, &mut again), Warning);
        instance.log.only();
        assert_eq!(instance.step(0.1, 0.1), Ok);
        assert_eq!(fmi2SetFMUstate(instance.handle, again), Error);
        assert!(instance.log.only().contains("freed"));
        let left = instance.save();
        fmi2FreeInstance(instance.handle);
        // A state ends with its instance.
        let other = Fmi2::running();
        assert_eq!(fmi2SetFMUstate(other.handle, left), Error);
    }
}

#[test]
fn changed_bytes_are_refused() {
    let instance = Fmi2::running();
    let state = instance.save();
    let mut size = 0;
    // SAFETY: handles of this library and places of the results.
    unsafe {
        fmi2SerializedFMUstateSize(instance.handle, state, &mut size);
        let mut bytes = vec![0_u8; size];
        fmi2SerializeFMUstate(instance.handle, state, bytes.as_mut_ptr(), size);
        bytes[size / 2] ^= 1;
        for (length, part) in [
            (size, "corrupted"),
            (size - 1, "truncated"),
            (0, "truncated"),
        ] {
            let mut other = Fmi2::running();
            let mut made = NULL;
            let pointer = bytes.as_ptr();
            assert_eq!(
                fmi2DeSerializeFMUstate(other.handle, pointer, length, &mut made),
                Error
            );
            let message = other.log.only();
            assert!(message.contains(part), "{message}");
            assert!(made.is_null());
        }
    }
}

#[test]
fn input_derivatives_make_a_ramp() {
    let instance = Fmi2::running();
    // SAFETY: one variable, one order, one value each.
    unsafe {
        assert_eq!(
            fmi2SetRealInputDerivatives(instance.handle, &U, 1, &1, &4.0),
            Ok
        );
        instance.step(0.0, 0.5);
        // x' = −x + 4 t from 0: x = 4 (t − 1 + e^−t).
        let expected = 4.0 * (0.5 - 1.0 + (-0.5_f64).exp());
        assert!((instance.get(X) - expected).abs() < 1e-12);
        let mut slope = 0.0;
        assert_eq!(
            fmi2GetRealOutputDerivatives(instance.handle, &X, 1, &1, &mut slope),
            Ok
        );
        assert!((slope - (2.0 - expected)).abs() < 1e-12);
        assert_eq!(
            fmi2SetRealInputDerivatives(instance.handle, &U, 1, &1, &f64::NAN),
            Discard
        );
        assert_eq!(
            fmi2SetRealInputDerivatives(instance.handle, &U, 1, &0, &1.0),
            Error
        );
    }
}

#[test]
fn directional_derivative_weighs_the_seed() {
    let instance = Fmi2::running();
    instance.set(U, 3.0);
    let mut sensitivity = [f64::NAN; 2];
    // SAFETY: two unknowns, two knowns.
    let status = unsafe {
        fmi2GetDirectionalDerivative(
            instance.handle,
            [Y, X].as_ptr(),
            2,
            [U, GAIN].as_ptr(),
            2,
            [1.0, 10.0].as_ptr(),
            sensitivity.as_mut_ptr(),
        )
    };
    assert_eq!((status, sensitivity), (Ok, [2.0 + 10.0 * 3.0, 0.0]));
}

#[test]
fn booleans_are_read_as_integers() {
    let instance = Fmi2::running();
    let mut above = 9;
    instance.set(U, 10.0);
    instance.step(0.0, 1.0);
    // SAFETY: one variable, one value.
    unsafe { assert_eq!(fmi2GetBoolean(instance.handle, &ABOVE, 1, &mut above), Ok) };
    assert_eq!(above, 1);
}
