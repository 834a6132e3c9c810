//! Disc sensors that lag show the motion as it was, also after a change of inputs and a restart.

mod importer;

use importer::{Component, Fmi2, Fmi3, REDUCED_RIG};

const DELAY: f64 = 0.05;
const CASE: [(&str, f64); 2] = [("u", 3.1), ("N2", 50.0)];

fn lagging() -> Component {
    Component::new(&format!("{REDUCED_RIG}\n[sensor_delay]\ndelay = {DELAY}\n"))
}

#[test]
fn angle_and_velocity_are_those_of_the_moment_before() {
    let (plain, lagging) = (Component::new(REDUCED_RIG), lagging());
    let mut early = plain.start(Fmi3, &CASE);
    let mut late = lagging.start(Fmi3, &CASE);
    late.run(0.01, DELAY);
    assert_eq!((late.get("theta"), late.get("theta_dot")), (0.0, 0.0));
    for n in 1..=500 {
        let time = f64::from(n) * 0.01;
        early.run(0.01, time);
        late.run(0.01, time + DELAY);
        for name in ["theta", "theta_dot"] {
            let difference = early.get(name) - late.get(name);
            assert!(difference.abs() < 1e-11, "{name} at {time}: {difference}");
        }
    }
    assert!(early.get("theta") > 10.0);
    // The motor's channels do not lag.
    early.run(0.01, 5.0 + DELAY);
    assert_eq!(early.get("i").to_bits(), late.get("i").to_bits());
}

#[test]
fn before_the_first_reading_the_sensors_show_the_start() {
    let component = lagging();
    let start = [("u", 3.1), ("N2", 0.0), ("theta", 2.0), ("theta_dot", 3.0)];
    let mut instance = component.start(Fmi3, &start);
    for time in [0.0, 0.02, DELAY - 0.001] {
        if time > 0.0 {
            instance.run(0.001, time);
        }
        let shown = (instance.get("theta"), instance.get("theta_dot"));
        assert_eq!(shown, (2.0, 3.0), "at {time} s");
    }
    instance.run(0.001, DELAY + 0.01);
    let (angle, expected) = (instance.get("theta"), 2.0 + 0.01 * 3.0);
    assert!((angle - expected).abs() < 1e-2 && angle > 2.02, "{angle}");
}

#[test]
fn the_past_is_part_of_a_saved_state_and_survives_a_cut_segment() {
    let component = lagging();
    let mut instance = component.start(Fmi2, &CASE);
    instance.run(0.01, 3.0);
    let bytes = instance.serialize(instance.save());
    let shown = instance.get("theta");
    instance.set("u", 3.5);
    instance.run(0.001, 3.02);
    let expected = instance.get("theta").to_bits();
    assert!(instance.get("theta") >= shown);

    let mut other = component.instantiate(Fmi2);
    let state = other.deserialize(&bytes);
    other.restore(state);
    assert_eq!(other.get("theta").to_bits(), shown.to_bits());
    other.set("u", 3.5);
    other.run(0.001, 3.02);
    assert_eq!(other.get("theta").to_bits(), expected);
}
