//! `stickslip export`: parameters beside the law that they stand for, what they leave out, input that is refused.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use std::fs;

use common::stickslip;
use quick_xml::Reader;
use quick_xml::events::Event;

/// A servo with an arm.
const ARM: &str = r#"
[plant]
kind = "joint"
path = "turn"
[joint]
stiffness = 72.0
rest = 0.0
viscous = { value = 1.0, unit = "1/s", interval95 = [0.9, 1.1] }
gain = 15.0
back_emf = 10.0
[coulomb_friction]
force = 4.0
[stribeck]
excess = 2.5
speed = 0.3
"#;

/// Effects that a line over the speed does not have.
const LOADS: &str = r#"
[motor_load_friction]
coefficient = 0.2
[external_load_friction_square]
coefficient = 0.001
[friction_wear]
rate_per_minute = 0.5
[[effect]]
name = "tilt"
title = "a constant moment"
port = "plant.force"
equation = "- -size"
parameters.size = { value = 0.1, unit = "force", description = "its size" }
"#;

const AXIS: &str = r#"
[plant]
kind = "drive"
path = "line"
[drive]
inertia = 90.0
viscous = 200.0
offset = -3.0
[coulomb_friction]
force = 20.0
[sensor_delay]
delay = 0.002
"#;

const INERTIA: f64 = 0.012;
const MOTOR: [&str; 6] = [
    "--inertia",
    "0.012",
    "--rotor-inertia",
    "3e-8",
    "--ratio",
    "288.4",
];

/// Exports a model: exit code, what was printed, the file.
fn export(model: &str, to: &str, more: &[&str]) -> (i32, String, Option<String>) {
    let directory = tempfile::tempdir().unwrap();
    let (input, output) = (
        directory.path().join("model.toml"),
        directory.path().join("joint.xml"),
    );
    fs::write(&input, model).unwrap();
    let (input, out) = (input.to_str().unwrap(), output.to_str().unwrap());
    let arguments = ["export", input, "--to", to, "--out", out];
    let (code, text) = stickslip(&[&arguments, more].concat());
    let others = fs::read_dir(directory.path()).unwrap().count();
    assert_eq!(others, 1 + usize::from(output.exists()), "{text}");
    (code, text, fs::read_to_string(output).ok())
}

/// The file of an export that works.
fn exported(model: &str, to: &str, more: &[&str]) -> String {
    let (code, text, file) = export(model, to, &[&["--name", "elbow"], more].concat());
    assert_eq!(code, 0, "{text}");
    file.unwrap()
}

/// An attribute of the element that has it.
fn attribute(xml: &str, element: &str, name: &str) -> String {
    let mut reader = Reader::from_str(xml);
    loop {
        let event = reader.read_event().unwrap();
        assert_ne!(event, Event::Eof, "no {name} of {element} in {xml}");
        if let Event::Start(found) | Event::Empty(found) = event
            && found.name().as_ref() == element
            && let Some(found) = found.try_get_attribute(name).unwrap()
        {
            return found.value.into_owned();
        }
    }
}

fn number(xml: &str, element: &str, name: &str) -> f64 {
    attribute(xml, element, name).parse().unwrap()
}

/// The largest error that the file states for MuJoCo.
fn stated(xml: &str) -> f64 {
    let (_, rest) = xml
        .split_once("name=\"elbow_largest_error\" data=\"")
        .unwrap();
    rest.split('"').next().unwrap().parse().unwrap()
}

/// The arm's friction over the speed [N m], written out.
fn friction(speed: f64) -> f64 {
    INERTIA * (speed + 4.0 + 2.5 * (-speed / 0.3).exp())
}

#[test]
fn the_stated_error_is_the_largest_one_beside_the_law() {
    for (low, high) in [(0.05, 6.0), (0.0, 0.5), (1.0, 30.0)] {
        let speed = format!("{low}:{high}");
        let xml = exported(ARM, "mujoco", &[&MOTOR[..], &["--speed", &speed]].concat());
        let (damping, loss) = (
            number(&xml, "joint", "damping"),
            number(&xml, "joint", "frictionloss"),
        );
        let largest = |damping: f64, loss: f64| {
            let speeds = (0..=100_000).map(|at| low + (high - low) * f64::from(at) * 1e-5);
            let errors = speeds.map(|v| (friction(v) - damping * v - loss).abs());
            errors.fold(0.0, f64::max)
        };
        let (error, stated) = (largest(damping, loss), stated(&xml));
        assert!(error <= stated * (1.0 + 1e-6), "{error} {xml}");
        assert!(stated <= 1.02 * error + 1e-9, "{error} {xml}");
        // No other line comes closer.
        for (more, shift) in [(0.02, 0.0), (0.0, 0.02), (0.02, 0.01), (0.02, -0.01)] {
            for sign in [-1.0, 1.0] {
                let (damping, loss) = (
                    damping + sign * more * loss / high,
                    loss * (1.0 + sign * shift),
                );
                if damping >= 0.0 {
                    assert!(largest(damping, loss) > error, "{damping} {loss} {xml}");
                }
            }
        }
    }
}

#[test]
fn friction_that_is_a_line_is_exported_as_it_is() {
    let model = ARM.split("[stribeck]").next().unwrap();
    let xml = exported(model, "mujoco", &[&MOTOR[..], &["--speed", "0:6"]].concat());
    assert_eq!(number(&xml, "joint", "damping"), 0.012);
    assert_eq!(number(&xml, "joint", "frictionloss"), 0.048);
    // 3e-8 · 288.4², to six digits.
    assert_eq!(number(&xml, "joint", "armature"), 0.00249524);
    assert!(stated(&xml) < 1e-15, "{xml}");
    assert_eq!(attribute(&xml, "joint", "type"), "hinge");
    assert_eq!(attribute(&xml, "default", "class"), "elbow");
    // Voltage to torque, and the back-EMF.
    assert_eq!(number(&xml, "general", "gainprm"), 0.18);
    assert_eq!(attribute(&xml, "general", "biasprm"), "0 0 -0.12");
    assert!(xml.contains("viscous = 1 1/s (95 %: 0.9 to 1.1)"), "{xml}");
}

#[test]
fn what_the_parameters_cannot_tell_is_said_and_left_out() {
    let with = format!("{ARM}{LOADS}");
    let more = [&MOTOR[..], &["--speed", "0.05:6", "--name", "elbow"]].concat();
    let (code, text, file) = export(&with, "mujoco", &more);
    let xml = file.unwrap();
    assert_eq!(code, 0, "{text}");
    let without = exported(
        ARM,
        "mujoco",
        &[&MOTOR[..], &["--speed", "0.05:6"]].concat(),
    );
    for name in ["damping", "frictionloss", "armature"] {
        let [with, without] = [&xml, &without].map(|xml| attribute(xml, "joint", name));
        assert_eq!(with, without);
    }
    for words in [
        "motor_load_friction depends on the motor's torque: coefficient * abs(motor) * direction, with \
         motor_load_friction.coefficient = 0.2 1; 0.1728 N.m where the motor holds the arm level",
        "external_load_friction_square depends on the load",
        "0.062208 N.m where the motor holds the arm level",
        "friction_wear depends on the time",
        "tilt is a force that does not depend on the motion: - -size",
        "the moment of the weight, 0.864 N.m where the arm is level",
        "At rest that law holds up to 0.078 N.m",
        "backlash, an elastic shaft, delays and a sag of the supply",
    ] {
        assert!(xml.contains(words), "{words}: {xml}");
    }
    assert!(
        text.contains(
            "these parameters cannot tell external_load_friction_square, friction_wear, motor_load_friction, tilt;"
        ),
        "{text}"
    );
}

#[test]
fn an_axis_along_a_line_keeps_its_own_inertia() {
    let motor = ["--rotor-inertia", "0.0004", "--ratio", "400"];
    let xml = exported(
        AXIS,
        "mujoco",
        &[&motor[..], &["--speed", "0:0.4"]].concat(),
    );
    assert_eq!(attribute(&xml, "joint", "type"), "slide");
    assert_eq!(number(&xml, "joint", "damping"), 200.0);
    assert_eq!(number(&xml, "joint", "frictionloss"), 20.0);
    assert!((number(&xml, "joint", "armature") - 64.0).abs() < 1e-12);
    assert!(!xml.contains("<general"), "{xml}");
    for words in [
        "drive.offset, a constant force of -3 N",
        "sensor_delay is in the readings",
        "the body has the rest, 26 kg",
    ] {
        assert!(xml.contains(words), "{words}: {xml}");
    }
}

#[test]
fn urdf_has_damping_and_friction_and_a_word_on_the_rest() {
    let xml = exported(ARM, "urdf", &["--inertia", "0.012", "--speed", "1:6"]);
    assert_eq!(attribute(&xml, "joint", "name"), "elbow");
    let line = [
        number(&xml, "dynamics", "damping"),
        number(&xml, "dynamics", "friction"),
    ];
    let mujoco = exported(ARM, "mujoco", &[&MOTOR[..], &["--speed", "1:6"]].concat());
    let same = ["damping", "frictionloss"].map(|name| number(&mujoco, "joint", name));
    assert_eq!(line, same);
    for words in [
        "URDF has no armature; the motor's part of the inertia was not given",
        "the motor: 0.18 N.m/V, less 0.12 N.m.s/rad of back-EMF",
    ] {
        assert!(xml.contains(words), "{words}: {xml}");
    }
    let given = exported(ARM, "urdf", &[&MOTOR[..], &["--speed", "1:6"]].concat());
    assert!(given.contains("URDF has no armature: 0.0024"), "{given}");
}

#[test]
fn bad_input_is_told_and_leaves_no_file() {
    let speed = ["--name", "elbow", "--speed", "0.05:6"];
    let arm = |more: &[&str]| export(ARM, "mujoco", &[&speed, more].concat());
    let motor = &MOTOR[2..];
    for (more, words) in [
        (
            &["--inertia", "0.012"][..],
            "give --rotor-inertia [kg.m2] and --ratio [1]",
        ),
        (
            motor,
            "all numbers of a joint are over its moment of inertia; give that about the axis as --inertia",
        ),
        (
            &[
                "--inertia",
                "-0.012",
                "--rotor-inertia",
                "1",
                "--ratio",
                "1",
            ],
            "--inertia is -0.012; it must be a finite number above 0 [kg.m2]",
        ),
        (
            &["--inertia", "0.012", "--rotor-inertia", "1", "--ratio", "0"],
            "--ratio is 0; it must be",
        ),
        (
            &[
                "--inertia",
                "0.012",
                "--rotor-inertia",
                "1e-6",
                "--ratio",
                "200",
            ],
            "is 0.04 kg.m2; it must not be above the whole inertia, 0.012 kg.m2",
        ),
        (&["--inertia", "0.012", "--ratio", "200"], "--rotor-inertia"),
    ] {
        let (code, text, file) = arm(more);
        assert_eq!((code, file), (2, None), "{text}");
        assert!(text.contains(words), "{words}: {text}");
    }
    for (range, words) in [
        ("6:1", "0 or more"),
        ("-1:6", "0 or more"),
        ("6", "LOW:HIGH"),
    ] {
        let more = [&MOTOR[..], &["--name", "elbow", "--speed", range]].concat();
        let (code, text, file) = export(ARM, "mujoco", &more);
        assert_eq!((code, file), (2, None), "{text}");
        assert!(text.contains(words) && text.contains("--speed"), "{text}");
    }
    let (code, text, _) = export(ARM, "mujoco", &["--name", "elbow"]);
    assert!(code == 2 && text.contains("--speed"), "{text}");
    let more = [&MOTOR[..], &["--name", "an elbow", "--speed", "1:2"]].concat();
    let (code, text, file) = export(ARM, "mujoco", &more);
    assert_eq!((code, file), (2, None), "{text}");
    assert!(text.contains("--name is \"an elbow\""), "{text}");

    for (model, more, words) in [
        (AXIS.to_owned(), &["--inertia", "3"][..], "[drive] inertia = 90 is the model's own; leave --inertia out"),
        (AXIS.replace("[sensor_delay]", "[sensor_dealy]"), &[], "section [sensor_dealy]"),
        (AXIS.replace("viscous = 200.0", "viscous = \"much\""), &[], "viscous"),
        ("[plant]\nkind = \"balance\"\npath = \"turn\"\n".to_owned(), &[], "[plant] kind = \"balance\" must be \"drive\", \"pendulum\" or \"joint\" to be exported"),
        (
            "[plant]\nkind = \"pendulum\"\npath = \"turn\"\n[pendulum]\nstiffness = 40.0\nrest = 0.0\nviscous = 0.1\n".to_owned(),
            &MOTOR,
            "a pendulum has no motor",
        ),
    ] {
        let (code, text, file) = export(&model, "urdf", &[&speed, more].concat());
        assert_eq!((code, file), (2, None), "{text}");
        assert!(text.contains(words) && text.contains("model.toml"), "{words}: {text}");
    }
}
