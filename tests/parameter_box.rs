//! What must hold for every rig and not only for the dissertation's: random rigs from the whole parameter box, each law,
//! both rigs, from random states under random inputs.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod common;

use common::energy::{EnergyBalance, GAUSS, torques};
use common::{LAWS, Uniform};
use stickslip::integrator::Simulation;
use stickslip::plant::{Rig, RigInputs, RigState, STATES, index::*};

/// Random rigs for each law and each of the two rigs.
const EACH: u64 = 40;
/// Length of a run [s].
const END: f64 = 2.0;

/// A rig of the box with a state and inputs.
struct Case {
    name: String,
    rig: Rig<f64>,
    state: RigState<f64>,
    inputs: RigInputs<f64>,
}

/// Every inertia, stiffness, damping, resistance … between a third and three times the dissertation's.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (number, law) in LAWS.into_iter().enumerate() {
        for full in [false, true] {
            for seed in 0..EACH {
                let key = 1 + seed + 100 * number as u64 + 1000 * u64::from(full);
                let mut random = Uniform(key.wrapping_mul(0x9E37_79B9_7F4A_7C15));
                let mut rig = common::rig(full, law, "");
                for section in ["disc", "disc1", "shaft", "shaft1", "motor"] {
                    for key in [
                        "inertia",
                        "stiffness",
                        "damping",
                        "resistance",
                        "inductance",
                        "coulomb_torque",
                        "viscous_damping",
                    ] {
                        let name = format!("{section}.{key}");
                        let place = rig.parameters().iter().position(|one| one.name == name);
                        if let Some(value) = place.and_then(|place| rig.parameter_at(place)) {
                            let factor = random.decades(1.0 / 3.0, 3.0);
                            rig.set_parameter(&name, factor * value).unwrap();
                        }
                    }
                }
                let mut state = [0.0; STATES];
                for place in [THETA, OMEGA, THETA3, OMEGA3] {
                    state[place] = random.between(-3.0, 3.0);
                }
                if full {
                    state[THETA1] = random.between(-3.0, 3.0);
                    state[OMEGA1] = random.between(-3.0, 3.0);
                }
                state[CURRENT] = random.between(-1.0, 1.0);
                let inputs = RigInputs::held(
                    random.between(-6.0, 6.0),
                    random.between(0.0, 70.0),
                    random.between(0.0, 30.0),
                );
                cases.push(Case {
                    name: format!("{}{}, seed {seed}", if full { "full " } else { "" }, law.0),
                    rig,
                    state,
                    inputs,
                });
            }
        }
    }
    cases
}

fn run(case: &Case) -> Simulation<f64, Rig<f64>> {
    common::start(&case.rig, 1e-12, case.state, case.inputs).unwrap()
}

#[test]
fn energy_is_accounted_for_and_numbers_stay_numbers() {
    let mut worst = (0.0, String::new());
    for case in cases() {
        let mut run = run(&case);
        let mut balance = EnergyBalance::new(&run);
        balance.advance(&mut run, END);
        let end = run.state_at(run.segment_start());
        assert!(end.iter().all(|x| x.is_finite()), "{}: {end:?}", case.name);
        let error = balance.error(&run);
        if error > worst.0 {
            worst = (error, case.name);
        }
    }
    println!(
        "largest energy error {:.1e} of what was turned over: {}",
        worst.0, worst.1
    );
    assert!(worst.0 < 1e-11, "{worst:?}");
}

#[test]
fn friction_never_drives_and_never_holds_more_than_the_breakaway_torque() {
    let mut stuck = 0;
    for case in cases() {
        let law = case.rig.law;
        let memoryless = ["coulomb", "stribeck"]
            .iter()
            .any(|name| case.name.contains(name));
        let load = if law.is_torque() {
            [1.0; 2]
        } else {
            [
                0.075 * case.inputs.normal_force[0],
                0.089 * case.inputs.normal_force_1[0],
            ]
        };
        // Karnopp's law and the switch model have a band of velocities that counts as zero; in the switch model the
        // velocity in it decays, which takes a torque of its own.
        let (band, decay) = law.band();
        let disc1 = case
            .rig
            .disc1
            .as_ref()
            .map_or(0.0, |disc1| disc1.disc.inertia);
        let mut run = run(&case);
        while run.segment_end() < END {
            let (from, to) = (run.segment_start(), run.segment_end());
            for (node, _) in GAUSS {
                let tau = 0.5 * (to - from) * (1.0 + node);
                let (x, t) = (run.state_at(from + tau), torques(&run, tau));
                assert!(
                    t[2] * x[OMEGA3] >= -1e-12,
                    "{}: the motor's friction drives",
                    case.name
                );
                let contacts = [
                    (
                        t[0],
                        x[OMEGA],
                        run.mode().disc,
                        load[0],
                        case.rig.disc.inertia,
                    ),
                    (t[1], x[OMEGA1], run.mode().disc1, load[1], disc1),
                ];
                for (torque, omega, mode, load, inertia) in contacts {
                    if memoryless {
                        assert!(
                            torque * omega >= -1e-12,
                            "{}: friction gives {} W",
                            case.name,
                            -torque * omega
                        );
                    }
                    if mode.is_stuck() {
                        stuck += 1;
                        let limit =
                            load * law.breakaway() * (1.0 + 1e-10) + inertia * decay * band + 1e-12;
                        assert!(
                            torque.abs() <= limit,
                            "{}: {torque} N m in stick above {limit}",
                            case.name
                        );
                    }
                }
            }
            run.next_segment().unwrap();
        }
    }
    assert!(stuck > 10_000, "{stuck} instants in stick");
}

#[test]
fn mirrored_and_shifted_runs_are_the_same_runs() {
    let (mut mirror, mut shift) = (0.0_f64, 0.0_f64);
    for case in cases() {
        let plain = common::state_after(&case.rig, case.state, case.inputs, END);
        let mut inputs = case.inputs;
        inputs.voltage = inputs.voltage.map(|u| -u);
        let mirrored = common::state_after(&case.rig, case.state.map(|x| -x), inputs, END);
        let begin = 1024.0;
        let later = RigInputs {
            time: begin,
            ..case.inputs
        };
        let mut shifted =
            Simulation::new(case.rig, common::options(1e-12), begin, case.state, later).unwrap();
        shifted.advance_to(begin + END).unwrap();
        let shifted = shifted.state_at(begin + END);
        for place in 0..STATES {
            let size = 1.0 + plain[place].abs();
            let (m, s) = (
                (plain[place] + mirrored[place]).abs() / size,
                (plain[place] - shifted[place]).abs() / size,
            );
            assert!(
                m < 1e-12,
                "{}: component {place}: {} against {}",
                case.name,
                plain[place],
                mirrored[place]
            );
            assert!(
                s < 1e-8,
                "{}: component {place}: {} against {}",
                case.name,
                plain[place],
                shifted[place]
            );
            (mirror, shift) = (mirror.max(m), shift.max(s));
        }
    }
    println!("mirrored within {mirror:.1e}, shifted within {shift:.1e}");
}

#[test]
fn a_vanishing_normal_force_approaches_the_rig_without_friction_in_proportion() {
    for case in cases() {
        if case.rig.law.is_torque() {
            continue; // Its torque does not depend on the normal force.
        }
        let after = |force: f64| {
            let inputs = RigInputs::held(case.inputs.voltage[0], force, force);
            common::state_after(&case.rig, case.state, inputs, 1.0)
        };
        let (none, small, smaller) = (after(0.0), after(1e-3), after(1e-5));
        let apart = |a: &RigState<f64>, b: &RigState<f64>| (a[OMEGA] - b[OMEGA]).abs();
        // Impulses that friction of 1e-3 N can give to discs of these inertias in a second.
        let bound = 1e-3 * 0.089 * 0.4 / (0.0149 / 3.0);
        assert!(
            apart(&none, &small) < 10.0 * bound,
            "{}: {}",
            case.name,
            apart(&none, &small)
        );
        assert!(
            apart(&none, &smaller) < 0.1 * bound,
            "{}: {}",
            case.name,
            apart(&none, &smaller)
        );
    }
}
