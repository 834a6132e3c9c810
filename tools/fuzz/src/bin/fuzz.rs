//! The target that the environment variable `FUZZ_TARGET` names, under libFuzzer.
#![no_main]
#![allow(
    clippy::panic,
    reason = "libFuzzer has no other way to hear of a wrong name"
)]

use std::sync::OnceLock;

use fuzz::TARGETS;
use libfuzzer_sys::fuzz_target;

fn target() -> fn(&[u8]) {
    static TARGET: OnceLock<fn(&[u8])> = OnceLock::new();
    *TARGET.get_or_init(|| {
        let name = std::env::var("FUZZ_TARGET").unwrap_or_default();
        let found = TARGETS.iter().find(|(known, _)| *known == name);
        found
            .unwrap_or_else(|| panic!("FUZZ_TARGET={name:?}: there is no such target"))
            .1
    })
}

fuzz_target!(|bytes: &[u8]| target()(bytes));
