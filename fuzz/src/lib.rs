//! What coverage-guided fuzzing feeds (`fuzz/run`), and what replays its corpus: bytes in, no panic and no endless loop
//! out.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use build_fmu::lint::{self, Loading, Package};
use stickslip::cosim::state::{seal, unseal};
use stickslip::cosim::{StateReader, open};
use workbench::component::Fmu;
use workbench::diagnose::sensors::Sensors;
use workbench::files::record::{Missing, Record};

/// The component whose states are fuzzed.
const REDUCED_RIG: &str = include_str!("../../modelDescription/reduced-rig.toml");

/// A fuzz target: its name, which is that of its folder in the corpus, and what it does.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [Target; 5] = [
    ("state", state),
    ("model", model),
    ("record", record),
    ("sensors", sensors),
    ("fmu", fmu),
];

/// Content of a serialised state, put into the envelope that a forger would make: restored, stepped and read.
pub fn state(content: &[u8]) {
    let Ok(mut rig) = open(REDUCED_RIG, "model.toml") else {
        return;
    };
    let sealed = seal(rig.token(), content);
    assert_eq!(unseal(rig.token(), &sealed), Ok(content));
    let _ = unseal(rig.token(), content);
    if rig.restore(&mut StateReader::new(content)).is_err() {
        return;
    }
    let _ = rig.step(rig.time() + 1e-3, false);
    for variable in rig.table().variables().to_vec() {
        let _ = rig.real(variable.value_reference);
    }
}

/// The text of a `model.toml`: opened, and if it is one, started and stepped.
pub fn model(bytes: &[u8]) {
    let Ok(mut rig) = open(&String::from_utf8_lossy(bytes), "model.toml") else {
        return;
    };
    if rig.initialise().is_ok() {
        let _ = rig.step(rig.time() + 1e-3, false);
    }
}

/// The text of a record.
pub fn record(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    for missing in [Missing::Refuse, Missing::KeepAsNan] {
        if let Ok(record) = Record::parse(&text, "record.csv", missing) {
            let _ = (record.median_step(), record.gaps(), record.missing());
            assert!(record.time().windows(2).all(|pair| pair[0] < pair[1]));
        }
    }
}

/// The text of a `sensors.toml`.
pub fn sensors(bytes: &[u8]) {
    let _ = Sensors::parse(&String::from_utf8_lossy(bytes), "sensors.toml");
}

/// An FMU: its archive and its description, without running its binary.
pub fn fmu(bytes: &[u8]) {
    static PLACE: OnceLock<Option<tempfile::TempDir>> = OnceLock::new();
    let Some(place) = PLACE.get_or_init(|| tempfile::tempdir().ok()) else {
        return;
    };
    let path = place.path().join("fuzzed.fmu");
    if fs::write(&path, bytes).is_err() {
        return;
    }
    let _ = Fmu::describe(&path);
    if let Ok(package) = Package::open(&path) {
        let _ = lint::check(&package, Loading::FilesOnly);
    }
    let text = String::from_utf8_lossy(bytes);
    let _ = workbench::component::Description::parse(&text, Path::new("fuzzed.fmu"));
}
