//! Records with missing values and holes in time.

use std::fs;

use workbench::diagnose::finding::VerdictName;

use crate::records::{DRIVE, PENDULUM, drive, pendulum, stopping};
use crate::{Place, names};

/// The record without some lines, and without a value in some.
fn with_holes(record: &str) -> String {
    let mut lines: Vec<String> = record.lines().map(str::to_owned).collect();
    for line in &mut lines[1500..1520] {
        let values: Vec<&str> = line.split(',').collect();
        *line = format!("{},,{}", values[0], values[2]);
    }
    lines.drain(4000..4100);
    lines.join("\n")
}

#[test]
fn stretches_between_holes_are_records_of_their_own() {
    let place = Place::new(
        DRIVE,
        &with_holes(&drive(5.0, 1)),
        &with_holes(&drive(5.0, 2)),
    );
    let (found, text) = place.diagnosed(0);
    assert_eq!(found.finding.verdict, VerdictName::Named, "{text}");
    assert_eq!(names(&found), ["coulomb_friction"]);
    let force = &found.finding.effects[0].parameters["force"];
    assert!((force.value / 5.0 - 1.0).abs() < 0.03, "{force:?}");
    let notes = found.finding.notes.join("\n");
    assert!(notes.contains("records of their own: 3"), "{notes}");
    assert!(notes.contains("its longest stretch"), "{notes}");
}

#[test]
fn a_swing_with_a_hole_is_refused_with_the_place() {
    let place = Place::new(
        PENDULUM,
        &pendulum(0.1, 0.0, 0.0, 1),
        &pendulum(0.1, 0.0, 0.0, 2),
    );
    let path = place.file("run-a.csv");
    let mut lines: Vec<String> = fs::read_to_string(&path)
        .unwrap()
        .lines()
        .map(str::to_owned)
        .collect();
    lines.drain(700..720);
    fs::write(&path, lines.join("\n")).unwrap();
    place.refused("run-a.csv: the step at");
}

#[test]
fn a_column_without_values_is_refused() {
    let empty = |record: &str| {
        let lines = record.lines().enumerate();
        lines
            .map(|(at, line)| match (at, line.rsplit_once(',')) {
                (1.., Some((rest, _))) => format!("{rest},\n"),
                _ => format!("{line}\n"),
            })
            .collect::<String>()
    };
    let place = Place::new(DRIVE, &empty(&drive(5.0, 1)), &drive(5.0, 2));
    place.refused("run-a.csv: has 0 samples with a value in every column");
}

#[test]
fn a_stretch_in_which_the_plant_rests_is_left_out() {
    let model = DRIVE.replace("edge = 0.2", "edge = 0.2\nstandstill_speed = 0.01");
    let begun_at_rest = |seed| {
        let mut lines: Vec<String> = stopping(seed).lines().map(str::to_owned).collect();
        let at_rest = lines[1].split(',').nth(1).unwrap().to_owned();
        for line in &mut lines[1..500] {
            let values: Vec<&str> = line.split(',').collect();
            *line = format!("{},{at_rest},{}", values[0], values[2]);
        }
        lines.drain(500..600);
        lines.join("\n")
    };
    let place = Place::new(&model, &begun_at_rest(1), &stopping(2));
    let (found, text) = place.diagnosed(0);
    assert_eq!(names(&found), ["coulomb_friction"], "{text}");
    let notes = found.finding.notes.join("\n");
    let left_out = "a stretch was left out: ";
    assert!(
        notes.contains(left_out) && notes.contains("standstill_speed = 0.01"),
        "{notes}"
    );
}
