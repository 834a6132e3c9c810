//! What ends each mode: the guards' series, collected from the series just computed.

use super::bristle::{Bristle, bristle_guards};
use super::index::{BRISTLE, BRISTLE1, OMEGA, OMEGA1, OMEGA3, THETA, THETA3};
use super::jet::PinJet;
use super::{Contact, Coupling, Rig, RigGuard, RigJet, RigMode};
use crate::friction::{ContactMode, Direction, Law, Regime};
use crate::integrator::Guard;
use crate::series::{Scalar, Series, TERMS, convolution};

/// Takes what is watched in a mode: the guard and the coefficients of its quantity.
pub(super) trait Watcher<S> {
    fn watch(&mut self, kind: RigGuard, coefficient: impl Fn(usize) -> S);
}

/// Collects the series of all guards, without derivatives.
struct Collection<'a> {
    guards: &'a mut Vec<Guard<RigGuard>>,
    order: usize,
}

impl<S: Scalar> Watcher<S> for Collection<'_> {
    #[inline]
    fn watch(&mut self, kind: RigGuard, coefficient: impl Fn(usize) -> S) {
        let mut series = [0.0; TERMS];
        for (k, c) in series.iter_mut().enumerate().take(self.order + 1) {
            *c = coefficient(k).value();
        }
        self.guards.push(Guard { kind, series });
    }
}

/// Finds the present value of one guard.
struct Present<S> {
    wanted: RigGuard,
    value: S,
}

impl<S: Scalar> Watcher<S> for Present<S> {
    fn watch(&mut self, kind: RigGuard, coefficient: impl Fn(usize) -> S) {
        if kind == self.wanted {
            self.value = coefficient(0);
        }
    }
}

impl<S: Scalar> Rig<S> {
    /// Collects the guards of `mode` from the series just computed.
    pub(super) fn set_guards(&self, mode: &RigMode, jet: &mut RigJet<S>) {
        let mut guards = std::mem::take(&mut jet.guards);
        guards.clear();
        let mut collection = Collection {
            guards: &mut guards,
            order: jet.order,
        };
        self.watch(mode, jet, &mut collection);
        jet.guards = guards;
    }

    /// Quantity that `guard` watches in `mode` at the start of the segment in `jet`.
    pub(super) fn guard_value(&self, mode: &RigMode, guard: RigGuard, jet: &RigJet<S>) -> S {
        let mut present = Present {
            wanted: guard,
            value: S::ZERO,
        };
        self.watch(mode, jet, &mut present);
        present.value
    }

    pub(super) fn watch(&self, mode: &RigMode, jet: &RigJet<S>, watcher: &mut impl Watcher<S>) {
        let RigJet {
            states,
            disc,
            disc1,
            motor_torque,
            order,
            ..
        } = jet;
        let bristle = |place: usize| {
            self.effects.presliding.as_ref().map(|presliding| Bristle {
                presliding,
                deflection: &states[place],
                order: *order,
            })
        };
        pin_guards(
            Contact::Disc,
            mode.disc,
            &self.law,
            &states[OMEGA],
            disc,
            mode.near[0],
            bristle(BRISTLE),
            watcher,
        );
        if let (Some(disc1), Some(pin)) = (&self.disc1, disc1.as_ref()) {
            pin_guards(
                Contact::Disc1,
                mode.disc1,
                &disc1.law,
                &states[OMEGA1],
                pin,
                mode.near[1],
                bristle(BRISTLE1),
                watcher,
            );
        }
        match mode.motor {
            ContactMode::Stuck => {
                let limit = self.gearbox.ratio * self.motor.coulomb_torque;
                for direction in [Direction::Forward, Direction::Backward] {
                    let sign = direction.sign();
                    watcher.watch(RigGuard::Breakaway(Contact::Motor, direction), |k| {
                        let held = motor_torque[k] * -sign;
                        if k == 0 { limit + held } else { held }
                    });
                }
            }
            ContactMode::Breaking(direction) | ContactMode::Slipping(direction, _) => {
                let sign = direction.sign();
                watcher.watch(RigGuard::Rest(Contact::Motor), |k| states[OMEGA3][k] * sign);
            }
        }
        let equations = jet
            .effects
            .as_ref()
            .and_then(|work| work.equations.as_ref());
        if let Some(work) = equations {
            self.equations
                .watch_branches(&mode.branches, work, |place, upwards, coefficient| {
                    watcher.watch(RigGuard::Branch(place as u8, upwards), coefficient);
                });
        }
        if let Some(backlash) = &self.effects.backlash {
            let half = backlash.gap * 0.5;
            let distance = |sign: f64, inward: f64| {
                move |k: usize| {
                    let value = (states[THETA][k] - states[THETA3][k]) * sign;
                    let value = if k == 0 { value - half } else { value };
                    value * inward
                }
            };
            match mode.coupling {
                Coupling::Ahead => {
                    let f = distance(1.0, 1.0);
                    watcher.watch(RigGuard::Play(Coupling::Free), f);
                }
                Coupling::Behind => {
                    let f = distance(-1.0, 1.0);
                    watcher.watch(RigGuard::Play(Coupling::Free), f);
                }
                Coupling::Free => {
                    let f = distance(1.0, -1.0);
                    watcher.watch(RigGuard::Play(Coupling::Ahead), f);
                    let f = distance(-1.0, -1.0);
                    watcher.watch(RigGuard::Play(Coupling::Behind), f);
                }
            }
        }
    }
}

#[allow(clippy::too_many_arguments)]
fn pin_guards<S: Scalar>(
    contact: Contact,
    mode: ContactMode,
    law: &Law<S>,
    omega: &Series<S>,
    pin: &PinJet<S>,
    near: f64,
    bristle: Option<Bristle<'_, S>>,
    watcher: &mut impl Watcher<S>,
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
        watcher.watch(RigGuard::Load(contact), |k| moving[k] * sign);
    }
    if let (Some(bristle), ContactMode::Stuck | ContactMode::Breaking(_)) = (bristle, mode) {
        return bristle_guards(contact, mode, bristle, omega, pin, watcher);
    }
    match mode {
        ContactMode::Stuck => {
            for direction in [Direction::Forward, Direction::Backward] {
                let sign = direction.sign();
                watcher.watch(RigGuard::Breakaway(contact, direction), |k| {
                    pin.breakaway[k] + pin.resisting[k] * sign
                });
            }
        }
        ContactMode::Breaking(direction) => {
            let sign = direction.sign();
            watcher.watch(RigGuard::LeaveBand(contact, direction), |k| {
                at_zero(k, band) - omega[k] * sign
            });
            watcher.watch(RigGuard::Calm(contact), |k| {
                -(pin.resisting[k] * sign) - pin.breakaway[k]
            });
        }
        ContactMode::Slipping(direction, regime) => {
            watcher.watch(RigGuard::Rest(contact), |k| {
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
                    watcher.watch(kind, |k| at_zero(k, S::constant(-1.0)));
                } else {
                    watcher.watch(kind, |k| pin.slip.acceleration[k] * earlier.sign());
                }
                return;
            }
            // While the speed is held the reaction lies between the two branches.
            let branch = |k: usize, level: &Series<S>| convolution(&pin.load[..=k], &level[..=k]);
            watcher.watch(RigGuard::Release(contact, Direction::Forward), |k| {
                branch(k, &pin.slip.level) + at_zero(k, pin.constant_torque) - pin.slip.torque[k]
            });
            watcher.watch(RigGuard::Release(contact, Direction::Backward), |k| {
                pin.slip.torque[k]
                    - branch(k, &pin.slip.lower_level)
                    - at_zero(k, pin.constant_torque)
            });
        }
    }
}
