//! What ends each mode: the guards' series, collected from the series just computed.

use super::expansion::PinJet;
use super::index::{OMEGA, OMEGA1, OMEGA3};
use super::{Contact, Coupling, Rig, RigGuard, RigJet, RigMode};
use crate::friction::{ContactMode, Direction, Law, Regime};
use crate::integrator::Guard;
use crate::series::{Scalar, Series, TERMS, convolution};

impl<S: Scalar> Rig<S> {
    /// Collects the guards of `mode` from the series just computed.
    pub(super) fn set_guards(&self, mode: &RigMode, jet: &mut RigJet<S>) {
        let RigJet {
            states,
            disc,
            disc1,
            motor_torque,
            twist,
            guards,
            order,
            ..
        } = jet;
        let order = *order;
        guards.clear();
        pin_guards(
            Contact::Disc,
            mode.disc,
            &self.law,
            &states[OMEGA],
            disc,
            mode.near[0],
            order,
            guards,
        );
        if let (Some(outer), Some(pin)) = (&self.outer, disc1.as_ref()) {
            pin_guards(
                Contact::Disc1,
                mode.disc1,
                &outer.law,
                &states[OMEGA1],
                pin,
                mode.near[1],
                order,
                guards,
            );
        }
        match mode.motor {
            ContactMode::Stuck => {
                let limit = self.gearbox.ratio * self.motor.coulomb_torque;
                for direction in [Direction::Forward, Direction::Backward] {
                    let sign = direction.sign();
                    push(
                        guards,
                        RigGuard::Breakaway(Contact::Motor, direction),
                        order,
                        |k| {
                            let held = motor_torque[k] * -sign;
                            if k == 0 { limit + held } else { held }
                        },
                    );
                }
            }
            ContactMode::Breaking(direction) | ContactMode::Slipping(direction, _) => {
                let sign = direction.sign();
                push(guards, RigGuard::Rest(Contact::Motor), order, |k| {
                    states[OMEGA3][k] * sign
                });
            }
        }
        if let Some(backlash) = &self.effects.backlash {
            let half = backlash.gap * 0.5;
            let distance = |sign: f64, inward: f64| {
                move |k: usize, twist: &Series<S>| {
                    let value = twist[k] * sign;
                    let value = if k == 0 { value - half } else { value };
                    value * inward
                }
            };
            match mode.coupling {
                Coupling::Ahead => {
                    let f = distance(1.0, 1.0);
                    push(guards, RigGuard::Play(Coupling::Free), order, |k| {
                        f(k, twist)
                    });
                }
                Coupling::Behind => {
                    let f = distance(-1.0, 1.0);
                    push(guards, RigGuard::Play(Coupling::Free), order, |k| {
                        f(k, twist)
                    });
                }
                Coupling::Free => {
                    let f = distance(1.0, -1.0);
                    push(guards, RigGuard::Play(Coupling::Ahead), order, |k| {
                        f(k, twist)
                    });
                    let f = distance(-1.0, -1.0);
                    push(guards, RigGuard::Play(Coupling::Behind), order, |k| {
                        f(k, twist)
                    });
                }
            }
        }
    }
}

#[inline]
fn push<S: Scalar>(
    guards: &mut Vec<Guard<S, RigGuard>>,
    kind: RigGuard,
    order: usize,
    coefficient: impl Fn(usize) -> S,
) {
    let mut series = [S::ZERO; TERMS];
    for (k, c) in series.iter_mut().enumerate().take(order + 1) {
        *c = coefficient(k);
    }
    guards.push(Guard { kind, series });
}

#[allow(clippy::too_many_arguments)]
fn pin_guards<S: Scalar>(
    contact: Contact,
    mode: ContactMode,
    law: &Law<S>,
    omega: &Series<S>,
    pin: &PinJet<S>,
    near: f64,
    order: usize,
    guards: &mut Vec<Guard<S, RigGuard>>,
) {
    let (band, _) = law.band();
    let at_zero = |k: usize, value: S| if k == 0 { value } else { S::ZERO };
    for moving in pin.moving.iter().flatten() {
        let next = moving.iter().map(|c| c.value()).find(|c| *c != 0.0);
        let sign = if next.is_some_and(|c| c < 0.0) {
            -1.0
        } else {
            1.0
        };
        push(guards, RigGuard::Load(contact), order, |k| moving[k] * sign);
    }
    match mode {
        ContactMode::Stuck => {
            for direction in [Direction::Forward, Direction::Backward] {
                let sign = direction.sign();
                push(
                    guards,
                    RigGuard::Breakaway(contact, direction),
                    order,
                    |k| pin.breakaway[k] + pin.resisting[k] * sign,
                );
            }
        }
        ContactMode::Breaking(direction) => {
            let sign = direction.sign();
            push(
                guards,
                RigGuard::LeaveBand(contact, direction),
                order,
                |k| at_zero(k, band) - omega[k] * sign,
            );
            push(guards, RigGuard::Calm(contact), order, |k| {
                -(pin.resisting[k] * sign) - pin.breakaway[k]
            });
        }
        ContactMode::Slipping(direction, regime) => {
            push(guards, RigGuard::Rest(contact), order, |k| {
                omega[k] * direction.sign() - at_zero(k, band)
            });
            if !law.has_branches() || pin.slip.branches_meet {
                return;
            }
            let speeding_up = match regime {
                Regime::SpeedingUp => Some(true),
                Regime::SlowingDown => Some(false),
                Regime::Free => Some(!near.is_sign_negative()),
                Regime::Holding => None,
            };
            if let Some(up) = speeding_up {
                let earlier = if up {
                    Direction::Forward
                } else {
                    Direction::Backward
                };
                let kind = RigGuard::Turn(contact, earlier);
                if pin.slip.between {
                    push(guards, kind, order, |k| at_zero(k, S::constant(-1.0)));
                } else {
                    push(guards, kind, order, |k| {
                        pin.slip.acceleration[k] * earlier.sign()
                    });
                }
                return;
            }
            // While the speed is held the reaction lies between the two branches.
            let branch = |k: usize, level: &Series<S>| convolution(&pin.load[..=k], &level[..=k]);
            push(
                guards,
                RigGuard::Release(contact, Direction::Forward),
                order,
                |k| {
                    branch(k, &pin.slip.level) + at_zero(k, pin.constant_torque)
                        - pin.slip.torque[k]
                },
            );
            push(
                guards,
                RigGuard::Release(contact, Direction::Backward),
                order,
                |k| {
                    pin.slip.torque[k]
                        - branch(k, &pin.slip.lower_level)
                        - at_zero(k, pin.constant_torque)
                },
            );
        }
    }
}
