//! Bristles through both C interfaces: their deflection is a variable and part of a saved state.

mod importer;

use importer::{Component, FULL_RIG, Fmi2, Fmi3, REDUCED_RIG, Version};

const STIFFNESS: f64 = 20.0;
const DAMPING: f64 = 0.05;
const CASE: [(&str, f64); 2] = [("u", 3.1), ("N2", 50.0)];

fn model(rig: &str) -> String {
    format!("{rig}\n[presliding]\nstiffness = {STIFFNESS:?}\ndamping = {DAMPING:?}\n")
}

#[test]
fn the_friction_torque_of_a_sticking_disc_is_that_of_its_bristles() {
    let component = Component::new(&model(REDUCED_RIG));
    let mut instance = component.start(Fmi3, &CASE);
    let (mut stuck, mut slid) = (0, 0);
    for n in 1..=2000 {
        instance.run(0.003, 0.003 * f64::from(n));
        let deflection = instance.get("presliding_deflection");
        let torque = STIFFNESS * deflection + DAMPING * instance.get("theta_dot");
        // Sliding friction is never zero under a force, the bristles' deflection then is.
        if deflection == 0.0 {
            slid += 1;
        } else {
            stuck += 1;
            assert!((instance.get("T_f") - torque).abs() < 1e-12);
        }
    }
    assert!(stuck > 100 && slid > 100, "{stuck} {slid}");
}

#[test]
fn a_disc_may_start_on_deflected_bristles() {
    for version in [Fmi2, Fmi3] {
        let component = Component::new(&model(REDUCED_RIG));
        let start = [
            ("N2", 50.0),
            ("theta_dot", 0.1),
            ("presliding_deflection", -0.01),
        ];
        let instance = component.start(version, &start);
        assert_eq!(instance.get("presliding_deflection"), -0.01);
        assert!((instance.get("T_f") - (DAMPING * 0.1 - STIFFNESS * 0.01)).abs() < 1e-15);
    }
}

fn continues_bit_for_bit(version: Version, rig: &str, case: &[(&str, f64)], deflections: &[&str]) {
    let component = Component::new(&model(rig));
    let mut instance = component.start(version, case);
    let mut time = 2.0;
    while deflections.iter().any(|name| instance.get(name) == 0.0) {
        time += 0.01;
        assert!(time < 60.0, "never stuck");
        instance.run(0.01, time);
    }
    let state = instance.save();
    let bytes = instance.serialize(state);
    let names = [&["theta", "theta_dot", "T_f", "theta3"], deflections].concat();
    instance.run(0.007, time + 5.0);
    let expected: Vec<u64> = names
        .iter()
        .map(|name| instance.get(name).to_bits())
        .collect();
    instance.set("N2", 10.0);
    instance.run(0.01, time + 6.0);
    instance.restore(state);
    instance.run(0.007, time + 5.0);
    let again: Vec<u64> = names
        .iter()
        .map(|name| instance.get(name).to_bits())
        .collect();
    assert_eq!(again, expected);

    let mut other = component.instantiate(version);
    let copy = other.deserialize(&bytes);
    other.restore(copy);
    other.run(0.007, time + 5.0);
    let elsewhere: Vec<u64> = names.iter().map(|name| other.get(name).to_bits()).collect();
    assert_eq!(elsewhere, expected);
}

#[test]
fn a_state_saved_on_deflected_bristles_continues_bit_for_bit() {
    continues_bit_for_bit(Fmi2, REDUCED_RIG, &CASE, &["presliding_deflection"]);
    let both = ["presliding_deflection", "presliding_deflection1"];
    let case = [("u", 2.0), ("N1", 40.0), ("N2", 20.0)];
    continues_bit_for_bit(Fmi3, FULL_RIG, &case, &both);
}
