//! The calibrated laws meet what the dissertation publishes; the shipped target files are sound.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::BTreeSet;
use std::path::Path;

use stickslip::plant::Rig;
use workbench::calibrate::cost::Judgement;
use workbench::calibrate::cycle::Cycle;
use workbench::calibrate::target::Target;
use workbench::experiment::{self, virtual_rig};

fn shipped(equation: &str) -> (Rig<f64>, Target) {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("targets");
    let model = std::fs::read_to_string(directory.join(format!("{equation}-rig.toml"))).unwrap();
    let rig = Rig::from_toml(&model, "rig").unwrap();
    let target = Target::read(&directory.join(format!("{equation}.toml")), &rig).unwrap();
    (rig, target)
}

fn cycle(rig: &Rig<f64>, normal_force: f64) -> Cycle {
    Cycle::of(rig, virtual_rig::radians_per_second(55.0), normal_force).unwrap()
}

#[test]
fn shipped_numbers_meet_every_bar_of_their_targets() {
    for equation in ["eq-6-1", "eq-6-2"] {
        let (rig, target) = shipped(equation);
        let values: Vec<f64> = target
            .parameter
            .iter()
            .map(|sought| rig.parameter(&sought.name).unwrap())
            .collect();
        let judgement = Judgement::of(&rig, &target, &values);
        assert_eq!(judgement.excess(), 0.0, "{equation}: {judgement:?}");
        assert!(judgement.loop_margin() > 0.5, "{equation}: {judgement:?}");
    }
}

#[test]
fn second_law_has_the_published_frequencies() {
    let rig = virtual_rig::two_gaussian_rig().unwrap();
    let (sticking, sliding) = (cycle(&rig, 50.0), cycle(&rig, 10.0));
    assert!(
        (sticking.frequency.unwrap() / 0.756 - 1.0).abs() < 0.005,
        "{sticking:?}"
    );
    assert!(
        (sliding.frequency.unwrap() / 0.824 - 1.0).abs() < 0.005,
        "{sliding:?}"
    );
    assert!(sticking.stick_fraction > 0.0 && sliding.stick_fraction == 0.0);
    assert!((sticking.half_amplitude() / 6.3 - 1.0).abs() < 0.1);
    assert!((sliding.half_amplitude() / 4.1 - 1.0).abs() < 0.1);
}

#[test]
fn first_law_does_not_know_the_normal_force() {
    let rig = virtual_rig::first_law_rig().unwrap();
    let (heavy, light) = (cycle(&rig, 50.0), cycle(&rig, 10.0));
    assert_eq!(heavy.frequency, light.frequency);
    assert!(
        (heavy.frequency.unwrap() / 0.764 - 1.0).abs() < 0.005,
        "{heavy:?}"
    );
    assert!(
        (light.frequency.unwrap() / 0.77 - 1.0).abs() < 0.005,
        "{light:?}"
    );
}

#[test]
fn a_target_that_makes_no_sense_is_refused() {
    let (rig, _) = shipped("eq-6-2");
    let search = "[search]\nseed = 1\nstarts = 1\npopulation = 10\ngenerations = 1\nsmallest_loop_margin = 0.5\n";
    let point = "[[point]]\nspeed_rpm = 55.0\nnormal_force = 50.0\nsticking = true\n";
    let parameter = |name: &str, minimum: f64| {
        format!("[[parameter]]\nname = \"{name}\"\nminimum = {minimum:?}\nmaximum = 1.0\n")
    };
    let message = |name: &str, minimum: f64| {
        let text = format!("{search}{}{point}", parameter(name, minimum));
        Target::parse(&text, "t.toml", &rig).map_err(|error| error.to_string())
    };
    assert!(message("contact.a1", 0.0).is_ok());
    assert!(
        message("contact.a9", 0.0)
            .unwrap_err()
            .contains("contact.a9")
    );
    assert!(
        message("contact.a1", 2.0)
            .unwrap_err()
            .contains("minimum must be below maximum")
    );
    assert!(
        message("contact.c1", -1.0)
            .unwrap_err()
            .contains("contact.c1")
    );
}

#[test]
fn experiment_ids_are_unique() {
    let ids: BTreeSet<&str> = experiment::all().iter().map(|entry| entry.id).collect();
    assert_eq!(ids.len(), experiment::all().len());
}
