//! Mistakes that people make at the command line: exit code 2, one line that says what was wrong and what is right, each
//! reason said once, and nothing written.
#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail by panicking, like the tests"
)]

use std::fs;
use std::path::Path;
use std::process::Command;

/// The reduced rig with one text replaced, as a file of this name.
fn changed(folder: &Path, name: &str, old: &str, new: &str) {
    let text = include_str!("../../../modelDescription/reduced-rig.toml");
    assert!(text.contains(old), "{old}");
    fs::write(folder.join(name), text.replacen(old, new, 1)).unwrap();
}

#[test]
fn each_mistake_is_named_once_with_its_remedy() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    for (name, text) in [
        (
            "rig.toml",
            include_str!("../../../modelDescription/reduced-rig.toml"),
        ),
        (
            "full.toml",
            include_str!("../../../modelDescription/full-rig.toml"),
        ),
        (
            "soft.toml",
            include_str!("../../../modelDescription/soft-torque.toml"),
        ),
        (
            "parameter.csv",
            "time,u,N2,disc.inertia\n0,1,5,0.01\n1,1,5,0.02\n",
        ),
        ("foreign.csv", "time,u,N2,foo\n0,1,5,1\n1,1,5,1\n"),
        ("semicolons.csv", "time;u;N2\n0;1;5\n"),
        ("backward.csv", "time,u,N2\n0,1,5\n1,1,5\n0.5,1,5\n"),
        (
            "control.csv",
            "time,omega_ref,theta3_dot,i\n0,5,4,0\n1,5,4,0\n",
        ),
        ("text.fmu", "no archive"),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
    changed(folder, "misspelt.toml", "inertia =", "inertai =");
    changed(folder, "negative.toml", "value = 0.3482", "value = -0.3482");
    changed(folder, "unit.toml", "\"kg m2\"", "\"g cm2\"");
    fs::write(folder.join("bytes.toml"), [0x50, 0x4b, 3, 4, 0xff, 0xfe]).unwrap();
    let drive = "--speed-rpm 55 --normal-force 50";
    for (command, parts) in [
        (
            format!("simulate misspelt.toml {drive}"),
            &[
                "misspelt.toml",
                "[disc]",
                "\"inertai\"",
                "known are inertia",
            ][..],
        ),
        (
            format!("simulate negative.toml {drive}"),
            &["negative.toml", "shaft.stiffness = -0.3482", "not below 0"],
        ),
        (
            format!("simulate unit.toml {drive}"),
            &["unit.toml", "inertia.unit = \"g cm2\"", "\"kg.m2\""],
        ),
        (
            "build misspelt.toml".to_owned(),
            &["misspelt.toml", "\"inertai\"", "known are inertia"],
        ),
        (
            "build absent.toml".to_owned(),
            &["absent.toml", "No such file"],
        ),
        (
            "build bytes.toml".to_owned(),
            &["bytes.toml", "not a text file", "(.toml)"],
        ),
        (
            format!("simulate absent.toml {drive}"),
            &["absent.toml", "No such file"],
        ),
        (
            format!("simulate rig.toml {drive} --out rig.toml"),
            &["rig.toml", "File exists"],
        ),
        (
            "simulate rig.toml --speed-rpm 55 --normal-force -50".to_owned(),
            &["--normal-force -50", "0 N or more"],
        ),
        (
            format!("simulate rig.toml {drive} --duration -1"),
            &["--duration -1", "positive"],
        ),
        (
            format!("simulate rig.toml {drive} --set disc.inertia=1 --set disc.inertia=2"),
            &["--set disc.inertia", "twice"],
        ),
        (
            "simulate rig.toml --inputs parameter.csv".to_owned(),
            &["parameter.csv", "`disc.inertia`", "--set"],
        ),
        (
            "simulate rig.toml --inputs foreign.csv".to_owned(),
            &["foreign.csv", "no variable `foo`"],
        ),
        (
            "simulate rig.toml --inputs semicolons.csv".to_owned(),
            &["semicolons.csv line 1", "separated by commas"],
        ),
        (
            "simulate rig.toml --inputs backward.csv".to_owned(),
            &["backward.csv line 4", "times must increase"],
        ),
        (
            "simulate soft.toml --inputs control.csv".to_owned(),
            &["a rig is needed", "closed-loop"],
        ),
        (
            format!("simulate text.fmu {drive}"),
            &["text.fmu", "not a sound zip archive"],
        ),
        (
            format!("map rig.toml {drive} --vary contact.mu=0.1:0.2:3"),
            &["`contact.mu`", "did you mean"],
        ),
        (
            "map rig.toml --speed-rpm 55 --normal-force -10:20:3".to_owned(),
            &["normal_force = -10", "0 N or more"],
        ),
        (
            "map rig.toml --speed-rpm 5:60 --normal-force 10".to_owned(),
            &["5:60", "from:to:count"],
        ),
        (
            "map text.fmu --speed-rpm 5:60:3 --normal-force 10".to_owned(),
            &["text.fmu is an FMU", "resources/model.toml"],
        ),
        (
            "map soft.toml --speed-rpm 5:60:3 --normal-force 10".to_owned(),
            &["soft.toml is a controller", "closed-loop"],
        ),
        (
            format!("closed-loop full.toml --controller soft.toml {drive}"),
            &["full.toml is a full rig", "--normal-force-1"],
        ),
        (
            format!("closed-loop rig.toml --controller soft.toml {drive} --normal-force-1 5"),
            &["rig.toml has no disc D1"],
        ),
        (
            format!("closed-loop rig.toml --controller absent.toml {drive}"),
            &["absent.toml", "No such file"],
        ),
        (
            format!("cross-check rig.toml {drive} --duration 0.001"),
            &["--duration 0.001", "0.01 s or more"],
        ),
        (
            "cross-check rig.toml --normal-force 50".to_owned(),
            &["--speed-rpm RPM", "needed for a rig"],
        ),
        (
            "cross-check text.fmu --normal-force 50".to_owned(),
            &["--normal-force", "its own experiment"],
        ),
        (
            "cross-check text.fmu".to_owned(),
            &["text.fmu is not a zip archive"],
        ),
        (
            format!("cross-check soft.toml {drive}"),
            &["soft.toml", "needs a rig"],
        ),
    ] {
        let mut words: Vec<&str> = command.split(' ').collect();
        if !words.contains(&"--out") {
            words.extend(["--out", "out"]);
        }
        let output = Command::new(env!("CARGO_BIN_EXE_stickslip"))
            .args(&words)
            .current_dir(folder)
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{command}: {said}");
        for part in parts {
            assert!(said.contains(part), "{command}: {part:?} is not in {said}");
        }
        let reasons: Vec<&str> = said.trim_end().split(": ").collect();
        for (place, reason) in reasons.iter().enumerate() {
            assert!(!reasons[..place].contains(reason), "twice: {said}");
        }
        assert!(!folder.join("out").exists(), "{command} left something");
    }
}

#[test]
fn a_controller_is_described_too() {
    let model = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../modelDescription/soft-torque.toml"
    );
    let output = Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(["info", model])
        .output()
        .unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success());
    for part in ["control  soft torque", "omega_ref", "soft_torque.impedance"] {
        assert!(said.contains(part), "{part} is missing in\n{said}");
    }
}
