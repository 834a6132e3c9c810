//! Bad input through both C interfaces: the standard's status, one log line that says which thing, what it was and what
//! is right, and an instance that goes on where the standard lets it.
//!
//! After *discard* and *warning* an instance goes on as one that never saw the call; after *error* a reset, or a saved
//! state, brings it back. NULL pointers and calls in the wrong state have files of their own.

mod importer;

use importer::{Component, FULL_RIG, Fmi2, Fmi3, Instance, Log, REDUCED_RIG, Request, Version};
use std::ffi::{CStr, CString, c_char, c_void};
use std::{fs, ptr};
use stickslip::ffi::Status::{self, Discard, Error, Ok, Warning};
use stickslip::ffi::fmi2::{fmi2FreeInstance, fmi2SetDebugLogging};
use stickslip::ffi::fmi3::{fmi3FreeInstance, fmi3SetDebugLogging};

const BOTH: [Version; 2] = [Fmi2, Fmi3];
const CASE: [(&str, f64); 2] = [("u", 3.1), ("N2", 50.0)];
const OUTPUTS: [&str; 6] = ["theta", "theta_dot", "T_f", "theta3", "theta3_dot", "i"];

/// The one line that a call must have left in the log beside events: of this status, with all these parts.
#[track_caller]
fn said(log: &Log, status: Status, parts: &[&str]) {
    let lines: Vec<_> = log
        .take()
        .into_iter()
        .filter(|line| line.category != "logEvents")
        .collect();
    let category = match status {
        Warning => "logStatusWarning",
        Discard => "logStatusDiscard",
        _ => "logStatusError",
    };
    assert_eq!(lines.len(), 1, "{lines:?}");
    let line = &lines[0];
    assert_eq!(
        (line.status, line.category.as_str()),
        (status as i32, category)
    );
    for part in parts {
        assert!(
            line.text.contains(part),
            "{part:?} is not in {:?}",
            line.text
        );
    }
}

fn outputs(instance: &Instance<'_>) -> [u64; 6] {
    OUTPUTS.map(|name| instance.get(name).to_bits())
}

/// What a run that nobody disturbs comes to at `end` [s].
fn undisturbed(component: &Component, version: Version, end: f64) -> [u64; 6] {
    let mut instance = component.start(version, &CASE);
    instance.run(0.01, end);
    outputs(&instance)
}

/// The instance goes on to `end` [s] as one that never saw the bad call.
#[track_caller]
fn goes_on(component: &Component, instance: &mut Instance<'_>, end: f64) {
    instance.run(0.01, end);
    let expected = undisturbed(component, instance.version, end);
    assert_eq!(outputs(instance), expected);
}

/// After an error an instance still reads, refuses to step in words that say why, and a reset makes it as new.
#[track_caller]
fn recovers(component: &Component, instance: &mut Instance<'_>) {
    let reads = instance.get_reference(instance.reference("theta"));
    assert!(reads.is_ok(), "{reads:?}");
    assert_eq!(instance.step_from(instance.time, 0.01).status, Error);
    said(&instance.log, Error, &["DoStep", "after an error"]);
    instance.reset();
    instance.initialize(0.0, &CASE);
    goes_on(component, instance, 1.0);
}

#[test]
fn values_that_cannot_be_are_discarded_and_the_old_ones_hold() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let mut instance = component.start(version, &CASE);
        instance.run(0.01, 0.5);
        let setter = if version == Fmi2 {
            "fmi2SetReal"
        } else {
            "fmi3SetFloat64"
        };
        for (name, value, was, right) in [
            ("u", f64::NAN, "NaN", "a finite number"),
            ("u", f64::INFINITY, "inf", "a finite number"),
            ("N2", f64::NEG_INFINITY, "-inf", "a finite number"),
            ("N2", f64::NAN, "NaN", "a finite number"),
            ("contact.mu_s", -0.1, "-0.1", "not below 0"),
            ("contact.omega_s", 0.0, "0", "above 0"),
            ("motor.resistance", f64::NAN, "NaN", "above 0"),
        ] {
            let before = instance.get(name).to_bits();
            assert_eq!(instance.try_set(name, value), Discard, "{name} = {value}");
            let quoted = format!("\"{name}\" cannot be {was}");
            said(&instance.log, Discard, &[setter, &quoted, right]);
            assert_eq!(instance.get(name).to_bits(), before);
        }
        // The first of the two would do: all or none.
        let references = ["u", "N2"].map(|name| instance.reference(name));
        assert_eq!(
            instance.set_references(&references, &[9.0, f64::NAN]),
            Discard
        );
        said(&instance.log, Discard, &["\"N2\" cannot be NaN"]);
        assert_eq!(instance.get("u"), 3.1);
        goes_on(&component, &mut instance, 2.0);
    }
}

#[test]
fn start_values_out_of_range_are_discarded_before_the_simulation() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let mut instance = component.instantiate(version);
        for (name, value, right) in [
            ("disc.inertia", 0.0, "above 0"),
            ("gearbox.ratio", -8.0, "above 0"),
            ("shaft.damping", -1e-9, "not below 0"),
            ("theta_dot", f64::NAN, "a finite number"),
        ] {
            assert_eq!(instance.try_set(name, value), Discard);
            let quoted = format!("\"{name}\" cannot be {value}");
            said(&instance.log, Discard, &[&quoted, right]);
        }
        instance.initialize(0.0, &CASE);
        goes_on(&component, &mut instance, 1.0);
    }
}

#[test]
fn variables_that_are_not_there_or_not_to_be_set_are_errors() {
    let component = Component::new(REDUCED_RIG);
    let (stuck, theta) = (
        component.table.find("stuck").unwrap().value_reference,
        component.table.find("theta").unwrap().value_reference,
    );
    let largest = component.table.variables().len() - 1;
    let unknown = format!("no variable with value reference 4000000000; the largest is {largest}");
    for version in BOTH {
        type Call<'a> = Box<dyn Fn(&Instance<'_>) -> Status + 'a>;
        let set = |reference: u32| -> Call<'_> {
            Box::new(move |instance| instance.set_references(&[reference], &[1.0]))
        };
        let get = |reference: u32| -> Call<'_> {
            Box::new(move |instance| instance.get_reference(reference).unwrap_err())
        };
        let read_boolean = |reference: u32| -> Call<'_> {
            Box::new(move |instance| instance.get_boolean(reference).unwrap_err())
        };
        let named = |name: &'static str| -> Call<'_> {
            Box::new(move |instance| instance.try_set(name, 1.0))
        };
        let before_start = "it can be set before the simulation only";
        let cases: [(Call<'_>, &[&str]); 9] = [
            (set(4_000_000_000), &[&unknown]),
            (get(4_000_000_000), &[&unknown]),
            (read_boolean(4_000_000_000), &[&unknown]),
            (set(stuck), &["\"stuck\"", "is a Boolean, not a real"]),
            (get(stuck), &["\"stuck\"", "is a Boolean, not a real"]),
            (
                read_boolean(theta),
                &["\"theta\"", "is a real, not a Boolean"],
            ),
            (named("T_f"), &["\"T_f\" must not be set", "it is computed"]),
            (named("theta"), &["\"theta\" must not be set", before_start]),
            (
                named("disc.inertia"),
                &["\"disc.inertia\" must not", before_start],
            ),
        ];
        for (call, parts) in cases {
            let mut instance = component.start(version, &CASE);
            instance.run(0.01, 0.2);
            assert_eq!(call(&instance), Error, "{parts:?}");
            said(&instance.log, Error, parts);
            recovers(&component, &mut instance);
        }
    }
}

#[test]
fn steps_and_points_that_cannot_be_are_discarded_and_the_next_step_goes_on() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let mut instance = component.start(version, &CASE);
        instance.run(0.01, 0.5);
        let here = instance.time;
        let size = "the step must be finite and above 0";
        let point = "is not where the last step ended, 0.5 s";
        for (at, step, parts) in [
            (here, 0.0, ["communicationStepSize = 0 s", size]),
            (here, -0.01, ["communicationStepSize = -0.01 s", size]),
            (here, f64::NAN, ["communicationStepSize = NaN s", size]),
            (here, f64::INFINITY, ["communicationStepSize = inf s", size]),
            (f64::NAN, 0.01, ["currentCommunicationPoint = NaN s", point]),
            (
                f64::INFINITY,
                0.01,
                ["currentCommunicationPoint = inf s", point],
            ),
            (0.6, 0.01, ["currentCommunicationPoint = 0.6 s", point]),
            (0.4, 0.01, ["currentCommunicationPoint = 0.4 s", point]),
            (
                here + 2e-9,
                0.01,
                ["currentCommunicationPoint = 0.500000002", point],
            ),
            (0.0, 0.01, ["currentCommunicationPoint = 0 s", point]),
        ] {
            let result = instance.step_from(at, step);
            assert_eq!(result.status, Discard, "{at} {step}");
            said(&instance.log, Discard, &parts);
            if version == Fmi3 {
                assert_eq!(result.reached, here, "lastSuccessfulTime");
            }
        }
        assert_eq!(instance.get("time"), here);
        // The clocks of importers round: within a nanosecond it is the same point.
        assert_eq!(instance.step_from(here + 5e-10, 0.01).status, Ok);
        instance.time = instance.get("time");
        instance.run(0.01, 2.0);
        let difference = instance.get("theta") - {
            let mut other = component.start(version, &CASE);
            other.run(0.01, 2.0);
            other.get("theta")
        };
        assert!(difference.abs() < 1e-12, "{difference}");
    }
}

#[test]
fn experiments_that_cannot_be_are_errors() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        for (tolerance, start, stop, parts) in [
            (Some(0.0), 0.0, None, ["tolerance = 0", "between 0 and 1"]),
            (
                Some(-1e-6),
                0.0,
                None,
                ["tolerance = -0.000001", "between 0 and 1"],
            ),
            (
                Some(f64::NAN),
                0.0,
                None,
                ["tolerance = NaN", "between 0 and 1"],
            ),
            (Some(2.0), 0.0, None, ["tolerance = 2", "between 0 and 1"]),
            (None, f64::NAN, None, ["startTime = NaN", "must be finite"]),
            (
                None,
                f64::INFINITY,
                None,
                ["startTime = inf", "must be finite"],
            ),
            (
                None,
                0.0,
                Some(f64::NAN),
                ["stopTime = NaN", "after startTime = 0"],
            ),
            (
                None,
                2.0,
                Some(1.0),
                ["stopTime = 1", "after startTime = 2"],
            ),
        ] {
            let mut instance = component.instantiate(version);
            assert_eq!(instance.enter_initialization(tolerance, start, stop), Error);
            said(&instance.log, Error, &parts);
            instance.reset();
            instance.initialize(0.0, &CASE);
            goes_on(&component, &mut instance, 0.5);
        }
        let mut instance = component.instantiate(version);
        assert_eq!(instance.enter_initialization(None, 0.0, Some(0.3)), Ok);
        assert_eq!(instance.exit_initialization(), Ok);
        instance.run(0.1, 0.3);
        assert_eq!(instance.try_step(0.1).status, Error);
        said(
            &instance.log,
            Error,
            &["the step to 0.4 s", "the stop time 0.3 s"],
        );
        recovers(&component, &mut instance);
    }
}

#[test]
fn parameters_that_contradict_each_other_are_errors_that_name_both() {
    let component = Component::new(REDUCED_RIG);
    let parts = ["contact: the breakaway level mu_s = 0.2 is below the sliding level mu_c = 0.5"];
    for version in BOTH {
        let mut instance = component.instantiate(version);
        instance.set("contact.mu_c", 0.5);
        assert_eq!(instance.enter_initialization(None, 0.0, None), Ok);
        assert_eq!(instance.exit_initialization(), Error);
        said(&instance.log, Error, &parts);
        instance.reset();
        let consistent = [("contact.mu_c", 0.5), ("contact.mu_s", 0.6)];
        instance.initialize(0.0, &consistent);
        assert_eq!(instance.get("contact.mu_s"), 0.6);

        // While it runs, both may be set one after the other; what counts is the next step.
        let mut instance = component.start(version, &CASE);
        instance.run(0.01, 0.5);
        instance.set("contact.mu_c", 0.5);
        instance.set("contact.mu_s", 0.6);
        instance.step(0.01);
        instance.set("contact.mu_s", 0.2);
        assert_eq!(instance.try_step(0.01).status, Error);
        said(&instance.log, Error, &parts);
        instance.reset();
        instance.initialize(0.0, &CASE);
        goes_on(&component, &mut instance, 1.0);
    }
}

#[test]
fn derivatives_of_or_by_what_has_none_are_errors() {
    let component = Component::new(REDUCED_RIG);
    type Call = fn(&Instance<'_>) -> Status;
    let both: [(Call, &[&str]); 6] = [
        (
            |i| i.try_output_derivative("u", 1).unwrap_err(),
            &["\"u\" is not an output"],
        ),
        (
            |i| i.try_output_derivative("theta", 0).unwrap_err(),
            &["order 0 of the derivative of \"theta\" must be from 1 to 2"],
        ),
        (
            |i| i.try_output_derivative("theta", 3).unwrap_err(),
            &["order 3 of the derivative of \"theta\" must be from 1 to 2"],
        ),
        (
            |i| i.try_directional("u", &["u"], &[1.0]).unwrap_err(),
            &["\"u\" cannot be an unknown", "outputs and locals can"],
        ),
        (
            |i| i.try_directional("T_f", &["theta"], &[1.0]).unwrap_err(),
            &[
                "\"theta\" cannot be a known",
                "inputs and tunable parameters can",
            ],
        ),
        (
            |i| {
                i.try_directional("T_f", &["disc.inertia"], &[1.0])
                    .unwrap_err()
            },
            &["\"disc.inertia\" cannot be a known"],
        ),
    ];
    let fmi2: [(Call, &[&str]); 3] = [
        (
            |i| i.set_input_derivative("theta", 1, 1.0),
            &["\"theta\" is not an input"],
        ),
        (
            |i| i.set_input_derivative("u", 0, 1.0),
            &["order 0 of the derivative of \"u\" must be from 1 to 3"],
        ),
        (
            |i| i.set_input_derivative("u", 4, 1.0),
            &["order 4 of the derivative of \"u\" must be from 1 to 3"],
        ),
    ];
    for version in BOTH {
        let only: &[_] = if version == Fmi2 { &fmi2 } else { &[] };
        for (call, parts) in both.iter().chain(only) {
            let mut instance = component.start(version, &CASE);
            instance.run(0.01, 0.2);
            assert_eq!(call(&instance), Error, "{parts:?}");
            said(&instance.log, Error, parts);
            recovers(&component, &mut instance);
        }
    }
    let mut instance = component.start(Fmi2, &CASE);
    assert_eq!(instance.set_input_derivative("u", 1, f64::NAN), Discard);
    let parts = ["the derivative of \"u\" cannot be NaN", "a finite number"];
    said(&instance.log, Discard, &parts);
    goes_on(&component, &mut instance, 1.0);
}

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
            (ptr::null_mut::<c_void>(), ["NULL", "GetFMU"]),
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
    for version in BOTH {
        let mut instance = component.start(version, &CASE);
        let names = [c"logStatusWarning", c"logEverything"];
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
            "no such log category: logEverything",
            "there are: logEvents",
        ];
        said(&instance.log, Warning, &parts);
        goes_on(&component, &mut instance, 0.5);
    }
}

/// An instantiation that must fail, with one line that says all `parts`.
#[track_caller]
fn no_instance(version: Version, request: &Request, parts: &[&str]) {
    let (handle, log) = request.send(version);
    assert!(handle.is_null(), "{parts:?}");
    let function = match version {
        Fmi2 => "fmi2Instantiate",
        Fmi3 => "fmi3InstantiateCoSimulation",
    };
    said(&log, Error, &[&[function], parts].concat());
}

/// An instantiation that must do.
fn an_instance(version: Version, request: &Request) {
    let (handle, log) = request.send(version);
    assert!(!handle.is_null(), "{:?}", log.take());
    match version {
        Fmi2 => fmi2FreeInstance(handle),
        Fmi3 => fmi3FreeInstance(handle),
    }
}

#[test]
fn tokens_and_names_that_do_not_match_give_no_instance() {
    let component = Component::new(REDUCED_RIG);
    let own = component.token.to_str().unwrap().to_owned();
    let foreign = Component::new(FULL_RIG).token.to_str().unwrap().to_owned();
    for version in BOTH {
        let good = component.request(version);
        for token in [
            "",
            "{00000000-0000-0000-0000-000000000000}",
            foreign.as_str(),
            &own.to_uppercase(),
            &format!("{own} "),
        ] {
            let request = Request {
                token: Some(CString::new(token).unwrap()),
                ..good.clone()
            };
            let wrong = format!("the token {token} does not match {own}");
            no_instance(version, &request, &[&wrong, "one run of build-fmu"]);
        }
        let request = Request {
            token: None,
            ..good.clone()
        };
        no_instance(
            version,
            &request,
            &[
                "the instantiation token (GUID) is NULL",
                "modelDescription.xml",
            ],
        );
        let request = Request {
            name: None,
            ..good.clone()
        };
        no_instance(
            version,
            &request,
            &["'instanceName' is NULL", "at least one character"],
        );
        let request = Request {
            name: Some(c" ".to_owned()),
            ..good.clone()
        };
        no_instance(
            version,
            &request,
            &["'instanceName' is empty", "at least one character"],
        );
        an_instance(version, &good);
    }
}

#[test]
fn resource_locations_that_lead_nowhere_give_no_instance() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let good = component.request(version);
        for (location, parts) in [
            (None, &["the resource location is NULL", "model.toml"][..]),
            (
                Some("http://x/resources"),
                &["has the scheme http", "only file: URIs"],
            ),
            (
                Some("file://server/resources"),
                &["names another host", "expected file:///path"],
            ),
            (
                Some("resources"),
                &["\"resources\" is a relative path", "must be absolute"],
            ),
            (Some(""), &["\"\" is a relative path", "must be absolute"]),
            (
                Some("/nowhere"),
                &[
                    "cannot read /nowhere/model.toml",
                    "resources of the unpacked FMU",
                ],
            ),
        ] {
            let request = Request {
                resources: location.map(|text| CString::new(text).unwrap()),
                ..good.clone()
            };
            no_instance(version, &request, parts);
        }
        an_instance(version, &good);
    }
}

#[test]
fn a_missing_or_changed_resource_gives_no_instance_and_leaves_others_alone() {
    let component = Component::new(REDUCED_RIG);
    let file = component.folder.join("model.toml");
    let path = file.to_str().unwrap();
    let changes: [(&str, String, &[&str]); 8] = [
        (
            "a value",
            changed("0.0149", "0.0150"),
            &["the token", "does not match", path],
        ),
        (
            "a comment",
            format!("{REDUCED_RIG}\n# seen\n"),
            &["the token", "does not match", path],
        ),
        (
            "an unknown key",
            changed("[disc]\n", "[disc]\nmass = 4.5\n"),
            &[path, "[disc] has no key \"mass\"", "known are inertia"],
        ),
        (
            "an unknown section",
            format!("{REDUCED_RIG}\n[disk]\nx = 1\n"),
            &[path, "there is no section [disk]", "known are disc"],
        ),
        (
            "a missing key",
            changed("law = \"stribeck\"", ""),
            &[path, "[contact] lacks law", "one of coulomb"],
        ),
        (
            "out of range",
            changed("value = 0.0149", "value = -1.0"),
            &[path, "disc.inertia = -1", "above 0"],
        ),
        (
            "no TOML",
            "what is this".to_owned(),
            &[path, "not valid TOML"],
        ),
        (
            "too large",
            format!("{REDUCED_RIG}{}", "#".repeat(1 << 20)),
            &[path, "larger than 1048576 bytes"],
        ),
    ];
    for version in BOTH {
        let good = component.request(version);
        let mut living = component.start(version, &CASE);
        for (what, text, parts) in &changes {
            fs::write(&file, text).unwrap();
            println!("{what}");
            no_instance(version, &good, parts);
        }
        fs::write(&file, b"\xff\xfe").unwrap();
        no_instance(version, &good, &[path, "UTF-8"]);
        fs::remove_file(&file).unwrap();
        no_instance(version, &good, &["cannot read", path, "No such file"]);
        fs::create_dir(&file).unwrap();
        no_instance(version, &good, &["cannot read", path, "directory"]);
        fs::remove_dir(&file).unwrap();
        // What lives already does not need the file any more.
        living.run(0.01, 0.5);
        living.reset();
        fs::write(&file, REDUCED_RIG).unwrap();
        living.initialize(0.0, &CASE);
        goes_on(&component, &mut living, 0.5);
        an_instance(version, &good);
    }
}

/// The reduced rig's file with one text replaced; it must be there.
fn changed(old: &str, new: &str) -> String {
    assert!(REDUCED_RIG.contains(old), "{old}");
    REDUCED_RIG.replacen(old, new, 1)
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
