//! `stickslip diagnose --catalogue`, and functions that are learned where no effect explains the records, as a user runs them.
//!
//! The case is that of `diagnose.rs`: a disc with an unbalance.
#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail by panicking, like the tests"
)]

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use workbench::diagnose::finding::{Finding, VerdictName};

use common::{library, stickslip};

fn within(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Runs a stage on the case, into `out`.
fn run(stage: &str, out: &Path, further: &[&str]) -> (i32, String) {
    let case = within("tests/data/unbalance");
    let mut own = vec![
        stage,
        case.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ];
    let library = library("stickslip");
    if stage != "name" {
        own.extend(["--library", &library]);
    }
    stickslip(&[&own, further].concat())
}

#[test]
fn suspects_that_are_not_missing_are_not_named_beside_what_is() {
    let out = tempfile::tempdir().unwrap();
    let suspects = within("../../docs/examples/effects");
    let (code, text) = run(
        "name",
        out.path(),
        &["--catalogue", suspects.to_str().unwrap()],
    );
    assert_eq!(code, 0, "{text}");
    let finding = Finding::read(out.path()).unwrap();
    let names: Vec<&str> = finding.effects.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(
        (finding.verdict, names),
        (VerdictName::Named, vec!["unbalance"])
    );
}

#[test]
fn a_suspect_that_is_what_is_missing_goes_into_the_amended_model() {
    let (out, suspects) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let text = "[[effect]]\nname = \"heavy_spot\"\ntitle = \"a heavy spot on the disc\"\nport = \"disc.torque\"\n\
                equation = \"-weight*cos(angle - place)\"\n\
                parameters.weight = { unit = \"N.m\", range = \"non-negative\", description = \"largest torque\" }\n\
                parameters.place = { unit = \"rad\", description = \"angle of the largest torque\" }\n";
    fs::write(suspects.path().join("heavy.toml"), text).unwrap();
    let directory = suspects.path().to_str().unwrap();
    let further = ["--catalogue", directory, "--without", "unbalance"];
    let (code, text) = run("name", out.path(), &further);
    assert_eq!(code, 0, "{text}");
    let (code, text) = run("amend", out.path(), &further);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("a heavy spot on the disc"), "{text}");
    let finding = Finding::read(out.path()).unwrap();
    let weight = &finding.effects[0].parameters["weight"];
    let [low, high] = weight.interval95.unwrap();
    assert!(low < 0.0456 && 0.0456 < high, "{weight:?}");
    let model = fs::read_to_string(out.path().join("model.amended.toml")).unwrap();
    assert!(model.contains("name = \"heavy_spot\""), "{model}");
}

#[test]
fn what_no_effect_explains_is_learned_and_closes_the_gap_through_the_fmu() {
    let out = tempfile::tempdir().unwrap();
    let without = ["--without", "unbalance", "--without", "normal_force_wobble"];
    let (code, text) = run("diagnose", out.path(), &without);
    assert_eq!(code, 1, "{text}");
    let finding = Finding::read(out.path()).unwrap();
    assert_eq!(finding.verdict, VerdictName::NotInCatalogue);
    let learned = finding.learned.unwrap();
    assert_eq!(
        (learned.port.as_str(), learned.coordinate.as_str()),
        ("disc.torque", "angle")
    );
    let closed = finding.gap.unwrap().through_fmu.fmi3.closed.unwrap();
    assert!(closed > 0.99, "{closed}");
    let model = fs::read_to_string(out.path().join("model.amended.toml")).unwrap();
    assert!(model.contains("[effect.tables.term]"), "{model}");
}

#[test]
fn a_directory_of_suspects_that_cannot_be_used_is_refused_with_the_file() {
    let effect = |name: &str, equation: &str| {
        format!(
            "[[effect]]\nname = \"{name}\"\ntitle = \"t\"\nport = \"disc.torque\"\nequation = \"{equation}\"\n\
             parameters.pull = {{ unit = \"N.m\", description = \"d\" }}\n"
        )
    };
    let good = effect("tug", "pull*cos(angle)");
    /// Names and texts of the files, and what the message says.
    type Refused<'a> = (&'a [(&'a str, &'a str)], &'a [&'a str]);
    let cases: [Refused<'_>; 8] = [
        (&[], &["no file *.toml"]),
        (&[("a.toml", "[[effect]")], &["a.toml"]),
        (
            &[("a.toml", "[disc]\ninertia = 1.0\n")],
            &["a.toml", "disc", "effect"],
        ),
        (
            &[("a.toml", &effect("tug", "pull*velocity"))],
            &["a.toml", "tug", "N.m"],
        ),
        (
            &[("a.toml", &effect("unbalance", "pull*cos(angle)"))],
            &["a.toml", "unbalance"],
        ),
        (
            &[("a.toml", &good.replace("disc.torque", "disc1.torque"))],
            &["a.toml", "tug", "reduced rig"],
        ),
        (
            &[("a.toml", &good), ("b.toml", &good)],
            &["b.toml", "tug", "a.toml"],
        ),
        (
            &[(
                "a.toml",
                &good.replace("unit = \"N.m\"", "value = \"x\", unit = \"N.m\""),
            )],
            &["a.toml", "value", "x", "a finite number"],
        ),
    ];
    for (files, expected) in cases {
        let (out, suspects) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        for (name, text) in files {
            fs::write(suspects.path().join(name), text).unwrap();
        }
        let directory = suspects.path().to_str().unwrap();
        let (code, text) = run("name", out.path(), &["--catalogue", directory]);
        assert_eq!(code, 2, "{text}");
        for part in expected {
            assert!(text.contains(part), "{part}: {text}");
        }
    }
}
