//! Drives, pendulums and joints through the one model interface: closed forms, symmetry, independent references, saved states.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod bad_input;
mod plants;
mod reference;

use plants::{JOINT, PENDULUM, Run, SLED, SPRING};
use reference::Reference;
use std::cell::Cell;
use std::f64::consts::PI;
use stickslip::cosim::{self, StateReader};

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{found} instead of {expected}"
    );
}

#[test]
fn each_half_swing_of_a_mass_on_a_spring_loses_twice_the_friction_over_the_stiffness() {
    let (start, half_swing) = (1.0, PI / 5.0);
    let mut run = Run::new(SPRING, &[("position", start)]);
    let mut sign = 1.0;
    for swings in 0..8 {
        run.step(f64::from(swings) * half_swing);
        close(
            run.get("position"),
            sign * (start - 0.12 * f64::from(swings)),
            1e-9,
        );
        sign = -sign;
    }
    // The ninth turn is at 0.04 m, where the spring cannot overcome the friction.
    run.step(20.0);
    assert!(run.stuck());
    close(run.get("position"), 0.04, 1e-9);
    assert_eq!(run.get("velocity"), 0.0);
    assert_eq!(run.get("acceleration"), 0.0);
    close(run.get("friction"), -2.0, 1e-7);
}

#[test]
fn a_pendulum_turns_where_friction_has_taken_the_energy_that_is_missing() {
    let mut run = Run::new(PENDULUM, &[("position", 1.2)]);
    let (mut from, mut turns, step) = (1.2_f64, 0, 1e-4);
    let mut before = run.state();
    for at in 1..120_000 {
        run.step(f64::from(at) * step);
        let now = run.state();
        if now[1] * before[1] < 0.0 || (now[1] == 0.0 && before[1] != 0.0) {
            // The turn is where the parabola through the last point before it has its top.
            let turn = before[0] - before[1] * before[1] / (2.0 * before[3]);
            let energy = |x: f64| -40.0 * x.cos();
            let lost = energy(from) - energy(turn);
            close(lost, 1.5 * (turn - from).abs(), 1e-8);
            (from, turns) = (turn, turns + 1);
        }
        before = now;
    }
    assert!(run.stuck() && turns >= 10, "{turns} turns");
    assert!((40.0 * before[0].sin()).abs() <= 1.5);
    assert_eq!(before[1], 0.0);
}

#[test]
fn a_ramp_breaks_the_body_away_at_the_instant_at_which_it_reaches_the_friction() {
    for sign in [1.0, -1.0] {
        let mut run = Run::new(SLED, &[]);
        assert!(run.stuck());
        let force = run.reference("force");
        run.0.set_input_derivative(force, 1, 0.7 * sign).unwrap();
        let end = run.0.step(10.0, true).unwrap();
        assert!(end.switched && !run.stuck());
        close(end.time, 3.0 / 0.7, 1e-13);
        run.step(10.0);
        let since = 10.0 - 3.0 / 0.7;
        close(run.get("velocity"), sign * 0.7 * since * since / 4.0, 1e-12);
        close(run.get("friction"), 3.0 * sign, 0.0);
    }
}

#[test]
fn new_inputs_that_exceed_the_friction_break_it_away_at_once() {
    let mut run = Run::new(SLED, &[]);
    run.set("force", 2.9);
    run.step(1.0);
    assert!(run.stuck());
    close(run.get("friction"), 2.9, 1e-15);
    run.set("force", 3.5);
    let end = run.0.step(3.0, false).unwrap();
    assert!(end.switched && !run.stuck());
    close(run.get("position"), 0.5, 1e-14);
    // It slides to rest, and stays.
    run.set("force", 0.0);
    run.step(10.0);
    assert!(run.stuck());
    close(run.get("position"), 0.5 + 0.5 * 0.5 / 3.0, 1e-13);
    assert_eq!(run.get("velocity"), 0.0);
}

#[test]
fn friction_that_grows_with_the_acceleration_adds_to_the_inertia_one_way_and_takes_from_it_the_other()
 {
    let text = format!("{SLED}[load_friction]\ncoefficient = 0.5\n");
    let mut run = Run::new(&text, &[("force", 8.0)]);
    run.step(1.0);
    close(run.get("velocity"), 2.0, 1e-13);
    run.set("force", 0.0);
    close(run.get("acceleration"), -2.0, 1e-13);
    close(run.get("friction"), 4.0, 1e-13);
    run.step(1.5);
    close(run.get("velocity"), 1.0, 1e-13);
    run.step(9.0);
    assert!(run.stuck());
    close(run.get("position"), 1.0 + 1.0, 1e-12);
    // An inertia that does not outweigh it has no motion, or several.
    let mut run = Run::new(&text, &[("velocity", 1.0)]);
    run.set("load_friction.coefficient", 2.5);
    let error = run.0.step(1.0, false).unwrap_err().to_string();
    assert!(
        error.contains("outweigh") && error.contains("load_friction"),
        "{error}"
    );
}

#[test]
fn what_is_mirrored_moves_mirrored_bit_for_bit() {
    let mut runs = [1.0, -1.0].map(|sign| Run::new(JOINT, &[("position", 0.3 * sign)]));
    for at in 0..400_u32 {
        let voltage = 9.0 * (0.37 * f64::from(at)).sin();
        let connected = f64::from(u8::from(!at.is_multiple_of(7)));
        let mut states = Vec::new();
        for (run, sign) in runs.iter_mut().zip([1.0, -1.0]) {
            run.set("voltage", sign * voltage);
            run.set("connected", connected);
            run.step(f64::from(at + 1) * 0.02);
            states.push(run.state().map(|value| sign * value + 0.0));
        }
        assert_eq!(states[0], states[1], "step {at}");
    }
}

#[test]
fn the_motion_does_not_depend_on_the_communication_step() {
    for (text, values) in [
        (SPRING, [("position", 1.0)]),
        (PENDULUM, [("position", 1.0)]),
        (JOINT, [("voltage", 6.0)]),
    ] {
        let mut whole = Run::new(text, &values);
        whole.step(4.0);
        for count in [7, 4000] {
            let mut run = Run::new(text, &values);
            for at in 1..=count {
                run.step(4.0 * f64::from(at) / f64::from(count));
            }
            assert_eq!(run.state(), whole.state(), "{count} steps of {text}");
        }
    }
}

#[test]
fn a_saved_state_goes_on_bit_for_bit() {
    let mut run = Run::new(JOINT, &[("position", 0.4), ("voltage", 7.0)]);
    for at in 1..120 {
        run.set("voltage", 7.0 - 0.1 * f64::from(at));
        run.step(0.017 * f64::from(at));
        let saved = run.saved();
        let mut other = Run(cosim::open(JOINT, "test").unwrap());
        let mut reader = StateReader::new(&saved);
        other.0.restore(&mut reader).unwrap();
        reader.finish().unwrap();
        assert_eq!(other.saved(), saved);
        let mut ahead = Run(cosim::open(JOINT, "test").unwrap());
        ahead.0.restore(&mut StateReader::new(&saved)).unwrap();
        let until = 0.017 * f64::from(at) + 0.3;
        other.step(until);
        ahead.step(until - 0.1);
        ahead.step(until);
        assert_eq!(other.state(), ahead.state());
    }
}

#[test]
fn the_error_falls_with_the_tolerance_to_that_of_an_independent_reference() {
    // Stribeck and quadratic drag, an effect of one's own that sets in at an instant, a spring that is not straight.
    let text = r#"
[plant]
kind = "drive"
path = "line"
[drive]
inertia = 2.0
viscous = 0.4
offset = 0.3
[coulomb_friction]
force = 1.0
[stribeck]
excess = 0.8
speed = 0.2
[friction_asymmetry]
difference = 0.1
[quadratic_drag]
coefficient = 0.3
[elastic_force]
linear = 30.0
square = 2.0
[[effect]]
name = "kick"
title = "a force that sets in at one moment and fades"
port = "plant.force"
equation = "-force * (1 + sign(time - onset)) * exp(-abs(time - onset)/fade)"
parameters.force = { value = 4.0, unit = "N", description = "half its size" }
parameters.onset = { value = 2.3, unit = "s", description = "when" }
parameters.fade = { value = 0.8, unit = "s", range = "positive", description = "over which" }
"#;
    let friction =
        |v: f64, direction: f64| (1.0 + 0.8 * (-v.abs() / 0.2).exp()) * direction + 0.1 * v.abs();
    // A stage of a step must not see the other side of the onset.
    let has_kick = Cell::new(false);
    let acceleration = |t: f64, x: f64, v: f64, direction: f64| {
        let kick = if has_kick.get() {
            8.0 * (-(t - 2.3) / 0.8).exp()
        } else {
            0.0
        };
        let passive = 0.4 * v + 0.3 + 0.3 * v * v.abs() + (30.0 + 2.0 * x) * x;
        (kick - passive - friction(v, direction)) / 2.0
    };
    let mut reference = Reference::new(0.9, 0.0, 1e-4, acceleration);
    reference.advance(2.3);
    has_kick.set(true);
    reference.advance(4.0);
    assert!(reference.turns >= 4, "{}", reference.turns);
    let error = |text: &str, tolerance: f64| {
        let mut run = Run::at(text, Some(tolerance), &[("position", 0.9)]);
        run.step(4.0);
        (run.get("position") - reference.x).abs() + (run.get("velocity") - reference.v).abs()
    };
    for (tolerance, largest) in [(1e-10, 1e-9), (1e-13, 3e-11)] {
        let error = error(text, tolerance);
        assert!(error < largest, "{error:e} at {tolerance:e}");
    }
    let (plain, _) = text.split_once("[[effect]]").unwrap();
    has_kick.set(false);
    let mut reference = Reference::new(0.9, 0.0, 1e-4, acceleration);
    reference.advance(1.9);
    let errors = [1e-2, 1e-4, 1e-6, 1e-10].map(|tolerance| {
        let mut run = Run::at(plain, Some(tolerance), &[("position", 0.9)]);
        run.step(1.9);
        (run.get("position") - reference.x).abs() + (run.get("velocity") - reference.v).abs()
    });
    assert!(errors[3] < 1e-9 && errors[2] < 1e-5, "{errors:?}");
    assert!(
        errors.is_sorted_by(|loose, tight| tight < loose),
        "{errors:?}"
    );
}

#[test]
fn what_the_motor_puts_in_friction_and_the_arm_take_up() {
    let mut run = Run::new(JOINT, &[("voltage", 8.0)]);
    let (mut worked, step) = (0.0, 2e-4);
    let power = |run: &mut Run| {
        let [_, v, friction, _] = run.state();
        let motor = 15.0 * 8.0 - 10.0 * v;
        (motor - friction - v) * v
    };
    let mut before = power(&mut run);
    for at in 1..=15_000 {
        run.step(f64::from(at) * step);
        let now = power(&mut run);
        worked += 0.5 * step * (before + now);
        before = now;
    }
    let [x, v, ..] = run.state();
    close(0.5 * v * v - 72.0 * (x.cos() - 1.0), worked, 2e-4);
}

#[test]
fn derivatives_are_those_of_differences() {
    let text = JOINT.to_owned() + "[friction_wear]\nrate_per_minute = 0.5\n";
    let mut run = Run::new(&text, &[("position", 0.4), ("voltage", 7.0)]);
    run.step(0.1);
    assert!(!run.stuck());
    for known in [
        "voltage",
        "connected",
        "joint.gain",
        "stribeck.speed",
        "motor_load_friction.coefficient",
    ] {
        for unknown in ["acceleration", "friction"] {
            let (known_at, unknown_at) = (run.reference(known), run.reference(unknown));
            let found = run.0.partial_derivative(unknown_at, known_at).unwrap();
            let value = run.get(known);
            let h = 1e-5 * value;
            let mut moved = |by: f64| {
                run.set(known, value + by);
                run.get(unknown)
            };
            let expected = (moved(h) - moved(-h)) / (2.0 * h);
            run.set(known, value);
            close(found, expected, 1e-6 * expected.abs().max(1.0));
        }
    }
    // Time derivatives of outputs.
    let velocity = run.reference("velocity");
    let found = run.0.output_derivative(velocity, 1).unwrap();
    let acceleration = run.get("acceleration");
    close(found, acceleration, 1e-9 * acceleration.abs());
}

#[test]
fn a_body_that_rattles_ever_faster_ends_in_a_clear_message() {
    let text = r#"
[plant]
kind = "drive"
path = "line"
[drive]
inertia = 1.0
viscous = 1.0
offset = 0.0
[[effect]]
name = "edge"
title = "a force that changes its sign at one place"
port = "plant.force"
equation = "force * sign(position)"
parameters.force = { value = 3.0, unit = "N", description = "its size" }
"#;
    let mut run = Run::new(text, &[("position", 0.1)]);
    let error = run.0.step(60.0, false).unwrap_err().to_string();
    assert!(
        error.contains("chattering") || error.contains("segments"),
        "{error}"
    );
}

#[test]
fn a_joint_whose_terminals_are_open_is_a_pendulum() {
    let joint = JOINT.replace("[motor_load_friction]\ncoefficient = 0.15\n", "");
    let mut open = Run::new(
        &joint,
        &[("position", 1.1), ("voltage", 9.0), ("connected", 0.0)],
    );
    let still =
        "[joint]\nstiffness = 72.0\nrest = 0.0\nviscous = 1.0\ngain = 0.0\nback_emf = 0.0\n";
    let (head, tail) = joint.split_once("[joint]").unwrap();
    let (_, effects) = tail.split_once("[coulomb").unwrap();
    let mut free = Run::new(
        &format!("{head}{still}[coulomb{effects}"),
        &[("position", 1.1)],
    );
    for run in [&mut open, &mut free] {
        run.step(2.0);
    }
    assert_eq!(open.state(), free.state());
}

#[test]
fn a_stop_gives_the_speed_back_after_half_a_period_of_its_spring() {
    let text = r#"
[plant]
kind = "drive"
path = "line"
[drive]
inertia = 2.0
viscous = 0.0
offset = 0.0
[[effect]]
name = "stop"
title = "a stiff spring at the end of the way"
port = "plant.force"
equation = "stiffness * max(position - place, length*0)"
parameters.stiffness = { value = 800.0, unit = "N/m", description = "of the spring" }
parameters.place = { value = 0.5, unit = "m", description = "where it begins" }
parameters.length = { value = 1.0, unit = "m", description = "any length" }
"#;
    let mut run = Run::new(text, &[("velocity", 1.0)]);
    let touching = PI / 20.0;
    run.step(0.5 + 0.5 * touching);
    close(run.get("velocity"), 0.0, 1e-9);
    close(run.get("position"), 0.55, 1e-12);
    run.step(2.0);
    close(run.get("velocity"), -1.0, 1e-9);
    close(run.get("position"), 0.5 - (1.5 - touching), 1e-9);
}

#[test]
fn a_body_that_sticks_breaks_away_at_the_instant_at_which_a_fast_force_reaches_the_friction() {
    let text = format!(
        "{SLED}[[effect]]\nname = \"hum\"\ntitle = \"a force that swings fast\"\nport = \"plant.force\"\n\
         equation = \"-size * sin(rate * time)\"\n\
         parameters.size = {{ value = 4.0, unit = \"N\", description = \"its size\" }}\n\
         parameters.rate = {{ value = 100.0, unit = \"1/s\", description = \"its rate\" }}\n"
    );
    let mut run = Run::new(&text, &[]);
    let end = run.0.step(1.0, true).unwrap();
    assert!(end.switched);
    close(end.time, 0.75_f64.asin() / 100.0, 1e-12);
}
