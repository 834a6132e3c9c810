//! Inputs, states and parameters at the edge: runs end in numbers or in a clear error, never in NaN.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod common;

use common::energy::EnergyBalance;
use common::grazing::{TOUCH, around_grazing, pressed, towards_rest};
use common::{LAWS, Uniform};
use stickslip::integrator::{IntegrationError, Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES, index::*};

/// Share of the energy turned over that may be missing in the end.
const ENERGY: f64 = 1e-10;
/// The same where parameters span six decades, at the default tolerance.
const SIX_DECADES: f64 = 1e-8;

fn reduced(law: &str) -> Rig<f64> {
    common::rig(false, common::law(law), "")
}

#[test]
fn without_normal_force_every_law_is_the_frictionless_rig() {
    let bare = reduced("coulomb");
    let expected = common::state_after(&bare, [0.0; STATES], RigInputs::held(3.0, 0.0, 0.0), 4.0);
    for law in LAWS {
        if law.0 == "two_gaussian_torque" {
            continue; // Its torque does not depend on the normal force.
        }
        for force in [0.0, -20.0] {
            let inputs = RigInputs::held(3.0, force, 0.0);
            let state =
                common::state_after(&common::rig(false, law, ""), [0.0; STATES], inputs, 4.0);
            for (a, b) in state.iter().zip(expected) {
                assert!(
                    (a - b).abs() < 1e-10,
                    "{}, {force} N: {a} against {b}",
                    law.0
                );
            }
        }
    }
}

#[test]
fn a_pin_that_drops_and_lifts_within_a_step() {
    for law in LAWS {
        let rig = common::rig(false, law, "");
        let voltage = rig.voltage_for_speed(5.76);
        let mut run = common::start(
            &rig,
            1e-12,
            [0.0; STATES],
            RigInputs::held(voltage, 0.0, 0.0),
        )
        .unwrap();
        let mut balance = EnergyBalance::new(&run);
        for (time, force) in [
            (1.003, 70.0),
            (2.0, 0.0),
            (2.5, 70.0),
            (4.0, 0.0),
            (4.0, 70.0),
        ] {
            balance.advance(&mut run, time);
            run.set_inputs(time, RigInputs::held(voltage, force, 0.0))
                .unwrap();
        }
        balance.advance(&mut run, 10.0);
        let state = run.state_at(10.0);
        assert!(state[THETA] > 20.0, "{}: {state:?}", law.0);
        let error = balance.error(&run);
        println!("{:20} energy balance {error:.1e}", law.0);
        assert!(error < ENERGY, "{}: {error:e} is missing", law.0);
    }
}

#[test]
fn both_pins_of_the_full_rig_drop_and_lift_within_a_step() {
    for law in LAWS {
        let rig = common::rig(true, law, "");
        let voltage = rig.voltage_for_speed(5.76);
        let held = |force, force_1| RigInputs::held(voltage, force, force_1);
        let mut run = common::start(&rig, 1e-12, [0.0; STATES], held(0.0, 0.0)).unwrap();
        let mut balance = EnergyBalance::new(&run);
        for (time, force, force_1) in [
            (1.003, 70.0, 0.0),
            (1.503, 70.0, 70.0),
            (2.5, 0.0, 70.0),
            (2.5, 0.0, 0.0),
            (3.0, 70.0, 70.0),
        ] {
            balance.advance(&mut run, time);
            run.set_inputs(time, held(force, force_1)).unwrap();
        }
        balance.advance(&mut run, 8.0);
        let error = balance.error(&run);
        println!("{:20} energy balance {error:.1e}", law.0);
        assert!(error < ENERGY, "{}: {error:e} is missing", law.0);
    }
}

#[test]
fn both_contacts_stick_at_once_and_stay() {
    for law in LAWS {
        if law.0 == "karnopp" {
            continue; // Within its band a disc that counts as stuck keeps its velocity.
        }
        let rig = common::rig(true, law, "");
        let mut state = [0.0; STATES];
        (state[OMEGA], state[OMEGA1]) = (4.0, 4.0);
        let inputs = RigInputs::held(0.0, 60.0, 60.0);
        let mut run = common::start(&rig, 1e-12, state, inputs).unwrap();
        let mut balance = EnergyBalance::new(&run);
        balance.advance(&mut run, 20.0);
        let error = balance.error(&run);
        println!("{:20} energy balance {error:.1e}", law.0);
        assert!(error < ENERGY, "{}: {error:e} is missing", law.0);
        let mode = run.mode();
        assert!(
            mode.disc.is_stuck() && mode.disc1.is_stuck() && mode.motor.is_stuck(),
            "{}: {mode:?}",
            law.0
        );
        let segments = run.statistics().segments;
        run.advance_to(1000.0).unwrap();
        // Nothing moves: the longest step of 0.25 s is all that limits a segment, but for the velocity
        // that decays inside the band of the switch model.
        let spent = run.statistics().segments - segments;
        let bar = if law.0 == "switch" { 12_000 } else { 4_000 };
        assert!(spent < bar, "{}: {spent} segments", law.0);
    }
}

#[test]
fn a_voltage_that_changes_sign_every_tenth_of_a_second() {
    for law in LAWS {
        for full in [false, true] {
            let rig = common::rig(full, law, "");
            let mut run =
                common::start(&rig, 1e-12, [0.0; STATES], RigInputs::held(0.0, 0.0, 0.0)).unwrap();
            let mut balance = EnergyBalance::new(&run);
            for step in 0..100 {
                let voltage = if step % 2 == 0 { 6.0 } else { -6.0 };
                let time = 0.1 * f64::from(step);
                run.set_inputs(time, RigInputs::held(voltage, 15.0, 5.0))
                    .unwrap();
                balance.advance(&mut run, time + 0.1);
            }
            let error = balance.error(&run);
            println!("{:20} full rig {full:5}: energy balance {error:.1e}", law.0);
            assert!(
                error < ENERGY,
                "{}, full rig {full}: {error:e} is missing",
                law.0
            );
        }
    }
}

#[test]
fn ten_thousand_radians_per_second() {
    for (law, full) in LAWS.iter().flat_map(|law| [(*law, false), (*law, true)]) {
        let rig = common::rig(full, law, "");
        let mut state = [0.0; STATES];
        (state[OMEGA], state[OMEGA3]) = (1e4, -1e4);
        if full {
            state[OMEGA1] = -1e4;
        }
        let inputs = RigInputs::held(3.0, 50.0, if full { 10.0 } else { 0.0 });
        let mut run = common::start(&rig, 1e-12, state, inputs).unwrap();
        let mut balance = EnergyBalance::new(&run);
        balance.advance(&mut run, 30.0);
        let end = run.state_at(30.0);
        let error = balance.error(&run);
        println!("{:20} full rig {full:5}: energy balance {error:.1e}", law.0);
        assert!(
            error < ENERGY,
            "{}, full rig {full}: {error:e} is missing",
            law.0
        );
        assert!(
            end[OMEGA].abs() < 100.0,
            "{}, full rig {full}: it was braked, {end:?}",
            law.0
        );
    }
}

#[test]
fn parameters_and_states_over_six_decades() {
    let mut uniform = Uniform(0x5EED);
    let (mut finished, mut refused, mut worst) = (0, 0, 0.0_f64);
    for round in 0..240 {
        let law = LAWS[round % LAWS.len()];
        let mut rig = common::rig(round % 3 == 0, law, "");
        for name in [
            "disc.inertia",
            "shaft.stiffness",
            "shaft.damping",
            "motor.inertia",
            "motor.resistance",
            "motor.inductance",
            "motor.torque_constant",
            "motor.coulomb_torque",
            "contact.radius",
        ] {
            let value = rig.parameter(name).unwrap();
            rig.set_parameter(name, value * uniform.decades(1e-3, 1e3))
                .unwrap();
        }
        // What the motor gives must not exceed what it takes, or the rig feeds itself without bound.
        rig.motor.back_emf_constant = rig.motor.torque_constant;
        let mut state = [0.0; STATES];
        for place in [THETA, OMEGA, THETA3, OMEGA3, CURRENT] {
            state[place] = uniform.between(-1.0, 1.0) * uniform.decades(1e-3, 1e3);
        }
        let inputs = RigInputs::held(
            uniform.between(-24.0, 24.0),
            uniform.between(-10.0, 100.0),
            uniform.between(-10.0, 100.0),
        );
        let options = Options {
            budget: 4_000,
            ..Options::default()
        };
        let run = Simulation::new(rig, options, 0.0, state, inputs);
        let outcome = run.and_then(|mut run| {
            let fresh = run.clone();
            run.advance_to(0.5)?;
            Ok((run.state_at(0.5), fresh))
        });
        match outcome {
            Ok((state, mut run)) => {
                finished += 1;
                let mut balance = EnergyBalance::new(&run);
                balance.advance(&mut run, 0.5);
                worst = worst.max(balance.error(&run));
                assert!(
                    state.iter().all(|x| x.is_finite()),
                    "{}: {state:?} of {rig:?}",
                    law.0
                );
            }
            Err(
                IntegrationError::BudgetExhausted { .. } | IntegrationError::StepTooSmall { .. },
            ) => {
                refused += 1;
            }
            Err(error) => panic!("{}: {error}\n{rig:?}\n{inputs:?}\n{state:?}", law.0),
        }
    }
    println!(
        "{finished} finished, {refused} were too stiff for the budget; energy balance {worst:.1e}"
    );
    assert!(worst < SIX_DECADES, "{worst:e} is missing");
    assert!(
        finished > 120,
        "{finished} finished, {refused} were too stiff for the budget"
    );
}

#[test]
fn what_cannot_go_on_says_why() {
    let rig = reduced("stribeck");
    let inputs = RigInputs::held(rig.voltage_for_speed(5.76), 50.0, 0.0);
    let start = |options: Options, state: [f64; STATES]| {
        Simulation::new(rig, options, 0.0, state, inputs)
            .and_then(|mut run| run.advance_to(60.0))
            .unwrap_err()
            .to_string()
    };
    let text = start(
        Options {
            budget: 10,
            ..Options::default()
        },
        [0.0; STATES],
    );
    assert!(
        text.starts_with("10 segments did not reach t = 60 s (now at ")
            && text.contains("disc D2 stuck, motor slipping forward")
            && text.contains("raise it"),
        "{text}"
    );
    let mut broken = [0.0; STATES];
    broken[OMEGA] = f64::NAN;
    let text = start(Options::default(), broken);
    assert!(
        text.contains("no longer finite at t = 0 s in mode disc D2") && text.contains("check them"),
        "{text}"
    );
    // A time constant of 1e-19 s at a time of 1e6 s.
    let mut stiff = rig;
    stiff.motor.inductance = 1e-20;
    let mut state = [0.0; STATES];
    state[OMEGA3] = 1.0;
    let text = Simulation::new(stiff, Options::default(), 1e6, state, inputs)
        .and_then(|mut run| run.advance_to(1e6 + 1.0))
        .unwrap_err()
        .to_string();
    assert!(
        text.starts_with("the step fell to") && text.contains("check inertias, inductance"),
        "{text}"
    );
    let mut run = common::start(&rig, 1e-12, [0.0; STATES], inputs).unwrap();
    run.advance_to(1.0).unwrap();
    let text = run.set_inputs(0.5, inputs).unwrap_err().to_string();
    assert!(
        text.starts_with("t = 0.5 s lies before the present segment"),
        "{text}"
    );
}

#[test]
fn a_disc_that_just_touches_rest() {
    for law in LAWS {
        for full in [false, true] {
            let (free, rests) = around_grazing(full, law);
            let mut counted = Vec::new();
            for force in [free, rests, rests * (1.0 + 1e-3)] {
                let (rig, inputs) = pressed(full, law, force);
                let mut run = common::start(&rig, 1e-12, towards_rest(full), inputs).unwrap();
                let mut balance = EnergyBalance::new(&run);
                balance.advance(&mut run, TOUCH);
                let error = balance.error(&run);
                println!(
                    "{:20} full rig {full}, {force} N: energy balance {error:.1e}",
                    law.0
                );
                assert!(error < ENERGY, "{}: {error:e} is missing", law.0);
                counted.push(run.statistics().grazing > 0);
            }
            let name = format!("{}, full rig {full}, {rests} N", law.0);
            assert_eq!(counted, [false, true, false], "{name}");
        }
    }
}

#[test]
fn seeded_randomness_repeats() {
    let random = |seed: u32| {
        let keys = format!(
            "mu_c = 0.15\nmu_s = 0.2\nomega_s = 1.2\nstochastic_amplitude = 0.05\ncorrelation_angle = 0.3\nseed = {seed}"
        );
        let noise = format!(
            "[stochastic_friction]\nstandard_deviation = 0.04\ncorrelation_time = 0.1\nseed = {seed}\n"
        );
        let rig = common::rig(false, ("wojewoda", &keys), &noise);
        common::state_after(&rig, [0.0; STATES], RigInputs::held(3.0, 50.0, 0.0), 5.0)
    };
    assert_eq!(random(7), random(7));
    assert_ne!(random(7), random(8));
}

#[test]
fn restored_snapshots_continue_bit_for_bit() {
    for law in LAWS {
        for full in [false, true] {
            let rig = common::rig(full, law, "");
            let inputs = RigInputs::held(rig.voltage_for_speed(5.76), 40.0, 10.0);
            let mut run = common::start(&rig, 1e-12, [0.0; STATES], inputs).unwrap();
            run.advance_to(1.7).unwrap();
            let snapshot = run.snapshot();
            run.advance_to(6.0).unwrap();
            let expected = run.state_at(6.0);
            run.restore(&snapshot).unwrap();
            run.advance_to(6.0).unwrap();
            assert_eq!(run.state_at(6.0), expected, "{}", law.0);
        }
    }
}

#[test]
fn rounding_behind_a_switch_does_not_undo_it() {
    // Angles of hundreds of rad: the shafts' torques are known to 1e-14 N m only, and with them the
    // guards that are zero where the mode has just changed.
    let hysteretic = reduced("wojewoda");
    let narrow_band = common::rig(
        false,
        (
            "karnopp",
            "mu_c = 0.12\nmu_s = 0.2\nomega_s = 1.2\nomega_tolerance = 1e-3",
        ),
        "",
    );
    let mut disc1_pin = Rig::<f64>::from_toml(common::FULL_RIG, "full-rig.toml").unwrap();
    for (name, value) in [("mu_c", 0.05), ("mu_s", 0.25 / 3.0), ("omega_s", 2.4)] {
        disc1_pin
            .set_parameter(&format!("contact1.{name}"), value)
            .unwrap();
    }
    let cases = [
        (
            hysteretic,
            RigInputs::held(hysteretic.voltage_for_speed(5.76), 50.0, 0.0),
        ),
        (
            narrow_band,
            RigInputs::held(narrow_band.voltage_for_speed(5.76), 50.0, 0.0),
        ),
        (
            disc1_pin,
            RigInputs::held(
                disc1_pin.voltage_for_speed(40.0 * std::f64::consts::PI / 30.0),
                0.0,
                40.0,
            ),
        ),
    ];
    for (rig, inputs) in cases {
        let mut counts = Vec::new();
        let mut ends = Vec::new();
        for tolerance in [1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13] {
            let mut run = common::start(&rig, tolerance, [0.0; STATES], inputs).unwrap();
            run.advance_to(60.0).unwrap();
            counts.push(run.statistics().switches);
            ends.push(run.state_at(60.0)[THETA]);
        }
        assert!(
            counts.iter().all(|count| *count == counts[0]),
            "switches at tolerances 1e-8 to 1e-13: {counts:?}"
        );
        for pair in ends[2..].windows(2) {
            assert!((pair[0] - pair[1]).abs() < 1e-8, "{ends:?}");
        }
    }
}
