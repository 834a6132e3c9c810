//! The command line, run as a user runs it.
#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail by panicking, like the tests"
)]
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use workbench::files::record::Record;

fn stickslip(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(arguments)
        .output()
        .unwrap()
}

fn model(name: &str) -> String {
    format!(
        "{}/../../modelDescription/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    )
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Runs a command that must succeed.
fn done(arguments: &[&str]) -> String {
    let output = stickslip(arguments);
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

/// Runs a command that must refuse its input with exit code 2 and returns what it says.
fn refused(arguments: &[&str]) -> String {
    let output = stickslip(arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// The run whose end was computed independently: Stribeck law, ω = 5.76 rad/s, N2 = 50 N.
fn reference_inputs(directory: &Path) -> PathBuf {
    let path = directory.join("inputs.csv");
    fs::write(
        &path,
        "time,u,N2\n0,3.1087844266666664,50\n60,3.1087844266666664,50\n",
    )
    .unwrap();
    path
}

fn assert_reference(record: &Record) {
    let last = |name: &str| *record.require(name).unwrap().last().unwrap();
    let expected = [
        ("theta", 325.0431244429),
        ("theta_dot", 12.5319201466),
        ("theta3", 326.0615433823),
        ("theta3_dot", 5.5316915775),
        ("i", 1.3537462670),
    ];
    for (name, value) in expected {
        assert!(
            (last(name) - value).abs() < 1e-8,
            "{name}: {} instead of {value}",
            last(name)
        );
    }
}

#[test]
fn the_reference_run_from_a_csv() {
    let place = tempfile::tempdir().unwrap();
    let (inputs, out) = (reference_inputs(place.path()), place.path().join("out"));
    let said = done(&[
        "simulate",
        &model("reduced-rig"),
        "--inputs",
        text(&inputs),
        "--out",
        text(&out),
    ]);
    assert!(said.contains("motion          stick_slip"), "{said}");
    assert_reference(&Record::read(&out.join("result.csv")).unwrap());
    assert!(out.join("result.svg").exists() && out.join("result.png").exists());
}

#[test]
fn built_fmus_give_the_same_numbers_as_the_model() {
    let place = tempfile::tempdir().unwrap();
    let (inputs, out) = (reference_inputs(place.path()), place.path().join("out"));
    // The library that the tests were linked with lies beside the test binaries.
    let library = std::env::current_exe().unwrap().with_file_name(format!(
        "{}stickslip{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    ));
    done(&[
        "build",
        &model("reduced-rig"),
        "--library",
        text(&library),
        "--out",
        text(place.path()),
    ]);
    done(&[
        "simulate",
        &model("reduced-rig"),
        "--inputs",
        text(&inputs),
        "--out",
        text(&out),
    ]);
    let native = Record::read(&out.join("result.csv")).unwrap();
    for version in ["fmi2", "fmi3"] {
        let fmu = place.path().join(format!("ReducedRig.{version}.fmu"));
        let out = place.path().join(version);
        done(&[
            "simulate",
            text(&fmu),
            "--inputs",
            text(&inputs),
            "--out",
            text(&out),
        ]);
        let record = Record::read(&out.join("result.csv")).unwrap();
        assert_reference(&record);
        for name in ["theta", "theta_dot", "T_f", "theta3", "theta3_dot", "i"] {
            let both = native
                .require(name)
                .unwrap()
                .iter()
                .zip(record.require(name).unwrap());
            let apart = both
                .map(|(left, right)| (left - right).abs())
                .fold(0.0, f64::max);
            assert!(apart < 1e-12, "{version} {name}: {apart}");
        }
        let said = done(&["info", text(&fmu)]);
        assert!(
            said.contains("law      stribeck") && said.contains("contact.mu_s"),
            "{said}"
        );
    }
}

#[test]
fn the_full_rig_runs_and_asks_for_its_second_force() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("out");
    let begin = [
        "simulate",
        &model("full-rig"),
        "--speed-rpm",
        "40",
        "--normal-force",
        "20",
        "--out",
        text(&out),
    ];
    assert!(refused(&begin).contains("--normal-force-1 is needed"));
    let mut arguments = begin.to_vec();
    arguments.extend(["--normal-force-1", "30", "--duration", "5"]);
    done(&arguments);
    assert!(
        Record::read(&out.join("result.csv"))
            .unwrap()
            .column("theta1_dot")
            .is_some()
    );
}

#[test]
fn parameters_are_set_by_name() {
    let place = tempfile::tempdir().unwrap();
    let last = |setting: &str| {
        let out = place.path().join(setting);
        let model = model("reduced-rig");
        let arguments = [
            "simulate",
            &model,
            "--speed-rpm",
            "55",
            "--normal-force",
            "50",
            "--duration",
            "3",
        ];
        done(&[&arguments[..], &["--set", setting, "--out", text(&out)]].concat());
        *Record::read(&out.join("result.csv"))
            .unwrap()
            .require("theta")
            .unwrap()
            .last()
            .unwrap()
    };
    assert_eq!(last("disc.inertia=0.0149"), last("disc.inertia=1.49e-2"));
    assert!((last("disc.inertia=0.0149") - last("disc.inertia=0.03")).abs() > 1e-3);
}

#[test]
fn wrong_input_is_answered_with_what_is_right() {
    let place = tempfile::tempdir().unwrap();
    let model = model("reduced-rig");
    let out = place.path().join("out");
    let drive = [
        "--speed-rpm",
        "55",
        "--normal-force",
        "50",
        "--out",
        text(&out),
    ];
    let with = |more: &[&str]| refused(&[&["simulate", &model], &drive[..], more].concat());
    assert!(with(&["--set", "disc.inertai=0.015"]).contains("did you mean `disc.inertia`"));
    assert!(with(&["--set", "disc.inertia=-1"]).contains("disc.inertia = -1 is out of range"));
    assert!(with(&["--set", "u=3"]).contains("is not a parameter but an input"));
    assert!(with(&["--step", "0"]).contains("--step 0"));
    assert!(with(&["--normal-force-1", "3"]).contains("no disc D1"));
    let csv = |content: &str| {
        let path = place.path().join("wrong.csv");
        fs::write(&path, content).unwrap();
        refused(&[
            "simulate",
            &model,
            "--inputs",
            text(&path),
            "--out",
            text(&out),
        ])
    };
    assert!(csv("time,u\n0,1\n1,1\n").contains("has no column `N2`"));
    assert!(csv("time,u,n2\n0,1,1\n1,1,1\n").contains("did you mean `N2`"));
    assert!(csv("time,u,N2\n0,1,x\n").contains("line 2, column `N2`: `x` is not a number"));
    assert!(
        refused(&["simulate", &model, "--out", text(&out)]).contains("say what drives the rig")
    );
    assert!(refused(&["simulate", "rig.txt", "--out", text(&out)]).contains("neither a model"));
    assert!(refused(&["info", "nowhere.fmu"]).contains("nowhere.fmu"));
    assert!(!out.exists());
}

#[test]
fn info_tells_law_parameters_and_their_sources() {
    let said = done(&["info", &model("reduced-rig")]);
    for part in [
        "law      stribeck",
        "effects  none",
        "disc.inertia",
        "0.0149 kg.m2",
        "[published: Table 4.1",
        "theta_dot",
    ] {
        assert!(said.contains(part), "{part} is missing in\n{said}");
    }
}

#[test]
fn a_reader_that_has_gone_is_no_panic() {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .arg("effects")
        .stdout(writer)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
        .wait_with_output()
        .unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[test]
fn the_page_of_one_effect_is_printed() {
    let page = |name: &str| {
        Command::new(env!("CARGO_BIN_EXE_stickslip"))
            .args(["effects", name])
            .output()
            .unwrap()
    };
    let said = String::from_utf8(page("unbalance").stdout).unwrap();
    assert!(
        said.starts_with("# unbalance\n") && said.contains("## Equation"),
        "{said}"
    );
    let refused = page("unbalence");
    let said = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(said.contains("is `unbalance` meant?"), "{said}");
}
