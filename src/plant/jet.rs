//! Series of everything in the rig over one segment.

use super::equation::EquationJet;
use super::fading::Fading;
use super::linear_parts::LinearParts;
use super::slow_motion::SlowMotion;
use super::tangent::Tangent;
use super::{INPUT_TERMS, Rig, RigGuard, STATES};
use crate::friction::{Law, SlipJet};
use crate::integrator::Guard;
use crate::series::{Scalar, Series, TERMS, evaluate};

/// Series of one pin contact.
#[derive(Clone, Debug)]
pub(super) struct PinJet<S> {
    /// Of a law on an exponential curve, which has no branches: in place of the upper branch's level, j × coefficient j of
    /// −(slip speed)/(Stribeck velocity); in place of the lower one's, the exponential of that series.
    pub slip: SlipJet<S>,
    /// Normal force × radius [N m], or 1 for a law of the torque.
    pub load: Series<S>,
    /// Whether only order 0 of `load` differs from zero.
    pub load_is_constant: bool,
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
    pub(super) voltage: [S; INPUT_TERMS],
    pub(super) voltage_is_constant: bool,
    pub(super) parts: LinearParts<S>,
    pub(super) slow: SlowMotions<S>,
    /// For numbers with derivatives and rigs without effects.
    pub(super) tangent: Option<Box<Tangent<S>>>,
    /// Whether the motion of this segment is in `tangent`, and only the states' series are here.
    pub(super) follows_tangent: bool,
    /// What the derivatives have beside the series of the states.
    pub(super) fading: Option<Box<Fading<S>>>,
    pub(super) effects: Option<Box<EffectJet<S>>>,
    pub(super) guards: Vec<Guard<RigGuard>>,
    pub(super) order: usize,
    /// Orders that the second pass of the last segment on the slow manifold corrected.
    pub(super) corrected: usize,
}

/// Slow manifolds of the two rigs, by number of slow variables; `InUse` while one is at work.
#[derive(Clone, Debug)]
pub(super) enum SlowMotions<S> {
    Reduced(Box<SlowMotion<S, 2>>),
    Full(Box<SlowMotion<S, 4>>),
    InUse,
}

/// Series that only the effects need.
#[derive(Clone, Debug)]
pub(super) struct EffectJet<S> {
    pub factor: Series<S>,
    pub scratch: Series<S>,
    pub turn: TurnJet<S>,
    /// Apart, so that rigs without effects on disc D1 do not carry it.
    pub disc1: Option<Box<Disc1EffectJet<S>>>,
    /// Apart, so that rigs without effects by equation do not carry it.
    pub equations: Option<Box<EquationJet<S>>>,
    pub second_cosine: Series<S>,
    pub second_sine: Series<S>,
    pub weighted_motor_angle: Series<S>,
    pub motor_cosine: Series<S>,
    pub motor_sine: Series<S>,
    pub elastic_twist: Series<S>,
    pub twist_square: Series<S>,
    pub base_load: Series<S>,
    pub steady_load: Series<S>,
    pub noise: Series<S>,
}

/// Cosine and sine of a disc's angle.
#[derive(Clone, Debug)]
pub(super) struct TurnJet<S> {
    pub weighted_angle: Series<S>,
    pub cosine: Series<S>,
    pub sine: Series<S>,
}

/// Series that only the effects on disc D1 need.
#[derive(Clone, Debug)]
pub(super) struct Disc1EffectJet<S> {
    pub turn: TurnJet<S>,
    pub twist: Series<S>,
    pub twist_square: Series<S>,
    pub base_load: Series<S>,
    pub factor: Series<S>,
}

impl<S: Scalar> Disc1EffectJet<S> {
    fn new() -> Self {
        let zero = [S::ZERO; TERMS];
        Self {
            turn: TurnJet::new(),
            twist: zero,
            twist_square: zero,
            base_load: zero,
            factor: zero,
        }
    }
}

impl<S: Scalar> TurnJet<S> {
    fn new() -> Self {
        let zero = [S::ZERO; TERMS];
        Self {
            weighted_angle: zero,
            cosine: zero,
            sine: zero,
        }
    }
}

impl<S: Scalar> RigJet<S> {
    /// Empty series for `rig`.
    pub fn new(rig: &Rig<S>) -> Self {
        let zero = [S::ZERO; TERMS];
        let effects = rig.needs_effect_series().then(|| {
            let disc1 = rig.disc1.as_ref();
            Box::new(EffectJet {
                factor: zero,
                scratch: zero,
                turn: TurnJet::new(),
                disc1: disc1
                    .filter(|disc1| disc1.effects.need_series())
                    .map(|_| Box::new(Disc1EffectJet::new())),
                equations: (rig.equations.active().next())
                    .map(|_| Box::new(EquationJet::new(&rig.equations))),
                second_cosine: zero,
                second_sine: zero,
                weighted_motor_angle: zero,
                motor_cosine: zero,
                motor_sine: zero,
                elastic_twist: zero,
                twist_square: zero,
                base_load: zero,
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
                .disc1
                .as_ref()
                .map(|disc1| Box::new(PinJet::new(&disc1.law))),
            motor_torque: zero,
            voltage: [S::ZERO; INPUT_TERMS],
            voltage_is_constant: true,
            parts,
            tangent,
            follows_tangent: false,
            fading: None,
            slow: if rig.disc1.is_some() {
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

    /// Drops what is remembered of the run so far.
    pub fn forget(&mut self) {
        if let Some(tangent) = &mut self.tangent {
            tangent.forget();
        }
    }

    /// Friction torques on D2, on D1 (in the full rig) and inside the motor. Their derivatives are known
    /// only of expansions to orders below those of a run.
    pub(crate) fn torques(&self) -> (&[S], Option<&[S]>, &[S]) {
        let disc1 = self.disc1.as_ref();
        (
            &self.disc.torque[..=self.order],
            disc1.map(|pin| &pin.torque[..=self.order]),
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
        let disc1 = self.disc1.as_ref().map_or(1.0, |pin| pin.slip.margin);
        self.disc.slip.margin.min(disc1)
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
