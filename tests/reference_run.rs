//! The Stribeck reference run: 60 s from rest at 55 rpm and 50 N against solutions by SUNDIALS CVODE
//! with root finding and by an adaptive method of order 8, both at their tightest.

use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES, index};

const REDUCED_RIG: &str = include_str!("../modelDescription/reduced-rig.toml");

#[test]
fn reduced_rig_agrees_with_independent_solvers() {
    let rig = Rig::from_toml(REDUCED_RIG, "reduced-rig.toml").unwrap();
    let inputs = RigInputs::held(rig.voltage_for_speed(5.76), 50.0, 0.0);
    let mut run = Simulation::new(rig, Options::default(), 0.0, [0.0; STATES], inputs).unwrap();
    run.advance_to(60.0).unwrap();
    let state = run.state_at(60.0);
    let expected = [
        (index::THETA, 325.043_124_442_9),
        (index::OMEGA, 12.531_920_146_6),
        (index::THETA3, 326.061_543_382_3),
        (index::OMEGA3, 5.531_691_577_5),
        (index::CURRENT, 1.353_746_267_0),
    ];
    for (component, value) in expected {
        let error = state[component] - value;
        eprintln!("{component}: {} error {error:e}", state[component]);
        assert!(
            error.abs() < 1e-8,
            "component {component}: {} instead of {value}",
            state[component]
        );
    }
    eprintln!("{:?}", run.statistics());
}
