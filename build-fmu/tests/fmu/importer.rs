//! The built FMUs in a Rust importer (fmi-rs) against the native model.

use crate::component::{Component, build, shipped_model};
use build_fmu::platform::FmiVersion;
use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{self, Rig, RigInputs, RigKind};

const SPEED: f64 = 55.0 * std::f64::consts::TAU / 60.0;
const NORMAL_FORCE: f64 = 50.0;
const STATES: [&str; 5] = ["theta", "theta_dot", "theta3", "theta3_dot", "i"];

fn rig(model: &str) -> Rig<f64> {
    let text = std::fs::read_to_string(shipped_model(model)).unwrap();
    Rig::from_toml(&text, model).unwrap()
}

/// Largest difference over all states between an FMU and the native model at equal communication points.
fn largest_difference(model: &str, version: FmiVersion, step: f64, steps: u32) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let rig = rig(model);
    let voltage = rig.voltage_for_speed(SPEED);
    let mut component = Component::load(&build(model, version, folder.path()), version);
    let mut values = vec![("u", voltage), ("N2", NORMAL_FORCE)];
    let full = rig.kind() == RigKind::Full;
    if full {
        values.push(("N1", 0.5 * NORMAL_FORCE));
    }
    component.initialise(&values);
    let inputs = RigInputs::held(
        voltage,
        NORMAL_FORCE,
        if full { 0.5 * NORMAL_FORCE } else { 0.0 },
    );
    let mut native =
        Simulation::new(rig, Options::default(), 0.0, [0.0; plant::STATES], inputs).unwrap();
    let mut largest: f64 = 0.0;
    for number in 1..=steps {
        component.step_to(f64::from(number) * step);
        // The instance adds up step sizes, which rounds; the equal point is the one that it has reached.
        let time = component.get("time");
        native.advance_to(time).unwrap();
        let state = native.state_at(time);
        for (name, value) in STATES.into_iter().zip(state) {
            largest = largest.max((component.get(name) - value).abs());
        }
        if full {
            largest = largest.max((component.get("theta1") - state[5]).abs());
            largest = largest.max((component.get("theta1_dot") - state[6]).abs());
        }
    }
    assert!(component.get("theta") > 1.0, "the disc turns");
    largest
}

#[test]
fn reduced_rig_in_fmi2_equals_the_native_model() {
    let difference = largest_difference("reduced-rig.toml", FmiVersion::Fmi2, 0.01, 2000);
    assert!(difference <= 1e-12, "{difference:e}");
}

#[test]
fn reduced_rig_in_fmi3_equals_the_native_model() {
    let difference = largest_difference("reduced-rig.toml", FmiVersion::Fmi3, 0.01, 2000);
    assert!(difference <= 1e-12, "{difference:e}");
}

#[test]
fn full_rig_in_fmi2_equals_the_native_model() {
    let difference = largest_difference("full-rig.toml", FmiVersion::Fmi2, 0.01, 1000);
    assert!(difference <= 1e-12, "{difference:e}");
}

#[test]
fn full_rig_in_fmi3_equals_the_native_model() {
    let difference = largest_difference("full-rig.toml", FmiVersion::Fmi3, 0.01, 1000);
    assert!(difference <= 1e-12, "{difference:e}");
}

#[test]
fn several_instances_of_both_versions_live_side_by_side() {
    let folder = tempfile::tempdir().unwrap();
    let voltage = rig("reduced-rig.toml").voltage_for_speed(SPEED);
    let mut components: Vec<Component> = [FmiVersion::Fmi2, FmiVersion::Fmi3, FmiVersion::Fmi2]
        .into_iter()
        .map(|version| Component::load(&build("reduced-rig.toml", version, folder.path()), version))
        .collect();
    for (component, force) in components.iter_mut().zip([20.0, 50.0, 20.0]) {
        component.initialise(&[("u", voltage), ("N2", force)]);
    }
    for number in 1..=500 {
        for component in &mut components {
            component.step_to(f64::from(number) * 0.01);
        }
    }
    let angles: Vec<f64> = components
        .iter()
        .map(|component| component.get("theta"))
        .collect();
    assert_eq!(angles[0].to_bits(), angles[2].to_bits());
    assert!((angles[0] - angles[1]).abs() > 1e-3, "{angles:?}");
}
