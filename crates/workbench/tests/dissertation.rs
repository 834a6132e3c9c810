//! The calibrated laws meet what the dissertation publishes; the shipped target files are sound.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use stickslip::plant::Rig;
use workbench::calibrate::cost::Judgement;
use workbench::calibrate::cycle::{Cycle, Operating};
use workbench::calibrate::journal::Journal;
use workbench::calibrate::search::search;
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
    Cycle::of(rig, &Operating::reduced(55.0, normal_force)).unwrap()
}

#[test]
fn shipped_numbers_meet_every_bar_of_their_targets() {
    for equation in ["eq-6-1", "eq-6-2", "experiment", "experiment-full"] {
        let (rig, target) = shipped(equation);
        let values: Vec<f64> = target
            .parameter
            .iter()
            .map(|sought| rig.parameter(&sought.name).unwrap())
            .collect();
        let judgement = Judgement::of(&rig, &target, &values);
        assert_eq!(judgement.excess(), 0.0, "{equation}: {judgement:?}");
        let least = target.search.smallest_loop_margin;
        assert!(
            judgement.loop_margin() >= least,
            "{equation}: {judgement:?}"
        );
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

/// A search small enough for a test: a rig and a law other than the dissertation's, and facts taken from its own motion.
fn foreign_search() -> (Rig<f64>, Target, [f64; 2]) {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../modelDescription");
    let text = std::fs::read_to_string(directory.join("reduced-rig.toml")).unwrap();
    let mut rig = Rig::from_toml(&text, "rig").unwrap();
    rig.disc.inertia = 0.025;
    rig.shaft.stiffness = 0.6;
    let truth = [0.15, 0.26];
    rig.set_parameter("contact.mu_c", truth[0]).unwrap();
    rig.set_parameter("contact.mu_s", truth[1]).unwrap();
    let mut text = "[search]\nseed = 3\nstarts = 1\npopulation = 8\ngenerations = 20\nsmallest_loop_margin = 0.0\n\
        [[parameter]]\nname = \"contact.mu_c\"\nminimum = 0.05\nmaximum = 0.25\n\
        [[parameter]]\nname = \"contact.mu_s\"\nminimum = 0.25\nmaximum = 0.35\n"
        .to_owned();
    for (speed, force) in [(40.0, 30.0), (60.0, 45.0)] {
        let seen = Cycle::of(&rig, &Operating::reduced(speed, force)).unwrap();
        text.push_str(&format!(
            "[[point]]\nspeed_rpm = {speed:?}\nnormal_force = {force:?}\nsticking = {}\n\
             frequency_hz = {{ value = {:?}, bar = 0.01 }}\nmaximum_velocity = {{ value = {:?}, bar = 0.02 }}\n",
            seen.sticks_and_slips(),
            seen.frequency.unwrap(),
            seen.maximum
        ));
    }
    let target = Target::parse(&text, "foreign.toml", &rig).unwrap();
    (rig, target, truth)
}

#[test]
fn another_rig_with_another_law_is_calibrated_and_the_truth_is_among_the_sets() {
    let (rig, target, truth) = foreign_search();
    let never = AtomicBool::new(false);
    let found = search(&rig, &target, &mut Journal::none(), &never, |_| ()).unwrap();
    assert!(found.complete && found.ensemble.len() > 3, "{found:?}");
    for ((low, high), truth) in found.ranges().into_iter().zip(truth) {
        let slack = 0.02 * truth;
        assert!(
            low - slack <= truth && truth <= high + slack,
            "{low} {truth} {high}"
        );
    }
    assert!(found.best.judgement.distance() < 0.5, "{:?}", found.best);
}

#[test]
fn an_interrupted_search_goes_on_to_the_same_end() {
    let (rig, target, _) = foreign_search();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("calibration.journal");
    let never = AtomicBool::new(false);
    let whole = search(&rig, &target, &mut Journal::none(), &never, |_| ()).unwrap();
    let interrupted = AtomicBool::new(false);
    let mut journal = Journal::open(&path, "same").unwrap();
    let part = search(&rig, &target, &mut journal, &interrupted, |progress| {
        if progress.judged >= 40 {
            interrupted.store(true, Ordering::Relaxed);
        }
    })
    .unwrap();
    assert!(!part.complete && part.evaluations < whole.evaluations);
    let mut journal = Journal::open(&path, "same").unwrap();
    assert_eq!(journal.kept(), 40);
    let rest = search(&rig, &target, &mut journal, &never, |_| ()).unwrap();
    assert_eq!(rest, whole);
}

#[test]
fn numbers_of_a_target_that_cannot_be_are_refused() {
    let (rig, _) = shipped("eq-6-2");
    let good = "[search]\nseed = 1\nstarts = 1\npopulation = 10\ngenerations = 1\nsmallest_loop_margin = 0.5\n\
        [[parameter]]\nname = \"contact.a1\"\nminimum = 0.0\nmaximum = 1.0\n\
        [[point]]\nspeed_rpm = 55.0\nnormal_force = 50.0\nfrequency_hz = { value = 0.8, bar = 0.01 }\n";
    assert!(Target::parse(good, "t.toml", &rig).is_ok());
    for (from, to, word) in [
        ("population = 10", "population = 1000000000000", "at most"),
        ("starts = 1", "starts = 9000000000000000000", "at most"),
        ("generations = 1", "generations = 100001", "at most"),
        (
            "smallest_loop_margin = 0.5",
            "smallest_loop_margin = nan",
            "below 1",
        ),
        ("speed_rpm = 55.0", "speed_rpm = inf", "finite"),
        ("normal_force = 50.0", "normal_force = nan", "finite"),
        ("value = 0.8", "value = nan", "must be finite"),
        ("bar = 0.01", "bar = nan", "above 0, such as"),
        ("bar = 0.01", "bar = 0.01, weight = inf", "weight"),
        ("maximum = 1.0", "maximum = nan", "contact.a1"),
    ] {
        let message = Target::parse(&good.replacen(from, to, 1), "t.toml", &rig)
            .unwrap_err()
            .to_string();
        assert!(
            message.contains(word) && message.contains("t.toml"),
            "{to}: {message}"
        );
    }
}

#[test]
fn transitions_that_make_no_sense_are_refused() {
    let (rig, _) = shipped("eq-6-2");
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("targets");
    let text = std::fs::read_to_string(directory.join("eq-6-2.toml")).unwrap();
    for (from, to, word) in [
        (
            "between = [10.0, 54.0]",
            "between = [10.0, 64.0]",
            "within range",
        ),
        (
            "range = [6.0, 60.0]",
            "range = [60.0, 6.0]",
            "range must be",
        ),
        ("over = \"speed_rpm\"", "over = \"speed\"", "speed_rpm"),
    ] {
        let message = Target::parse(&text.replace(from, to), "t.toml", &rig)
            .unwrap_err()
            .to_string();
        assert!(message.contains(word), "{message}");
    }
    let disc1 = text.replacen("sticking = true", "sticking = true\ndisc = \"D1\"", 1);
    let message = Target::parse(&disc1, "t.toml", &rig)
        .unwrap_err()
        .to_string();
    assert!(message.contains("[disc1]"), "{message}");
}

#[test]
fn facts_that_make_no_sense_are_refused() {
    let (rig, _) = shipped("eq-6-2");
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("targets");
    let text = std::fs::read_to_string(directory.join("eq-6-2.toml")).unwrap();
    for (from, to, word) in [
        (text.as_str(), "", "is empty"),
        ("bar = 0.005", "bar = nan", "has the bar NaN"),
        ("bar = 0.005", "bar = 0.0", "has the bar 0"),
        ("value = 0.756", "value = -0.756", "must be above 0"),
        ("{ value = 0.756, bar = 0.005 }", "0.756", "a table such as"),
        ("normal_force = 50.0", "normal_force = -50.0", "cannot pull"),
        ("speed_rpm = 55.0", "speed_rpm = inf", "speed_rpm is inf"),
        ("contact.b1", "contact.a1", "is sought twice"),
        ("contact.b1", "contact.b9", "it has contact.radius"),
        (
            "contact.b1",
            "unbalance.torque",
            "with a section [unbalance]",
        ),
        ("population = 40", "population = 4", "population is 4"),
        (
            "smallest_loop_margin = 0.5",
            "smallest_loop_margin = 1.5",
            "smallest_loop_margin is 1.5",
        ),
    ] {
        let message = Target::parse(&text.replacen(from, to, 1), "t.toml", &rig)
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("t.toml") && message.contains(word),
            "{message}"
        );
    }
}

#[test]
fn a_document_of_another_kind_is_not_overwritten() {
    let place = tempfile::tempdir().unwrap();
    let document = place.path().join("notes.md");
    std::fs::write(&document, "# Notes\n").unwrap();
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(["experiment", "run", "table-4.1", "--out"])
        .arg(place.path())
        .arg("--document")
        .arg(&document)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("would be lost"));
    assert_eq!(std::fs::read_to_string(&document).unwrap(), "# Notes\n");
}

#[test]
fn the_document_holds_the_experiments_of_the_list_in_order() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reproduction.md");
    let text = std::fs::read_to_string(path).unwrap();
    let documented: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("<!-- experiment ")?.strip_suffix(" -->"))
        .collect();
    let listed: Vec<&str> = experiment::all().iter().map(|entry| entry.id).collect();
    assert_eq!(documented, listed);
    for shown in ["3.5", "5.2", "6.4", "6.11", "6.14", "6.15"] {
        assert!(
            text.contains(&format!("](pictures/fig-{shown}.svg)")),
            "{shown}"
        );
    }
}

#[test]
fn experiment_ids_are_unique() {
    let ids: BTreeSet<&str> = experiment::all().iter().map(|entry| entry.id).collect();
    assert_eq!(ids.len(), experiment::all().len());
}
