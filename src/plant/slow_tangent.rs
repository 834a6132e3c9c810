//! Derivatives of a segment on the slow manifold.
//!
//! Chang's coordinates serve the derivatives as they serve the motion; being a mere choice of
//! coordinates, they need no derivatives of their own. What parameters owe enters as a forcing in
//! physical coordinates, transformed once and then used in both passes.

use super::expansion::RigJet;
use super::index::{self, OMEGA, OMEGA1, OMEGA3, THETA, THETA1, THETA3};
use super::linear_parts::LinearParts;
use super::slow_manifold::{CURRENT, DISC, DISC_1, MOTOR, Regimes, SlowManifold, TWIST, TWIST_1};
use super::slow_motion::SlowMotion;
use super::tangent::{ACCURACY, PinTangent, Tangent, motor_sign, moved_torque, shaft};
use super::{INPUT_TERMS, RigInputs, RigMode, RigState};
use crate::series::{RECIPROCAL, Scalar, Series, TERMS};

/// The transformations of the rig, and what the parameters do while the motion is held, order by order.
#[derive(Clone, Debug)]
pub(super) struct Owed<S, const N: usize> {
    manifolds: Vec<(Regimes, Option<SlowManifold<f64, N>>)>,
    /// Forcing of the transformed slow and fast variables, without the friction torques'.
    slow: [[S; N]; TERMS],
    fast: [[S; 2]; TERMS],
    /// Friction torques on D2 and D1.
    torque: [Series<S>; 2],
}

impl<S: Scalar, const N: usize> Owed<S, N> {
    pub fn new() -> Self {
        Self {
            manifolds: Vec::with_capacity(4),
            slow: [[S::ZERO; N]; TERMS],
            fast: [[S::ZERO; 2]; TERMS],
            torque: [[S::ZERO; TERMS]; 2],
        }
    }

    /// The transformation for `regimes`.
    pub fn manifold(
        &mut self,
        parts: &LinearParts<f64>,
        regimes: Regimes,
    ) -> Option<SlowManifold<f64, N>> {
        let known = self.manifolds.iter().position(|(r, _)| *r == regimes);
        let place = known.unwrap_or_else(|| {
            self.manifolds
                .push((regimes, SlowManifold::new(parts, &regimes)));
            self.manifolds.len() - 1
        });
        self.manifolds[place].1.clone()
    }
}

/// A segment whose motion is known and whose derivatives are wanted.
pub(super) struct SlowVariation<'a, S, const N: usize> {
    pub mode: &'a RigMode,
    pub inputs: &'a RigInputs<S>,
    pub tangent: &'a Tangent<S>,
    pub manifold: &'a SlowManifold<f64, N>,
    pub disc: &'a PinTangent<S>,
    pub disc1: Option<&'a PinTangent<S>>,
    /// Orders that the motion's own second pass corrected.
    pub corrected: usize,
}

impl<S: Scalar, const N: usize> SlowVariation<'_, S, N> {
    const FULL: bool = N > DISC_1;

    /// Fills `jet` if the derivatives of `state` lie on the slow manifold; whether they do.
    pub fn expand(
        &self,
        state: &RigState<S>,
        order: usize,
        tolerance: f64,
        work: &mut SlowMotion<S, N>,
        owed: &mut Owed<S, N>,
        jet: &mut RigJet<S>,
    ) -> bool {
        let top = self.tangent.orders(order);
        let mut slow = [S::ZERO; N];
        slow[TWIST] = state[THETA] - state[THETA3];
        slow[DISC] = state[OMEGA];
        if Self::FULL {
            slow[TWIST_1] = state[THETA1] - state[THETA];
            slow[DISC_1] = state[OMEGA1];
        }
        let l = &self.manifold.fast_from_slow;
        let mut fast = [state[OMEGA3], state[index::CURRENT]];
        for (fast, row) in fast.iter_mut().zip(l) {
            *fast -= S::weighted(row, &slow);
        }
        for (slow, row) in slow.iter_mut().zip(&self.manifold.slow_from_fast) {
            *slow -= S::weighted(row, &fast);
        }
        self.owe(top, owed, jet);
        work.slow[0] = slow;
        work.fast[..=top + 1].fill([S::ZERO; 2]);
        work.fast[0] = fast;
        self.pass(0..top + 1, work, owed, jet);
        self.follow(top, work);
        let corrected = self
            .corrected
            .saturating_sub(self.tangent.spared)
            .min(top + 1);
        if corrected > 0 {
            self.pass(0..corrected, work, owed, jet);
            self.follow(corrected - 1, work);
        }
        let missed = [work.fast[0][0] - fast[0], work.fast[0][1] - fast[1]];
        if !S::derivatives_vanish(&missed, state, tolerance.max(ACCURACY)) {
            return false;
        }
        self.assemble(top, order, work, jet);
        true
    }

    /// What the parameters owe, up to order `top`.
    fn owe(&self, top: usize, owed: &mut Owed<S, N>, jet: &RigJet<S>) {
        let (x, rates) = (&self.tangent.jet.states, &self.tangent.rates);
        let motor_sign = motor_sign(self.mode);
        let (l, h) = (&self.manifold.fast_from_slow, &self.manifold.slow_from_fast);
        for k in 0..=top {
            let (twist, rate) = (x[THETA][k] - x[THETA3][k], x[OMEGA][k] - x[OMEGA3][k]);
            let mut on_slow = [S::ZERO; N];
            if let PinTangent::Stuck { decay, .. } = self.disc {
                on_slow[DISC] = S::combined([(-x[OMEGA][k], decay)]);
            } else {
                let plain = &self.tangent.jet.disc;
                owed.torque[0][k] = self.disc.owed_torque(k, &x[OMEGA], plain);
                let [k2, c2, by_inertia] = &rates.disc;
                let outside = if k == 0 {
                    self.inputs.disc_torque
                } else {
                    S::ZERO
                };
                on_slow[DISC] = S::combined([
                    (-twist, k2),
                    (-rate, c2),
                    (outside.value() - plain.torque[k], by_inertia),
                    (by_inertia.value(), &outside),
                ]);
            }
            if let (Some(pin), Some(plain)) = (self.disc1, &self.tangent.jet.disc1) {
                let (twist, rate) = (x[THETA1][k] - x[THETA][k], x[OMEGA1][k] - x[OMEGA][k]);
                if !matches!(self.disc, PinTangent::Stuck { .. }) {
                    let [k1, c1] = &rates.from_disc1;
                    on_slow[DISC] += S::combined([(twist, k1), (rate, c1)]);
                }
                if let PinTangent::Stuck { decay, .. } = pin {
                    on_slow[DISC_1] = S::combined([(-x[OMEGA1][k], decay)]);
                } else {
                    owed.torque[1][k] = pin.owed_torque(k, &x[OMEGA1], plain);
                    let [k1, c1, by_inertia] = &rates.disc1;
                    on_slow[DISC_1] =
                        S::combined([(-twist, k1), (-rate, c1), (-plain.torque[k], by_inertia)]);
                }
            }
            let [k2, c2, torque, damping, by_inertia] = &rates.motor;
            let mut on_fast = [S::ZERO; 2];
            if let Some(sign) = motor_sign {
                on_fast[MOTOR] = S::combined([
                    (twist, k2),
                    (rate, c2),
                    (x[index::CURRENT][k], torque),
                    (-x[OMEGA3][k], damping),
                ]);
                if k == 0 {
                    let net = self.inputs.motor_torque - jet.parts.motor_coulomb * sign;
                    on_fast[MOTOR] +=
                        S::combined([(net.value(), by_inertia), (by_inertia.value(), &net)]);
                }
            }
            let [circuit, resistance, back_emf] = &rates.circuit;
            on_fast[CURRENT] = S::combined([
                (-x[index::CURRENT][k], resistance),
                (-x[OMEGA3][k], back_emf),
            ]);
            if k < INPUT_TERMS {
                let voltage = &jet.voltage[k];
                on_fast[CURRENT] +=
                    S::combined([(voltage.value(), circuit), (circuit.value(), voltage)]);
            }
            for (fast, row) in on_fast.iter_mut().zip(l) {
                *fast -= S::weighted(row, &on_slow);
            }
            for (slow, row) in on_slow.iter_mut().zip(h) {
                *slow -= S::weighted(row, &on_fast);
            }
            (owed.slow[k], owed.fast[k]) = (on_slow, on_fast);
        }
    }

    /// Orders `range` of the slow variables and the friction, with the fast ones as they are known.
    fn pass(
        &self,
        range: std::ops::Range<usize>,
        work: &mut SlowMotion<S, N>,
        owed: &Owed<S, N>,
        jet: &mut RigJet<S>,
    ) {
        let plain = &self.tangent.jet;
        let (l, h) = (&self.manifold.fast_from_slow, &self.manifold.slow_from_fast);
        let answer = |disc: usize, by_inertia: f64| -> [f64; N] {
            std::array::from_fn(|j| {
                let direct = if j == disc { 1.0 } else { 0.0 };
                by_inertia * (direct + (h[j][0] * l[0][disc] + h[j][1] * l[1][disc]))
            })
        };
        let by_inertia = self.tangent.rates.disc[2].value();
        let by_inertia_1 = self.tangent.rates.disc1[2].value();
        let from_disc = answer(DISC, by_inertia);
        let from_disc1 = if Self::FULL {
            answer(DISC_1, by_inertia_1)
        } else {
            [0.0; N]
        };
        for k in range {
            let per_next = RECIPROCAL[k + 1];
            let (now, later) = work.slow[k..].split_at_mut(1);
            let (slow, fast) = (&now[0], &work.fast[k]);
            let velocity = |disc: usize| {
                S::combined([
                    (1.0, &slow[disc]),
                    (h[disc][0], &fast[0]),
                    (h[disc][1], &fast[1]),
                ])
            };
            jet.states[OMEGA][k] = velocity(DISC).with_value(plain.states[OMEGA][k]);
            let torque = match self.disc {
                PinTangent::Stuck { .. } => S::ZERO,
                pin => {
                    jet.disc.torque[k] =
                        moved_torque(k, owed.torque[0][k], pin, &jet.states[OMEGA], &plain.disc);
                    jet.disc.torque[k]
                }
            };
            let mut torque_1 = S::ZERO;
            if Self::FULL {
                jet.states[OMEGA1][k] = velocity(DISC_1).with_value(plain.states[OMEGA1][k]);
                if let (Some(pin), Some(plain), Some(pin_jet)) =
                    (self.disc1, &plain.disc1, jet.disc1.as_mut())
                    && !matches!(pin, PinTangent::Stuck { .. })
                {
                    pin_jet.torque[k] =
                        moved_torque(k, owed.torque[1][k], pin, &jet.states[OMEGA1], plain);
                    torque_1 = pin_jet.torque[k];
                }
            }
            for j in 0..N {
                let row = self.manifold.slow[j].map(|a| a * per_next);
                let mut next = S::weighted(&row, slow);
                next += S::combined([
                    (per_next, &owed.slow[k][j]),
                    (-from_disc[j] * per_next, &torque),
                ]);
                if Self::FULL {
                    next += S::combined([(-from_disc1[j] * per_next, &torque_1)]);
                }
                later[0][j] = next;
            }
            for f in 0..2 {
                let mut forcing =
                    S::combined([(1.0, &owed.fast[k][f]), (l[f][DISC] * by_inertia, &torque)]);
                if Self::FULL {
                    forcing += S::combined([(l[f][DISC_1] * by_inertia_1, &torque_1)]);
                }
                work.forcing[k][f] = forcing;
            }
        }
    }

    /// The fast variables without transient, from order `top` downwards.
    fn follow(&self, top: usize, work: &mut SlowMotion<S, N>) {
        let inverse = &self.manifold.fast_inverse;
        for k in (0..=top).rev() {
            let (next, forcing) = (work.fast[k + 1], work.forcing[k]);
            let scale = (k + 1) as f64;
            for j in 0..2 {
                let [a, b] = inverse[j];
                work.fast[k][j] = S::combined([
                    (a * scale, &next[0]),
                    (b * scale, &next[1]),
                    (-a, &forcing[0]),
                    (-b, &forcing[1]),
                ]);
            }
        }
    }

    /// Puts all series into `jet` once the transformed variables are known.
    fn assemble(&self, top: usize, order: usize, work: &SlowMotion<S, N>, jet: &mut RigJet<S>) {
        let plain = &self.tangent.jet;
        let (l, h) = (&self.manifold.fast_from_slow, &self.manifold.slow_from_fast);
        let motor_rests = motor_sign(self.mode).is_none();
        let used: &[usize] = if Self::FULL {
            &[THETA, OMEGA, THETA3, OMEGA3, index::CURRENT, THETA1, OMEGA1]
        } else {
            &[THETA, OMEGA, THETA3, OMEGA3, index::CURRENT]
        };
        let x = &mut jet.states;
        let parts = &jet.parts;
        for k in 0..=top {
            let per_next = RECIPROCAL[k + 1];
            let fast = &work.fast[k];
            let mut s = work.slow[k];
            for (s, row) in s.iter_mut().zip(h) {
                *s += S::weighted(row, fast);
            }
            x[OMEGA][k] = s[DISC];
            x[OMEGA3][k] = fast[MOTOR] + S::weighted(&l[MOTOR], &s);
            x[index::CURRENT][k] = fast[CURRENT] + S::weighted(&l[CURRENT], &s);
            if k == 0 {
                x[THETA3][0] = x[THETA][0] - s[TWIST];
            }
            x[THETA][k + 1] = s[DISC] * per_next;
            x[THETA3][k + 1] = x[OMEGA3][k] * per_next;
            if Self::FULL {
                x[OMEGA1][k] = s[DISC_1];
                if k == 0 {
                    x[THETA1][0] = x[THETA][0] + s[TWIST_1];
                }
                x[THETA1][k + 1] = s[DISC_1] * per_next;
            }
            for &index in used {
                x[index][k].set_value(plain.states[index][k]);
            }
            let first = |torque: S| if k == 0 { torque } else { S::ZERO };
            let outer_torque = || {
                let twist = x[THETA1][k] - x[THETA][k];
                let rate = x[OMEGA1][k] - x[OMEGA][k];
                shaft(&twist, &rate, &parts.stiffness_1, &parts.damping_1)
            };
            let shaft_torque = || {
                let twist = x[THETA][k] - x[THETA3][k];
                let rate = x[OMEGA][k] - x[OMEGA3][k];
                shaft(&twist, &rate, &parts.stiffness, &parts.damping)
            };
            if let (Some(pin), Some(plain), Some(pin_jet)) =
                (self.disc1, &plain.disc1, jet.disc1.as_mut())
            {
                pin.reaction(
                    k,
                    outer_torque,
                    &parts.inertia_1,
                    &x[OMEGA1],
                    plain,
                    pin_jet,
                );
            }
            let resisting = || {
                let mut torque = shaft_torque() - first(self.inputs.disc_torque);
                if Self::FULL {
                    torque -= outer_torque();
                }
                torque
            };
            let disc_jet = &mut jet.disc;
            self.disc.reaction(
                k,
                resisting,
                &parts.inertia,
                &x[OMEGA],
                &plain.disc,
                disc_jet,
            );
            let held = if motor_rests {
                let current = &x[index::CURRENT][k];
                S::combined([
                    (1.0, &shaft_torque()),
                    (parts.current_to_torque.value(), current),
                    (current.value(), &parts.current_to_torque),
                    (1.0, &first(self.inputs.motor_torque)),
                ])
            } else {
                let sign = motor_sign(self.mode).unwrap_or(1.0);
                first(parts.motor_coulomb * sign)
            };
            jet.motor_torque[k] = held.with_value(plain.motor_torque[k]);
        }
        self.tangent.beyond(top, order, jet);
    }
}
