//! The rigs under a solver from outside: the same trajectories and switches as an independent method found
//! (`golden/reference.py`), and derivatives that agree with differences.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod common;

use common::solver::{Input, Solver};
use stickslip::cosim::{CoSimulationModel, open_for_exchange};
use toml::Table;

const REFERENCES: &str = include_str!("golden/references.toml");
/// Largest difference of any state, relative to 1 + |x|.
const STATE_BAR: f64 = 1e-7;
/// Largest difference of any breakaway or sticking instant [s].
const INSTANT_BAR: f64 = 1e-7;
/// By how much both may be exceeded where bristles give way in small steps, because a solver from outside tells no rate of the force.
const STEPWISE: f64 = 1000.0;

fn numbers(case: &Table, key: &str) -> Vec<f64> {
    let list = case[key].as_array().unwrap();
    list.iter().map(|x| x.as_float().unwrap()).collect()
}

/// Names of the states in the order of the references.
const STATES: [&str; 10] = [
    "theta",
    "theta_dot",
    "theta3",
    "theta3_dot",
    "i",
    "theta1",
    "theta1_dot",
    "shaft_hysteresis_torque",
    "presliding_deflection",
    "presliding_deflection1",
];

/// An initialised model of the case and its inputs.
fn start(case: &Table) -> (Box<dyn CoSimulationModel>, Vec<Input>) {
    let name = case["name"].as_str().unwrap();
    let mut model = open_for_exchange(case["model"].as_str().unwrap(), name).unwrap();
    let table = model.table().clone();
    for (value, state) in numbers(case, "initial").into_iter().zip(STATES) {
        if let Some(variable) = table.find(state) {
            model.set_real(variable.value_reference, value).unwrap();
        }
    }
    let mut inputs: Vec<Input> = Vec::new();
    for (key, input) in [
        ("voltage", "u"),
        ("normal_force", "N2"),
        ("normal_force_1", "N1"),
    ] {
        let terms = numbers(case, key);
        if let Some(variable) = table.find(input) {
            let value = move |t: f64| terms.iter().rev().fold(0.0, |sum, c| sum * t + c);
            model
                .set_real(variable.value_reference, value(0.0))
                .unwrap();
            inputs.push((variable.value_reference, Box::new(value)));
        }
    }
    model.set_up(0.0, None);
    model.initialise().unwrap();
    (model, inputs)
}

/// Runs a case; the largest state error, the stuck contacts' instants of change, branch jumps.
fn compare(case: &Table) -> (f64, f64, u64) {
    let name = case["name"].as_str().unwrap();
    let (mut model, inputs) = start(case);
    let table = model.table().clone();
    let flags: Vec<u32> = ["stuck", "stuck1", "motor_stuck"]
        .iter()
        .filter_map(|flag| Some(table.find(flag)?.value_reference))
        .collect();
    let mut solver = Solver::new(model.as_mut(), inputs, 1e-12);
    let mut error = 0.0_f64;
    for (time, expected) in numbers(case, "times")
        .into_iter()
        .zip(case["states"].as_array().unwrap())
    {
        solver.advance_to(time);
        for (value, state) in expected.as_array().unwrap().iter().zip(STATES) {
            if let Some(variable) = table.find(state) {
                let expected = value.as_float().unwrap();
                let value = solver.model.real(variable.value_reference).unwrap();
                error = error.max((value - expected).abs() / (1.0 + expected.abs()));
            }
        }
    }
    let mut lines = Vec::new();
    solver
        .model
        .drain_notices(&mut |notice| lines.push(notice.to_string()));
    let jumps = lines.iter().filter(|line| line.contains("jumped")).count() as u64;
    for flag in flags {
        // A disc that sticks does not creep.
        let velocity = if flag == table.find("stuck").unwrap().value_reference {
            "theta_dot"
        } else {
            continue;
        };
        if solver.model.boolean(flag).unwrap()
            && !case["model"].as_str().unwrap().contains("presliding")
        {
            let band = if case["model"].as_str().unwrap().contains("omega_tolerance") {
                0.011
            } else {
                0.0
            };
            let reference = table.find(velocity).unwrap().value_reference;
            assert!(
                solver.model.real(reference).unwrap().abs() <= band,
                "{name}"
            );
        }
    }
    let mut expected = numbers(case, "switch_times");
    // At the start itself modes are found without an event.
    expected.retain(|time| *time > 0.0);
    let instants: Vec<f64> = solver.events.clone();
    let nearest = |time: &f64| {
        instants
            .iter()
            .map(|instant| (instant - time).abs())
            .fold(f64::INFINITY, f64::min)
    };
    let instant_error = expected.iter().map(nearest).fold(0.0, f64::max);
    (error, instant_error, jumps)
}

#[test]
fn trajectories_and_switches_agree_with_an_independent_method() {
    let file: Table = REFERENCES.parse().unwrap();
    let cases = file["case"].as_array().unwrap();
    assert!(cases.len() > 30);
    let mut failures = Vec::new();
    for case in cases {
        let case = case.as_table().unwrap();
        let name = case["name"].as_str().unwrap();
        let result = std::panic::catch_unwind(|| compare(case));
        let Ok((state, instant, jumps)) = result else {
            failures.push(format!("{name}: did not run"));
            continue;
        };
        println!("{name:32} states {state:8.1e}  switches {instant:8.1e} s  jumps {jumps}");
        let folds = case["folds"].as_integer().unwrap() as u64;
        let loose = if name.contains("falling force") || name.contains("lifts and touches") {
            STEPWISE
        } else {
            1.0
        };
        if !(state <= loose * STATE_BAR && instant <= loose * INSTANT_BAR && jumps == folds) {
            failures.push(format!(
                "{name}: states {state:e}, switches {instant:e} s, {jumps} jumps instead of {folds}"
            ));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
