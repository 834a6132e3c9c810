//! Effects on disc D1 of the full rig against their equations.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod common;

use common::{law, rig};
use stickslip::integrator::Simulation;
use stickslip::plant::{Rig, RigInputs, RigState, STATES, index::*};

/// A state in which both discs slide forward.
fn sliding() -> RigState<f64> {
    let mut state = [0.0; STATES];
    state[..5].copy_from_slice(&[0.4, 3.0, 1.4, 5.0, 0.7]);
    (state[THETA1], state[OMEGA1]) = (0.3, 2.0);
    state
}

fn inputs(rig: &Rig<f64>) -> RigInputs<f64> {
    RigInputs::held(rig.voltage_for_speed(5.76), 40.0, 12.0)
}

/// Time derivatives of a sliding rig's state.
fn rates(effect: &str) -> RigState<f64> {
    let rig = rig(true, law("stribeck"), effect);
    let mut jet = stickslip::integrator::HybridSystem::new_jet(&rig);
    let mut state = sliding();
    let inputs = inputs(&rig);
    let mode = rig.mode_at_start(0.0, &mut state, &inputs, &mut jet);
    rig.evaluate(&mode, 0.0, &state, &inputs, &mut jet);
    jet.rates()
}

#[test]
fn each_effect_accelerates_disc_d1_alone_by_its_torque() {
    let [plain, inertia] = [rates(""), [0.0288; STATES]];
    let state = sliding();
    let (angle, speed) = (state[THETA1], state[OMEGA1]);
    let friction = 12.0 * 0.089 * (0.12 + 0.08 * (-speed / 1.2).exp());
    for (effect, torque) in [
        ("[bearing_friction1]\ntorque = 0.05\n", -0.05),
        (
            "[unbalance1]\ntorque = 0.1\nphase = 0.7\n",
            -0.1 * (angle - 0.7).cos(),
        ),
        ("[viscous_drag1]\ncoefficient = 0.01\n", -0.01 * speed),
        (
            "[quadratic_drag1]\ncoefficient = 0.002\n",
            -0.002 * speed * speed,
        ),
        (
            "[normal_force_wobble1]\namplitude = 0.3\nphase = 0.7\n",
            -friction * 0.3 * (angle - 0.7).cos(),
        ),
    ] {
        for (place, (with, without)) in rates(effect).iter().zip(plain).enumerate() {
            let expected = if place == OMEGA1 {
                torque / inertia[place]
            } else {
                0.0
            };
            let found = with - without;
            assert!(
                (found - expected).abs() < 1e-12,
                "{effect}: {found}, {expected}"
            );
        }
    }
}

#[test]
fn a_hardening_shaft_1_turns_both_discs_against_each_other() {
    let (with, without) = (
        rates("[shaft_hardening1]\ncubic_stiffness = 40.0\n"),
        rates(""),
    );
    let state = sliding();
    let torque = 40.0 * (state[THETA1] - state[THETA]).powi(3);
    for (place, inertia, sign) in [(OMEGA1, 0.0288, -1.0), (OMEGA, 0.0149, 1.0)] {
        let found = with[place] - without[place];
        assert!((found - sign * torque / inertia).abs() < 1e-12, "{found}");
    }
}

#[test]
fn bearings_hold_a_disc_d1_whose_pin_is_lifted() {
    for (torque, sticks) in [(0.3, true), (0.01, false)] {
        let effect = format!("[bearing_friction1]\ntorque = {torque}\n");
        let rig = rig(true, law("coulomb"), &effect);
        let mut state = [0.0; STATES];
        // Shaft 1 pulls with 2.905 N m/rad × 0.05 rad.
        state[THETA1] = 0.05;
        let inputs = RigInputs::held(0.0, 100.0, 0.0);
        let mut run = Simulation::new(rig, common::options(1e-10), 0.0, state, inputs).unwrap();
        run.advance_to(0.05).unwrap();
        assert_eq!(run.state_at(0.05)[OMEGA1] == 0.0, sticks, "{torque}");
    }
}

#[test]
fn an_unbalance_keeps_the_energy_that_it_takes() {
    // Free of friction and damping but for the effect, D1 swings on its shaft about D2, which its pin holds.
    let mut rig = rig(
        true,
        law("coulomb"),
        "[unbalance1]\ntorque = 0.2\nphase = 0.4\n",
    );
    rig.set_parameter("shaft1.damping", 0.0).unwrap();
    let mut state = [0.0; STATES];
    state[THETA1] = 0.02;
    let energy = |state: &RigState<f64>| {
        0.5 * 0.0288 * state[OMEGA1].powi(2)
            + 0.5 * 2.905 * (state[THETA1] - state[THETA]).powi(2)
            + 0.2 * (state[THETA1] - 0.4).sin()
    };
    let inputs = RigInputs::held(0.0, 1000.0, 0.0);
    let mut run = Simulation::new(rig, common::options(1e-12), 0.0, state, inputs).unwrap();
    run.advance_to(3.0).unwrap();
    let end = run.state_at(3.0);
    assert!((energy(&end) - energy(&state)).abs() < 1e-10);
    assert!(
        (end[THETA1] - state[THETA1]).abs() > 1e-3,
        "it did not move"
    );
}
