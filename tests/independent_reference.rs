//! Every law and every effect against trajectories by an independent method of order 8
//! (`golden/reference.py`), and its switching instants.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod common;

use stickslip::integrator::Simulation;
use stickslip::plant::{INPUT_TERMS, Rig, RigGuard, RigInputs, STATES};
use toml::{Table, Value};

const REFERENCES: &str = include_str!("golden/references.toml");
/// Largest difference of any state variable, relative to 1 + |x|.
const STATE_BAR: f64 = 1e-8;
/// Largest difference of any breakaway or sticking instant [s].
const INSTANT_BAR: f64 = 1e-9;

fn numbers(case: &Table, key: &str) -> Vec<f64> {
    let list = case[key].as_array().unwrap();
    list.iter().map(|x| x.as_float().unwrap()).collect()
}

fn polynomial(case: &Table, key: &str) -> [f64; INPUT_TERMS] {
    let mut terms = [0.0; INPUT_TERMS];
    for (term, value) in terms.iter_mut().zip(numbers(case, key)) {
        *term = value;
    }
    terms
}

/// Runs a case; the largest state error, the largest error of a switching instant, branch jumps.
fn compare(case: &Table) -> (f64, f64, u64) {
    let name = case["name"].as_str().unwrap();
    let rig = Rig::from_toml(case["model"].as_str().unwrap(), name).unwrap();
    let mut inputs = RigInputs::held(0.0, 0.0, 0.0);
    inputs.voltage = polynomial(case, "voltage");
    inputs.normal_force = polynomial(case, "normal_force");
    inputs.normal_force_1 = polynomial(case, "normal_force_1");
    // Bristles are listed only where there are any.
    let initial = numbers(case, "initial");
    let mut state = [0.0; STATES];
    state[..initial.len()].copy_from_slice(&initial);
    let mut run = Simulation::new(rig, common::options(1e-13), 0.0, state, inputs).unwrap();
    let (mut state_error, mut instants) = (0.0_f64, Vec::new());
    for (time, expected) in numbers(case, "times")
        .into_iter()
        .zip(case["states"].as_array().unwrap())
    {
        while run.segment_end() < time {
            if let Some(event) = run.pending_switch()
                && let Some(RigGuard::Rest(_) | RigGuard::Breakaway(..)) = event.guard
            {
                instants.push(event.time);
            }
            run.next_segment().unwrap();
        }
        let state = run.state_at(time);
        let expected = expected.as_array().unwrap().iter();
        for (value, expected) in state.iter().zip(expected.map(|x| x.as_float().unwrap())) {
            state_error = state_error.max((value - expected).abs() / (1.0 + expected.abs()));
        }
    }
    let expected = numbers(case, "switch_times");
    assert_eq!(
        instants.len(),
        expected.len(),
        "{name}: switches at {instants:?} instead of {expected:?}"
    );
    let instant_error = instants
        .iter()
        .zip(&expected)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    (state_error, instant_error, run.statistics().branch_jumps)
}

#[test]
fn trajectories_and_switches_agree_with_an_independent_method() {
    let file: Table = REFERENCES.parse().unwrap();
    let mut failures = Vec::new();
    for case in file["case"].as_array().unwrap() {
        let case = case.as_table().unwrap();
        let name = case["name"].as_str().unwrap();
        let result = std::panic::catch_unwind(|| compare(case));
        let Ok((state, instant, jumps)) = result else {
            failures.push(format!("{name}: did not run"));
            continue;
        };
        println!("{name:32} states {state:8.1e}  switches {instant:8.1e} s  jumps {jumps}");
        let folds = case["folds"].as_integer().unwrap() as u64;
        if !(state <= STATE_BAR && instant <= INSTANT_BAR && jumps == folds) {
            failures.push(format!(
                "{name}: states {state:e}, switches {instant:e} s, {jumps} jumps instead of {folds}"
            ));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn the_references_cover_every_law_and_effect() {
    let file: Table = REFERENCES.parse().unwrap();
    let cases = file["case"].as_array().unwrap();
    let models: Vec<&str> = cases
        .iter()
        .map(|case: &Value| case["model"].as_str().unwrap())
        .collect();
    for law in stickslip::friction::LAW_NAMES {
        let line = format!("law = \"{law}\"");
        assert!(models.iter().any(|model| model.contains(&line)), "{law}");
    }
    for effect in stickslip::plant::EFFECT_NAMES {
        // The sensors' delay acts on what is read, not on the motion.
        let header = format!("[{effect}]");
        let covered = models.iter().any(|model| model.contains(&header));
        assert!(covered || *effect == "sensor_delay", "{effect}");
    }
}
