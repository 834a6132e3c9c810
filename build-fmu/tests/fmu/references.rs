//! The reference results inside FMUs: there, reproduced in both versions, left out on demand.

use std::fs;

use build_fmu::build::{Reference, Source};
use build_fmu::library;
use build_fmu::lint::{self, Loading, Package};
use build_fmu::platform::FmiVersion;
use build_fmu::reference::table::Table;

use crate::component::{Component, build, shipped_model};
use crate::spoiled::{pack, unpack};

const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";

#[test]
fn every_shipped_model_reproduces_its_results_in_both_versions() {
    let folder = tempfile::tempdir().unwrap();
    for model in [
        "reduced-rig.toml",
        "reduced-rig-two-gaussian.toml",
        "full-rig.toml",
        "soft-torque.toml",
        "speed-controller.toml",
    ] {
        for version in FmiVersion::ALL {
            let path = build(model, version, folder.path());
            let report = lint::report(&Package::open(&path).unwrap(), Loading::Load);
            assert_eq!(report.findings, [], "{model}, {version}");
            let [note] = report.notes.as_slice() else {
                panic!("{model}, {version}: {:?}", report.notes);
            };
            assert!(note.contains("at 401 times to the last bit"), "{note}");
        }
    }
}

/// Without our reader and runner: an importer by others, at a communication step of its own.
#[test]
fn another_importer_finds_the_results_at_its_own_step() {
    let folder = tempfile::tempdir().unwrap();
    for version in FmiVersion::ALL {
        let path = build("reduced-rig.toml", version, folder.path());
        let files = unpack(&path);
        let table = |end: &str| {
            let name = format!("{FOLDER}/ReducedRig_{end}.csv");
            Table::parse(std::str::from_utf8(&files[&name]).unwrap()).unwrap()
        };
        let (inputs, results) = (table("in"), table("ref"));
        let held: Vec<(&str, f64)> = inputs
            .columns
            .iter()
            .map(|column| (column.name.as_str(), column.values[0]))
            .collect();
        let mut component = Component::load(&path, version);
        component.initialise(&held);
        for row in (0..results.time.len()).step_by(5) {
            if row > 0 {
                component.step_to(results.time[row]);
            }
            for column in results
                .columns
                .iter()
                .filter(|column| column.name != "stuck")
            {
                let (found, expected) = (component.get(&column.name), column.values[row]);
                assert!(
                    (found - expected).abs() <= 1e-11 * expected.abs().max(1.0),
                    "{version}, {} at {} s: {found}, {expected}",
                    column.name,
                    results.time[row]
                );
            }
        }
    }
}

#[test]
fn without_a_reference_run_there_is_nothing_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut source = Source::read(&shipped_model("reduced-rig.toml")).unwrap();
    let libraries = [library::find(None).unwrap()];
    let with = source.to_bytes(&libraries, FmiVersion::Fmi2).unwrap().len();
    source.set_reference(Reference::LeftOut);
    let built = source
        .build(&libraries, FmiVersion::Fmi2, folder.path())
        .unwrap();
    let files = unpack(&built.path);
    assert!(files.keys().all(|name| !name.contains("ls-ref")));
    let page = String::from_utf8(files["documentation/index.html"].clone()).unwrap();
    assert!(!page.contains("fmi-ls-ref"), "a link to what is not there");
    let report = lint::report(&Package::open(&built.path).unwrap(), Loading::Load);
    assert_eq!((report.findings.len(), report.notes.len()), (0, 0));
    assert!(with - built.size < 48 << 10, "{} bytes", with - built.size);
}

#[test]
fn an_experiment_as_the_beta_had_it_is_repeated() {
    let folder = tempfile::tempdir().unwrap();
    let path = build("reduced-rig.toml", FmiVersion::Fmi3, folder.path());
    let mut files = unpack(&path);
    let name = format!("{FOLDER}/ReducedRig.exp");
    let text = String::from_utf8(files[&name].clone()).unwrap();
    let (times, new) = (
        " startTime=\"0\" stopTime=\"4\" stepSize=\"0.01\"",
        "<TransientSimulation",
    );
    assert!(text.contains(&format!("{new}{times}/>")), "{text}");
    let old = text
        .replace(&format!("{new}{times}/>"), "")
        .replace("<Experiment name", &format!("<Experiment{times} name"));
    files.insert(name, old.into_bytes());
    fs::write(&path, pack(&files, 1)).unwrap();
    let report = lint::report(&Package::open(&path).unwrap(), Loading::Load);
    assert_eq!(report.findings, []);
    assert!(
        report.notes[0].contains("at 401 times"),
        "{:?}",
        report.notes
    );
}

#[test]
fn what_cannot_be_repeated_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = build("reduced-rig.toml", FmiVersion::Fmi2, folder.path());
    let package = Package::open(&path).unwrap();
    let report = lint::report(&package, Loading::FilesOnly);
    assert!(report.notes[0].contains("not tried"), "{:?}", report.notes);
    let mut files = unpack(&path);
    let name = format!("{FOLDER}/ReducedRig.exp");
    let text = String::from_utf8(files[&name].clone()).unwrap();
    let hdf5 = text.replace("_ref.csv\"", "_ref.csv\" type=\"application/hdf5\"");
    files.insert(name, hdf5.into_bytes());
    fs::write(&path, pack(&files, 1)).unwrap();
    let report = lint::report(&Package::open(&path).unwrap(), Loading::Load);
    assert_eq!(report.findings, []);
    assert!(
        report.notes[0].contains("application/hdf5, which is not read"),
        "{:?}",
        report.notes
    );
}
