//! The rig with its effects: the recurrences order by order, and a pin contact in any of its modes.

use super::bristle::{follow_bristle, stuck_order};
use super::effect_series::OnDisc;
use super::equation_series::{At, ports};
use super::index::{BRISTLE, BRISTLE1, CURRENT, OMEGA, OMEGA1, OMEGA3, THETA, THETA1, THETA3};
use super::jet::{PinJet, RigJet};
use super::load::MINUTE;
use super::{Contact, Coupling, Rig, RigInputs, RigMode};
use crate::friction::{ContactMode, Law, RandomFunction, Slip};
use crate::series::{RECIPROCAL, Scalar, Series, TERMS};

/// The rig's numbers as the recurrences want them.
pub(super) struct Bodies<'a, S> {
    pub rig: &'a Rig<S>,
    pub has_effects: bool,
    pub inverse_motor_inertia: S,
    pub inverse_inductance: S,
    pub ratio: S,
    pub current_to_torque: S,
    pub motor_damping: S,
    pub back_emf: S,
    pub motor_coulomb: S,
    pub play: S,
    pub voltage_factor: S,
    pub random: Option<RandomFunction>,
    /// Breakaway levels and zero-velocity decay rates of D2 and D1, constant over a segment.
    pub breakaway: [S; 2],
    pub decay: [S; 2],
    pub disc_slip: SlipTemplate<'a, S>,
    pub disc1_slip: Option<SlipTemplate<'a, S>>,
    pub disturbances: [S; 2],
    pub on_disc: OnDisc<'a, S>,
    pub on_disc1: Option<OnDisc<'a, S>>,
    /// Where equations act.
    pub ports: u16,
}

/// What does not change in the course of a segment of one pin contact.
pub(super) struct SlipTemplate<'a, S> {
    pub law: &'a Law<S>,
    pub inertia: S,
    pub inverse_inertia: S,
    pub constant_torque: S,
    pub near: f64,
    pub folded: bool,
}

impl<'a, S: Scalar> Bodies<'a, S> {
    pub fn new(rig: &'a Rig<S>, mode: &RigMode, inputs: &RigInputs<S>) -> Self {
        let one = S::constant(1.0);
        let ratio = rig.gearbox.ratio;
        let motor_inertia = ratio * ratio * rig.motor.inertia;
        let effects = &rig.effects;
        let gap = effects.backlash.map_or(S::ZERO, |backlash| backlash.gap);
        let inverse_inertia = one / rig.disc.inertia;
        Self {
            rig,
            has_effects: rig.needs_effect_series(),
            inverse_motor_inertia: one / motor_inertia,
            inverse_inductance: one / rig.motor.inductance,
            ratio,
            current_to_torque: ratio * rig.motor.torque_constant,
            motor_damping: ratio * ratio * rig.motor_viscous_damping(),
            back_emf: ratio * rig.motor.back_emf_constant,
            motor_coulomb: ratio * rig.motor.coulomb_torque,
            play: gap * 0.5,
            voltage_factor: effects.supply_sag.map_or(one, |sag| sag.factor),
            random: effects.stochastic_friction.map(|noise| {
                RandomFunction::new(noise.seed.value() as u64, noise.correlation_time.value())
            }),
            breakaway: [
                rig.law.breakaway(),
                rig.disc1
                    .as_ref()
                    .map_or(S::ZERO, |disc1| disc1.law.breakaway()),
            ],
            decay: [
                rig.law.band().1,
                rig.disc1
                    .as_ref()
                    .map_or(S::ZERO, |disc1| disc1.law.band().1),
            ],
            disturbances: [inputs.disc_torque, inputs.motor_torque],
            on_disc: OnDisc {
                turns: effects.unbalance.is_some() || effects.normal_force_wobble.is_some(),
                unbalance: effects.unbalance.as_ref(),
                viscous_drag: effects.viscous_drag.as_ref(),
                quadratic_drag: effects.quadratic_drag.as_ref(),
                has_bristles: effects.presliding.is_some(),
            },
            on_disc1: rig.disc1.as_ref().map(|disc1| OnDisc {
                turns: disc1.effects.unbalance1.is_some()
                    || disc1.effects.normal_force_wobble1.is_some(),
                unbalance: disc1.effects.unbalance1.as_ref(),
                viscous_drag: disc1.effects.viscous_drag1.as_ref(),
                quadratic_drag: disc1.effects.quadratic_drag1.as_ref(),
                has_bristles: effects.presliding.is_some(),
            }),
            ports: ports(rig),
            disc_slip: SlipTemplate {
                law: &rig.law,
                inertia: rig.disc.inertia,
                inverse_inertia,
                constant_torque: rig.bearing_torque(),
                near: mode.near[0],
                folded: mode.folded[0],
            },
            disc1_slip: rig.disc1.as_ref().map(|disc1| SlipTemplate {
                law: &disc1.law,
                inertia: disc1.disc.inertia,
                inverse_inertia: one / disc1.disc.inertia,
                constant_torque: disc1
                    .effects
                    .bearing_friction1
                    .map_or(S::ZERO, |bearing| bearing.torque),
                near: mode.near[1],
                folded: mode.folded[1],
            }),
        }
    }

    /// What of the angle between the ends of a coupling twists the shaft.
    pub fn elastic_twist(&self, coupling: Coupling, twist: S) -> S {
        match coupling {
            Coupling::Free => S::ZERO,
            Coupling::Ahead => twist - self.play,
            Coupling::Behind => twist + self.play,
        }
    }

    #[inline]
    pub fn expand_order(
        &self,
        k: usize,
        mode: &RigMode,
        time: S,
        varying: bool,
        jet: &mut RigJet<S>,
    ) {
        let rig = self.rig;
        let x = &mut jet.states;
        let next = if k + 1 < TERMS { k + 1 } else { 0 };
        let per_next = if next == 0 { 0.0 } else { RECIPROCAL[next] };

        let mut twist = x[THETA][k] - x[THETA3][k];
        let twist_rate = x[OMEGA][k] - x[OMEGA3][k];
        let mut shaft_torque = rig.shaft.damping * twist_rate;
        if self.has_effects {
            if mode.coupling == Coupling::Free {
                twist = S::ZERO;
                shaft_torque = S::ZERO;
            } else if k == 0 {
                twist = self.elastic_twist(mode.coupling, twist);
            }
        }
        shaft_torque += rig.shaft.stiffness * twist;

        let mut on_disc = S::ZERO;
        let mut on_motor = S::ZERO;
        let mut added_voltage = S::ZERO;
        let mut voltage = jet.voltage.get(k).copied().unwrap_or(S::ZERO);
        let mut resistance_drop = rig.motor.resistance * x[CURRENT][k];
        if self.has_effects {
            if let Some(work) = &mut jet.effects {
                work.elastic_twist[k] = twist;
                let extra = self.effect_shaft_torque(k, twist_rate, x, next, per_next, work);
                if mode.coupling != Coupling::Free {
                    shaft_torque += extra;
                }
                let motion = (&x[THETA], &x[OMEGA]);
                let turn = self.on_disc.turns.then_some(&mut work.turn);
                on_disc = self.on_disc.torque(k, mode.disc, motion, turn);
                on_motor = self.effect_motor_torque(k, x, work);
                if varying {
                    self.effect_load(k, time, x, &mut jet.disc.load, work);
                }
                if let Some(equations) = &mut work.equations {
                    let at = At {
                        k,
                        time,
                        branches: &mode.branches,
                    };
                    let added = self.by_equation(&at, (twist, twist_rate), x, voltage, equations);
                    if mode.coupling != Coupling::Free {
                        shaft_torque += added.shaft;
                    }
                    on_disc += added.disc;
                    on_motor += added.motor;
                    added_voltage = added.voltage;
                    jet.disc.load[k] =
                        self.equation_load(Contact::Disc, &at, x, &jet.disc, equations);
                }
            }
            voltage = voltage * self.voltage_factor + added_voltage;
            if let Some(drift) = &rig.effects.resistance_drift {
                let rate = drift.rate_per_minute * (1.0 / MINUTE);
                let mut extra = rate * time * x[CURRENT][k];
                if k > 0 {
                    extra += rate * x[CURRENT][k - 1];
                }
                resistance_drop += rig.motor.resistance * extra;
            }
        }

        if k == 0 {
            on_disc += self.disturbances[0];
            on_motor += self.disturbances[1];
        }
        let presliding = rig.effects.presliding.as_ref();
        let mut resisting = shaft_torque - on_disc;
        if let (Some(disc1), Some(template), Some(pin)) =
            (&rig.disc1, &self.disc1_slip, &mut jet.disc1)
        {
            let mut torque1 = disc1.shaft.stiffness * (x[THETA1][k] - x[THETA][k])
                + disc1.shaft.damping * (x[OMEGA1][k] - x[OMEGA][k]);
            let mut on_disc1 = S::ZERO;
            if let (Some(effects1), Some(work)) = (&self.on_disc1, &mut jet.effects)
                && let Some(work) = &mut work.disc1
            {
                torque1 += disc1.effects.shaft_torque(k, x, work);
                let turn = effects1.turns.then_some(&mut work.turn);
                on_disc1 = effects1.torque(k, mode.disc1, (&x[THETA1], &x[OMEGA1]), turn);
                if !disc1.law.is_torque() {
                    disc1.effects.vary_load(k, work, &mut pin.load);
                }
            }
            let equations = jet
                .effects
                .as_mut()
                .and_then(|work| work.equations.as_mut());
            if let Some(equations) = equations {
                let at = At {
                    k,
                    time,
                    branches: &mode.branches,
                };
                let (torque, shaft) = self.disc1_by_equation(&at, x, equations);
                on_disc1 += torque;
                torque1 += shaft;
                pin.load[k] = self.equation_load(Contact::Disc1, &at, x, pin, equations);
            }
            resisting -= torque1;
            let resisting1 = torque1 - on_disc1;
            let acceleration = match presliding {
                Some(bristle) if mode.disc1.is_stuck() => {
                    let moved = (x[BRISTLE1][k], x[OMEGA1][k]);
                    stuck_order(
                        k,
                        bristle,
                        moved,
                        resisting1,
                        self.breakaway[1],
                        template,
                        pin,
                    )
                }
                _ => contact_order(
                    k,
                    mode.disc1,
                    resisting1,
                    self.breakaway[1],
                    self.decay[1],
                    template,
                    &x[THETA1],
                    &x[OMEGA1],
                    pin,
                ),
            };
            if let Some(bristle) = presliding {
                follow_bristle(k, bristle, mode.disc1, x[OMEGA1][k], pin, &mut x[BRISTLE1]);
            }
            x[OMEGA1][next] = acceleration * per_next;
            x[THETA1][next] = x[OMEGA1][k] * per_next;
        }

        let acceleration = match presliding {
            Some(bristle) if mode.disc.is_stuck() => {
                let moved = (x[BRISTLE][k], x[OMEGA][k]);
                let (level, template) = (self.breakaway[0], &self.disc_slip);
                stuck_order(k, bristle, moved, resisting, level, template, &mut jet.disc)
            }
            _ => contact_order(
                k,
                mode.disc,
                resisting,
                self.breakaway[0],
                self.decay[0],
                &self.disc_slip,
                &x[THETA],
                &x[OMEGA],
                &mut jet.disc,
            ),
        };
        if let Some(bristle) = presliding {
            follow_bristle(
                k,
                bristle,
                mode.disc,
                x[OMEGA][k],
                &jet.disc,
                &mut x[BRISTLE],
            );
        }
        x[OMEGA][next] = acceleration * per_next;
        x[THETA][next] = x[OMEGA][k] * per_next;

        let drive = self.current_to_torque * x[CURRENT][k] - self.motor_damping * x[OMEGA3][k]
            + shaft_torque
            + on_motor;
        let (friction, motor_acceleration) = match mode.motor {
            ContactMode::Stuck => (drive, S::ZERO),
            ContactMode::Breaking(direction) | ContactMode::Slipping(direction, _) => {
                let friction = if k == 0 {
                    self.motor_coulomb * direction.sign()
                } else {
                    S::ZERO
                };
                (friction, (drive - friction) * self.inverse_motor_inertia)
            }
        };
        jet.motor_torque[k] = friction;
        x[OMEGA3][next] = motor_acceleration * per_next;
        x[THETA3][next] = x[OMEGA3][k] * per_next;
        x[CURRENT][next] = (voltage - resistance_drop - self.back_emf * x[OMEGA3][k])
            * self.inverse_inductance
            * per_next;
    }
}

/// Order `k` of one pin contact; returns the coefficient of its disc's acceleration.
#[allow(clippy::too_many_arguments)]
#[inline]
pub(super) fn contact_order<S: Scalar>(
    k: usize,
    mode: ContactMode,
    resisting: S,
    breakaway: S,
    decay: S,
    template: &SlipTemplate<'_, S>,
    theta: &Series<S>,
    omega: &Series<S>,
    pin: &mut PinJet<S>,
) -> S {
    pin.resisting[k] = resisting;
    match mode {
        ContactMode::Slipping(direction, regime) => {
            let sign = direction.sign();
            let slip = Slip {
                law: template.law,
                regime,
                inertia: template.inertia,
                inverse_inertia: template.inverse_inertia,
                constant_torque: template.constant_torque,
                load: &pin.load,
                load_is_constant: pin.load_is_constant,
                near: template.near,
                folded: template.folded,
            };
            pin.slip.speed[k] = omega[k] * sign;
            slip.expand_order(k, resisting * sign, theta, &mut pin.slip);
            pin.torque[k] = pin.slip.torque[k] * sign;
            pin.slip.acceleration[k] * sign
        }
        ContactMode::Stuck => {
            let acceleration = -(decay * omega[k]);
            pin.torque[k] = -(resisting + template.inertia * acceleration);
            breakaway_order(k, breakaway, template, pin);
            acceleration
        }
        ContactMode::Breaking(direction) => {
            breakaway_order(k, breakaway, template, pin);
            pin.torque[k] = pin.breakaway[k] * direction.sign();
            -((resisting + pin.torque[k]) * template.inverse_inertia)
        }
    }
}

pub(super) fn breakaway_order<S: Scalar>(
    k: usize,
    level: S,
    template: &SlipTemplate<'_, S>,
    pin: &mut PinJet<S>,
) {
    let constant = if k == 0 {
        template.constant_torque
    } else {
        S::ZERO
    };
    pin.breakaway[k] = pin.load[k] * level + constant;
}
