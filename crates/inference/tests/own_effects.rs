//! An effect that a file describes is named where it is missing and only there; without the file its shape is learned.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use inference::diagnosis::{Diagnosis, Verdict, diagnose};
use inference::effects::EFFECTS;
use inference::problem::{Catalogue, Problem};
use stickslip::expression::Coordinate;
use stickslip::plant::{Port, Rig, Supposition};

mod common;
use common::{instruments, prepare_threads, record};

const BELIEVED: &str = include_str!("../../../modelDescription/reduced-rig.toml");
/// A bearing with three worn balls, in the rig that is measured.
const RUMBLE: (f64, f64) = (0.04, 0.8);

/// The effect; in a model its numbers have values.
fn rumble(value: impl Fn(f64) -> String) -> String {
    format!(
        "[[effect]]\nname = \"rumble\"\ntitle = \"a bearing with three worn balls\"\nport = \"disc.torque\"\n\
         equation = \"-torque*cos(3*angle - phase)\"\n\
         parameters.torque = {{ {}unit = \"N.m\", range = \"non-negative\", description = \"largest torque\" }}\n\
         parameters.phase = {{ {}unit = \"rad\", description = \"three times the angle of the largest torque\" }}\n",
        value(RUMBLE.0),
        value(RUMBLE.1)
    )
}

/// The effects of a file, if there is one, beside a few of the catalogue.
fn supposed(file: Option<&str>) -> Catalogue {
    let read = |text| Supposition::read_all(text, "effects").unwrap();
    let kept = ["unbalance", "viscous_drag", "normal_force_wobble"];
    let names = EFFECTS.iter().map(|effect| effect.name);
    Catalogue {
        without: names
            .filter(|name| !kept.contains(name))
            .map(str::to_owned)
            .collect(),
        supposed: file.map(read).unwrap_or_default(),
    }
}

/// What is found in a record of the believed rig with `effects`, where files describe `own` beside the catalogue.
fn found(effects: &str, own: Option<&str>) -> Diagnosis {
    prepare_threads();
    let believed = Rig::from_toml(BELIEVED, "believed").unwrap();
    let truth = Rig::from_toml(&format!("{BELIEVED}\n{effects}"), "truth").unwrap();
    let known = [
        ("disc.inertia", 0.006),
        ("shaft.stiffness", 0.02),
        ("motor.coulomb_torque", 0.04),
    ];
    let problem = Problem::new(
        &believed,
        known
            .map(|(name, deviation)| (name.to_owned(), deviation))
            .to_vec(),
        &[record(&truth, 1)],
        &instruments(),
        &supposed(own),
    )
    .unwrap();
    diagnose(&problem, &mut |_| {})
}

#[test]
fn an_effect_of_a_file_is_named_with_its_numbers_where_it_is_missing() {
    let found = found(
        &rumble(|value| format!("value = {value}, ")),
        Some(&rumble(|_| String::new())),
    );
    assert_eq!(
        (found.verdict, found.effects),
        (Verdict::Named, vec!["rumble"])
    );
    for (name, truth) in [("rumble.torque", RUMBLE.0), ("rumble.phase", RUMBLE.1)] {
        let estimates = &found.numbers.estimates;
        let estimate = estimates.iter().find(|e| e.name == name).unwrap();
        let off = (estimate.value - truth).abs();
        assert!(
            off < 3.0 * estimate.deviation && estimate.deviation < 0.05 * truth,
            "{estimate:?}"
        );
    }
}

#[test]
fn an_effect_of_a_file_that_is_not_missing_is_not_named() {
    let nothing = found("", Some(&rumble(|_| String::new())));
    assert_eq!(nothing.verdict, Verdict::NothingMissing);
    let drag = found(
        "[viscous_drag]\ncoefficient = 0.006\n",
        Some(&rumble(|_| String::new())),
    );
    assert_eq!(
        (drag.verdict, drag.effects),
        (Verdict::Named, vec!["viscous_drag"])
    );
}

#[test]
fn without_the_file_its_shape_is_learned() {
    let found = found(&rumble(|value| format!("value = {value}, ")), None);
    assert_eq!(found.verdict, Verdict::NotInCatalogue);
    let learned = found.learned.unwrap();
    assert_eq!(learned.family.port, Port::DiscTorque);
    assert_eq!(learned.family.over, Coordinate::Angle);
    let truth = |angle: f64| -RUMBLE.0 * (3.0 * angle - RUMBLE.1).cos();
    let knots = learned.table.knots.iter().zip(&learned.table.values);
    let off: Vec<f64> = knots.map(|(angle, value)| value - truth(*angle)).collect();
    let square = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
    let whole: Vec<f64> = learned.table.knots.iter().map(|a| truth(*a)).collect();
    let explained = 1.0 - square(&off) / square(&whole);
    assert!(explained > 0.95, "explains {explained}");
    let covered = off.iter().zip(&learned.deviations);
    let covered = covered
        .filter(|(off, deviation)| off.abs() < 1.96 * *deviation)
        .count();
    assert!(covered >= 20, "{covered} of {} intervals cover", off.len());
}

#[test]
fn an_equation_that_no_value_switches_off_is_refused() {
    let text = rumble(|_| String::new())
        .replace("-torque*cos(3*angle - phase)", "-torque*cos(phase) - pull")
        + "parameters.pull = { unit = \"N.m\", range = [0.1, 0.2], description = \"constant pull\" }\n";
    let rig = Rig::from_toml(BELIEVED, "believed").unwrap();
    let problem = Problem::new(
        &rig,
        Vec::new(),
        &[record(&rig, 1)],
        &instruments(),
        &supposed(Some(&text)),
    );
    let message = problem.unwrap_err().to_string();
    assert!(
        message.contains("rumble") && message.contains("vanish"),
        "{message}"
    );
}
