//! The four FMUs of the rigs in `fmi` 0.8, the dissertation's 60 s at 55 rpm, against the native model.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use fmi::fmi3::import::Fmi3Import;
use second_importer::{Component, build, root};
use std::path::PathBuf;
use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{self, Rig, RigInputs, RigKind};

const SPEED: f64 = 55.0 * std::f64::consts::TAU / 60.0;
const NORMAL_FORCE: f64 = 50.0;
const STATES: [&str; 7] = [
    "theta",
    "theta_dot",
    "theta3",
    "theta3_dot",
    "i",
    "theta1",
    "theta1_dot",
];

/// A rig with its FMUs in a folder of their own.
struct Rigs {
    folder: tempfile::TempDir,
    name: &'static str,
    rig: Rig<f64>,
}

impl Rigs {
    fn built(file: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        build(file, folder.path()).unwrap();
        let text = std::fs::read_to_string(root().join("modelDescription").join(file)).unwrap();
        let rig = Rig::from_toml(&text, file).unwrap();
        let name = match rig.kind() {
            RigKind::Reduced => "ReducedRig",
            RigKind::Full => "FullRig",
        };
        Self { folder, name, rig }
    }

    fn fmu(&self, version: &str) -> PathBuf {
        self.folder
            .path()
            .join(format!("{}.{version}.fmu", self.name))
    }

    fn inputs(&self) -> Vec<(&'static str, f64)> {
        let mut values = vec![
            ("u", self.rig.voltage_for_speed(SPEED)),
            ("N2", NORMAL_FORCE),
        ];
        if self.rig.kind() == RigKind::Full {
            values.push(("N1", 0.5 * NORMAL_FORCE));
        }
        values
    }

    fn native(&self) -> Simulation<f64, Rig<f64>> {
        let inputs = self.inputs();
        let disc1 = inputs.get(2).map_or(0.0, |(_, force)| *force);
        let inputs = RigInputs::held(inputs[0].1, NORMAL_FORCE, disc1);
        Simulation::new(
            self.rig,
            Options::default(),
            0.0,
            [0.0; plant::STATES],
            inputs,
        )
        .unwrap()
    }
}

/// Largest difference over all states and 60 s, at the times that the instance says it has reached.
fn largest_difference(rigs: &Rigs, version: &str) -> f64 {
    let mut component = Component::load(&rigs.fmu(version), false).unwrap();
    component.initialise(&rigs.inputs()).unwrap();
    let mut native = rigs.native();
    let count = if rigs.rig.kind() == RigKind::Full {
        7
    } else {
        5
    };
    let (mut time, mut largest, mut at_rest) = (0.0, 0.0_f64, 0);
    for number in 1..=6000 {
        let step = component
            .step(time, f64::from(number) * 0.01 - time)
            .unwrap();
        assert!(!step.event);
        time = step.time;
        native.advance_to(time).unwrap();
        let state = native.state_at(time);
        for (name, value) in STATES.into_iter().zip(state).take(count) {
            largest = largest.max((component.get(name).unwrap() - value).abs());
        }
        at_rest += usize::from(component.get("theta_dot").unwrap() == 0.0);
    }
    assert!((time - 60.0).abs() < 1e-9 && component.get("theta").unwrap() > 300.0);
    assert!(at_rest > 100, "the disc sticks");
    println!("{} {version}: {largest:e}", rigs.name);
    largest
}

#[test]
fn the_reduced_rig_equals_the_native_model_over_60_s() {
    let rigs = Rigs::built("reduced-rig.toml");
    assert!(largest_difference(&rigs, "fmi2") <= 1e-12);
    assert!(largest_difference(&rigs, "fmi3") <= 1e-12);
}

#[test]
fn the_full_rig_equals_the_native_model_over_60_s() {
    let rigs = Rigs::built("full-rig.toml");
    assert!(largest_difference(&rigs, "fmi2") <= 1e-12);
    assert!(largest_difference(&rigs, "fmi3") <= 1e-12);
}

#[test]
fn event_mode_and_early_return_of_fmi_3_end_where_plain_steps_end() {
    let rigs = Rigs::built("reduced-rig.toml");
    let mut component = Component::load(&rigs.fmu("fmi3"), true).unwrap();
    component.initialise(&rigs.inputs()).unwrap();
    let (mut time, mut events) = (0.0, 0);
    while time < 10.0 {
        let step = component.step(time, 10.0 - time).unwrap();
        time = step.time;
        if step.event {
            events += 1;
            component.handle_event().unwrap();
        }
    }
    assert!(events > 10, "{events}");
    let mut native = rigs.native();
    native.advance_to(time).unwrap();
    let difference = component.get("theta").unwrap() - native.state_at(time)[0];
    assert!(difference.abs() <= 1e-12, "{difference:e}");
}

#[test]
fn refusals_arrive_as_errors_and_the_instance_goes_on() {
    let rigs = Rigs::built("reduced-rig.toml");
    for version in ["fmi2", "fmi3"] {
        let mut component = Component::load(&rigs.fmu(version), false).unwrap();
        component.initialise(&rigs.inputs()).unwrap();
        assert!(component.set("u", f64::NAN).is_err());
        assert!(component.step(0.0, 0.0).is_err());
        assert!(component.step(1.0, 0.1).is_err());
        let mut time = 0.0;
        while component.get("theta_dot").unwrap() < 1.0 {
            time = component.step(time, 0.1).unwrap().time;
        }
        if version == "fmi2" {
            let derivative = component.derivative("T_f", "N2").unwrap();
            let torque = component.get("T_f").unwrap();
            assert!((derivative - torque / NORMAL_FORCE).abs() < 1e-12);
        }
    }
}

/// The day this fails, the importer reads the standard's units, and `Component::load` no longer has to help.
#[test]
fn a_description_with_units_in_fmi_3_is_still_refused() {
    let rigs = Rigs::built("reduced-rig.toml");
    let refused: Result<Fmi3Import, _> = fmi::import::from_path(rigs.fmu("fmi3"));
    let message = refused.map(|_| ()).unwrap_err().to_string();
    println!("{message}");
    assert!(message.contains("BaseUnit"), "{message}");
}
