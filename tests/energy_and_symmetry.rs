//! What holds for every law on both rigs: the energy balance, mirror symmetry, invariance under a
//! shift of time, dissipation, and the bound of friction in stick.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod common;

use common::LAWS;
use common::energy::{EnergyBalance, GAUSS, torques};
use stickslip::integrator::Simulation;
use stickslip::plant::{Rig, RigInputs, STATES, index::*};

fn each_rig(mut check: impl FnMut(&str, Rig<f64>)) {
    for law in LAWS {
        check(&format!("reduced, {}", law.0), common::rig(false, law, ""));
        check(&format!("full, {}", law.0), common::rig(true, law, ""));
    }
}

fn inputs_for(rig: &Rig<f64>) -> RigInputs<f64> {
    RigInputs::held(rig.voltage_for_speed(5.76), 40.0, 15.0)
}

#[test]
fn energy_is_neither_made_nor_lost() {
    each_rig(|name, rig| {
        let inputs = inputs_for(&rig);
        let mut run = common::start(&rig, 1e-13, [0.0; STATES], inputs).unwrap();
        let mut balance = EnergyBalance::new(&run);
        balance.advance(&mut run, 6.0);
        let error = balance.error(&run);
        println!("{name:30} energy balance {error:.1e}");
        assert!(error < 1e-11, "{name}: {error:e} is missing");
    });
}

#[test]
fn memoryless_laws_never_drive() {
    for name in ["coulomb", "coulomb_stiction", "stribeck"] {
        for full in [false, true] {
            let rig = common::rig(full, common::law(name), "");
            let mut run = common::start(&rig, 1e-12, [0.0; STATES], inputs_for(&rig)).unwrap();
            while run.segment_end() < 6.0 {
                let (from, to) = (run.segment_start(), run.segment_end());
                for (node, _) in GAUSS {
                    let tau = 0.5 * (to - from) * (1.0 + node);
                    let (x, t) = (run.state_at(from + tau), torques(&run, tau));
                    for (torque, omega) in t.into_iter().zip([x[OMEGA], x[OMEGA1], x[OMEGA3]]) {
                        assert!(
                            torque * omega >= -1e-12,
                            "{name}: friction gives {} W at {} s",
                            -torque * omega,
                            from + tau
                        );
                    }
                }
                run.next_segment().unwrap();
            }
        }
    }
}

#[test]
fn friction_in_stick_stays_below_breakaway() {
    each_rig(|name, rig| {
        let mut run = common::start(&rig, 1e-12, [0.0; STATES], inputs_for(&rig)).unwrap();
        let load = if rig.law.is_torque() {
            [1.0; 2]
        } else {
            [40.0 * 0.075, 15.0 * 0.089]
        };
        // The switch model lets a velocity inside its band decay, which takes this much torque more.
        let (band, decay) = rig.law.band();
        let limits = load.map(|load| load * rig.law.breakaway());
        let (mut stuck, mut largest) = (0, 0.0_f64);
        while run.segment_end() < 6.0 {
            let length = run.segment_end() - run.segment_start();
            for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let t = torques(&run, share * length);
                for (place, mode) in [run.mode().disc, run.mode().disc1].into_iter().enumerate() {
                    if mode.is_stuck() {
                        stuck += 1;
                        largest = largest.max(t[place].abs() / limits[place]);
                        let inertia = [rig.disc.inertia, 0.0288][place];
                        let extra = inertia * decay * band;
                        assert!(
                            t[place].abs() <= limits[place] * (1.0 + 1e-12) + extra,
                            "{name}: {} N m in stick above {}",
                            t[place],
                            limits[place]
                        );
                    }
                }
            }
            run.next_segment().unwrap();
        }
        assert!(stuck > 0 && largest > 0.99, "{name}: {stuck}, {largest}");
    });
}

#[test]
fn mirrored_inputs_mirror_the_motion() {
    each_rig(|name, rig| {
        let mut inputs = inputs_for(&rig);
        let state = [0.1, 0.0, -0.2, 0.3, 0.4, 0.05, 0.0, 0.0];
        let mut initial = [0.0; STATES];
        initial[..8].copy_from_slice(&state);
        let plain = common::state_after(&rig, initial, inputs, 5.0);
        inputs.voltage = inputs.voltage.map(|u| -u);
        let mirrored = common::state_after(&rig, initial.map(|x| -x), inputs, 5.0);
        for (a, b) in plain.iter().zip(mirrored) {
            assert!((a + b).abs() < 1e-12, "{name}: {a} against {b}");
        }
    });
}

#[test]
fn a_shift_of_time_changes_nothing() {
    each_rig(|name, rig| {
        let inputs = inputs_for(&rig);
        let early = common::state_after(&rig, [0.0; STATES], inputs, 5.0);
        let mut run = Simulation::new(
            rig,
            common::options(1e-12),
            1024.0,
            [0.0; STATES],
            RigInputs {
                time: 1024.0,
                ..inputs
            },
        )
        .unwrap();
        run.advance_to(1029.0).unwrap();
        for (a, b) in early.iter().zip(run.state_at(1029.0)) {
            // Time itself is known to 2e-13 s at 1024 s.
            assert!((a - b).abs() < 1e-10, "{name}: {a} against {b}");
        }
    });
}
