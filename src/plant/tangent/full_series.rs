//! Derivatives of a segment whose series carries the fast modes.

use super::motion::{LOWEST_ORDER, Tangent};
use super::parameter_forcing::{ON_CIRCUIT, ON_DISC, ON_DISC_1, ON_MOTOR};
use super::pin::PinTangent;
use crate::plant::index::{CURRENT, OMEGA, OMEGA1, OMEGA3, THETA, THETA1, THETA3};
use crate::plant::slow_manifold::DiscMotion;
use crate::plant::{Rig, RigInputs, RigJet, RigMode, RigState};
use crate::series::{RECIPROCAL, Scalar, Series, TERMS};

impl<S: Scalar> Rig<S> {
    /// As `expand_plain` by a motion without derivatives and its variational equations; `false`,
    /// with nothing done, where that is not possible.
    pub(in crate::plant) fn expand_tangent(
        &self,
        mode: &RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        order: usize,
        jet: &mut RigJet<S>,
    ) -> bool {
        if order < LOWEST_ORDER {
            return false;
        }
        let Some(mut tangent) = jet.tangent.take() else {
            return false;
        };
        tangent.rig.expand_motion(
            mode,
            time.value(),
            &state.map(S::value),
            &inputs.to_scalar(),
            order,
            &mut tangent.jet,
        );
        tangent.linearise(mode, inputs, (order, order + 1), jet);
        if tangent.rig.disc1.is_some() {
            tangent.vary::<true>(mode, order, jet);
        } else {
            tangent.vary::<false>(mode, order, jet);
        }
        tangent.judge_full(order, jet);
        jet.tangent = Some(tangent);
        true
    }
}

impl<S: Scalar> Tangent<S> {
    /// Fills `jet` up to `order` with the motion and its derivatives.
    fn vary<const FULL: bool>(&mut self, mode: &RigMode, order: usize, jet: &mut RigJet<S>) {
        let Self {
            jet: plain,
            pins,
            forcing,
            accelerations,
            ..
        } = self;
        let parts = &plain.parts;
        let (stiffness, damping) = (parts.stiffness, parts.damping);
        let (stiffness_1, damping_1) = (parts.stiffness_1, parts.damping_1);
        let on_motor = parts.inverse_motor_inertia;
        let on_circuit = parts.inverse_inductance;
        let motor_turns = !mode.motor.is_stuck();
        let x = &mut jet.states;
        let [accelerations, accelerations_1] = &mut **accelerations;
        for k in 0..=order.min(TERMS - 2) {
            let per_next = RECIPROCAL[k + 1];
            let (twist, rate) = (x[THETA][k] - x[THETA3][k], x[OMEGA][k] - x[OMEGA3][k]);
            let shaft = S::combined([(stiffness, &twist), (damping, &rate)]);
            let mut on_disc = S::ZERO;
            if FULL {
                let (twist, rate) = (x[THETA1][k] - x[THETA][k], x[OMEGA1][k] - x[OMEGA][k]);
                on_disc = S::combined([(stiffness_1, &twist), (damping_1, &rate)]);
                let torques = S::combined([
                    (-parts.inverse_inertia_1, &on_disc),
                    (1.0, &forcing[ON_DISC_1][k]),
                ]);
                let acceleration =
                    pins[1].acceleration(k, torques, &x[THETA1], &x[OMEGA1], accelerations_1);
                x[OMEGA1][k + 1] = S::combined([(per_next, &acceleration)]);
                x[THETA1][k + 1] = S::combined([(per_next, &x[OMEGA1][k])]);
            }
            let torques = S::combined([
                (-parts.inverse_inertia, &shaft),
                (parts.inverse_inertia, &on_disc),
                (1.0, &forcing[ON_DISC][k]),
            ]);
            let acceleration =
                pins[0].acceleration(k, torques, &x[THETA], &x[OMEGA], accelerations);
            x[OMEGA][k + 1] = S::combined([(per_next, &acceleration)]);
            x[OMEGA3][k + 1] = if motor_turns {
                S::combined([
                    (on_motor * per_next, &shaft),
                    (
                        on_motor * parts.current_to_torque * per_next,
                        &x[CURRENT][k],
                    ),
                    (-on_motor * parts.motor_damping * per_next, &x[OMEGA3][k]),
                    (per_next, &forcing[ON_MOTOR][k]),
                ])
            } else {
                S::ZERO
            };
            x[CURRENT][k + 1] = S::combined([
                (-on_circuit * parts.resistance * per_next, &x[CURRENT][k]),
                (-on_circuit * parts.back_emf * per_next, &x[OMEGA3][k]),
                (per_next, &forcing[ON_CIRCUIT][k]),
            ]);
            x[THETA][k + 1] = S::combined([(per_next, &x[OMEGA][k])]);
            x[THETA3][k + 1] = S::combined([(per_next, &x[OMEGA3][k])]);
            let used = if FULL { OMEGA1 } else { CURRENT };
            for (series, plain) in x[..=used].iter_mut().zip(&plain.states) {
                series[k + 1].set_value(plain[k + 1]);
            }
        }
    }
}

impl PinTangent {
    pub fn is_driven(&self) -> bool {
        self.motion == DiscMotion::Driven
    }

    /// Derivatives of coefficient `k` of the disc's acceleration from `torques`, what everything but the
    /// friction's own slopes makes of it; also left in `accelerations`.
    #[inline(always)]
    fn acceleration<S: Scalar>(
        &self,
        k: usize,
        torques: S,
        theta: &Series<S>,
        omega: &Series<S>,
        accelerations: &mut Series<S>,
    ) -> S {
        match self.motion {
            DiscMotion::Kept => S::ZERO,
            DiscMotion::Stuck => S::combined([(-self.decay, &omega[k])]),
            DiscMotion::Driven => {
                let mut acceleration = torques;
                if let Some(slope) = &self.by_velocity {
                    acceleration += S::filtered(&slope[..=k], &omega[..=k]);
                }
                if let Some(slope) = &self.by_angle {
                    acceleration += S::filtered(&slope[..=k], &theta[..=k]);
                }
                if let Some(slope) = &self.by_acceleration {
                    acceleration += S::filtered(&slope[1..=k], &accelerations[..k]);
                    acceleration = S::combined([(self.inverse_margin, &acceleration)]);
                    accelerations[k] = acceleration;
                }
                acceleration
            }
        }
    }
}
