//! `stickslip closed-loop` as a user runs it: what soft torque does, and what it leaves behind.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn model(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../modelDescription")
        .join(name)
}

fn closed_loop(controller: &str, arguments: &[&str], out: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .arg("closed-loop")
        .arg(model("reduced-rig.toml"))
        .arg("--controller")
        .arg(model(controller))
        .args(arguments)
        .arg("--out")
        .arg(out)
        .output()
        .unwrap()
}

/// The rows of a table whose first cells are these, as cells.
fn rows(table: &str, start: &str) -> Vec<Vec<String>> {
    let lines = table.lines().filter(|line| line.starts_with(start));
    lines
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect()
}

#[test]
fn soft_torque_ends_stick_slip_over_most_of_the_map() {
    let folder = tempfile::tempdir().unwrap();
    let arguments =
        "--speed-rpm 20:60:3 --normal-force 30:70:3 --duration 40 --communication-step 0.005";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let output = closed_loop("soft-torque.toml", &arguments, folder.path());
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let table = fs::read_to_string(folder.path().join("map.csv")).unwrap();
    let sticks = |drive: &str| -> usize {
        let of_drive = rows(&table, drive);
        assert_eq!(of_drive.len(), 9);
        of_drive.iter().filter(|row| row[3] == "stick_slip").count()
    };
    assert_eq!(sticks("constant_voltage"), 9, "{table}");
    // At 20 rpm and 50 or 70 N friction falls too steeply with velocity for a matched drive.
    assert_eq!(sticks("soft_torque"), 2, "{table}");
    let slow = |row: &[String]| row[1] == "20.0" && row[2] != "30.0";
    let controlled = rows(&table, "soft_torque");
    assert!(
        controlled.iter().all(|row| slow(row) || row[3] == "steady"),
        "{table}"
    );
    for picture in ["map.svg", "map.png"] {
        assert!(fs::metadata(folder.path().join(picture)).unwrap().len() > 5000);
    }
    assert!(!folder.path().join("map.journal").exists());
}

#[test]
fn longer_communication_steps_move_the_closed_loop_away() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = "--speed-rpm 55 --normal-force 50 --duration 20 --communication-step 0.05,0.0005,0.001,0.002";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let output = closed_loop("soft-torque.toml", &arguments, folder.path());
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let table = fs::read_to_string(folder.path().join("steps.csv")).unwrap();
    let differences = |drive: &str| -> Vec<f64> {
        rows(&table, drive)
            .iter()
            .map(|row| row[7].parse().unwrap())
            .collect()
    };
    // Constant voltage: nothing is exchanged, nothing changes.
    assert!(
        differences("constant_voltage")
            .iter()
            .all(|difference| *difference < 1e-12),
        "{table}"
    );
    let soft = differences("soft_torque");
    assert_eq!(soft.len(), 4);
    assert!(
        soft.is_sorted() && soft[1] > 1e-5 && soft[2] < 1e-2 && soft[3] > 0.1,
        "{table}"
    );
    assert!(fs::metadata(folder.path().join("steps.svg")).unwrap().len() > 5000);
}

#[test]
fn what_cannot_be_a_closed_loop_is_refused_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |controller: &str, arguments: &str, reason: &str| {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let output = closed_loop(controller, &arguments, &folder.path().join("out"));
        assert_eq!(output.status.code(), Some(2));
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(message.contains(reason), "{message}");
        assert!(!folder.path().join("out").exists());
    };
    let range = "--speed-rpm 20:60:3 --normal-force 50";
    refused("full-rig.toml", range, "has an output `u`");
    refused("absent.toml", range, "cannot be read");
    refused(
        "soft-torque.toml",
        &format!("{range} --communication-step 0.001,0.002"),
        "one speed",
    );
    refused(
        "soft-torque.toml",
        &format!("{range} --communication-step 0"),
        "positive",
    );
    refused(
        "soft-torque.toml",
        "--speed-rpm 20 --normal-force -1",
        "0 N or more",
    );
}
