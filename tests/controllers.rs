//! The controllers through the one model interface: closed forms, limits, independence of the communication step.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use common::Uniform;
use stickslip::cosim::{self, CoSimulationModel, StateReader, StateWriter};

const SPEED: &str = include_str!("../modelDescription/speed-controller.toml");
const SOFT: &str = include_str!("../modelDescription/soft-torque.toml");

/// A controller at the end of its initialisation with these start values.
fn started(text: &str, values: &[(&str, f64)]) -> Box<dyn CoSimulationModel> {
    let mut model = cosim::open(text, "test").unwrap();
    set(&mut model, values);
    model.initialise().unwrap();
    model
}

fn reference(model: &dyn CoSimulationModel, name: &str) -> u32 {
    model.table().find(name).unwrap().value_reference
}

fn set(model: &mut Box<dyn CoSimulationModel>, values: &[(&str, f64)]) {
    for (name, value) in values {
        let reference = reference(&**model, name);
        model.set_real(reference, *value).unwrap();
    }
}

fn get(model: &mut Box<dyn CoSimulationModel>, name: &str) -> f64 {
    let reference = reference(&**model, name);
    model.real(reference).unwrap()
}

fn saturated(model: &mut Box<dyn CoSimulationModel>) -> bool {
    let reference = reference(&**model, "saturated");
    model.boolean(reference).unwrap()
}

fn close(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= 1e-13 * expected.abs().max(1.0),
        "{found} instead of {expected}"
    );
}

#[test]
fn a_held_error_gives_the_ramp_of_a_pi_controller() {
    let mut model = started(SPEED, &[("omega_ref", 5.0), ("theta3_dot", 3.0)]);
    close(get(&mut model, "u"), 2.8 * 2.0);
    model.step(0.7, false).unwrap();
    close(get(&mut model, "u"), 2.8 * 2.0 + 3.5 * 2.0 * 0.7);
    close(get(&mut model, "integral"), 3.5 * 2.0 * 0.7);
}

#[test]
fn gains_on_the_motor_speed_are_gains_times_the_ratio() {
    let motor = SPEED.replace("\"gearbox_output\"", "\"motor\"") + "[gearbox]\nratio = 8.0\n";
    let mut model = started(&motor, &[("omega_ref", 5.0), ("theta3_dot", 4.9)]);
    close(get(&mut model, "u"), 2.8 * 8.0 * 0.1);
    // Without the motor's speed the ratio means nothing, and with it it cannot be missing.
    let refused = |text: &str| cosim::open(text, "c.toml").err().unwrap().to_string();
    assert!(refused(&(SPEED.to_owned() + "[gearbox]\nratio = 8.0\n")).contains("[gearbox]"));
    assert!(refused(&SPEED.replace("\"gearbox_output\"", "\"motor\"")).contains("[gearbox]"));
    assert!(
        refused(&SPEED.replace("\"gearbox_output\"", "\"disc\"")).contains("gearbox_output, motor")
    );
}

#[test]
fn the_limit_is_reached_at_its_exact_instant_and_the_integral_waits_there() {
    let mut model = started(SPEED, &[("omega_ref", 6.0), ("theta3_dot", 1.0)]);
    let instant = (24.0 - 2.8 * 5.0) / (3.5 * 5.0);
    let end = model.step(10.0, true).unwrap();
    assert!(end.switched);
    close(end.time, instant);
    assert!(saturated(&mut model));
    let held = get(&mut model, "integral");
    close(held, 24.0 - 2.8 * 5.0);
    model.step(10.0, false).unwrap();
    close(get(&mut model, "u"), 24.0);
    close(get(&mut model, "integral"), held);
    // The error shrinks: at once off the limit, with the integral from where it waited.
    set(&mut model, &[("theta3_dot", 4.0)]);
    close(get(&mut model, "u"), 2.8 * 2.0 + held);
    assert!(!saturated(&mut model));
    set(&mut model, &[("omega_ref", -20.0)]);
    close(get(&mut model, "u"), -24.0);
}

#[test]
fn an_integral_beyond_the_limit_runs_back_and_leaves_it_at_the_exact_instant() {
    let values = [("omega_ref", 1.0), ("theta3_dot", 2.0), ("integral", 40.0)];
    let mut model = started(SPEED, &values);
    assert!(saturated(&mut model));
    let end = model.step(100.0, true).unwrap();
    // −2.8 + 40 − 3.5 t = 24
    close(end.time, (40.0 - 2.8 - 24.0) / 3.5);
    assert!(end.switched && !saturated(&mut model));
    model.step(end.time + 1.0, false).unwrap();
    close(get(&mut model, "u"), 24.0 - 3.5);
}

#[test]
fn soft_torque_filters_in_closed_form() {
    let mut model = started(SOFT, &[("omega_ref", 5.0), ("theta3_dot", 5.0), ("i", 1.5)]);
    let (torque, emf) = (8.0 * 0.126 * 1.5, 0.0602 * 8.0);
    let motor = 64.0 * 0.126 * 0.0602 / 0.33;
    for time in [0.01, 0.05, 0.2, 3.0] {
        model.step(time, false).unwrap();
        let filtered = torque * (1.0 - libm::exp(-time / 0.05));
        close(get(&mut model, "filtered_torque"), filtered);
        close(
            get(&mut model, "u"),
            emf * (5.0 - filtered * (1.0 / 0.072 - 1.0 / motor)),
        );
    }
}

#[test]
fn soft_torque_cannot_be_stiffer_than_the_motor() {
    let text = SOFT.replace("value = 0.072", "value = 1.5");
    let error = cosim::open(&text, "soft.toml").err().unwrap().to_string();
    assert!(
        error.contains("soft.toml") && error.contains("1.5") && error.contains("1.47"),
        "{error}"
    );
    let text = SOFT.replace("value = -24.0", "value = 30.0");
    let error = cosim::open(&text, "soft.toml").err().unwrap().to_string();
    assert!(
        error.contains("minimum = 30 V must be below maximum = 24 V"),
        "{error}"
    );
}

/// Sets cubic inputs that drive a controller into both limits and back.
fn drive_hard(model: &mut Box<dyn CoSimulationModel>) {
    let inputs = [
        ("omega_ref", [4.0, 30.0, -160.0, 240.0]),
        ("theta3_dot", [1.0, -3.0, 4.0, 0.0]),
    ];
    for (name, values) in inputs {
        let place = reference(&**model, name);
        model.set_real(place, values[0]).unwrap();
        for (order, value) in (1..).zip(&values[1..]) {
            model.set_input_derivative(place, order, *value).unwrap();
        }
    }
    if let Some(current) = model.table().find("i").map(|v| v.value_reference) {
        model.set_real(current, 1.0).unwrap();
        model.set_input_derivative(current, 2, 9.0).unwrap();
    }
}

#[test]
fn nothing_depends_on_the_communication_step() {
    for text in [SPEED, SOFT] {
        let mut results = Vec::new();
        for steps in [1, 7, 3000] {
            let mut model = started(text, &[]);
            drive_hard(&mut model);
            for step in 1..=steps {
                model
                    .step(3.0 * f64::from(step) / f64::from(steps), false)
                    .unwrap();
            }
            results.push([get(&mut model, "u"), get(&mut model, "integral")].map(f64::to_bits));
        }
        assert!(
            results.iter().all(|result| *result == results[0]),
            "{results:?}"
        );
    }
}

/// The rules of limits and anti-windup in their plainest form, by tiny steps.
fn by_tiny_steps(soft: bool, end: f64) -> (f64, f64) {
    let (steps, mut integral, mut filtered) = (3_000_000, 0.0, 0.0);
    let h = end / f64::from(steps);
    let emf = 0.0602 * 8.0;
    let admittance = 1.0 / 0.072 - 0.33 / (64.0 * 0.126 * 0.0602);
    let mut output = 0.0;
    for step in 0..=steps {
        let t = h * f64::from(step);
        let wanted = 4.0 + 30.0 * t - 80.0 * t * t + 40.0 * t * t * t;
        let speed = 1.0 - 3.0 * t + 2.0 * t * t;
        let current = 1.0 + 4.5 * t * t;
        let (rest, rate) = if soft {
            (
                emf * (wanted - filtered * admittance),
                emf * 2.24 * (wanted - speed),
            )
        } else {
            (2.8 * (wanted - speed), 3.5 * (wanted - speed))
        };
        let unlimited: f64 = rest + integral;
        output = unlimited.clamp(-24.0, 24.0);
        if step == steps {
            break;
        }
        let outward = (unlimited >= 24.0 && rate > 0.0) || (unlimited <= -24.0 && rate < 0.0);
        if !outward {
            integral += h * rate;
        }
        filtered += h * (8.0 * 0.126 * current - filtered) / 0.05;
    }
    (output, integral)
}

#[test]
fn limits_and_anti_windup_agree_with_tiny_steps() {
    for (text, soft) in [(SPEED, false), (SOFT, true)] {
        let mut model = started(text, &[]);
        drive_hard(&mut model);
        let mut switches = 0;
        for time in [0.15, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.1, 2.4, 3.0] {
            while get(&mut model, "time") < time {
                switches += u32::from(model.step(time, true).unwrap().switched);
            }
            let (output, integral) = by_tiny_steps(soft, time);
            let (u, v) = (get(&mut model, "u"), get(&mut model, "integral"));
            assert!(
                (u - output).abs() < 2e-3,
                "t = {time}: u = {u}, not {output}"
            );
            assert!(
                (v - integral).abs() < 2e-3,
                "t = {time}: v = {v}, not {integral}"
            );
        }
        assert!(
            switches >= 3,
            "the inputs reach both limits: {switches} switches"
        );
    }
}

#[test]
fn a_restored_controller_goes_on_bit_for_bit() {
    for text in [SPEED, SOFT] {
        let mut model = started(text, &[]);
        drive_hard(&mut model);
        model.step(0.21, false).unwrap();
        let mut writer = StateWriter::default();
        model.save(&mut writer);
        let bytes = writer.into_bytes();
        let run = |model: &mut Box<dyn CoSimulationModel>| {
            let mut bits = Vec::new();
            for step in 1..200 {
                model.step(0.21 + 0.01 * f64::from(step), false).unwrap();
                bits.push([get(model, "u"), get(model, "integral")].map(f64::to_bits));
            }
            bits
        };
        let first = run(&mut model);
        let mut other = started(text, &[("omega_ref", 3.0)]);
        other.restore(&mut StateReader::new(&bytes)).unwrap();
        assert_eq!(run(&mut other), first);
        model.restore(&mut StateReader::new(&bytes)).unwrap();
        assert_eq!(run(&mut model), first);
        for length in 0..bytes.len() {
            assert!(
                model
                    .restore(&mut StateReader::new(&bytes[..length]))
                    .is_err()
            );
        }
    }
}

#[test]
fn derivatives_are_those_of_difference_quotients() {
    for text in [SPEED, SOFT] {
        let mut model = started(text, &[("omega_ref", 5.0), ("theta3_dot", 4.5)]);
        model.step(0.02, false).unwrap();
        let u = reference(&*model, "u");
        let names: Vec<String> = model
            .table()
            .variables()
            .iter()
            .map(|v| v.name.clone())
            .collect();
        for name in names
            .iter()
            .filter(|name| name.contains('.') || *name == "omega_ref")
        {
            if name.starts_with("gearbox") {
                continue; // fixed
            }
            let place = reference(&*model, name);
            let exact = model.partial_derivative(u, place).unwrap();
            let value = model.real(place).unwrap();
            let mut at = |value: f64| {
                model.set_real(place, value).unwrap();
                model.real(u).unwrap()
            };
            let change = 1e-6 * value.abs().max(1e-3);
            let quotient = (at(value + change) - at(value - change)) / (2.0 * change);
            at(value);
            assert!(
                (exact - quotient).abs() <= 1e-6 * exact.abs().max(1.0),
                "{name}: {exact}, {quotient}"
            );
        }
        // du/dt of the PI controller with a held error is its integral gain times the error.
        if text == SPEED {
            close(model.output_derivative(u, 1).unwrap(), 3.5 * 0.5);
        }
    }
}

#[test]
fn a_reset_controller_is_a_new_one() {
    let mut model = started(SOFT, &[("omega_ref", 5.0), ("i", 2.0)]);
    model.step(1.0, false).unwrap();
    model.reset();
    assert_eq!(get(&mut model, "omega_ref"), 0.0);
    set(&mut model, &[("omega_ref", 5.0)]);
    model.initialise().unwrap();
    let mut fresh = started(SOFT, &[("omega_ref", 5.0)]);
    for time in [0.1, 5.0] {
        model.step(time, false).unwrap();
        fresh.step(time, false).unwrap();
        assert_eq!(
            get(&mut model, "u").to_bits(),
            get(&mut fresh, "u").to_bits()
        );
    }
}

#[test]
fn random_controllers_under_random_inputs_stay_within_their_limits_and_do_not_chatter() {
    let mut random = Uniform(7);
    let mut saturations = 0;
    for case in 0..1000 {
        let mut model = cosim::open(if case % 2 == 0 { SPEED } else { SOFT }, "test").unwrap();
        let (low, high) = (-random.between(0.1, 30.0), random.between(0.1, 30.0));
        let mut values = vec![("voltage.minimum", low), ("voltage.maximum", high)];
        if case % 2 == 0 {
            let gain = random.decades(1e-3, 1e3);
            values.extend([
                ("speed_controller.kappa_p", gain),
                ("speed_controller.kappa_i", 10.0 / gain),
            ]);
        } else {
            let (time, rate) = (random.decades(1e-4, 1e2), random.between(0.0, 1e3));
            values.extend([
                ("soft_torque.filter_time", time),
                ("soft_torque.integral_rate", rate),
            ]);
        }
        set(&mut model, &values);
        model.initialise().unwrap();
        let mut whole = cosim::open(if case % 2 == 0 { SPEED } else { SOFT }, "test").unwrap();
        set(&mut whole, &values);
        whole.initialise().unwrap();
        let names: Vec<&str> = ["omega_ref", "theta3_dot", "i"]
            .into_iter()
            .filter(|name| model.table().find(name).is_some())
            .collect();
        let mut time = 0.0;
        for _ in 0..5 {
            for name in &names {
                let place = reference(&*model, name);
                // Now and then an input is zero or as it was: guards then start at zero.
                for (order, size) in [(0, 10.0), (1, 50.0), (2, 300.0), (3, 3000.0)] {
                    let value = if random.between(0.0, 1.0) < 0.4 {
                        0.0
                    } else {
                        random.between(-size, size)
                    };
                    for component in [&mut model, &mut whole] {
                        if order == 0 {
                            component.set_real(place, value).unwrap();
                        } else {
                            component.set_input_derivative(place, order, value).unwrap();
                        }
                    }
                }
            }
            let end = time + random.decades(1e-3, 3.0);
            whole.step(end, false).unwrap();
            while time < end {
                time = (time + (end - time) * random.between(0.05, 0.5)).min(end);
                if end - time < 1e-6 {
                    time = end;
                }
                saturations += u32::from(model.step(time, false).unwrap().switched);
                let voltage = get(&mut model, "u");
                assert!(
                    voltage >= low - 1e-9 && voltage <= high + 1e-9,
                    "case {case}: {voltage}"
                );
            }
            for name in ["u", "integral"] {
                assert_eq!(
                    get(&mut model, name).to_bits(),
                    get(&mut whole, name).to_bits(),
                    "case {case}: {name}"
                );
            }
        }
    }
    assert!(saturations > 1000, "{saturations}");
}
