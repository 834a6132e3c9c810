//! Small plants: what is hidden in records made here is named, nothing is named where nothing is hidden, bad input is told.

#![allow(clippy::unwrap_used, reason = "tests")]

mod bad_input;
mod beliefs;
#[path = "../common/mod.rs"]
mod common;
mod fmus;
mod holes;
mod own;
mod real;
mod records;
mod timing;

use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;

use workbench::diagnose::finding::{Finding, ParameterValue, VerdictName};
use workbench::diagnose::small_plant::finding::SmallFinding;

use crate::common::{library, stickslip};
use crate::records::{
    ARM, BALANCE, CONTACT, DRIVE, PENDULUM, arm, balance, contact, drive, driven, loaded,
    multiplied, pendulum, pendulum_read, resized, stopping,
};

struct Place {
    directory: tempfile::TempDir,
}

impl Place {
    fn new(model: &str, record: &str, held_out: &str) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let place = Self { directory };
        fs::write(place.file("model.toml"), model).unwrap();
        fs::write(place.file("run-a.csv"), record).unwrap();
        fs::write(place.file("held-out.csv"), held_out).unwrap();
        place
    }

    fn file(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    fn run(&self, stage: &str, more: &[&str]) -> (i32, String) {
        let case = self.directory.path().to_str().unwrap().to_owned();
        let out = self.file("out").to_str().unwrap().to_owned();
        let library = library("stickslip");
        let packed: &[&str] = match stage {
            "diagnose" | "amend" => &["--library", &library],
            _ => &[],
        };
        stickslip(&[&[stage, &case, "--out", &out], packed, more].concat())
    }

    /// What a diagnosis finds, whose exit code is this, with what it shows.
    fn diagnosed(&self, expected: i32) -> (SmallFinding, String) {
        let (code, text) = self.run("diagnose", &[]);
        assert_eq!(code, expected, "{text}");
        (self.finding(), text)
    }

    /// Refused with these words.
    fn refused(&self, words: &str) {
        let (code, text) = self.run("diagnose", &[]);
        assert!(code == 2 && text.contains(words), "{code}: {text}");
    }

    fn finding(&self) -> SmallFinding {
        SmallFinding::read(&self.file("out")).unwrap()
    }
}

fn names(found: &SmallFinding) -> Vec<&str> {
    found
        .finding
        .effects
        .iter()
        .map(|effect| effect.name.as_str())
        .collect()
}

#[test]
fn a_drive_that_stops_and_goes_lacks_nothing() {
    let standstill = DRIVE.replace("edge = 0.2", "edge = 0.2\nstandstill_speed = 0.01");
    let model = format!("{standstill}[coulomb_friction]\nforce = 11.0\n");
    let place = Place::new(&model, &stopping(1), &stopping(2));
    let (found, text) = place.diagnosed(0);
    assert_eq!(found.finding.verdict, VerdictName::NothingMissing, "{text}");
    let force = &found.finding.parameters["coulomb_friction.force"];
    assert!((force.value / 12.0 - 1.0).abs() < 0.02, "{force:?}");
    let fast = standstill.replace("standstill_speed = 0.01", "standstill_speed = 0.3");
    Place::new(&fast, &stopping(1), &stopping(2)).refused("standstill_speed = 0.3");
}

#[test]
fn a_dead_zone_of_a_drive_is_told_over_its_force() {
    let zone = |force: f64| force + 5.0 * force.signum();
    let place = Place::new(DRIVE, &driven(0.0, zone, 1), &driven(0.0, zone, 2));
    let (found, text) = place.diagnosed(1);
    assert_eq!(found.finding.verdict, VerdictName::NotInCatalogue, "{text}");
    let disagreement = &found.finding.structure[0];
    assert_eq!(disagreement.coordinate, "driving_input", "{text}");
}

#[test]
fn a_torque_from_another_axis_is_told_though_no_coordinate_shows_it() {
    let other = |time: f64| (TAU * 0.53 * time).sin() + (TAU * 1.13 * time + 1.0).sin();
    let from_another_axis = |size: f64| {
        let record = |seed| balance(|_, _, _, _, time| size * other(time), seed);
        Place::new(BALANCE, &record(1), &record(2))
    };
    let (found, text) = from_another_axis(1.0).diagnosed(1);
    assert_eq!(found.finding.verdict, VerdictName::NotInCatalogue, "{text}");
    assert!(names(&found).is_empty(), "{text}");
    assert!(text.contains("What is left is no noise"), "{text}");
    let (found, text) = from_another_axis(0.05).diagnosed(0);
    assert_eq!(found.finding.verdict, VerdictName::NothingMissing, "{text}");
}

#[test]
fn dry_friction_of_a_drive_is_named_and_measured() {
    let place = Place::new(DRIVE, &drive(5.0, 1), &drive(5.0, 2));
    let (found, text) = place.diagnosed(0);
    assert_eq!(found.finding.verdict, VerdictName::Named, "{text}");
    assert_eq!(names(&found), ["coulomb_friction"]);
    let force = &found.finding.effects[0].parameters["force"];
    assert!((force.value / 5.0 - 1.0).abs() < 0.03, "{force:?}");
    let inertia = &found.finding.parameters["drive.inertia"];
    let [low, high] = inertia.interval95.unwrap();
    assert!(
        low < 10.05 && 9.95 < high && high - low < 0.5,
        "{inertia:?}"
    );
    let steps = &found.small_plant.steps;
    assert!(
        steps[1].held_out.rmse < 0.2 * steps[0].held_out.rmse,
        "{steps:?}"
    );
    for file in ["finding.json", "model.amended.toml", "report.html"] {
        assert!(place.file("out").join(file).is_file(), "{file}");
    }
    for fmu in ["Drive.fmi2.fmu", "Drive.fmi3.fmu"] {
        assert!(text.contains(fmu), "{text}");
        // Held at rest by its friction.
        let held = [("force", vec![4.0; 3])];
        let run = fmus::positions(
            &place.file("out").join(fmu),
            [0.1, 0.0],
            &[0.0, 0.5, 1.0],
            &held,
        );
        assert_eq!(run, [0.1; 3]);
    }
    // The plain reader of findings takes it too.
    Finding::read(&place.file("out")).unwrap();
    // The amended model lacks nothing any more.
    fs::copy(
        place.file("out").join("model.amended.toml"),
        place.file("model.toml"),
    )
    .unwrap();
    let (found, text) = place.diagnosed(0);
    assert_eq!(found.finding.verdict, VerdictName::NothingMissing, "{text}");
}

#[test]
fn nothing_is_named_where_nothing_is_hidden() {
    for seed in 10..13 {
        let place = Place::new(DRIVE, &drive(0.0, seed), &drive(0.0, seed + 100));
        let (found, text) = place.diagnosed(0);
        assert_eq!(
            found.finding.verdict,
            VerdictName::NothingMissing,
            "seed {seed}: {text}"
        );
        let place = Place::new(CONTACT, &contact(false, seed), &contact(false, seed + 100));
        let (found, text) = place.diagnosed(0);
        assert_eq!(
            found.finding.verdict,
            VerdictName::NothingMissing,
            "seed {seed}: {text}"
        );
    }
    let place = Place::new(
        PENDULUM,
        &pendulum(0.06, 0.0, 0.0, 1),
        &pendulum(0.06, 0.0, 0.0, 2),
    );
    let (found, text) = place.diagnosed(0);
    assert_eq!(found.finding.verdict, VerdictName::NothingMissing, "{text}");
}

#[test]
fn hysteresis_of_a_contact_is_named() {
    let place = Place::new(CONTACT, &contact(true, 1), &contact(true, 2));
    let (found, text) = place.diagnosed(0);
    assert_eq!(names(&found), ["acceleration_hysteresis"], "{text}");
    let rmse = found.small_plant.steps[1].held_out.rmse;
    assert!((0.04..0.07).contains(&rmse), "noise is 0.05: {rmse}");
}

#[test]
fn dry_friction_and_quadratic_drag_of_a_pendulum_are_named() {
    let swing = |seed| pendulum(0.0, 0.4, 0.03, seed);
    let place = Place::new(PENDULUM, &swing(1), &swing(2));
    let (found, text) = place.diagnosed(0);
    let mut named = names(&found);
    named.sort_unstable();
    assert_eq!(named, ["coulomb_friction", "quadratic_drag"], "{text}");
    let dry = found
        .finding
        .effects
        .iter()
        .find(|effect| effect.name == "coulomb_friction")
        .unwrap();
    assert!(
        (dry.parameters["force"].value / 0.4 - 1.0).abs() < 0.1,
        "{dry:?}"
    );
    let last = found.small_plant.steps.last().unwrap();
    assert!(last.held_out.rmse < 0.003, "{last:?}");
    let record = fmus::columns(&place.file("held-out.csv"));
    let measured: Vec<f64> = record[1].iter().map(|angle| angle.to_radians()).collect();
    for fmu in ["Pendulum.fmi2.fmu", "Pendulum.fmi3.fmu"] {
        assert!(text.contains(fmu), "{text}");
        let fmu = place.file("out").join(fmu);
        let error = fmus::best_rmse(&fmu, [1.4, 0.0], &record[0], &measured);
        assert!(error < 1.2 * last.held_out.rmse, "{error} beside {last:?}");
    }
}

#[test]
fn an_encoder_off_the_axis_of_a_pendulum_is_named() {
    let off = 0.004;
    let swing = |seed| pendulum_read(0.06, 0.0, 0.0, seed, off);
    let place = Place::new(PENDULUM, &swing(1), &swing(2));
    let (found, text) = place.diagnosed(0);
    assert_eq!(names(&found), ["encoder_eccentricity"], "{text}");
    let cosine = &found.finding.effects[0].parameters["cosine"];
    assert!((cosine.value / off - 1.0).abs() < 0.1, "{cosine:?}");
    let last = found.small_plant.steps.last().unwrap();
    assert!(last.held_out.rmse < 0.0005, "{last:?}");
    assert!(text.contains("friction_wear was not tried"), "{text}");
    // What an encoder reads is no motion: no FMU, and none of an earlier model.
    let why = "no FMU was built: model.amended.toml: [encoder_eccentricity]";
    assert!(text.contains(why), "{text}");
    assert!(!place.file("out").join("Pendulum.fmi3.fmu").exists());
}

type Torque = fn(f64, f64, f64, f64, f64) -> f64;

#[test]
fn what_a_joint_needs_beside_its_model_is_named() {
    let hidden: [(&[&str], Torque); 6] = [
        (&[], |_, _, _, _, _| 0.0),
        (&["transmitted_friction"], |_, rate, _, model, _| {
            0.1 * model.abs() * rate.signum()
        }),
        (&["coulomb_friction"], |_, rate, _, _, _| {
            0.6 * rate.signum()
        }),
        (&["acceleration_torque"], |_, _, acceleration, _, _| {
            0.03 * acceleration
        }),
        (&["offset"], |_, _, _, _, _| 0.5),
        (&["unbalance"], |q, _, _, _, _| 0.5 * (q - 0.4).cos()),
    ];
    for (at, (expected, torque)) in hidden.into_iter().enumerate() {
        let seed = 40 + at as u64;
        let place = Place::new(
            BALANCE,
            &balance(torque, seed),
            &balance(torque, seed + 100),
        );
        let (found, text) = place.diagnosed(0);
        assert_eq!(names(&found), *expected, "{text}");
    }
}

#[test]
fn friction_that_depends_on_a_measured_load_is_named() {
    let predicted = "predicted = { column = \"model\", unit = \"N m\" }";
    assert!(BALANCE.contains(predicted));
    let load = format!("{predicted}\nload = {{ column = \"output\", unit = \"N m\" }}");
    let model = BALANCE.replace(predicted, &load);
    type Hidden = fn(f64, f64, f64) -> f64;
    let hidden: [(&[&str], Hidden); 4] = [
        (&[], |_, _, _| 0.0),
        (&["external_load_friction"], |_, rate, load| {
            0.08 * load.abs() * rate.signum()
        }),
        (&["external_load_wobble"], |q, rate, load| {
            0.1 * load.abs() * (q - 0.4).cos() * rate.signum()
        }),
        (&["external_load_share"], |_, _, load| 0.06 * load),
    ];
    for (at, (expected, torque)) in hidden.into_iter().enumerate() {
        let seed = 80 + at as u64;
        let place = Place::new(&model, &loaded(torque, seed), &loaded(torque, seed + 100));
        let (found, text) = place.diagnosed(0);
        assert_eq!(names(&found), *expected, "{text}");
    }
}

type Loads = fn(f64, f64) -> f64;

#[test]
fn friction_of_an_arm_that_a_motor_turns_is_named_from_its_voltage_and_angle() {
    let hidden: [(&[&str], Loads); 3] = [
        (&[], |_, _| 0.0),
        (&["coulomb_friction"], |_, _| 9.0),
        (&["motor_load_friction"], |motor, _| 0.3 * motor.abs()),
    ];
    for (at, (expected, friction)) in hidden.into_iter().enumerate() {
        let seed = 60 + at as u64;
        let place = Place::new(ARM, &arm(friction, seed), &arm(friction, seed + 100));
        let (found, text) = place.diagnosed(0);
        assert_eq!(names(&found), *expected, "{text}");
        assert!(text.contains("read off every 0.00"), "{text}");
        let last = found.small_plant.steps.last().unwrap();
        assert!(last.held_out.relative < 0.05, "{text}");
        let record = fmus::columns(&place.file("held-out.csv"));
        let voltage: Vec<f64> = record[2].iter().map(|duty| duty / 885.0 * 7.4).collect();
        // Held from one reading to the next, the mean of both.
        let between = voltage
            .iter()
            .zip(voltage.iter().skip(1).chain(voltage.last()));
        let voltage = between.map(|(now, next)| 0.5 * (now + next)).collect();
        let inputs = [("voltage", voltage), ("connected", record[4].clone())];
        let fmu = place.file("out").join("Joint.fmi3.fmu");
        let run = fmus::positions(&fmu, [record[1][0], 0.0], &record[0], &inputs);
        let error = fmus::rmse(&record[1], &run);
        assert!(error < 1.2 * last.held_out.rmse, "{error} beside {last:?}");
    }
}

#[test]
fn what_no_effect_is_like_is_not_named_after_one() {
    let hidden: [Torque; 3] = [
        |q, _, _, _, _| 0.8 * (9.0 * q).cos(),
        // Of two coordinates at once.
        |q, rate, _, _, _| 0.5 * q * rate,
        |_, rate, _, _, time| if time > 9.0 { 0.8 * rate.signum() } else { 0.0 },
    ];
    for torque in hidden {
        let place = Place::new(BALANCE, &balance(torque, 60), &balance(torque, 61));
        let (found, text) = place.diagnosed(1);
        assert_eq!(found.finding.verdict, VerdictName::NotInCatalogue, "{text}");
        // No load is measured, so that nothing is structured over it.
        let mut places = found.finding.structure.iter();
        assert!(!places.any(|place| place.coordinate.starts_with("load")));
    }
}

/// The same names, and intervals of the same place, in units of their width, within 1 %.
fn assert_alike(before: &SmallFinding, after: &SmallFinding, what: &str) {
    assert_eq!(before.finding.verdict, after.finding.verdict, "{what}");
    assert_eq!(names(before), names(after), "{what}");
    for (old, new) in before.finding.effects.iter().zip(&after.finding.effects) {
        for (key, old) in &old.parameters {
            let new = &new.parameters[key];
            let relative = |number: &ParameterValue| {
                let [low, high] = number.interval95.unwrap();
                [low, high].map(|end| end / (high - low))
            };
            for (old, new) in relative(old).into_iter().zip(relative(new)) {
                assert!(
                    (old - new).abs() < 0.01 * old.abs().max(1.0),
                    "{what}: {key} {old} {new}"
                );
            }
        }
    }
}

/// Model, records, and what the columns and numbers of another size are multiplied by.
type Plant = (
    &'static str,
    [String; 2],
    Vec<f64>,
    Vec<(&'static str, f64)>,
);

#[test]
fn a_plant_of_another_size_and_speed_gets_the_same_verdict() {
    let friction: Torque = |_, rate, _, model, _| 0.1 * model.abs() * rate.signum();
    let names_of_rates = [
        "motion_low_pass = ",
        "compare_low_pass = ",
        "compare_rate = ",
    ];
    for (force, time) in [(1e-4, 20.0), (1e6, 0.05), (1e6, 20.0), (1e-4, 0.05)] {
        let rates = names_of_rates.map(|name| (name, 1.0 / time));
        let edge = [("edge = ", time)];
        let plants: [Plant; 4] = [
            (
                DRIVE,
                [drive(5.0, 1), drive(5.0, 2)],
                vec![time, 1.0, force],
                vec![
                    ("inertia = { value = ", force * time * time),
                    ("viscous = ", force * time),
                ],
            ),
            (
                CONTACT,
                [contact(false, 1), contact(false, 2)],
                vec![time, 1.0 / time, force],
                vec![
                    ("standstill_speed = ", 1.0 / time),
                    ("sliding = ", force),
                    ("breakaway = ", force),
                    ("speed = ", 1.0 / time),
                ],
            ),
            (
                PENDULUM,
                [pendulum(0.03, 0.05, 0.05, 1), pendulum(0.03, 0.05, 0.05, 2)],
                vec![time, 1.0],
                vec![
                    ("stiffness = ", 1.0 / (time * time)),
                    ("viscous = ", 1.0 / time),
                ],
            ),
            (
                BALANCE,
                [balance(friction, 1), balance(friction, 2)],
                vec![time, 1.0, force, force],
                vec![],
            ),
        ];
        for (model, [record, held_out], factors, numbers) in plants {
            let before = Place::new(model, &record, &held_out);
            let model = resized(model, &[&rates[..], &edge, &numbers].concat());
            let after = Place::new(
                &model,
                &multiplied(&record, &factors),
                &multiplied(&held_out, &factors),
            );
            let [(_, old), (code, new)] = [&before, &after].map(|place| place.run("diagnose", &[]));
            assert!(code < 2, "{new}");
            assert_alike(
                &before.finding(),
                &after.finding(),
                &format!("{model}{old}{new}"),
            );
        }
    }
}

#[test]
fn the_stages_on_each_others_files() {
    let place = Place::new(DRIVE, &drive(5.0, 1), &drive(5.0, 2));
    let (code, text) = place.run("show", &[]);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("stickslip name"), "{text}");
    let (code, text) = place.run("locate", &[]);
    assert_eq!(code, 1, "{text}");
    assert_eq!(
        place.finding().finding.structure[0].coordinate,
        "velocity",
        "{text}"
    );
    let (code, text) = place.run(
        "name",
        &["--without", "coulomb_friction", "--without", "stribeck"],
    );
    assert!(code < 2, "{text}");
    assert!(
        !names(&place.finding()).contains(&"coulomb_friction"),
        "{text}"
    );
    let (code, text) = place.run("amend", &["--effect", "coulomb_friction"]);
    assert_eq!(code, 0, "{text}");
    let (code, text) = place.run("show", &[]);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("+ coulomb_friction"), "{text}");
    let page = fs::read_to_string(place.file("out").join("report.html")).unwrap();
    roxmltree::Document::parse(page.strip_prefix("<!DOCTYPE html>").unwrap()).unwrap();
    let (code, text) = place.run("amend", &["--effect", "hardening"]);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("what can be is coulomb_friction"), "{text}");
}
