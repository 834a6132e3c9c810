//! The rig's equations of motion as recurrences for Taylor coefficients (Eqs 4-4 and 4-5 put right).
//!
//! J2 dω2/dt = −c2 (ω2 − ω3) − k2 (θ2 − θ3) − T_f − …,
//! η² J_m dω3/dt = η (K_T i − C_m η ω3 − T_fm) + c2 (ω2 − ω3) + k2 (θ2 − θ3) + …,
//! L di/dt = u − R i − K_E η ω3; the full rig adds D1: J1 dω1/dt = −c1 (ω1 − ω2) − k1 (θ1 − θ2) − T_f1.

use super::index::{CURRENT, OMEGA, OMEGA1, OMEGA3, RELAXING_TORQUE, THETA, THETA1, THETA3};
use super::inputs::recentre;
use super::linear_parts::LinearParts;
use super::slow_motion::{LOWEST_ORDER, SlowMotion};
use super::tangent::Tangent;
use super::{Coupling, Rig, RigGuard, RigInputs, RigMode, RigState, STATES};
use crate::friction::{ContactMode, HARMONICS, Law, RandomFunction, Slip, SlipJet};
use crate::integrator::Guard;
use crate::series::{RECIPROCAL, Scalar, Series, TERMS, convolution, cosine_sine, evaluate};

/// Seconds over which the drifts of wear and of resistance are stated.
const MINUTE: f64 = 60.0;
/// Normal force [N] at which a load exponent changes nothing.
const REFERENCE_LOAD: f64 = 50.0;
/// Normal force [N] below which a load exponent sees none: a power is not analytic at zero.
const SMALLEST_POWER_LOAD: f64 = 1e-6;
/// Normal force [N] that is rounding where a moving force passes through zero.
const ROUNDING_OF_FORCE: f64 = 1e-9;

/// Series of one pin contact.
#[derive(Clone, Debug)]
pub(super) struct PinJet<S> {
    pub slip: SlipJet<S>,
    /// Normal force × radius [N m], or 1 for a law of the torque.
    pub load: Series<S>,
    /// Whether only order 0 of `load` differs from zero.
    pub load_is_constant: bool,
    /// j × coefficient j of −(slip speed)/(Stribeck velocity), and the exponential of that series.
    pub curve: [Series<S>; 2],
    /// Friction torque on the disc, signed.
    pub torque: Series<S>,
    /// Breakaway torque, ≥ 0.
    pub breakaway: Series<S>,
    /// All other torques that resist a positive rotation.
    pub resisting: Series<S>,
    /// Friction torque that does not depend on the normal force, ≥ 0.
    pub constant_torque: S,
    /// Normal force [N] and factor of wear, each when it changes in the course of the segment: the
    /// load vanishes while one is negative.
    pub moving: [Option<Box<Series<S>>>; 2],
}

impl<S: Scalar> PinJet<S> {
    fn new(law: &Law<S>) -> Self {
        let zero = [S::ZERO; TERMS];
        Self {
            slip: SlipJet::new(law),
            load: zero,
            load_is_constant: true,
            curve: [zero; 2],
            torque: zero,
            breakaway: zero,
            resisting: zero,
            constant_torque: S::ZERO,
            moving: [None, None],
        }
    }
}

/// Taylor coefficients of everything in the rig over one segment.
#[derive(Clone, Debug)]
pub struct RigJet<S> {
    pub(super) states: [Series<S>; STATES],
    pub(super) disc: PinJet<S>,
    /// Apart, so that the reduced rig does not carry it.
    pub(super) disc1: Option<Box<PinJet<S>>>,
    pub(super) motor_torque: Series<S>,
    pub(super) twist: Series<S>,
    pub(super) voltage: Series<S>,
    pub(super) voltage_is_constant: bool,
    pub(super) parts: LinearParts<S>,
    slow: SlowMotions<S>,
    /// For numbers with derivatives and rigs without effects.
    pub(super) tangent: Option<Box<Tangent<S>>>,
    /// Whether the motion of this segment is in `tangent`, and only the states' series are here.
    pub(super) follows_tangent: bool,
    pub(super) effects: Option<Box<EffectJet<S>>>,
    pub(super) guards: Vec<Guard<RigGuard>>,
    pub(super) order: usize,
    /// Orders that the second pass of the last segment on the slow manifold corrected.
    pub(super) corrected: usize,
}

/// Slow manifolds of the two rigs, by number of slow variables; `InUse` while one is at work.
#[derive(Clone, Debug)]
enum SlowMotions<S> {
    Reduced(Box<SlowMotion<S, 2>>),
    Full(Box<SlowMotion<S, 4>>),
    InUse,
}

/// Series that only the effects need.
#[derive(Clone, Debug)]
pub(super) struct EffectJet<S> {
    factor: Series<S>,
    scratch: Series<S>,
    weighted_angle: Series<S>,
    cosine: Series<S>,
    sine: Series<S>,
    second_cosine: Series<S>,
    second_sine: Series<S>,
    weighted_motor_angle: Series<S>,
    motor_cosine: Series<S>,
    motor_sine: Series<S>,
    elastic_twist: Series<S>,
    twist_square: Series<S>,
    base_load: Series<S>,
    power_load: Series<S>,
    steady_load: Series<S>,
    noise: Series<S>,
}

impl<S: Scalar> RigJet<S> {
    /// Empty series for `rig`.
    pub fn new(rig: &Rig<S>) -> Self {
        let zero = [S::ZERO; TERMS];
        let effects = rig.effects.act_on_motion().then(|| {
            Box::new(EffectJet {
                factor: zero,
                scratch: zero,
                weighted_angle: zero,
                cosine: zero,
                sine: zero,
                second_cosine: zero,
                second_sine: zero,
                weighted_motor_angle: zero,
                motor_cosine: zero,
                motor_sine: zero,
                elastic_twist: zero,
                twist_square: zero,
                base_load: zero,
                power_load: zero,
                steady_load: zero,
                noise: zero,
            })
        });
        let parts = LinearParts::new(rig);
        let tangent =
            (S::HAS_DERIVATIVES && effects.is_none()).then(|| Box::new(Tangent::new(rig, &parts)));
        Self {
            states: [zero; STATES],
            disc: PinJet::new(&rig.law),
            disc1: rig
                .outer
                .as_ref()
                .map(|outer| Box::new(PinJet::new(&outer.law))),
            motor_torque: zero,
            twist: zero,
            voltage: zero,
            voltage_is_constant: true,
            parts,
            tangent,
            follows_tangent: false,
            slow: if rig.outer.is_some() {
                SlowMotions::Full(Box::new(SlowMotion::new()))
            } else {
                SlowMotions::Reduced(Box::new(SlowMotion::new()))
            },
            effects,
            guards: Vec::new(),
            order: 0,
            corrected: 0,
        }
    }

    /// Friction torques on D2, on D1 (in the full rig) and inside the motor. Their derivatives are known
    /// only of expansions to orders below those of a run.
    pub(crate) fn torques(&self) -> (&[S], Option<&[S]>, &[S]) {
        let outer = self.disc1.as_ref();
        (
            &self.disc.torque[..=self.order],
            outer.map(|pin| &pin.torque[..=self.order]),
            &self.motor_torque[..=self.order],
        )
    }

    /// Friction torque on disc D2 [N m] at local time `tau` [s], without derivatives.
    pub fn friction_torque_at(&self, tau: f64) -> f64 {
        match self.motion() {
            Some((_, plain)) => evaluate(plain.friction_torque(), tau),
            None => evaluate(&self.disc.torque[..=self.order], S::constant(tau)).value(),
        }
    }

    /// The plain rig and its jet, where they carry the motion of this segment.
    pub(super) fn motion(&self) -> Option<(&Rig<f64>, &RigJet<f64>)> {
        let tangent = self.tangent.as_ref().filter(|_| self.follows_tangent)?;
        Some((&tangent.rig, &tangent.jet))
    }

    /// Smallest 1 + (∂T/∂a)/J of the discs' algebraic loops at the segment's start.
    pub fn loop_margin(&self) -> f64 {
        if let Some((_, plain)) = self.motion() {
            return plain.loop_margin();
        }
        let outer = self.disc1.as_ref().map_or(1.0, |pin| pin.slip.margin);
        self.disc.slip.margin.min(outer)
    }
}

impl RigJet<f64> {
    /// Friction torque on disc D2 [N m].
    pub fn friction_torque(&self) -> &[f64] {
        &self.disc.torque[..=self.order]
    }

    /// Friction torque on disc D1 [N m], in the full rig.
    pub fn friction_torque_1(&self) -> Option<&[f64]> {
        self.disc1.as_ref().map(|pin| &pin.torque[..=self.order])
    }

    /// Friction torque inside the motor, on the shaft side of the gearbox [N m].
    pub fn motor_friction_torque(&self) -> &[f64] {
        &self.motor_torque[..=self.order]
    }
}

impl<S: Scalar> Rig<S> {
    /// Fills `jet` with the coefficients of orders 0 to `order` of the motion that starts at `time`
    /// [s] from `state` in `mode`.
    pub fn expand_motion(
        &self,
        mode: &RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        order: usize,
        jet: &mut RigJet<S>,
    ) {
        let varying = self.start(time, state, inputs, order, jet);
        jet.follows_tangent = self.expand_tangent(mode, time, state, inputs, order, jet);
        if jet.follows_tangent {
            return;
        }
        if jet.effects.is_none() {
            self.expand_plain(mode, inputs, order, jet);
            self.set_guards(mode, jet);
            return;
        }
        let bodies = Bodies::new(self, mode, inputs);
        jet.disc.constant_torque = bodies.disc_slip.constant_torque;
        for k in 0..=order {
            bodies.expand_order(k, mode, time, varying, jet);
        }
        self.set_guards(mode, jet);
    }

    /// As [`Self::expand_motion`], on the slow manifold if `state` lies on it within `tolerance`;
    /// whether it does.
    #[allow(clippy::too_many_arguments)]
    pub fn expand_without_transients(
        &self,
        mode: &RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        order: usize,
        tolerance: f64,
        jet: &mut RigJet<S>,
    ) -> bool {
        if jet.effects.is_some() || order < LOWEST_ORDER || self.is_bistable() {
            return false;
        }
        self.start(time, state, inputs, order, jet);
        let mut motions = std::mem::replace(&mut jet.slow, SlowMotions::InUse);
        let found = match &mut motions {
            SlowMotions::Reduced(work) => {
                self.expand_settled(mode, time, state, inputs, order, tolerance, work, jet)
            }
            SlowMotions::Full(work) => {
                self.expand_settled(mode, time, state, inputs, order, tolerance, work, jet)
            }
            SlowMotions::InUse => false,
        };
        jet.slow = motions;
        jet.follows_tangent = found && jet.tangent.is_some();
        if found && !jet.follows_tangent {
            self.set_guards(mode, jet);
        }
        found
    }

    /// Whether a law holds or frees the slip velocity as the torques lie between or beyond its two
    /// branches: its switches ask for torques as exact as only the full series gives them.
    fn is_bistable(&self) -> bool {
        let wojewoda = |law: &Law<S>| matches!(law, Law::Wojewoda(_));
        wojewoda(&self.law)
            || self
                .outer
                .as_ref()
                .is_some_and(|outer| wojewoda(&outer.law))
    }

    /// Puts state and inputs into `jet`; whether effects make the load vary.
    fn start(
        &self,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        order: usize,
        jet: &mut RigJet<S>,
    ) -> bool {
        jet.order = order;
        for (series, &value) in jet.states.iter_mut().zip(state) {
            series[0] = value;
        }
        let offset = time - inputs.time;
        jet.voltage_is_constant = recentre(
            &inputs.voltage,
            offset,
            jet.voltage_is_constant,
            &mut jet.voltage,
        );
        let varying = self.effects.normal_force_wobble.is_some()
            || self.effects.position_friction.is_some()
            || self.effects.stochastic_friction.is_some();
        jet.disc.load_is_constant = self.start_load(inputs, time, offset, jet) && !varying;
        if let (Some(outer), Some(pin)) = (&self.outer, &mut jet.disc1) {
            let constant = recentre(
                &inputs.normal_force_1,
                offset,
                pin.load_is_constant,
                &mut pin.load,
            );
            pin.moving[0] = lift_off(&mut pin.load, constant, 0.0);
            scale(&mut pin.load, constant, outer.contact.radius);
            pin.load_is_constant = constant || outer.law.is_torque();
            if outer.law.is_torque() {
                pin.load = [S::ZERO; TERMS];
                pin.load[0] = S::constant(1.0);
            }
        }
        varying
    }

    /// Puts the normal force × radius before any factor that varies with angle or time into the
    /// jet; whether it is constant.
    fn start_load(&self, inputs: &RigInputs<S>, time: S, offset: S, jet: &mut RigJet<S>) -> bool {
        let pin = &mut jet.disc;
        let mut constant = true;
        if self.law.is_torque() {
            pin.load = [S::ZERO; TERMS];
            pin.load[0] = S::constant(1.0);
        } else {
            constant = recentre(
                &inputs.normal_force,
                offset,
                pin.load_is_constant,
                &mut pin.load,
            );
            if let Some(bias) = &self.effects.load_cell_bias {
                // A lifted pin reads zero whatever the offset is.
                if !constant || pin.load[0].value() != 0.0 {
                    pin.load[0] -= bias.bias;
                }
            }
            match (&self.effects.load_exponent, &mut jet.effects) {
                (Some(exponent), Some(work)) => {
                    pin.moving[0] = lift_off(&mut pin.load, constant, SMALLEST_POWER_LOAD);
                    if pin.load[0].value() > 0.0 {
                        power(exponent.exponent, constant, &mut pin.load, work);
                    }
                }
                _ => pin.moving[0] = lift_off(&mut pin.load, constant, 0.0),
            }
            scale(&mut pin.load, constant, self.contact.radius);
        }
        if let Some(wear) = &self.effects.friction_wear {
            let rate = wear.rate_per_minute * (1.0 / MINUTE);
            let mut factor = [S::ZERO; TERMS];
            (factor[0], factor[1]) = (rate * time + 1.0, rate);
            pin.moving[1] = lift_off(&mut factor, false, 0.0);
            for k in (0..TERMS).rev() {
                let earlier = if k > 0 { pin.load[k - 1] } else { S::ZERO };
                pin.load[k] = pin.load[k] * factor[0] + earlier * factor[1];
            }
            constant = false;
        }
        if let Some(work) = &mut jet.effects {
            work.base_load = pin.load;
        }
        constant
    }
}

/// Makes a force (or a factor of it) that is not above `threshold` vanish: a pin cannot pull. Gives
/// what has to be watched if it is not constant.
fn lift_off<S: Scalar>(
    force: &mut Series<S>,
    constant: bool,
    threshold: f64,
) -> Option<Box<Series<S>>> {
    if constant {
        if force[0].value() <= threshold + ROUNDING_OF_FORCE {
            force[0] = S::ZERO;
        }
        return None;
    }
    let mut watched = *force;
    watched[0] = watched[0] + -threshold;
    if watched[0].value().abs() <= ROUNDING_OF_FORCE {
        // At the instant of touching or lifting the sign is that of what comes next.
        watched[0] = S::ZERO;
        force[0] = S::constant(threshold);
    }
    let next = watched.iter().map(|c| c.value()).find(|c| *c != 0.0);
    if next.is_none_or(|c| c < 0.0) {
        *force = [S::ZERO; TERMS];
    }
    Some(Box::new(watched))
}

fn scale<S: Scalar>(series: &mut Series<S>, constant: bool, factor: S) {
    let used = if constant { 1 } else { TERMS };
    for c in series.iter_mut().take(used) {
        *c = *c * factor;
    }
}

/// Replaces a positive load by 50 N (N/50 N)^exponent.
fn power<S: Scalar>(exponent: S, constant: bool, load: &mut Series<S>, work: &mut EffectJet<S>) {
    let first = load[0];
    let scaled = (first * (1.0 / REFERENCE_LOAD)).powf(exponent) * REFERENCE_LOAD;
    work.power_load[0] = scaled;
    if !constant {
        // k y_k x_0 = Σ_{j=1..k} (p j − (k − j)) x_j y_{k−j} for y = x^p.
        for k in 1..TERMS {
            let mut sum = S::ZERO;
            for j in 1..=k {
                let weight = exponent * j as f64 - (k - j) as f64;
                sum += weight * load[j] * work.power_load[k - j];
            }
            work.power_load[k] = sum * RECIPROCAL[k] / first;
        }
        *load = work.power_load;
    } else {
        load[0] = scaled;
    }
}

/// The rig's numbers as the recurrences want them.
struct Bodies<'a, S> {
    rig: &'a Rig<S>,
    has_effects: bool,
    inverse_motor_inertia: S,
    inverse_inductance: S,
    ratio: S,
    current_to_torque: S,
    motor_damping: S,
    back_emf: S,
    motor_coulomb: S,
    play: S,
    voltage_factor: S,
    random: Option<RandomFunction>,
    /// Breakaway levels and zero-velocity decay rates of D2 and D1, constant over a segment.
    breakaway: [S; 2],
    decay: [S; 2],
    disc_slip: SlipTemplate<'a, S>,
    disc1_slip: Option<SlipTemplate<'a, S>>,
    disturbances: [S; 2],
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
    fn new(rig: &'a Rig<S>, mode: &RigMode, inputs: &RigInputs<S>) -> Self {
        let one = S::constant(1.0);
        let ratio = rig.gearbox.ratio;
        let motor_inertia = ratio * ratio * rig.motor.inertia;
        let effects = &rig.effects;
        let mut viscous = rig.motor.viscous_damping;
        if let Some(extra) = &effects.motor_viscous {
            viscous += extra.coefficient;
        }
        let gap = effects.backlash.map_or(S::ZERO, |backlash| backlash.gap);
        let inverse_inertia = one / rig.disc.inertia;
        let bearing = effects.bearing_friction.map_or(S::ZERO, |b| b.torque);
        Self {
            rig,
            has_effects: effects.act_on_motion(),
            inverse_motor_inertia: one / motor_inertia,
            inverse_inductance: one / rig.motor.inductance,
            ratio,
            current_to_torque: ratio * rig.motor.torque_constant,
            motor_damping: ratio * ratio * viscous,
            back_emf: ratio * rig.motor.back_emf_constant,
            motor_coulomb: ratio * rig.motor.coulomb_torque,
            play: gap * 0.5,
            voltage_factor: effects.supply_sag.map_or(one, |sag| sag.factor),
            random: effects.stochastic_friction.map(|noise| {
                RandomFunction::new(noise.seed.value() as u64, noise.correlation_time.value())
            }),
            breakaway: [
                rig.law.breakaway(),
                rig.outer
                    .as_ref()
                    .map_or(S::ZERO, |outer| outer.law.breakaway()),
            ],
            decay: [
                rig.law.band().1,
                rig.outer
                    .as_ref()
                    .map_or(S::ZERO, |outer| outer.law.band().1),
            ],
            disturbances: [inputs.disc_torque, inputs.motor_torque],
            disc_slip: SlipTemplate {
                law: &rig.law,
                inertia: rig.disc.inertia,
                inverse_inertia,
                constant_torque: bearing,
                near: mode.near[0],
                folded: mode.folded[0],
            },
            disc1_slip: rig.outer.as_ref().map(|outer| SlipTemplate {
                law: &outer.law,
                inertia: outer.disc.inertia,
                inverse_inertia: one / outer.disc.inertia,
                constant_torque: S::ZERO,
                near: mode.near[1],
                folded: mode.folded[1],
            }),
        }
    }

    #[inline]
    fn expand_order(&self, k: usize, mode: &RigMode, time: S, varying: bool, jet: &mut RigJet<S>) {
        let rig = self.rig;
        let x = &mut jet.states;
        let next = if k + 1 < TERMS { k + 1 } else { 0 };
        let per_next = if next == 0 { 0.0 } else { RECIPROCAL[next] };

        let mut twist = x[THETA][k] - x[THETA3][k];
        let twist_rate = x[OMEGA][k] - x[OMEGA3][k];
        let mut shaft_torque = rig.shaft.damping * twist_rate;
        if self.has_effects {
            jet.twist[k] = twist;
            if mode.coupling == Coupling::Free {
                twist = S::ZERO;
                shaft_torque = S::ZERO;
            } else if k == 0 {
                match mode.coupling {
                    Coupling::Ahead => twist -= self.play,
                    _ => twist += self.play,
                }
            }
        }
        shaft_torque += rig.shaft.stiffness * twist;

        let mut on_disc = S::ZERO;
        let mut on_motor = S::ZERO;
        let mut voltage = jet.voltage[k];
        let mut resistance_drop = rig.motor.resistance * x[CURRENT][k];
        if self.has_effects {
            if let Some(work) = &mut jet.effects {
                work.elastic_twist[k] = twist;
                let extra = self.effect_shaft_torque(k, twist_rate, x, next, per_next, work);
                if mode.coupling != Coupling::Free {
                    shaft_torque += extra;
                }
                on_disc = self.effect_disc_torque(k, mode, x, work);
                on_motor = self.effect_motor_torque(k, x, work);
                if varying {
                    self.effect_load(k, time, x, &mut jet.disc.load, work);
                }
            }
            voltage = voltage * self.voltage_factor;
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
        let mut resisting = shaft_torque - on_disc;
        if let (Some(outer), Some(template), Some(pin)) =
            (&rig.outer, &self.disc1_slip, &mut jet.disc1)
        {
            let outer_torque = outer.shaft.stiffness * (x[THETA1][k] - x[THETA][k])
                + outer.shaft.damping * (x[OMEGA1][k] - x[OMEGA][k]);
            resisting -= outer_torque;
            let acceleration = contact_order(
                k,
                mode.disc1,
                outer_torque,
                self.breakaway[1],
                self.decay[1],
                template,
                &x[THETA1],
                &x[OMEGA1],
                pin,
            );
            x[OMEGA1][next] = acceleration * per_next;
            x[THETA1][next] = x[OMEGA1][k] * per_next;
        }

        let acceleration = contact_order(
            k,
            mode.disc,
            resisting,
            self.breakaway[0],
            self.decay[0],
            &self.disc_slip,
            &x[THETA],
            &x[OMEGA],
            &mut jet.disc,
        );
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

    fn effect_shaft_torque(
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

    fn effect_disc_torque(
        &self,
        k: usize,
        mode: &RigMode,
        x: &[Series<S>; STATES],
        work: &mut EffectJet<S>,
    ) -> S {
        let effects = &self.rig.effects;
        if effects.unbalance.is_some() || effects.normal_force_wobble.is_some() {
            work.weighted_angle[k] = x[THETA][k] * k as f64;
            let (c, s) = if k == 0 {
                let (s, c) = x[THETA][0].sin_cos();
                (c, s)
            } else {
                cosine_sine(k, &work.weighted_angle, &work.cosine, &work.sine)
            };
            (work.cosine[k], work.sine[k]) = (c, s);
        }
        let mut torque = S::ZERO;
        if let Some(unbalance) = &effects.unbalance {
            let (sin, cos) = unbalance.phase.sin_cos();
            torque -= unbalance.torque * (work.cosine[k] * cos + work.sine[k] * sin);
        }
        if let Some(drag) = &effects.viscous_drag {
            torque -= drag.coefficient * x[OMEGA][k];
        }
        if let (
            Some(drag),
            ContactMode::Slipping(direction, _) | ContactMode::Breaking(direction),
        ) = (&effects.quadratic_drag, mode.disc)
        {
            let square = convolution(&x[OMEGA][..=k], &x[OMEGA][..=k]);
            torque -= drag.coefficient * square * direction.sign();
        }
        torque
    }

    fn effect_motor_torque(&self, k: usize, x: &[Series<S>; STATES], work: &mut EffectJet<S>) -> S {
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
    fn effect_load(
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
            work.factor[k] = one + wobble.amplitude * (work.cosine[k] * cos + work.sine[k] * sin);
            coefficient = convolution(&work.base_load[..=k], &work.factor[..=k]);
        }
        if let Some(position) = &effects.position_friction {
            // The load so far must be kept as a series to be multiplied again.
            work.scratch[k] = coefficient;
            work.weighted_angle[k] = x[THETA][k] * k as f64;
            let (c, s) = if k == 0 {
                let (s, c) = (x[THETA][0] * 2.0 - position.phase).sin_cos();
                (c, s)
            } else {
                let (c, s) = cosine_sine(
                    k,
                    &work.weighted_angle,
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

fn breakaway_order<S: Scalar>(
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
