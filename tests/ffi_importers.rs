//! What one importer does otherwise than another must not matter: names, spellings of the resource location, no logger,
//! values beside a flag that says "not defined", reading early, clocks that round.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod importer;

use importer::{Component, Fmi2, Fmi3, Instance, REDUCED_RIG, Request, Version};
use std::ffi::{CStr, CString};
use std::fs;
use std::ptr;
use stickslip::ffi::Status::{Discard, Ok};
use stickslip::ffi::{fmi2, fmi3};

const BOTH: [Version; 2] = [Fmi2, Fmi3];
const CASE: [(&str, f64); 2] = [("u", 3.1), ("N2", 50.0)];
const OUTPUTS: [&str; 6] = ["theta", "theta_dot", "T_f", "theta3", "theta3_dot", "i"];

fn outputs(instance: &Instance<'_>) -> [u64; 6] {
    OUTPUTS.map(|name| instance.get(name).to_bits())
}

/// Outputs of a plain run at `end` [s].
fn plain(component: &Component, version: Version, end: f64) -> [u64; 6] {
    let mut instance = component.start(version, &CASE);
    instance.run(0.01, end);
    outputs(&instance)
}

#[test]
fn names_may_be_paths_and_the_same_for_all() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let expected = plain(&component, version, 2.0);
        let names = [
            c"rig",
            c"rig",
            c"/tmp/a b/Rig.fmu",
            c"C:\\x\\Rig.fmu",
            c"100 % #1 \xc3\xa4",
        ];
        let mut living: Vec<Instance<'_>> = names
            .into_iter()
            .map(|name| component.instantiate_named(version, name))
            .collect();
        for instance in &mut living {
            instance.initialize(0.0, &CASE);
        }
        for tenth in 1..=20 {
            let end = f64::from(tenth) * 0.1;
            living
                .iter_mut()
                .for_each(|instance| instance.run(0.01, end));
        }
        for instance in &living {
            assert_eq!(outputs(instance), expected);
        }
    }
}

#[test]
fn every_spelling_of_the_resource_location_leads_to_the_model() {
    let component = Component::new(REDUCED_RIG);
    let folder = component.folder.join("two words é");
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("model.toml"), REDUCED_RIG).unwrap();
    let native = folder.to_str().unwrap().to_owned();
    let encoded = native.replace(' ', "%20").replace('é', "%C3%A9");
    for version in BOTH {
        for location in [
            format!("file://{encoded}"),
            format!("file://{encoded}/"),
            format!("file:{encoded}"),
            format!("file:///{encoded}"),
            format!("file://localhost{encoded}"),
            format!("file://{native}"),
            native.clone(),
            format!("{native}/"),
        ] {
            let request = Request {
                resources: Some(CString::new(location.as_str()).unwrap()),
                ..component.request(version)
            };
            let (handle, log) = request.send(version);
            assert!(!handle.is_null(), "{location}: {:?}", log.take());
            match version {
                Fmi2 => fmi2::fmi2FreeInstance(handle),
                Fmi3 => fmi3::fmi3FreeInstance(handle),
            }
        }
    }
}

#[test]
fn fmi_3_goes_without_a_logger() {
    let component = Component::new(REDUCED_RIG);
    let request = component.request(Fmi3);
    let text = |text: &Option<CString>| text.as_deref().map_or(ptr::null(), CStr::as_ptr);
    let resources = text(&request.resources);
    // SAFETY: texts that outlive the calls, no logger, no environment.
    unsafe {
        let make = |token| {
            fmi3::fmi3InstantiateCoSimulation(
                c"rig".as_ptr(),
                token,
                resources,
                0,
                1,
                0,
                0,
                ptr::null(),
                0,
                ptr::null_mut(),
                None,
                None,
            )
        };
        assert!(make(c"{another}".as_ptr()).is_null());
        let handle = make(text(&request.token));
        assert!(!handle.is_null());
        assert_eq!(
            fmi3::fmi3EnterInitializationMode(handle, 0, 0.0, 0.0, 0, 0.0),
            Ok
        );
        assert_eq!(fmi3::fmi3ExitInitializationMode(handle), Ok);
        let [mut event, mut terminate, mut early] = [0; 3];
        let mut step = |size| {
            let mut reached = 0.0;
            fmi3::fmi3DoStep(
                handle,
                0.0,
                size,
                1,
                &mut event,
                &mut terminate,
                &mut early,
                &mut reached,
            )
        };
        assert_eq!(step(-1.0), Discard);
        assert_eq!(step(0.1), Ok);
        fmi3::fmi3FreeInstance(handle);
    }
}

#[test]
fn values_that_are_not_defined_may_be_anything() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let expected = plain(&component, version, 1.0);
        for value in [0.0, -1.0, 1e-2, 7.0, f64::NAN, f64::INFINITY] {
            let mut instance = component.instantiate(version);
            // SAFETY: no pointers but the handle.
            let status = unsafe {
                let c = instance.handle;
                match version {
                    Fmi2 => {
                        assert_eq!(fmi2::fmi2SetupExperiment(c, 0, value, 0.0, 0, value), Ok);
                        fmi2::fmi2EnterInitializationMode(c)
                    }
                    Fmi3 => fmi3::fmi3EnterInitializationMode(c, 0, value, 0.0, 0, value),
                }
            };
            assert_eq!(status, Ok, "{value}");
            for (name, value) in CASE {
                instance.set(name, value);
            }
            assert_eq!(instance.exit_initialization(), Ok);
            instance.run(0.01, 1.0);
            assert_eq!(outputs(&instance), expected, "{value}");
        }
    }
}

#[test]
fn reading_during_initialisation_changes_nothing() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let mut instance = component.instantiate(version);
        assert_eq!(instance.enter_initialization(None, 0.0, None), Ok);
        assert_eq!(outputs(&instance), [0.0_f64; 6].map(f64::to_bits));
        instance.set("N2", 50.0);
        outputs(&instance);
        instance.set("u", 3.1);
        assert_eq!((instance.get("u"), instance.get("N2")), (3.1, 50.0));
        assert!(instance.is("stuck"));
        assert_eq!(instance.get("contact.mu_s"), 0.2);
        assert_eq!(instance.exit_initialization(), Ok);
        instance.run(0.01, 2.0);
        assert_eq!(outputs(&instance), plain(&component, version, 2.0));
    }
}

#[test]
fn a_clock_that_rounds_gives_the_same_motion() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let mut exact = component.start(version, &CASE);
        exact.run(0.01, 5.0);
        for jitter in [1e-16, -1e-16, 4e-16, -4e-16, 7e-16, -7e-16] {
            let instance = component.start(version, &CASE);
            for n in 0..500 {
                // The point a little off where the last step ended, the size off its length.
                let point = f64::from(n) * 0.01 + if n % 2 == 0 { jitter } else { -jitter };
                assert_eq!(instance.step_from(point, 0.01 + jitter).status, Ok, "{n}");
            }
            // What is left of a step after such sums.
            let here = instance.get("time");
            assert_eq!(instance.step_from(here, jitter.abs()).status, Ok);
            for name in OUTPUTS {
                let difference = instance.get(name) - exact.get(name);
                assert!(difference.abs() < 1e-12, "{jitter} {name} {difference}");
            }
        }
    }
}
