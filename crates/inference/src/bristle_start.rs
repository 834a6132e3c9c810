//! Where the bristles of a pin that sticks stand at the start of a window: presliding.
//!
//! Nobody measures their deflection. A disc that sticks rests, or nearly: the bristles carry the shaft's torque. What a
//! window's start holds for them is how much further they are deflected, so that it is about zero in every model.

use stickslip::plant::{Rig, RigState, index};
use stickslip::series::Scalar;

/// Turns what a start holds for the bristles into their deflection. None are deflected in a rig without bristles or
/// where the disc slides.
pub fn deflect_bristles<S: Scalar>(rig: &Rig<S>, state: &mut RigState<S>) {
    let twist = state[index::THETA] - state[index::THETA3];
    let slip = state[index::OMEGA] - state[index::OMEGA3];
    let mut pull = rig.shaft.stiffness * twist + rig.shaft.damping * slip;
    let deflected = |further: S, velocity: S, pull: S| match &rig.effects.presliding {
        Some(presliding) if velocity.value() == 0.0 => further - pull / presliding.stiffness,
        _ => S::ZERO,
    };
    if let Some(disc1) = &rig.disc1 {
        let twist = state[index::THETA1] - state[index::THETA];
        let slip = state[index::OMEGA1] - state[index::OMEGA];
        let disc1_pull = disc1.shaft.stiffness * twist + disc1.shaft.damping * slip;
        pull -= disc1_pull;
        state[index::BRISTLE1] =
            deflected(state[index::BRISTLE1], state[index::OMEGA1], disc1_pull);
    }
    state[index::BRISTLE] = deflected(state[index::BRISTLE], state[index::OMEGA], pull);
}
