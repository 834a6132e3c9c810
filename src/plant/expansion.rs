//! The rig's equations of motion as recurrences for Taylor coefficients (Eqs 4-4 and 4-5 put right).
//!
//! J2 dω2/dt = −c2 (ω2 − ω3) − k2 (θ2 − θ3) − T_f − …,
//! η² J_m dω3/dt = η (K_T i − C_m η ω3 − T_fm) + c2 (ω2 − ω3) + k2 (θ2 − θ3) + …,
//! L di/dt = u − R i − K_E η ω3; the full rig adds D1: J1 dω1/dt = −c1 (ω1 − ω2) − k1 (θ1 − θ2) − T_f1.

use super::bodies::Bodies;
use super::inputs::recentre;
use super::jet::{RigJet, SlowMotions};
use super::load::{lift_off, scale};
use super::slow_motion::LOWEST_ORDER;
use super::{Port, Rig, RigInputs, RigMode, RigState};
use crate::friction::Law;
use crate::series::{Scalar, TERMS};

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
        let varying = self.start_series(time, state, inputs, order, jet);
        jet.follows_tangent = self.expand_tangent(mode, time, state, inputs, order, jet);
        if jet.follows_tangent {
            return;
        }
        self.expand_equations(mode, time, inputs, order, varying, jet);
        self.set_guards(mode, jet);
    }

    #[inline(always)]
    fn expand_equations(
        &self,
        mode: &RigMode,
        time: S,
        inputs: &RigInputs<S>,
        order: usize,
        varying: bool,
        jet: &mut RigJet<S>,
    ) {
        if jet.effects.is_none() {
            self.expand_plain(mode, inputs, order, jet);
            return;
        }
        let bodies = Bodies::new(self, mode, inputs);
        if let (Some(pin), Some(slip)) = (&mut jet.disc1, &bodies.disc1_slip) {
            pin.constant_torque = slip.constant_torque;
        }
        for k in 0..=order {
            bodies.expand_order(k, mode, time, varying, jet);
        }
    }

    /// As [`Self::expand_motion`] to the order that torques and first derivatives need, without guards.
    pub(super) fn expand_instant(
        &self,
        mode: &RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        jet: &mut RigJet<S>,
    ) {
        // The velocity of bristles that give way is that of the torque which they carry.
        let order = usize::from(self.effects.presliding.is_some());
        let varying = self.start_series(time, state, inputs, order, jet);
        jet.follows_tangent = false;
        self.expand_equations(mode, time, inputs, order, varying, jet);
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
        self.start_series(time, state, inputs, order, jet);
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
                .disc1
                .as_ref()
                .is_some_and(|disc1| wojewoda(&disc1.law))
    }

    /// Puts state and inputs into `jet`; whether effects make the load vary.
    pub(super) fn start_series(
        &self,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        order: usize,
        jet: &mut RigJet<S>,
    ) -> bool {
        jet.order = order;
        jet.fading = None;
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
        // Where there are series of effects, equations among them see the voltage before it sags.
        if let (Some(sag), None) = (&self.effects.supply_sag, &jet.effects) {
            for c in &mut jet.voltage {
                *c = *c * sag.factor;
            }
        }
        jet.disc.constant_torque = self.bearing_torque();
        let varying = self.effects.normal_force_wobble.is_some()
            || self.effects.position_friction.is_some()
            || self.effects.stochastic_friction.is_some();
        let by_equation = self.equations.act_at(Port::DiscFriction);
        jet.disc.load_is_constant =
            self.start_load(inputs, time, offset, jet) && !varying && !by_equation;
        if let (Some(disc1), Some(pin)) = (&self.disc1, &mut jet.disc1) {
            let constant = recentre(
                &inputs.normal_force_1,
                offset,
                pin.load_is_constant,
                &mut pin.load,
            );
            pin.moving[0] = lift_off(&mut pin.load, constant, 0.0);
            if let Some(work) = &mut jet.effects
                && let Some(equations) = &mut work.equations
            {
                equations.loads[1] = pin.load;
            }
            scale(&mut pin.load, constant, disc1.contact.radius);
            pin.load_is_constant =
                (constant || disc1.law.is_torque()) && !self.equations.act_at(Port::Disc1Friction);
            if disc1.law.is_torque() {
                pin.load = [S::ZERO; TERMS];
                pin.load[0] = S::constant(1.0);
            }
            let work = jet.effects.as_mut().and_then(|work| work.disc1.as_mut());
            if let (Some(_), Some(work)) = (&disc1.effects.normal_force_wobble1, work) {
                pin.load_is_constant &= disc1.law.is_torque();
                work.base_load = pin.load;
            }
        }
        varying
    }
}
