//! A disc that only just comes to rest.

use stickslip::integrator::Simulation;
use stickslip::plant::{Contact, Rig, RigGuard, RigInputs, RigState, STATES, index::*};

/// Time [s] within which the disc is slowest for the first time; later swings grow.
pub const TOUCH: f64 = 1.0;
/// First five components of a state from which the disc slows down towards rest.
const TOWARDS_REST: [f64; 5] = [2.6, 5.0, 2.0, 5.0, 1.5];

/// A state from which both discs slow down towards rest.
pub fn towards_rest(full: bool) -> RigState<f64> {
    let mut state = [0.0; STATES];
    state[..5].copy_from_slice(&TOWARDS_REST);
    if full {
        (state[THETA1], state[OMEGA1]) = (state[THETA], state[OMEGA]);
    }
    state
}

/// A rig under `law` with inputs that press its pins by `force` [N]; a law of the torque is made as strong.
pub fn pressed(full: bool, law: (&str, &str), force: f64) -> (Rig<f64>, RigInputs<f64>) {
    let mut rig = super::rig(full, law, "");
    if rig.law.is_torque() {
        for section in ["contact", "contact1"] {
            for key in ["a1", "a2"] {
                let name = format!("{section}.{key}");
                if let Some(height) = rig.parameter(&name) {
                    rig.set_parameter(&name, height * force / 50.0).unwrap();
                }
            }
        }
    }
    let inputs = RigInputs::held(rig.voltage_for_speed(5.76), force, 0.2 * force);
    (rig, inputs)
}

/// Whether disc D2 comes to rest by then.
fn rests(mut run: Simulation<f64, Rig<f64>>) -> bool {
    while run.segment_end() < TOUCH {
        let guard = run.pending_switch().and_then(|event| event.guard);
        if guard == Some(RigGuard::Rest(Contact::Disc)) {
            return true;
        }
        run.next_segment().unwrap();
    }
    false
}

/// The largest force at which the disc does not come to rest in that time, and the smallest at which it does.
pub fn around_grazing(full: bool, law: (&str, &str)) -> (f64, f64) {
    let (mut free, mut grips) = (0.0, 60.0);
    while grips - free > 1e-13 * grips {
        let force = 0.5 * (free + grips);
        let (rig, inputs) = pressed(full, law, force);
        if rests(super::start(&rig, 1e-12, towards_rest(full), inputs).unwrap()) {
            grips = force;
        } else {
            free = force;
        }
    }
    (free, grips)
}
