//! What the effects add to the torques and to the load, order by order.

use super::bodies::Bodies;
use super::index::{RELAXING_TORQUE, THETA, THETA1, THETA3};
use super::jet::{Disc1EffectJet, EffectJet, TurnJet};
use super::{Disc1Effects, QuadraticDrag, STATES, Unbalance, ViscousDrag};
use crate::friction::{ContactMode, HARMONICS, RandomFunction};
use crate::series::{RECIPROCAL, Scalar, Series, convolution, cosine_sine};

impl<S: Scalar> Bodies<'_, S> {
    pub fn effect_shaft_torque(
        &self,
        k: usize,
        twist_rate: S,
        x: &mut [Series<S>; STATES],
        next: usize,
        per_next: f64,
        work: &mut EffectJet<S>,
    ) -> S {
        let mut torque = S::ZERO;
        if let Some(hardening) = &self.rig.effects.shaft_hardening {
            let twist = &work.elastic_twist[..=k];
            work.twist_square[k] = convolution(twist, twist);
            torque += hardening.cubic_stiffness * convolution(&work.twist_square[..=k], twist);
        }
        if let Some(hysteresis) = &self.rig.effects.shaft_hysteresis {
            let relaxing = x[RELAXING_TORQUE][k];
            torque += relaxing;
            x[RELAXING_TORQUE][next] = (hysteresis.stiffness * twist_rate
                - relaxing / hysteresis.relaxation_time)
                * per_next;
        }
        torque
    }

    pub fn effect_motor_torque(
        &self,
        k: usize,
        x: &[Series<S>; STATES],
        work: &mut EffectJet<S>,
    ) -> S {
        let Some(ripple) = &self.rig.effects.gear_ripple else {
            return S::ZERO;
        };
        let cycles = ripple.order * self.ratio;
        work.weighted_motor_angle[k] = cycles * x[THETA3][k] * k as f64;
        let (c, s) = if k == 0 {
            let (s, c) = (cycles * x[THETA3][0] + ripple.phase).sin_cos();
            (c, s)
        } else {
            cosine_sine(
                k,
                &work.weighted_motor_angle,
                &work.motor_cosine,
                &work.motor_sine,
            )
        };
        (work.motor_cosine[k], work.motor_sine[k]) = (c, s);
        self.ratio * ripple.torque * s
    }

    /// Coefficient `k` of the load under the factors that vary with angle and time.
    pub fn effect_load(
        &self,
        k: usize,
        time: S,
        x: &[Series<S>; STATES],
        load: &mut Series<S>,
        work: &mut EffectJet<S>,
    ) {
        let effects = &self.rig.effects;
        let one = if k == 0 { S::constant(1.0) } else { S::ZERO };
        let mut coefficient = work.base_load[k];
        let wobble = effects.normal_force_wobble.as_ref();
        if let Some(wobble) = wobble.filter(|_| !self.rig.law.is_torque()) {
            let (sin, cos) = wobble.phase.sin_cos();
            work.factor[k] =
                one + wobble.amplitude * (work.turn.cosine[k] * cos + work.turn.sine[k] * sin);
            coefficient = convolution(&work.base_load[..=k], &work.factor[..=k]);
        }
        if let Some(position) = &effects.position_friction {
            // The load so far must be kept as a series to be multiplied again.
            work.scratch[k] = coefficient;
            work.turn.weighted_angle[k] = x[THETA][k] * k as f64;
            let (c, s) = if k == 0 {
                let (s, c) = (x[THETA][0] * 2.0 - position.phase).sin_cos();
                (c, s)
            } else {
                let (c, s) = cosine_sine(
                    k,
                    &work.turn.weighted_angle,
                    &work.second_cosine,
                    &work.second_sine,
                );
                (c * 2.0, s * 2.0)
            };
            (work.second_cosine[k], work.second_sine[k]) = (c, s);
            coefficient = work.scratch[k]
                + position.amplitude * convolution(&work.scratch[..=k], &work.second_cosine[..=k]);
        }
        if let (Some(noise), Some(random)) = (&effects.stochastic_friction, &self.random) {
            work.steady_load[k] = coefficient;
            let correlation_time = noise.correlation_time;
            let stretch = S::constant(correlation_time.value()) / correlation_time;
            work.noise[k] =
                one + noise.standard_deviation * random_coefficient(random, stretch, k, time);
            coefficient = convolution(&work.steady_load[..=k], &work.noise[..=k]);
        }
        load[k] = coefficient;
    }
}

/// What acts on one disc beside its shafts and its pin.
pub(super) struct OnDisc<'a, S> {
    /// Whether an effect depends on the cosine and sine of the disc's angle.
    pub turns: bool,
    pub unbalance: Option<&'a Unbalance<S>>,
    pub viscous_drag: Option<&'a ViscousDrag<S>>,
    pub quadratic_drag: Option<&'a QuadraticDrag<S>>,
    /// Whether bristles that give way do so against the disc's motion.
    pub has_bristles: bool,
}

impl<S: Scalar> OnDisc<'_, S> {
    /// Coefficient `k` of the torque on a disc with this motion; cosine and sine of its angle are left in `turn`, which is
    /// there if anything depends on them.
    #[inline]
    pub fn torque(
        &self,
        k: usize,
        mode: ContactMode,
        (theta, omega): (&Series<S>, &Series<S>),
        turn: Option<&mut TurnJet<S>>,
    ) -> S {
        let mut torque = S::ZERO;
        if let Some(turn) = turn {
            turn.weighted_angle[k] = theta[k] * k as f64;
            let (c, s) = if k == 0 {
                let (s, c) = theta[0].sin_cos();
                (c, s)
            } else {
                cosine_sine(k, &turn.weighted_angle, &turn.cosine, &turn.sine)
            };
            (turn.cosine[k], turn.sine[k]) = (c, s);
            if let Some(unbalance) = self.unbalance {
                let (sin, cos) = unbalance.phase.sin_cos();
                torque -= unbalance.torque * (c * cos + s * sin);
            }
        }
        if let Some(drag) = self.viscous_drag {
            torque -= drag.coefficient * omega[k];
        }
        let moving = match mode {
            ContactMode::Slipping(direction, _) => Some(direction),
            ContactMode::Breaking(direction) if !self.has_bristles => Some(direction),
            ContactMode::Breaking(_) | ContactMode::Stuck => None,
        };
        if let (Some(drag), Some(direction)) = (self.quadratic_drag, moving) {
            let square = convolution(&omega[..=k], &omega[..=k]);
            torque -= drag.coefficient * square * direction.sign();
        }
        torque
    }
}

impl<S: Scalar> Disc1Effects<S> {
    /// Coefficient `k` of what the effects add to the torque of shaft 1.
    pub(super) fn shaft_torque(
        &self,
        k: usize,
        x: &[Series<S>; STATES],
        work: &mut Disc1EffectJet<S>,
    ) -> S {
        let Some(hardening) = &self.shaft_hardening1 else {
            return S::ZERO;
        };
        work.twist[k] = x[THETA1][k] - x[THETA][k];
        let twist = &work.twist[..=k];
        work.twist_square[k] = convolution(twist, twist);
        hardening.cubic_stiffness * convolution(&work.twist_square[..=k], twist)
    }

    /// Coefficient `k` of the load on D1 under a normal force that varies with its angle.
    pub(super) fn vary_load(&self, k: usize, work: &mut Disc1EffectJet<S>, load: &mut Series<S>) {
        let Some(wobble) = &self.normal_force_wobble1 else {
            return;
        };
        let one = if k == 0 { S::constant(1.0) } else { S::ZERO };
        let (sin, cos) = wobble.phase.sin_cos();
        work.factor[k] =
            one + wobble.amplitude * (work.turn.cosine[k] * cos + work.turn.sine[k] * sin);
        load[k] = convolution(&work.base_load[..=k], &work.factor[..=k]);
    }
}

/// Coefficient `k` about `time` of a seeded random function of time. `stretch` is one; it carries the
/// derivatives of all rates.
fn random_coefficient<S: Scalar>(random: &RandomFunction, stretch: S, k: usize, time: S) -> S {
    let mut sum = S::ZERO;
    for &(rate, phase) in &random.harmonics[..HARMONICS] {
        let rate = stretch * rate;
        let (sin, cos) = (time * rate + phase).sin_cos();
        // The k-th derivative of a cosine is ω^k cos(… + k π/2).
        let wave = match k % 4 {
            0 => cos,
            1 => -sin,
            2 => -cos,
            _ => sin,
        };
        let mut term = wave;
        for j in 1..=k {
            term = term * rate * RECIPROCAL[j];
        }
        sum += term;
    }
    sum * RandomFunction::amplitude()
}
