//! Saved states, log categories and instances that are none.

use crate::importer::{Component, FULL_RIG, Fmi2, Fmi3, REDUCED_RIG};
use crate::{BOTH, CASE, goes_on, said};
use std::ffi::{CStr, c_char, c_void};
use std::ptr;
use stickslip::ffi::Status::{Error, Ok, Warning};
use stickslip::ffi::fmi2::{fmi2FreeInstance, fmi2SetDebugLogging};
use stickslip::ffi::fmi3::{fmi3FreeInstance, fmi3SetDebugLogging};

#[test]
fn saved_states_that_are_none_are_errors_and_the_next_good_one_continues() {
    let component = Component::new(REDUCED_RIG);
    let foreign = Component::new(FULL_RIG);
    for version in BOTH {
        let other = foreign.start(version, &[]);
        let other_version = component.start(if version == Fmi2 { Fmi3 } else { Fmi2 }, &CASE);
        let mut instance = component.start(version, &CASE);
        instance.run(0.01, 0.5);
        let good = instance.save();
        let mut freed = instance.save();
        let kept = freed;
        assert_eq!(instance.free_state(&mut freed), Ok);
        let dead = ["not a live one", "freed"];
        for (state, parts) in [
            (
                ptr::null_mut::<c_void>(),
                ["is NULL", "expected a state that was saved"],
            ),
            (kept, dead),
            (ptr::without_provenance_mut(0x1000), dead),
            (
                other.save(),
                ["the state belongs to the component", "this one is"],
            ),
            (
                other_version.save(),
                ["saved through the other FMI version", "invalid"],
            ),
        ] {
            assert_eq!(instance.try_restore(state), Error, "{parts:?}");
            said(&instance.log, Error, &parts);
            // A saved state brings an instance back from an error.
            instance.restore(good);
        }
        let mut twice = kept;
        assert_eq!(instance.free_state(&mut twice), Warning);
        said(
            &instance.log,
            Warning,
            &["freed before", "nothing was freed"],
        );

        let bytes = instance.serialize(good);
        let mut changed = bytes.clone();
        changed[bytes.len() / 2] ^= 1;
        for (bytes, parts) in [
            (changed, ["the state is corrupted", "checksum"]),
            (
                bytes[..bytes.len() - 1].to_vec(),
                ["the state is truncated", "ends before"],
            ),
            (Vec::new(), ["the state is truncated", "ends before"]),
            (
                b"what is not a state".to_vec(),
                ["not a state written by this library", "STKSLIP"],
            ),
            (
                other.serialize(other.save()),
                ["belongs to the component", "this one is"],
            ),
        ] {
            assert_eq!(instance.try_deserialize(&bytes).unwrap_err(), Error);
            said(&instance.log, Error, &parts);
            instance.restore(good);
        }
        let mut short = vec![0; bytes.len() - 1];
        assert_eq!(instance.try_serialize(good, &mut short), Error);
        let parts = [
            format!("size = {}", short.len()),
            format!("{} bytes", bytes.len()),
        ];
        said(&instance.log, Error, &[&parts[0], &parts[1]]);
        instance.restore(good);
        goes_on(&component, &mut instance, 1.0);
    }
}

#[test]
fn log_categories_that_are_none_are_named() {
    let component = Component::new(REDUCED_RIG);
    for (version, first) in BOTH
        .into_iter()
        .flat_map(|version| [(version, c"logStatusError"), (version, c"logNothing")])
    {
        let mut instance = component.start(version, &CASE);
        let names = [first, c"logEverything"];
        let categories: [*const c_char; 2] = names.map(CStr::as_ptr);
        // SAFETY: two categories.
        let status = unsafe {
            match version {
                Fmi2 => fmi2SetDebugLogging(instance.handle, 1, 2, categories.as_ptr()),
                Fmi3 => fmi3SetDebugLogging(instance.handle, 1, 2, categories.as_ptr()),
            }
        };
        assert_eq!(status, Warning);
        let parts = [
            "no such log category: ",
            "logEverything; ",
            "there are: logEvents",
        ];
        said(&instance.log, Warning, &parts);
        goes_on(&component, &mut instance, 0.5);
    }
}

#[test]
fn handles_that_are_none_are_errors_without_a_trace() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let mut instance = component.start(version, &CASE);
        let log_of_other = component.start(version, &CASE);
        for handle in [
            ptr::null_mut::<c_void>(),
            ptr::without_provenance_mut(1),
            ptr::without_provenance_mut(usize::MAX),
            // A saved state's mark in place of an instance's.
            ptr::without_provenance_mut(instance.handle.addr() ^ 3),
        ] {
            let alive = std::mem::replace(&mut instance.handle, handle);
            assert_eq!(instance.try_step(0.01).status, Error);
            assert_eq!(instance.try_set("u", 1.0), Error);
            assert_eq!(instance.get_reference(0), Err(Error));
            match version {
                Fmi2 => fmi2FreeInstance(handle),
                Fmi3 => fmi3FreeInstance(handle),
            }
            instance.handle = alive;
        }
        assert!(log_of_other.log.take().is_empty());
        goes_on(&component, &mut instance, 0.5);
    }
}
