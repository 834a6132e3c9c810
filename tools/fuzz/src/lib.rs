//! What coverage-guided fuzzing feeds (`tools/fuzz/run`), and what replays its corpus: bytes in, no panic and no endless loop
//! out.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use build_fmu::binary_header;
use build_fmu::lint::{self, Loading, Package};
use build_fmu::platform::FmiVersion;
use build_fmu::symbols;
use stickslip::body::{self, Kind};
use stickslip::cosim::state::{seal, unseal};
use stickslip::cosim::{Causality, StateReader, open};
use stickslip::plant::{Rig, Supposition};
use workbench::calibrate::journal::Journal as Judgements;
use workbench::calibrate::target::Target as Calibration;
use workbench::component::Fmu;
use workbench::diagnose::case::Case;
use workbench::diagnose::finding::{self, Finding};
use workbench::diagnose::material::CaseArguments;
use workbench::diagnose::sensors::Sensors;
use workbench::diagnose::small_plant::finding::SmallFinding;
use workbench::diagnose::small_plant::model_file::SmallModel;
use workbench::diagnose::{amend, console};
use workbench::files::record::{Missing, Record};
use workbench::map::Journal;

/// The component whose states are fuzzed.
const REDUCED_RIG: &str = include_str!("../../../modelDescription/reduced-rig.toml");
/// A rig with all ports at which an effect can act.
const FULL_RIG: &str = include_str!("../../../modelDescription/full-rig.toml");
/// A small plant with all coordinates on which an effect of a run can depend.
const JOINT: &str = r#"
[plant]
kind = "joint"
path = "turn"
[joint]
stiffness = 72.0
rest = 0.0
viscous = 1.0
gain = 15.0
back_emf = 10.0
[coulomb_friction]
force = 4.0
"#;
/// A rig with the law that calibrations are about.
const TWO_GAUSSIAN_RIG: &str = include_str!("../../../crates/workbench/targets/eq-6-2-rig.toml");
/// A case for findings to be about.
const CASE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../crates/workbench/tests/data/unbalance"
);

/// A fuzz target: its name, which is that of its folder in the corpus, and what it does.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [Target; 11] = [
    ("state", state),
    ("model", model),
    ("record", record),
    ("sensors", sensors),
    ("fmu", fmu),
    ("binary", binary),
    ("calibration", calibration),
    ("small", small),
    ("effect", effect),
    ("finding", found),
    ("journal", journal),
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

/// A file of its own for the bytes, where a reader wants a file.
fn file(bytes: &[u8], name: &str) -> Option<PathBuf> {
    static PLACE: OnceLock<Option<tempfile::TempDir>> = OnceLock::new();
    let place = PLACE.get_or_init(|| tempfile::tempdir().ok()).as_ref()?;
    let path = place.path().join(name);
    fs::write(&path, bytes).ok()?;
    Some(path)
}

/// An FMU: its archive and its description, without running its binary.
pub fn fmu(bytes: &[u8]) {
    let Some(path) = file(bytes, "fuzzed.fmu") else {
        return;
    };
    let _ = Fmu::describe(&path);
    if let Ok(package) = Package::open(&path) {
        let _ = lint::check(&package, Loading::FilesOnly);
    }
    let text = String::from_utf8_lossy(bytes);
    let _ = workbench::component::Description::parse(&text, Path::new("fuzzed.fmu"));
}

/// A library's headers and exports, without loading it.
pub fn binary(bytes: &[u8]) {
    let _ = (
        binary_header::check(bytes),
        binary_header::platform(bytes).is_ok(),
    );
    if let Ok(library) = binary_header::parse(bytes) {
        let required = symbols::required(FmiVersion::Fmi3).to_vec();
        let _ = symbols::missing_from(&library, required);
    }
}

/// The text of a calibration's target file.
pub fn calibration(bytes: &[u8]) {
    static RIG: OnceLock<Option<Rig<f64>>> = OnceLock::new();
    if let Some(rig) = RIG.get_or_init(|| Rig::from_toml(TWO_GAUSSIAN_RIG, "rig.toml").ok()) {
        let _ = Calibration::parse(&String::from_utf8_lossy(bytes), "target.toml", rig);
    }
}

/// The text of a small plant's model file.
pub fn small(bytes: &[u8]) {
    let _ = SmallModel::parse(&String::from_utf8_lossy(bytes), "model.toml");
}

/// A file of effects: read as `--catalogue` reads it, for rigs and for small plants, and each equation evaluated; then as sections of a
/// rig's and of a joint's model file, and where those are models, started and stepped.
pub fn effect(bytes: &[u8]) {
    const VALUES: [f64; 7] = [0.0, 1.0, -1.0, 0.3, -2e6, 1e300, f64::MIN_POSITIVE];
    let text = String::from_utf8_lossy(bytes);
    if let Ok(all) = Supposition::read_all(&text, "effect.toml") {
        for Supposition { definition, .. } in all {
            let numbers = vec![0.7; definition.infos().len()];
            for value in VALUES {
                let _ = definition.value(
                    |coordinate| value * (1.0 + coordinate as u8 as f64),
                    &numbers,
                );
            }
        }
    }
    for described in body::read_effects(&text, "effect.toml").unwrap_or_default() {
        for kind in Kind::ALL {
            for path in [body::Path::Line, body::Path::Turn] {
                let _ = described.effect("effect.toml", kind, path);
            }
        }
    }
    for plant in [FULL_RIG, JOINT] {
        under_way(&format!("{plant}\n{text}"));
    }
}

/// A model with effects of its own, driven: its first hundredth of a second.
fn under_way(text: &str) {
    let Ok(mut model) = open(text, "model.toml") else {
        return;
    };
    for variable in model.table().variables().to_vec() {
        if variable.causality == Causality::Input {
            let _ = model.set_real(variable.value_reference, 5.0);
        }
    }
    if model.initialise().is_ok() {
        let _ = model.step(model.time() + 1e-2, false);
    }
}

/// A `finding.json`: read, shown, and made into an amended model.
pub fn found(bytes: &[u8]) {
    static CASES: OnceLock<Option<Case>> = OnceLock::new();
    let case = CASES.get_or_init(|| {
        let arguments = CaseArguments {
            case: Some(CASE.into()),
            ..CaseArguments::default()
        };
        arguments.load().ok()
    });
    let path = file(bytes, finding::FILE);
    let (Some(case), Some(folder)) = (case, path.as_deref().and_then(Path::parent)) else {
        return;
    };
    let _ = SmallFinding::read(folder);
    let Ok(finding) = Finding::read(folder) else {
        return;
    };
    let _ = (console::screen("fuzzed", &finding), finding.is_settled());
    if let Ok(model) = amend::amended_model(case, &finding) {
        let _ = amend::text(case, &finding, &model);
    }
}

/// What a killed map or calibration left, below the line that says whose it is.
pub fn journal(bytes: &[u8]) {
    let Some(path) = file(&[b"\"whose\"\n", bytes].concat(), "fuzzed.journal") else {
        return;
    };
    if let Ok((_, rows)) = Journal::open(&path, "whose", "map", (3, 2)) {
        assert!(
            rows.iter()
                .all(|(row, points)| *row < 3 && points.len() == 2)
        );
    }
    if fs::write(&path, [b"\"whose\"\n", bytes].concat()).is_ok() {
        let _ = Judgements::open(&path, "whose");
    }
}
