//! `stickslip cross-check` of FMUs with reference results inside.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail by panicking, like the tests"
)]

mod common;

use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use build_fmu::build::Source;
use build_fmu::library;
use build_fmu::platform::FmiVersion;
use common::stickslip;
use workbench::files::record::Record;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

const RESULTS: &str = "extra/org.fmi-standard.fmi-ls-ref/ReducedRig_ref.csv";

fn fmu(version: FmiVersion, folder: &Path) -> PathBuf {
    let model =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../modelDescription/reduced-rig.toml");
    let source = Source::read(&model).unwrap();
    let libraries = [library::find(None).unwrap()];
    source.build(&libraries, version, folder).unwrap().path
}

/// Rewrites the FMU with other results; without `change` it has none.
fn rewrite(path: &Path, change: Option<fn(&str) -> String>) {
    let mut archive = ZipArchive::new(File::open(path).unwrap()).unwrap();
    let mut writer = ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).unwrap();
        let name = entry.name().unwrap().into_owned();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).unwrap();
        match change {
            Some(change) if name == RESULTS => {
                content = change(std::str::from_utf8(&content).unwrap()).into_bytes();
            }
            None if name.starts_with("extra/") => continue,
            _ => {}
        }
        writer
            .start_file(name, SimpleFileOptions::default())
            .unwrap();
        writer.write_all(&content).unwrap();
    }
    fs::write(path, writer.finish().unwrap().into_inner()).unwrap();
}

#[test]
fn an_fmu_gives_the_results_that_it_holds() {
    let place = tempfile::tempdir().unwrap();
    for (version, folder) in [
        (FmiVersion::Fmi2, "2.0/cs/linux64"),
        (FmiVersion::Fmi3, "3.0/cs/x86_64-linux"),
    ] {
        let path = fmu(version, place.path());
        let out = place.path().join("out");
        let arguments = [
            "cross-check",
            path.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ];
        let (code, said) = stickslip(&arguments);
        assert_eq!(code, 0, "{said}");
        let folder = out
            .join(folder)
            .join("stickslip_build-fmu")
            .join(env!("CARGO_PKG_VERSION"))
            .join("ReducedRig");
        let record = |end: &str| Record::read(&folder.join(format!("ReducedRig{end}"))).unwrap();
        let (reference, found) = (record("_ref.csv"), record("_out.csv"));
        assert_eq!(reference.len(), 401);
        for name in reference.names() {
            assert_eq!(found.column(name), reference.column(name), "{name}");
        }
        assert_eq!(
            record("_in.csv").column("N2"),
            Some([50.0, 50.0].as_slice())
        );
        let options = fs::read_to_string(folder.join("ReducedRig_ref.opt")).unwrap();
        assert_eq!(
            options,
            "StartTime, 0\nStopTime, 4\nStepSize, 0.01\nRelTol, 1e-10\n"
        );
        assert_eq!(
            fs::read(folder.join("ReducedRig.fmu")).unwrap(),
            fs::read(&path).unwrap()
        );
    }
}

#[test]
fn an_fmu_that_gives_others_fails_the_check() {
    let place = tempfile::tempdir().unwrap();
    let path = fmu(FmiVersion::Fmi2, place.path());
    rewrite(&path, Some(|text| text.replace("\n4,", "\n4,1")));
    let arguments = [
        "cross-check",
        path.to_str().unwrap(),
        "--out",
        place.path().to_str().unwrap(),
    ];
    let (code, said) = stickslip(&arguments);
    assert_eq!(code, 1, "{said}");
    let excess: Vec<&str> = said
        .lines()
        .filter(|line| line.contains("DIFFERS"))
        .collect();
    assert_eq!(excess.len(), 1, "{said}");
    assert!(
        excess[0].contains("theta ") && excess[0].contains("at 4 s"),
        "{said}"
    );
}

#[test]
fn an_fmu_without_results_is_told_so() {
    let place = tempfile::tempdir().unwrap();
    let path = fmu(FmiVersion::Fmi3, place.path());
    rewrite(&path, None);
    let arguments = [
        "cross-check",
        path.to_str().unwrap(),
        "--out",
        place.path().to_str().unwrap(),
    ];
    let (code, said) = stickslip(&arguments);
    assert_eq!(code, 2, "{said}");
    assert!(said.contains("holds no reference results"), "{said}");
}
