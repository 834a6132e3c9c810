//! The rig without effects: the recurrences on which almost every run spends its time.
//!
//! The chain from one order to the next is what costs: everything that does not depend on the
//! coefficient just found is kept off it.

use super::bodies::{SlipTemplate, contact_order};
use super::index::{CURRENT, OMEGA, OMEGA1, OMEGA3, THETA, THETA1, THETA3};
use super::jet::PinJet;
use super::{Rig, RigInputs, RigJet, RigMode};
use crate::friction::{ContactMode, ExponentialCurve, Law, Regime};
use crate::series::{RECIPROCAL, Scalar, Series, TERMS};

/// A pin contact over one segment.
pub(super) enum Pin<'a, S> {
    /// Slips under a constant load by a law whose level is an exponential of the slip speed.
    OnCurve {
        curve: ExponentialCurve<S>,
        /// Direction of sliding, ±1.
        sign: f64,
        /// Load with that sign [N m].
        load: S,
        /// Torque beside the law with that sign [N m].
        constant_torque: S,
        inverse_inertia: S,
    },
    /// Any other.
    General {
        mode: ContactMode,
        breakaway: S,
        decay: S,
        template: SlipTemplate<'a, S>,
    },
}

impl<'a, S: Scalar> Pin<'a, S> {
    pub fn new(
        mode: ContactMode,
        law: &'a Law<S>,
        (inertia, inverse_inertia): (S, S),
        (near, folded): (f64, bool),
        pin: &PinJet<S>,
    ) -> Self {
        if let (ContactMode::Slipping(direction, _), Some(curve), true) =
            (mode, law.exponential_curve(), pin.load_is_constant)
        {
            return Self::OnCurve {
                curve,
                sign: direction.sign(),
                load: pin.load[0] * direction.sign(),
                constant_torque: pin.constant_torque * direction.sign(),
                inverse_inertia,
            };
        }
        Self::General {
            mode,
            breakaway: law.breakaway(),
            decay: law.band().1,
            template: SlipTemplate {
                law,
                inertia,
                inverse_inertia,
                constant_torque: pin.constant_torque,
                near,
                folded,
            },
        }
    }

    /// Coefficient `k` + 1 of the disc's velocity from coefficient `k` of the other torques that
    /// resist it; leaves coefficient `k` of the friction torque in `jet`.
    #[inline(always)]
    pub fn next_velocity(
        &self,
        k: usize,
        resisting: S,
        theta: &Series<S>,
        omega: &Series<S>,
        jet: &mut PinJet<S>,
    ) -> S {
        let per_next = RECIPROCAL[k + 1];
        match self {
            Self::OnCurve {
                curve,
                sign,
                load,
                constant_torque,
                inverse_inertia,
            } => {
                let (weighted, excess) = (&mut jet.slip.level, &mut jet.slip.lower_level);
                let rate = curve.inverse_omega_s * *sign;
                let scale = *inverse_inertia * per_next;
                if k == 0 {
                    excess[0] = curve.span * (-(rate * omega[0])).exp();
                    jet.torque[0] = *load * (curve.mu_c + excess[0]) + *constant_torque;
                    return -((resisting + jet.torque[0]) * scale);
                }
                weighted[k] = -(rate * omega[k] * k as f64);
                excess[k] =
                    S::earlier_exponential(k, weighted, excess) - omega[k] * (rate * excess[0]);
                jet.torque[k] = *load * excess[k];
                -(resisting * scale) - (*load * scale) * excess[k]
            }
            Self::General {
                mode,
                breakaway,
                decay,
                template,
            } => {
                let acceleration = contact_order(
                    k, *mode, resisting, *breakaway, *decay, template, theta, omega, jet,
                );
                acceleration * per_next
            }
        }
    }

    /// Whether the friction torque depends on the slip speed alone.
    pub fn is_free_of_torques(&self) -> bool {
        match self {
            Self::OnCurve { .. } => true,
            Self::General { mode, .. } => is_reaction(*mode),
        }
    }

    /// Coefficient `k` of the friction torque if it is a reaction to the other torques.
    #[inline(always)]
    pub fn reaction(
        &self,
        k: usize,
        resisting: S,
        theta: &Series<S>,
        omega: &Series<S>,
        jet: &mut PinJet<S>,
    ) {
        if let Self::General { mode, .. } = self
            && is_reaction(*mode)
        {
            self.next_velocity(k, resisting, theta, omega, jet);
        }
    }
}

/// Whether friction in this mode is a reaction that keeps the velocity as it is.
fn is_reaction(mode: ContactMode) -> bool {
    matches!(
        mode,
        ContactMode::Stuck | ContactMode::Slipping(_, Regime::Holding)
    )
}

impl<S: Scalar> Rig<S> {
    /// The pin contacts on D2 and, in the full rig, on D1.
    pub(super) fn pins<'a>(
        &'a self,
        mode: &RigMode,
        jet: &RigJet<S>,
    ) -> (Pin<'a, S>, Option<Pin<'a, S>>) {
        let parts = &jet.parts;
        let inertias = (parts.inertia, parts.inverse_inertia);
        let root = (mode.near[0], mode.folded[0]);
        let disc = Pin::new(mode.disc, &self.law, inertias, root, &jet.disc);
        let disc1 = match (&self.disc1, &jet.disc1) {
            (Some(disc1), Some(pin)) => {
                let inertias = (parts.inertia_1, parts.inverse_inertia_1);
                let root = (mode.near[1], mode.folded[1]);
                Some(Pin::new(mode.disc1, &disc1.law, inertias, root, pin))
            }
            _ => None,
        };
        (disc, disc1)
    }

    /// Fills `jet`, whose inputs and order 0 are in place, with the orders up to `order`.
    pub(super) fn expand_plain(
        &self,
        mode: &RigMode,
        inputs: &RigInputs<S>,
        order: usize,
        jet: &mut RigJet<S>,
    ) {
        if self.disc1.is_some() {
            self.expand_bodies::<true>(mode, inputs, order, jet);
        } else {
            self.expand_bodies::<false>(mode, inputs, order, jet);
        }
    }

    fn expand_bodies<const FULL: bool>(
        &self,
        mode: &RigMode,
        inputs: &RigInputs<S>,
        order: usize,
        jet: &mut RigJet<S>,
    ) {
        let (disc, disc1) = self.pins(mode, jet);
        let parts = jet.parts;
        let motor_friction = match mode.motor {
            ContactMode::Stuck => None,
            ContactMode::Breaking(direction) | ContactMode::Slipping(direction, _) => {
                Some(parts.motor_coulomb * direction.sign())
            }
        };
        let RigJet {
            states: x,
            disc: disc_jet,
            disc1: disc1_jet,
            motor_torque,
            voltage,
            ..
        } = jet;
        for k in 0..=order.min(TERMS - 2) {
            let per_next = RECIPROCAL[k + 1];
            let (omega, omega3, current) = (x[OMEGA][k], x[OMEGA3][k], x[CURRENT][k]);
            let shaft_torque =
                parts.damping * (omega - omega3) + parts.stiffness * (x[THETA][k] - x[THETA3][k]);
            let mut resisting = shaft_torque;
            let mut drive =
                parts.current_to_torque * current - parts.motor_damping * omega3 + shaft_torque;
            if k == 0 {
                resisting -= inputs.disc_torque;
                drive += inputs.motor_torque;
            }
            if FULL && let (Some(pin), Some(pin_jet)) = (&disc1, disc1_jet.as_mut()) {
                let torque1 = parts.stiffness_1 * (x[THETA1][k] - x[THETA][k])
                    + parts.damping_1 * (x[OMEGA1][k] - omega);
                resisting -= torque1;
                x[OMEGA1][k + 1] = pin.next_velocity(k, torque1, &x[THETA1], &x[OMEGA1], pin_jet);
                x[THETA1][k + 1] = x[OMEGA1][k] * per_next;
            }
            x[OMEGA][k + 1] = disc.next_velocity(k, resisting, &x[THETA], &x[OMEGA], disc_jet);
            x[THETA][k + 1] = omega * per_next;
            x[THETA3][k + 1] = omega3 * per_next;
            (motor_torque[k], x[OMEGA3][k + 1]) = match motor_friction {
                None => (drive, S::ZERO),
                Some(friction) => {
                    let friction = if k == 0 { friction } else { S::ZERO };
                    let scale = parts.inverse_motor_inertia * per_next;
                    (friction, (drive - friction) * scale)
                }
            };
            let voltage = voltage.get(k).copied().unwrap_or(S::ZERO);
            x[CURRENT][k + 1] = (voltage - parts.resistance * current - parts.back_emf * omega3)
                * (parts.inverse_inductance * per_next);
        }
    }
}
