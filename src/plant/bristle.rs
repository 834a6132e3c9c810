//! Bristles between a sticking pin and its disc: presliding.
//!
//! A contact that sticks is not rigid: while it is *stuck*, T = σ0 z + σ1 dz/dt with dz/dt = ω, linear in
//! the state (Dahl 1968), and the disc moves freely under that torque. Sliding is as without bristles:
//! this is the elasto-plastic model (Dupont, Hayward, Armstrong and Altpeter 2002) with its transition
//! from elastic to plastic drawn together to one instant, so that every mode stays analytic.
//!
//! - T reaches the breakaway torque with the disc moving along: the contact slides, z = 0.
//! - It does so with the disc at rest or springing back, because the breakaway torque fell: the bristles
//!   give way, *breaking*: T stays at the breakaway torque, z = (T − σ1 ω)/σ0, until the disc moves along
//!   and slides, or until their ends no longer slip: ω − dz/dt reaches zero.
//! - A slide comes to rest: the bristles carry the friction torque of that instant, z = T/σ0.

use super::bodies::{SlipTemplate, breakaway_order};
use super::guards::Watcher;
use super::index::{BRISTLE, BRISTLE1};
use super::jet::PinJet;
use super::switching::velocity_of;
use super::{Contact, Presliding, Rig, RigGuard, RigInputs, RigJet, RigMode, RigState};
use crate::friction::{ContactMode, Direction, Law};
use crate::parameter::ParameterError;
use crate::series::{RECIPROCAL, Scalar, Series, TERMS};

/// Share of the breakaway torque by which bristles may fall short of it as they give way: rounding.
const ROUNDING: f64 = 1e-9;

/// Bristles as the guards look at them.
#[derive(Clone, Copy)]
pub(super) struct Bristle<'a, S> {
    pub presliding: &'a Presliding<S>,
    pub deflection: &'a Series<S>,
    /// Order of the expansion.
    pub order: usize,
}

/// Order `k` of a pin contact that sticks with bristles, `moved` = (deflection, velocity) at that order;
/// returns the coefficient of its disc's acceleration.
pub(super) fn stuck_order<S: Scalar>(
    k: usize,
    presliding: &Presliding<S>,
    moved: (S, S),
    resisting: S,
    level: S,
    template: &SlipTemplate<'_, S>,
    pin: &mut PinJet<S>,
) -> S {
    pin.resisting[k] = resisting;
    breakaway_order(k, level, template, pin);
    pin.torque[k] = presliding.stiffness * moved.0 + presliding.damping * moved.1;
    -((resisting + pin.torque[k]) * template.inverse_inertia)
}

/// What the deflection does at order `k`, the friction torque being known at that order.
pub(super) fn follow_bristle<S: Scalar>(
    k: usize,
    presliding: &Presliding<S>,
    mode: ContactMode,
    omega: S,
    pin: &PinJet<S>,
    deflection: &mut Series<S>,
) {
    match mode {
        ContactMode::Stuck => {
            if k + 1 < TERMS {
                deflection[k + 1] = omega * RECIPROCAL[k + 1];
            }
        }
        ContactMode::Breaking(direction) => {
            let carried = (pin.torque[k] - presliding.damping * omega) / presliding.stiffness;
            // Bristles that give way relax: they do not take up a torque that has grown.
            if k > 0 || (carried - deflection[0]).value() * direction.sign() <= 0.0 {
                deflection[k] = carried;
            }
        }
        ContactMode::Slipping(..) => {
            if k > 0 {
                deflection[k] = S::ZERO;
            }
        }
    }
}

/// Guards of a contact that sticks with bristles or whose bristles give way.
pub(super) fn bristle_guards<S: Scalar>(
    contact: Contact,
    mode: ContactMode,
    bristle: Bristle<'_, S>,
    omega: &Series<S>,
    pin: &PinJet<S>,
    watcher: &mut impl Watcher<S>,
) {
    let Bristle {
        presliding,
        deflection,
        order,
    } = bristle;
    match mode {
        ContactMode::Stuck => {
            for direction in [Direction::Forward, Direction::Backward] {
                let sign = direction.sign();
                watcher.watch(RigGuard::Breakaway(contact, direction), |k| {
                    pin.breakaway[k] - pin.torque[k] * sign
                });
            }
        }
        ContactMode::Breaking(direction) => {
            let sign = direction.sign();
            watcher.watch(RigGuard::LeaveBand(contact, direction), |k| {
                -(omega[k] * sign)
            });
            let carried = presliding.stiffness * deflection[0] + presliding.damping * omega[0];
            let (carried, limit) = (carried.value() * sign, pin.breakaway[0].value());
            let holds = carried < limit * (1.0 - ROUNDING);
            watcher.watch(RigGuard::Calm(contact), |k| {
                if holds {
                    return S::constant(if k == 0 { -1.0 } else { 0.0 });
                }
                if k == order {
                    return S::ZERO;
                }
                (omega[k] - deflection[k + 1] * (k + 1) as f64) * sign
            });
        }
        ContactMode::Slipping(..) => {}
    }
}

impl<S: Scalar> Rig<S> {
    /// Place of the bristles' deflection in the state and their law, if `contact` has any.
    pub(super) fn bristle(&self, contact: Contact) -> Option<(usize, &Presliding<S>)> {
        let place = match contact {
            Contact::Disc => BRISTLE,
            Contact::Disc1 => BRISTLE1,
            Contact::Motor => return None,
        };
        let presliding = self.effects.presliding.as_ref()?;
        Some((place, presliding))
    }

    /// Whether `contact` has bristles that carry a torque: its disc sticks even if it moves.
    pub(super) fn is_deflected(&self, contact: Contact, state: &RigState<S>) -> bool {
        self.bristle(contact)
            .is_some_and(|(place, _)| state[place].value() != 0.0)
    }

    /// Deflects the bristles of a contact that has come to rest as far as the friction torque of its sliding
    /// `mode` wants.
    pub(super) fn load_bristle(
        &self,
        contact: Contact,
        mode: &RigMode,
        time: S,
        state: &mut RigState<S>,
        inputs: &RigInputs<S>,
        jet: &mut RigJet<S>,
    ) {
        let Some((place, presliding)) = self.bristle(contact) else {
            return;
        };
        self.expand_motion(mode, time, state, inputs, 0, jet);
        let pin = match (contact, &jet.disc1) {
            (Contact::Disc1, Some(pin)) => pin,
            _ => &jet.disc,
        };
        state[place] = pin.torque[0] / presliding.stiffness;
    }

    /// Mode of a contact whose bristles have reached the breakaway torque in this direction.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn let_go(
        &self,
        contact: Contact,
        direction: Direction,
        mode: &mut RigMode,
        time: S,
        state: &mut RigState<S>,
        inputs: &RigInputs<S>,
        jet: &mut RigJet<S>,
    ) {
        self.break_away(contact, direction, mode);
        if state[velocity_of(contact)].value() * direction.sign() <= 0.0 {
            return mode.set_contact(contact, ContactMode::Breaking(direction));
        }
        if let Some((place, _)) = self.bristle(contact) {
            state[place] = S::ZERO;
        }
        if self.law_of(contact).is_some_and(Law::has_branches) {
            self.turn(contact, None, mode, time, state, inputs, jet);
        }
    }

    /// Order to which the motion has to be known at the switch of `guard`.
    pub(super) fn order_of_guard(&self, guard: RigGuard) -> usize {
        match guard {
            // The bristles' own velocity.
            RigGuard::Calm(contact) => usize::from(self.bristle(contact).is_some()),
            _ => 0,
        }
    }

    /// Refuses bristles under a law that counts a band of velocities as zero.
    pub(super) fn check_bristles(&self) -> Result<(), ParameterError> {
        if self.effects.presliding.is_none() {
            return Ok(());
        }
        let laws = [
            ("contact", Some(&self.law)),
            ("contact1", self.disc1.as_ref().map(|disc1| &disc1.law)),
        ];
        for (section, law) in laws {
            if let Some(law) = law.filter(|law| law.band().0.value() > 0.0) {
                return Err(ParameterError::Inconsistent {
                    section: "presliding".to_owned(),
                    message: format!(
                        "bristles cannot go with law = \"{}\" in [{section}], which counts velocities up to omega_tolerance as \
                         zero; take law = \"stribeck\" or leave [presliding] out",
                        law.name()
                    ),
                });
            }
        }
        Ok(())
    }
}
