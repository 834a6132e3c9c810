//! Segments and switches of the reference runs: a loss of efficiency fails here without a clock.

#![allow(clippy::unwrap_used, reason = "a test's helper fails the test")]

use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES};

const REDUCED_RIG: &str = include_str!("../modelDescription/reduced-rig.toml");
const FULL_RIG: &str = include_str!("../modelDescription/full-rig.toml");

/// (segments, switches) of 60 s from rest at a speed [rad/s] under N1 and N2 [N].
fn statistics(model: &str, tolerance: f64, speed: f64, forces: [f64; 2]) -> (u64, u64) {
    let rig = Rig::from_toml(model, "model.toml").unwrap();
    let inputs = RigInputs::held(rig.voltage_for_speed(speed), forces[1], forces[0]);
    let options = Options {
        tolerance,
        ..Options::default()
    };
    let mut run = Simulation::new(rig, options, 0.0, [0.0; STATES], inputs).unwrap();
    run.advance_to(60.0).unwrap();
    let statistics = run.statistics();
    assert_eq!(statistics.discarded, 0);
    (statistics.segments, statistics.switches)
}

#[test]
fn reduced_rig() {
    assert_eq!(statistics(REDUCED_RIG, 1e-8, 5.76, [0.0, 50.0]), (794, 88));
    assert_eq!(
        statistics(REDUCED_RIG, 1e-12, 5.76, [0.0, 50.0]),
        (1454, 88)
    );
}

#[test]
fn two_gaussian_law() {
    let (parts, _) = REDUCED_RIG.split_once("law = ").unwrap();
    let model = format!(
        "{parts}law = \"two_gaussian_mu\"\na1 = 0.27115\nb1 = -3.07246\nc1 = 1.28946\n\
         a2 = 0.18567\nb2 = 0.4796\nc2 = 2.62303\nomega_centre = 7.15956\n\
         acceleration_semi_axis = 58.2873\n"
    );
    let speed = 55.0 * std::f64::consts::PI / 30.0;
    assert_eq!(statistics(&model, 1e-8, speed, [0.0, 50.0]), (1091, 136));
}

#[test]
fn full_rig() {
    let speed = 40.0 * std::f64::consts::PI / 30.0;
    assert_eq!(statistics(FULL_RIG, 1e-8, speed, [30.0, 20.0]), (974, 155));
}
