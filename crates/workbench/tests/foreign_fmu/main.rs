//! An FMU of another exporter as the plant: what its records hide is named, bad FMUs and ports are told.

#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "../common/mod.rs"]
mod common;
mod plant;

use std::fs;
use std::path::{Path, PathBuf};

use workbench::component;
use workbench::diagnose::finding::VerdictName;
use workbench::diagnose::small_plant::finding::SmallFinding;

use crate::common::{library, stickslip};
use crate::plant::{Hidden, PORTS, record, write_fmu, write_fmu_without_torque_input};

struct Place {
    directory: tempfile::TempDir,
}

impl Place {
    fn new(dry: f64, hidden: Hidden, late: usize) -> Self {
        let place = Self {
            directory: tempfile::tempdir().unwrap(),
        };
        write_fmu(&place.file("axis.fmu"), &[]);
        fs::write(place.file("ports.toml"), PORTS).unwrap();
        for (at, name) in ["run-a.csv", "run-b.csv", "held-out.csv"]
            .iter()
            .enumerate()
        {
            fs::write(place.file(name), record(dry, hidden, late, at as u64 + 1)).unwrap();
        }
        place
    }

    fn file(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    fn run(&self, stage: &str) -> (i32, String) {
        let named = |name: &str| self.file(name).to_str().unwrap().to_owned();
        let (fmu, ports) = (named("axis.fmu"), named("ports.toml"));
        let (a, b, held_out, out) = (
            named("run-a.csv"),
            named("run-b.csv"),
            named("held-out.csv"),
            named("out"),
        );
        stickslip(&[
            stage,
            "--model",
            &fmu,
            "--ports",
            &ports,
            "--records",
            &a,
            &b,
            "--held-out",
            &held_out,
            "--out",
            &out,
            "--library",
            &library("stickslip_wrapper"),
        ])
    }

    fn diagnosed(&self) -> SmallFinding {
        let (code, text) = self.run("diagnose");
        assert!(code < 2, "{text}");
        SmallFinding::read(&self.file("out")).unwrap()
    }

    /// What the command says of ports that were changed.
    fn refusal(&self, from: &str, to: &str) -> String {
        assert!(PORTS.contains(from), "{from}");
        fs::write(self.file("ports.toml"), PORTS.replace(from, to)).unwrap();
        let (code, text) = self.run("locate");
        assert_eq!(code, 2, "{text}");
        assert!(!self.file("out").join("finding.json").exists(), "{text}");
        text
    }
}

/// How far an FMU of the axis turns in 4 s at 3 V [rad], with these variables set before.
fn turned(fmu: &Path, settings: &[(&str, f64)]) -> f64 {
    let mut component = component::open(fmu).unwrap();
    let place = |name: &str| component::position(&*component, name).unwrap();
    let mut values = vec![(place("voltage"), 3.0)];
    values.extend(settings.iter().map(|(name, value)| (place(name), *value)));
    let phi = place("phi");
    component.set(&values).unwrap();
    component.initialise(0.0, 4.0).unwrap();
    for step in 0..40 {
        component
            .step(f64::from(step) * 0.1, f64::from(step + 1) * 0.1)
            .unwrap();
    }
    let mut angle = [0.0];
    component.get(&[phi], &mut angle).unwrap();
    angle[0]
}

fn names(found: &SmallFinding) -> Vec<&str> {
    let effects = found.finding.effects.iter();
    effects.map(|effect| effect.name.as_str()).collect()
}

#[test]
fn dry_friction_of_the_real_axis_is_named_and_its_amended_model_lacks_nothing() {
    let place = Place::new(0.08, |_, _| 0.0, 0);
    let found = place.diagnosed();
    assert_eq!(found.finding.verdict, VerdictName::Named);
    assert_eq!(names(&found), ["coulomb_friction"]);
    let force = &found.finding.effects[0].parameters["force"];
    assert!((force.value / 0.08 - 1.0).abs() < 0.03, "{force:?}");
    let steps = &found.small_plant.steps;
    assert!(
        steps[1].held_out.rmse < 0.2 * steps[0].held_out.rmse,
        "{steps:?}"
    );
    let wrapped = place.file("out").join("axis.amended.fmu");
    // The hidden friction inside the axis, and the found one around it.
    let inside = turned(
        &wrapped,
        &[("friction", 0.08), ("effects.coulomb_friction.force", 0.0)],
    );
    let around = turned(&wrapped, &[]);
    assert!((around / inside - 1.0).abs() < 0.02, "{around} {inside}");
    let amended = fs::read_to_string(place.file("out").join("model.amended.toml")).unwrap();
    fs::write(place.file("ports.toml"), amended).unwrap();
    let again = place.diagnosed();
    assert!(names(&again).is_empty(), "{:?}", names(&again));
}

#[test]
fn nothing_is_named_where_the_fmu_is_right_but_for_its_parameters() {
    let found = Place::new(0.0, |_, _| 0.0, 0).diagnosed();
    assert_eq!(found.finding.verdict, VerdictName::NothingMissing);
    for (name, real) in [("J", 0.0206), ("R", 1.95), ("m", 0.59)] {
        let found = found.finding.parameters[&format!("parameters.{name}")].value;
        assert!((found / real - 1.0).abs() < 0.02, "{name} = {found}");
    }
}

#[test]
fn drag_unbalance_and_delay_are_told_apart() {
    let drag: Hidden = |_, w| 0.002 * w * w.abs();
    assert_eq!(
        names(&Place::new(0.0, drag, 0).diagnosed()),
        ["quadratic_drag"]
    );
    let unbalance: Hidden = |angle, _| 0.08 * angle.cos();
    assert_eq!(
        names(&Place::new(0.0, unbalance, 0).diagnosed()),
        ["unbalance"]
    );
    let late = Place::new(0.0, |_, _| 0.0, 2).diagnosed();
    assert_eq!(names(&late), ["sensor_delay"]);
    let delay = &late.finding.effects[0].parameters["delay"];
    assert!((delay.value / 0.01 - 1.0).abs() < 0.1, "{delay:?}");
}

#[test]
fn a_ripple_that_no_effect_is_like_gets_no_name() {
    let found = Place::new(0.0, |angle, _| 0.08 * (9.0 * angle).sin(), 0).diagnosed();
    assert_eq!(found.finding.verdict, VerdictName::NotInCatalogue);
    assert!(names(&found).is_empty(), "{:?}", names(&found));
}

#[test]
fn a_parameter_that_may_change_between_steps_is_a_port_and_a_fixed_one_is_not() {
    let place = Place::new(0.0, |_, w| 0.002 * w * w.abs(), 0);
    let fmu = place.file("axis.fmu");
    write_fmu_without_torque_input(&fmu, "fixed");
    let (code, text) = place.run("locate");
    assert_eq!(code, 2, "{text}");
    assert!(
        text.contains("[port] names `torque`")
            && text.contains("no such input or tunable parameter"),
        "{text}"
    );
    write_fmu_without_torque_input(&fmu, "tunable");
    assert_eq!(names(&place.diagnosed()), ["quadratic_drag"]);
    let wrapped = place.file("out").join("axis.amended.fmu");
    let free = turned(&wrapped, &[("effects.quadratic_drag.coefficient", 0.0)]);
    let braked = turned(&wrapped, &[]);
    assert!(
        0.5 * free < braked && braked < 0.99 * free,
        "{braked} {free}"
    );
    let (code, written) = stickslip(&["ports", fmu.to_str().unwrap()]);
    assert!(
        code == 0 && written.contains("input = \"torque\""),
        "{written}"
    );
}

#[test]
fn effects_are_not_named_at_several_ports() {
    let place = Place::new(0.0, |_, _| 0.0, 0);
    let further = "[[port]]\nname = \"motor\"\ninput = \"torque\"\nposition = \"phi\"\n\
                   measured_position = { column = \"angle\", unit = \"deg\" }\n\n[inputs]";
    let ports = PORTS.replace("[port]", "[[port]]\nname = \"axis\"");
    fs::write(place.file("ports.toml"), ports.replace("[inputs]", further)).unwrap();
    for stage in ["diagnose", "name"] {
        let (code, text) = place.run(stage);
        assert_eq!(code, 2, "{text}");
        assert!(
            text.contains("2 ports (axis, motor)") && text.contains("stickslip locate"),
            "{text}"
        );
        assert!(!place.file("out").join("finding.json").exists(), "{text}");
    }
}

#[test]
fn wrong_ports_are_told_with_what_would_be_right() {
    let place = Place::new(0.0, |_, _| 0.0, 0);
    for (from, to, said) in [
        (
            "velocity = \"w\"",
            "velocity = \"omega\"",
            "[port] names `omega`",
        ),
        (
            "position = \"phi\"",
            "position = \"ph\"",
            "did you mean `phi`?",
        ),
        (
            "input = \"torque\"",
            "input = \"voltage\"",
            "\"V\", which is no unit of force",
        ),
        ("unit = \"V\"", "unit = \"mV\"", "give factor"),
        ("column = \"u\"", "column = \"i\"", "has no column `i`"),
        ("between = \"linear\"", "between = \"cubic\"", "cubic"),
        ("J = { value", "K = { value", "[parameters] names `K`"),
        (
            "unit = \"kg.m2\"",
            "unit = \"g.m2\"",
            "\"g.m2\" is not the FMU's, \"kg.m2\"",
        ),
        ("compare_low_pass = 10.0\n", "", "lacks compare_low_pass"),
        ("kind = \"fmu\"", "kind = \"drive\"", "drive"),
        (
            "[start]\nphi = \"position\"",
            "[start]\ncrash = \"position\"",
            "[start] names `crash`",
        ),
    ] {
        let text = place.refusal(from, to);
        assert!(
            text.contains(said) && !text.contains("panicked"),
            "{to}: {text}"
        );
        assert!(
            text.contains("ports.toml") || text.contains("run-a.csv"),
            "{text}"
        );
    }
}

#[test]
fn an_fmu_without_ports_is_told_how_to_get_them() {
    let place = Place::new(0.0, |_, _| 0.0, 0);
    let fmu = place.file("axis.fmu").to_str().unwrap().to_owned();
    let (code, text) = stickslip(&[
        "diagnose",
        "--model",
        &fmu,
        "--records",
        "a.csv",
        "--out",
        "out",
    ]);
    assert_eq!(code, 2);
    assert!(
        text.contains("--ports") && text.contains("stickslip ports"),
        "{text}"
    );
    let (code, written) = stickslip(&["ports", &fmu]);
    assert_eq!(code, 0, "{written}");
    for line in [
        "input = \"torque\"  # or",
        "position = \"phi\"",
        "velocity = \"w\"",
        "path = \"turn\"",
    ] {
        let is_there = written.contains(line) || written.contains(&line.replace("  # or", ""));
        assert!(is_there, "{line}: {written}");
    }
}

#[test]
fn an_fmu_that_crashes_or_gives_no_number_is_named_with_the_time() {
    let place = Place::new(0.0, |_, _| 0.0, 0);
    let crashing =
        "[parameters]\ncrash_at = { value = 7.0, unit = \"s\", relative_uncertainty = 1e-3 }";
    let text = place.refusal("[parameters]", crashing);
    assert!(
        text.contains("axis.fmu: crashed") && text.contains("out of licences"),
        "{text}"
    );
    let text = place.refusal("[parameters]", &crashing.replace("crash_at", "nan_at"));
    assert!(
        text.contains("axis.fmu") && text.contains("not finite at t = 7"),
        "{text}"
    );
}

#[test]
fn the_stages_can_be_run_alone() {
    let place = Place::new(0.08, |_, _| 0.0, 0);
    for stage in ["locate", "name", "amend", "show"] {
        let (code, text) = place.run(stage);
        assert!(code < 2, "{stage}: {text}");
    }
    assert!(place.file("out").join("report.html").exists());
}
