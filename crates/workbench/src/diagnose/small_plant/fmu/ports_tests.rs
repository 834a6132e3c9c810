//! Several ports in a ports file: read as they are written, refused where they cannot be told apart.

#![allow(clippy::unwrap_used, reason = "tests")]

use crate::diagnose::small_plant::model_file::SmallModel;
use inference::body::term::Sample;

const TWO: &str = r#"[plant]
kind = "fmu"
path = "turn"

[[port]]
name = "disc"
input = "disc_port.torque"
position = "theta"

[[port]]
name = "motor"
input = "motor_torque"
velocity = "w"
measured_velocity = { column = "w_motor", unit = "rpm" }
repeats = [16.0]
compare_low_pass = 20.0

[inputs]
N2 = { column = "load", unit = "N", between = "held", may_be_offset = true }

[drifts]
parameters = ["R"]

[columns]
time = { column = "t", unit = "s" }
position = { column = "angle", unit = "rad" }

[measurement]
motion_low_pass = 20.0
compare_low_pass = 8.0
compare_rate = 50.0

[parameters]
J = { value = 0.02, unit = "kg.m2", relative_uncertainty = 0.05 }
R = { value = 2.0, unit = "Ohm", relative_uncertainty = 0.05 }
"#;

#[test]
fn several_ports_are_written_as_they_are_read() {
    let model = SmallModel::parse(TWO, "ports.toml").unwrap();
    let again = SmallModel::parse(&model.to_toml("disc and motor"), "again.toml").unwrap();
    assert_eq!(model.port_names(), ["disc", "motor"]);
    assert_eq!(again.ports, model.ports);
}

#[test]
fn effects_have_the_name_of_their_place() {
    let model = SmallModel::parse(TWO, "ports.toml").unwrap();
    let names: Vec<&str> = model.of_ports.iter().map(|own| own.name).collect();
    for name in [
        "coulomb_friction_at_disc",
        "coulomb_friction_at_motor",
        "ripple_16_at_motor",
        "R_drift",
        "N2_offset",
    ] {
        assert!(names.contains(&name), "{name}: {names:?}");
    }
    // The disc has no teeth.
    assert!(!names.contains(&"ripple_16_at_disc"), "{names:?}");
}

#[test]
fn an_effect_acts_at_its_port_alone() {
    let model = SmallModel::parse(TWO, "ports.toml").unwrap();
    let force = |name: &str, values: Vec<f64>, port: usize| {
        let entry = model.of_ports.iter().find(|own| own.name == name).unwrap();
        let sample = Sample {
            velocity: 2.0,
            direction: 1.0,
            port,
            ..Sample::default()
        };
        model.model.with(entry, values).force(&sample)
    };
    assert_eq!(force("coulomb_friction_at_motor", vec![0.3], 0), 0.0);
    assert_eq!(force("coulomb_friction_at_motor", vec![0.3], 1), 0.3);
}

#[test]
fn ports_that_cannot_be_told_apart_or_have_no_motion_are_refused() {
    let column = "measured_velocity = { column = \"w_motor\", unit = \"rpm\" }\n";
    let offset = "may_be_offset = true }\n";
    let more: String = ["a", "b", "c", "d"]
        .map(|name| {
            offset.to_owned() + name + " = { column = \"x\", unit = \"N\", between = \"held\", "
        })
        .concat()
        + offset;
    for (from, to, said) in [
        ("name = \"motor\"\n", "", "a name of letters"),
        (
            "name = \"motor\"",
            "name = \"the motor\"",
            "a name of letters",
        ),
        ("name = \"motor\"", "name = \"disc\"", "no other port has"),
        (column, "", "a column for one of them at every port"),
        (
            "position = \"theta\"\n",
            column,
            "[columns] has those of the first port",
        ),
        (
            "compare_low_pass = 20.0",
            "compare_low_pass = -20.0",
            "above 0 [Hz]",
        ),
        ("repeats = [16.0]", "repeats = [0.0]", "numbers above 0"),
        ("[\"R\"]", "[\"L\"]", "names out of [parameters]: J, R"),
        (offset, more.as_str(), "4 or fewer inputs"),
    ] {
        assert!(TWO.contains(from), "{from}");
        let error = SmallModel::parse(&TWO.replacen(from, to, 1), "ports.toml").unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains("ports.toml") && text.contains(said),
            "{to}: {text}"
        );
    }
}
