//! Where the bristles of a pin that sticks stand at the start of a window: presliding.
//!
//! Nobody measures their deflection. A disc that sticks rests, or nearly: the bristles carry the shaft's torque. What a
//! window's start holds for them is how much further they are deflected, so that it is about zero in every model.

use stickslip::plant::{Rig, RigState, index};
use stickslip::series::Scalar;

/// Turns what a start holds for the bristles into their deflection. None are deflected in a rig without bristles or
/// where the disc slides.
pub fn deflect_bristles<S: Scalar>(rig: &Rig<S>, state: &mut RigState<S>) {
    let further = state[index::BRISTLE];
    let sticks = state[index::OMEGA].value() == 0.0;
    state[index::BRISTLE] = match &rig.effects.presliding {
        Some(presliding) if sticks => {
            let twist = state[index::THETA] - state[index::THETA3];
            let slip = state[index::OMEGA] - state[index::OMEGA3];
            let pull = rig.shaft.stiffness * twist + rig.shaft.damping * slip;
            further - pull / presliding.stiffness
        }
        _ => S::ZERO,
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::integrator::{Options, Simulation};
    use stickslip::plant::{ModelFile, RigInputs, STATES};

    #[test]
    fn a_disc_on_its_bristles_rests_from_the_start() {
        let mut text = include_str!("../../../../modelDescription/reduced-rig.toml").to_owned();
        text.push_str("\n[presliding]\nstiffness = 80.0\ndamping = 0.5\n");
        let rig = ModelFile::parse(&text, "rig").unwrap().rig;
        let mut state: RigState<f64> = [0.0; STATES];
        state[index::THETA3] = 0.4;
        deflect_bristles(&rig, &mut state);
        assert!((state[index::BRISTLE] - 0.4 * rig.shaft.stiffness / 80.0).abs() < 1e-12);
        let inputs = RigInputs::held(0.0, 50.0, 0.0);
        let mut run = Simulation::new(rig, Options::default(), 0.0, state, inputs).unwrap();
        run.advance_to(0.01).unwrap();
        // The gearbox, which is let go of, moves; the disc follows it by what the bristles give.
        assert!(run.state_at(0.01)[index::OMEGA].abs() < 1e-2);
        state[index::OMEGA] = 1.0;
        deflect_bristles(&rig, &mut state);
        assert_eq!(state[index::BRISTLE], 0.0);
    }
}
