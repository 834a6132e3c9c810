//! A disc that only just comes to rest.

use stickslip::plant::{Rig, RigInputs, RigState};

/// Laws under which a disc that starts as [`TOWARDS_REST`] comes to rest by one touch as the force grows.
pub const GRAZING_LAWS: [&str; 3] = ["coulomb", "coulomb_stiction", "stribeck"];
/// First five components of a state from which the disc slows down towards rest.
pub const TOWARDS_REST: [f64; 5] = [2.6, 5.0, 2.0, 5.0, 1.5];
/// Time [s] within which the disc is slowest for the first time; later swings grow.
pub const TOUCH: f64 = 1.0;

/// The largest force at which the disc does not come to rest in that time, and the smallest at which it does.
pub fn around_grazing(rig: &Rig<f64>, state: RigState<f64>) -> (f64, f64) {
    let (mut free, mut rests) = (0.0, 60.0);
    while rests - free > 1e-13 * rests {
        let force = 0.5 * (free + rests);
        let inputs = RigInputs::held(rig.voltage_for_speed(5.76), force, 0.0);
        let mut run = super::start(rig, 1e-12, state, inputs).unwrap();
        run.advance_to(TOUCH).unwrap();
        if run.statistics().switches > 0 {
            rests = force;
        } else {
            free = force;
        }
    }
    (free, rests)
}
