//! The controllers under a solver from outside, against their own exact course.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use common::Uniform;
use common::solver::{Input, Solver};
use stickslip::cosim::{CoSimulationModel, open, open_for_exchange};

const SPEED: &str = include_str!("../modelDescription/speed-controller.toml");
const SOFT: &str = include_str!("../modelDescription/soft-torque.toml");
/// Range of the voltage [V].
const RANGE: f64 = 48.0;
/// Largest difference of voltages where all that counts is known to the solver [V].
const EXACT: f64 = 1e-7;
/// The band about a limit on which the integral rides, where the rates of inputs are not known [V].
const BAND: f64 = 1e-4 * RANGE;

type Model = Box<dyn CoSimulationModel>;

fn set(model: &mut Model, name: &str, value: f64) {
    if let Some(variable) = model.table().clone().find(name) {
        model.set_real(variable.value_reference, value).unwrap();
    }
}

fn get(model: &mut dyn CoSimulationModel, name: &str) -> f64 {
    let table = model.table().clone();
    model
        .real(table.find(name).unwrap().value_reference)
        .unwrap()
}

/// When the voltage reached or left a limit, since the last question.
fn instants(model: &mut dyn CoSimulationModel) -> Vec<(f64, String)> {
    let mut list = Vec::new();
    model.drain_notices(&mut |notice| list.push((notice.time(), notice.what())));
    list
}

/// Both kinds of a controller with these inputs from the start on.
fn pair(text: &str, inputs: [f64; 3]) -> [Model; 2] {
    [open, open_for_exchange].map(|open| {
        let mut model = open(text, "controller").unwrap();
        for (name, value) in NAMES.into_iter().zip(inputs) {
            set(&mut model, name, value);
        }
        model.initialise().unwrap();
        model
    })
}

const NAMES: [&str; 3] = ["omega_ref", "theta3_dot", "i"];

#[test]
fn held_inputs_give_the_same_course_and_the_same_switches() {
    for (text, pieces, riding_is_known) in [(SPEED, 2, false), (SOFT, 20, true)] {
        let mut random = Uniform(7);
        let [mut w, mut v] = [12.0, 2.0];
        let [mut inside, mut outside] = pair(text, [w, v, 0.0]);
        let (mut time, mut switches, mut rides, mut error) = (0.0, 0, 0, 0.0_f64);
        for piece in 0..400 {
            if piece % pieces == pieces / 2 {
                [w, v] = [random.between(0.0, 12.0), random.between(-6.0, 12.0)];
            }
            // The torque goes and comes back: the integral rides on the limit on which it was held before.
            let i = if piece % 2 == 0 {
                0.0
            } else {
                random.between(-8.0, 0.0)
            };
            let length = random.between(0.01, 1.5);
            outside.exchange().unwrap().enter_event_mode();
            for (name, value) in NAMES.into_iter().zip([w, v, i]) {
                set(&mut inside, name, value);
                set(&mut outside, name, value);
            }
            time += length;
            inside.step(time, false).unwrap();
            let mut solver = Solver::new(outside.as_mut(), Vec::new(), 1e-13);
            for part in [0.1, 0.2, 0.4, 0.7, 1.0] {
                solver.advance_to(time - (1.0 - part) * length);
                let turns = solver.model.table().find("event_indicator[4]").cloned();
                rides += usize::from(turns.is_some_and(|indicator| {
                    solver.model.real(indicator.value_reference).unwrap() != 1.0
                }));
            }
            assert!(solver.events.len() < 10, "{:?}", solver.events);
            for name in ["u", "integral"] {
                let difference = get(inside.as_mut(), name) - get(outside.as_mut(), name);
                error = error.max(difference.abs());
            }
            let (found, expected) = (instants(outside.as_mut()), instants(inside.as_mut()));
            assert_eq!(found.len(), expected.len(), "{found:?}, {expected:?}");
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found.0 - expected.0).abs() < 1e-8 && found.1 == expected.1);
            }
            switches += found.len();
        }
        println!("{switches} switches, {rides} times riding, {error:e} V");
        assert!(error < EXACT, "{error:e}");
        assert!(switches > 100);
        assert!(rides > 5 || !riding_is_known);
    }
}

/// Value and three derivatives of a wave.
fn wave(mean: f64, size: f64, rate: f64, t: f64) -> [f64; 4] {
    let (sine, cosine) = libm::sincos(rate * t);
    [
        mean + size * sine,
        size * rate * cosine,
        -size * rate * rate * sine,
        -size * rate * rate * rate * cosine,
    ]
}

#[test]
fn moving_inputs_are_followed_exactly_through_a_filter_and_in_a_band_without_one() {
    let waves = [(6.0, 0.0, 1.0), (2.0, 5.0, 2.3), (0.0, 12.0, 3.1)];
    for (text, bar, most_events) in [(SPEED, 1.1 * BAND, 5000), (SOFT, EXACT, 300)] {
        let at = |t: f64| waves.map(|(mean, size, rate)| wave(mean, size, rate, t));
        let [mut inside, mut outside] = pair(text, at(0.0).map(|terms| terms[0]));
        let table = inside.table().clone();
        let references = NAMES.map(|name| Some(table.find(name)?.value_reference));
        let inputs =
            references
                .into_iter()
                .zip(waves)
                .filter_map(|(reference, (mean, size, rate))| {
                    let value: Box<dyn Fn(f64) -> f64> =
                        Box::new(move |t| wave(mean, size, rate, t)[0]);
                    Some((reference?, value))
                });
        let inputs: Vec<Input> = inputs.collect();
        let mut solver = Solver::new(outside.as_mut(), inputs, 1e-12);
        let (mut error, mut saturated) = (0.0_f64, 0);
        for step in 0..20_000_u32 {
            let time = f64::from(step) * 1e-3;
            for (reference, terms) in references.iter().zip(at(time)) {
                let Some(reference) = *reference else {
                    continue;
                };
                inside.set_real(reference, terms[0]).unwrap();
                for (order, value) in (1..).zip(&terms[1..]) {
                    inside
                        .set_input_derivative(reference, order, *value)
                        .unwrap();
                }
            }
            if step % 50 == 0 {
                solver.advance_to(time);
                let difference = get(inside.as_mut(), "u") - get(solver.model, "u");
                error = error.max(difference.abs());
                saturated += usize::from(get(inside.as_mut(), "u").abs() == 0.5 * RANGE);
            }
            inside.step(time + 1e-3, false).unwrap();
        }
        println!(
            "{error:e} V, {} events, at a limit {saturated} times of 400",
            solver.events.len()
        );
        assert!(error < bar, "{error:e}");
        assert!(solver.events.len() < most_events);
        assert!(saturated > 40);
    }
}
