//! A small campaign against the library of this build: `cargo build -p stickslip` has to come first.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use stress_tests::campaign;
use stress_tests::component::{Component, FULL_RIG, REDUCED_RIG};
use stress_tests::library::{Library, beside_program};
use stress_tests::standard::Version;

#[test]
fn twenty_thousand_calls_of_each_version_do_as_standard_and_native_model_say() {
    let library = Library::load(&beside_program().unwrap()).unwrap();
    let components = [
        Component::new(REDUCED_RIG).unwrap(),
        Component::new(FULL_RIG).unwrap(),
    ];
    for version in [Version::Two, Version::Three] {
        match campaign::run(&library, &components, version, 77, 20_000, |_| ()) {
            Ok(tally) => assert!(
                tally.refused > tally.calls / 10 && tally.refused < tally.calls / 2,
                "{tally:?}"
            ),
            Err(failure) => panic!("{failure}"),
        }
    }
}
