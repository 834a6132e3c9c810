//! Bad input through both C interfaces: the standard's status, one log line that says which thing, what it was and what
//! is right, and an instance that goes on where the standard lets it.
//!
//! After *discard* and *warning* an instance goes on as one that never saw the call; after *error* a reset, or a saved
//! state, brings it back. NULL pointers and calls in the wrong state have files of their own.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod call_order;
mod handles;
#[path = "../importer/mod.rs"]
mod importer;
mod instantiation;
mod null_pointers;
mod steps;
mod values;

use importer::{Component, Fmi2, Fmi3, Instance, Log, Version};
use stickslip::ffi::Status::{self, Discard, Error, Warning};

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

/// As [`goes_on`], to 1e-9: inputs that were put in force and taken back begin a segment of their own.
#[track_caller]
fn goes_on_nearly(component: &Component, instance: &mut Instance<'_>, end: f64) {
    instance.run(0.01, end);
    let expected = undisturbed(component, instance.version, end);
    let found = outputs(instance);
    for (name, (found, expected)) in OUTPUTS.iter().zip(found.iter().zip(&expected)) {
        let (found, expected) = (f64::from_bits(*found), f64::from_bits(*expected));
        assert!(
            (found - expected).abs() < 1e-9,
            "{name}: {found} for {expected}"
        );
    }
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
