//! A rig at one instant, as a solver that brings its own steps sees it: derivatives of the state in a mode that is held, and
//! the change of mode that an event asks for.
//!
//! The equations are those of [`expansion`](super::expansion), to the lowest order; the algebraic loop of Eqs 6-1 and 6-2 is
//! solved exactly at every call.

use super::index::{BRISTLE, BRISTLE1, OMEGA1, RELAXING_TORQUE, THETA1};
use super::indicators::Indicator;
use super::switching::velocity_of;
use super::{Contact, Indicators, Rig, RigInputs, RigJet, RigMode, RigState};
use crate::friction::{ContactMode, Direction};
use crate::integrator::HybridSystem;
use crate::series::Scalar;
use thiserror::Error;

/// Switches at one instant after which modes are taken to chase each other.
const CHATTERING: usize = 200;

/// Velocity \[rad/s\] up to which a solver may only be probing how derivatives change.
const PROBE: f64 = 1e-3;

/// Modes that chase each other.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "modes changed {CHATTERING} times at t = {time} s, now {mode}; check parameters and inputs"
)]
pub struct Chattering {
    /// Time \[s\].
    pub time: f64,
    /// The present mode.
    pub mode: String,
}

/// What an event changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Whether any mode did.
    pub mode: bool,
    /// Whether a branch of a many-valued law ended.
    pub branch: bool,
}

impl<S: Scalar> Rig<S> {
    /// Places of the state's components that this rig has, in the order of [`index`](super::index).
    pub fn state_places(&self) -> Vec<usize> {
        let mut places: Vec<usize> = (0..THETA1).collect();
        let full = self.disc1.is_some();
        if full {
            places.extend([THETA1, OMEGA1]);
        }
        if self.effects.shaft_hysteresis.is_some() {
            places.push(RELAXING_TORQUE);
        }
        if self.effects.presliding.is_some() {
            places.push(BRISTLE);
            if full {
                places.push(BRISTLE1);
            }
        }
        places
    }

    /// Computes torques and derivatives at `time` \[s\] of `state` in `mode`; [`RigJet::rates`] and `torques` have
    /// them.
    pub fn evaluate(
        &self,
        mode: &RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        jet: &mut RigJet<S>,
    ) {
        self.expand_instant(mode, time, state, inputs, jet);
    }
}

impl<S: Scalar> RigJet<S> {
    /// Time derivatives of the state's components where [`Rig::evaluate`] was called last.
    pub fn rates(&self) -> RigState<S> {
        self.states.map(|series| series[1])
    }
}

impl Rig<f64> {
    /// The mode that `state` wants at the start; may correct the state.
    pub fn mode_at_start(
        &self,
        time: f64,
        state: &mut RigState<f64>,
        inputs: &RigInputs<f64>,
        jet: &mut RigJet<f64>,
    ) -> RigMode {
        let mode = self.initial_mode(time, state, inputs, jet);
        self.evaluate(&mode, time, state, inputs, jet);
        self.follow(&mode, jet)
    }

    /// `mode` with its memory of the followed root brought up to the instant in `jet`. The side of zero acceleration is left
    /// to events.
    pub fn follow(&self, mode: &RigMode, jet: &RigJet<f64>) -> RigMode {
        let mut next = *mode;
        next.folded = [false; 2];
        let pins = [Some(&jet.disc), jet.disc1.as_deref()];
        for (place, (contact, pin)) in [mode.disc, mode.disc1].into_iter().zip(pins).enumerate() {
            if let (ContactMode::Slipping(..), Some(pin)) = (contact, pin) {
                let (root, side) = (pin.slip.acceleration[0], mode.near[place]);
                next.near[place] =
                    if root != 0.0 && root.is_sign_negative() == side.is_sign_negative() {
                        root
                    } else {
                        libm::copysign(0.0, side)
                    };
            }
        }
        next
    }

    /// Lets contacts slide that stick by their mode and move by their state, because a solver was put elsewhere; whether there are
    /// any. On the course of a solution there are none: what sticks has velocity zero exactly.
    pub fn let_move(&self, mode: &mut RigMode, state: &RigState<f64>) -> bool {
        let mut any = false;
        for contact in [Contact::Disc, Contact::Disc1, Contact::Motor] {
            let velocity = state[velocity_of(contact)];
            let band = self.law_of(contact).map_or(0.0, |law| law.band().0);
            if mode.contact(contact).is_stuck()
                && velocity.abs() > band + PROBE
                && !(contact == Contact::Disc1 && self.disc1.is_none())
                && self.bristle(contact).is_none()
            {
                self.set_sliding(contact, Direction::of(velocity), mode);
                any = true;
            }
        }
        any
    }

    /// Brings `mode`, and the state where a switch corrects it, to what holds at this instant: switches one after the other,
    /// until every indicator is positive. `continuous`: whether the inputs are those of the motion so far, so that a root that
    /// is gone has ended at a fold.
    ///
    /// # Errors
    /// Modes that change without end.
    #[allow(clippy::too_many_arguments)]
    pub fn settle(
        &self,
        indicators: &Indicators,
        mode: &mut RigMode,
        time: f64,
        state: &mut RigState<f64>,
        inputs: &RigInputs<f64>,
        continuous: bool,
        jet: &mut RigJet<f64>,
    ) -> Result<Changes, Chattering> {
        let mut changes = Changes::default();
        changes.mode |= self.let_move(mode, state);
        for _ in 0..CHATTERING {
            self.evaluate(mode, time, state, inputs, jet);
            let Some(lost) = indicators.first_lost(self, mode, jet) else {
                *mode = self.follow(mode, jet);
                return Ok(changes);
            };
            match lost {
                Indicator::Guard(guard) => {
                    changes.mode = true;
                    *mode = HybridSystem::switch(self, mode, guard, time, state, inputs, jet);
                }
                Indicator::Fold(place) => {
                    changes.branch |= continuous;
                    mode.folded[place] = continuous && !changes.mode;
                }
            }
            self.evaluate(mode, time, state, inputs, jet);
            // A root on the other side of zero acceleration decides the side, as it does behind a fold.
            let side = |near: f64, root: f64| if root != 0.0 { root } else { near };
            if let Indicator::Fold(place) = lost {
                let pin = match (place, jet.disc1.as_deref()) {
                    (1, Some(pin)) => pin,
                    _ => &jet.disc,
                };
                mode.near[place] = side(mode.near[place], pin.slip.acceleration[0]);
            }
            *mode = self.follow(mode, jet);
            // Bristles that give way relax at once.
            for (contact, place) in [(mode.disc, BRISTLE), (mode.disc1, BRISTLE1)] {
                if let (ContactMode::Breaking(_), Some(_)) = (contact, &self.effects.presliding) {
                    state[place] = jet.states[place][0];
                }
            }
        }
        Err(Chattering {
            time,
            mode: self.describe(mode),
        })
    }
}
