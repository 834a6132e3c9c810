//! A contact without normal force: it neither holds nor chatters when its disc starts from rest.

use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES};

#[test]
fn disc_d1_without_friction_starts_with_its_neighbour() {
    let text = include_str!("../modelDescription/full-rig.toml");
    let rig = Rig::<f64>::from_toml(text, "full-rig.toml").unwrap();
    let inputs = RigInputs::held(rig.voltage_for_speed(5.76), 50.0, 0.0);
    let mut run = Simulation::new(rig, Options::default(), 0.0, [0.0; STATES], inputs).unwrap();
    run.advance_to(0.3).unwrap();
    assert_eq!(
        run.state_at(0.3)[6],
        0.0,
        "both discs wait for D2's breakaway"
    );
    run.advance_to(20.0).unwrap();
    let state = run.state_at(20.0);
    assert!(
        (state[5] - state[0]).abs() < 1.0,
        "D1 goes along: {state:?}"
    );
    assert!(state[0] > 60.0, "{state:?}");
}
