//! The effects that may be missing: which numbers each has, how large they are as shares of what the records show, and from
//! where fits of them start.

mod catalogue;
mod equation;
mod laws;

use std::convert::Infallible;

pub use self::catalogue::EFFECTS;
use self::equation::Equation;
use self::laws::{hysteresis, stiction, stribeck};
use crate::hypothesis::{Free, Hypothesis};
use crate::law_start::Scatter;
use crate::numbers::{BOUND, USUAL};
use crate::scales::Scales;
use crate::units::PlantUnits;
use stickslip::parameter::{ParameterError, ParameterInfo};
use stickslip::plant::{Rig, Supposition};

/// Where fits start that begin with hardly any effect, in usual sizes: so little that the best instruments do not see it.
const NEAR: f64 = 1e-5;

/// What an effect's size is a share of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Base {
    /// One: a factor, a relative amplitude.
    One,
    /// Friction torque.
    Torque,
    /// Friction torque over the speed.
    TorqueOverSpeed,
    /// Friction torque over the square of the speed.
    TorqueOverSpeedSquared,
    /// Stiffness of the shaft over the square of its twist.
    StiffnessOverTwistSquared,
    /// The same of shaft 1.
    Shaft1StiffnessOverTwistSquared,
    /// Twist of the shaft by the friction torque.
    Twist,
    /// Friction torque on the motor's side.
    MotorTorque,
    /// The same over the motor's speed.
    MotorTorqueOverSpeed,
    /// Change over the records' duration, per minute.
    PerDuration,
    /// Mean normal force.
    Load,
    /// A radian of the shaft's natural oscillation.
    Time,
}

/// How an effect enters a hypothesis.
#[derive(Clone, Debug, PartialEq)]
enum Form {
    /// One number that is `origin` where there is no effect; `far` are further starts, in usual sizes.
    One {
        key: &'static str,
        origin: f64,
        base: Base,
        positive: bool,
        far: &'static [f64],
    },
    /// Amplitude and phase; of the effects with an order, one hypothesis for each.
    Polar {
        amplitude: &'static str,
        base: Base,
        orders: &'static [f64],
        far: &'static [f64],
    },
    /// Friction that is not proportional to the load, with the level at the mean load.
    Exponent,
    /// Stiffness and relaxation time of the shaft's internal friction.
    Relaxation,
    /// Stiffness and damping of the bristles of a sticking pin.
    Bristles,
    /// Breakaway above sliding.
    Stiction,
    /// Sliding friction that falls with speed.
    Stribeck,
    /// Eq. 6-2.
    Hysteresis,
    /// What a file describes.
    Equation(Equation),
}

/// One physical effect that a model may lack.
#[derive(Clone, Debug, PartialEq)]
pub struct Effect {
    /// Name in findings.
    pub name: &'static str,
    form: Form,
}

impl Effect {
    /// The effect that a file supposes, on a plant of this size.
    ///
    /// # Errors
    /// The rig cannot have the effect, or no value of its numbers makes it vanish.
    pub fn supposed(
        supposition: &Supposition,
        rig: &Rig<f64>,
        scales: &Scales,
        units: &PlantUnits,
    ) -> Result<Self, ParameterError> {
        let equation = Equation::of(supposition, rig, scales, units)?;
        Ok(Self {
            name: equation.name(),
            form: Form::Equation(equation),
        })
    }

    /// Whether the effect replaces the friction law.
    #[must_use]
    pub fn is_law(&self) -> bool {
        matches!(
            self.form,
            Form::Stiction | Form::Stribeck | Form::Hysteresis
        )
    }

    /// The numbers that make the effect vanish, or its law become a simpler one, once all have these values: dotted names, and the
    /// values. None for effects that only vanish far away: bristles that are infinitely stiff.
    #[must_use]
    pub fn vanishing(&self) -> Vec<(String, f64)> {
        let dotted = |key: &str, value: f64| (format!("{}.{key}", self.name), value);
        match &self.form {
            Form::One { key, origin, .. } => vec![dotted(key, *origin)],
            Form::Polar { amplitude, .. } => vec![dotted(amplitude, 0.0)],
            Form::Exponent => vec![dotted("exponent", 1.0)],
            Form::Relaxation => vec![dotted("stiffness", 0.0)],
            Form::Equation(equation) => equation
                .vanishing()
                .map(|(key, value)| dotted(key, value))
                .collect(),
            Form::Stribeck => vec![("contact.omega_s".to_owned(), 0.0)],
            Form::Bristles | Form::Stiction | Form::Hysteresis => Vec::new(),
        }
    }

    /// Whether a rig has what the effect acts on.
    #[must_use]
    pub fn is_possible(&self, rig: &Rig<f64>) -> bool {
        match &self.form {
            Form::Equation(_) => true,
            _ => self.is_law() || rig.effect_names().any(|name| name == self.name),
        }
    }

    /// What the dotted names of its numbers begin with: its own section, or the law's.
    #[must_use]
    pub fn prefix(&self) -> &'static str {
        if self.is_law() { "contact." } else { self.name }
    }

    /// Whether a start is so far from the best numbers that a step or two are needed to see what it promises.
    #[must_use]
    pub fn is_nonlinear(&self) -> bool {
        matches!(
            self.form,
            Form::Bristles | Form::Hysteresis | Form::Stribeck | Form::Stiction | Form::Relaxation
        ) || matches!(&self.form, Form::One { far, .. } if !far.is_empty())
            || matches!(&self.form, Form::Equation(equation) if equation.has_shape())
    }

    /// The hypotheses from which fits of this effect on top of `base` start; empty if the effect makes no sense there.
    ///
    /// `scatter` is the friction that the records show; where it is given, starts far from no effect are among them.
    #[must_use]
    pub fn starts(
        &self,
        base: &Hypothesis,
        scales: &Scales,
        scatter: Option<&Scatter>,
    ) -> Vec<Hypothesis> {
        if !self.is_possible(&base.rig) || base.effects.iter().any(|name| name == self.name) {
            return Vec::new();
        }
        let far = scatter.is_some();
        let mut hypotheses = match self.form {
            Form::One {
                key,
                origin,
                base: of,
                positive,
                far: distant,
            } => {
                let scale = USUAL * size(of, scales, &base.rig);
                if scale == 0.0 {
                    return Vec::new();
                }
                let low = if positive {
                    origin
                } else if of == Base::One {
                    0.01
                } else {
                    -BOUND * scale
                };
                std::iter::once(&NEAR)
                    .chain(if far { distant } else { &[] })
                    .map(|&start| {
                        let value = origin + scale * start;
                        let mut h = base.clone();
                        switch_on(&mut h, self.name, &[(key, value)]);
                        let high = origin + BOUND * scale;
                        push(&mut h, self.name, key, (origin, scale), (low, high), value);
                        h
                    })
                    .collect()
            }
            Form::Polar {
                amplitude,
                base: of,
                orders,
                far: distant,
            } => {
                let scale = USUAL * size(of, scales, &base.rig);
                let high = if of == Base::One { 0.95 } else { BOUND * scale };
                let near: Vec<(f64, f64, f64)> = if orders.is_empty() {
                    vec![(0.0, NEAR, 0.0)]
                } else {
                    orders.iter().map(|&order| (order, NEAR, 0.0)).collect()
                };
                let turned = [0.0, 1.6, 3.1, 4.7];
                let distant = (if far { distant } else { &[] })
                    .iter()
                    .flat_map(|&start| turned.map(|phase| (0.0, start, phase)));
                near.into_iter()
                    .chain(distant)
                    .map(|(order, start, phase)| {
                        let mut h = base.clone();
                        let numbers = [
                            ("order", order),
                            (amplitude, start * scale),
                            ("phase", phase),
                        ];
                        switch_on(&mut h, self.name, &numbers);
                        h.free.push(Free::Polar {
                            amplitude: format!("{}.{amplitude}", self.name),
                            phase: format!("{}.phase", self.name),
                            scale,
                            high,
                        });
                        h.x.extend([start * phase.cos(), start * phase.sin()]);
                        h
                    })
                    .collect()
            }
            Form::Exponent if scales.load == 0.0 => Vec::new(),
            Form::Exponent => {
                let mut h = base.clone();
                let value = 1.0 - NEAR * USUAL;
                switch_on(&mut h, self.name, &[("exponent", value)]);
                push(
                    &mut h,
                    self.name,
                    "exponent",
                    (1.0, USUAL),
                    (0.05, 4.0),
                    value,
                );
                h.free.push(Free::Level);
                h.x.push(0.0);
                vec![h]
            }
            Form::Relaxation => [0.5, 2.4]
                .iter()
                .map(|&time| {
                    let mut h = base.clone();
                    let stiffness = NEAR * USUAL;
                    let numbers = [("stiffness", stiffness), ("relaxation_time", time)];
                    switch_on(&mut h, self.name, &numbers);
                    push(
                        &mut h,
                        self.name,
                        "stiffness",
                        (0.0, USUAL),
                        (0.0, 10.0),
                        stiffness,
                    );
                    push(
                        &mut h,
                        self.name,
                        "relaxation_time",
                        (1.0, 3.0),
                        (0.03, 30.0),
                        time,
                    );
                    h
                })
                .collect(),
            Form::Bristles if base.rig.law.band().0 > 0.0 || scales.load == 0.0 => Vec::new(),
            // Of the bristles on D1 windows have no start that could be fitted.
            Form::Bristles if base.rig.disc1.is_some() => Vec::new(),
            // Bristles that give way by less than can be read are none.
            Form::Bristles => {
                let stiffest = scales.torque / scales.resolution;
                [0.6, 0.2, 0.06]
                    .iter()
                    .map(|share| {
                        let mut h = base.clone();
                        let stiffness = share * stiffest;
                        let damping = 0.6 * stiffness.sqrt();
                        let numbers = [("stiffness", stiffness), ("damping", damping)];
                        switch_on(&mut h, self.name, &numbers);
                        let of = (stiffness, stiffness);
                        push(
                            &mut h,
                            self.name,
                            "stiffness",
                            of,
                            (1.0, stiffest),
                            stiffness,
                        );
                        let of = (damping, damping);
                        let most = 100.0 * damping;
                        push(&mut h, self.name, "damping", of, (0.0, most), damping);
                        h
                    })
                    .collect()
            }
            Form::Equation(ref equation) => equation.starts(base),
            _ if scales.load == 0.0 => Vec::new(),
            Form::Stiction => stiction(base, scatter),
            Form::Stribeck => stribeck(base, scales, scatter),
            Form::Hysteresis => hysteresis(base, scales, scatter),
        };
        for h in &mut hypotheses {
            h.effects.push(self.name.to_owned());
        }
        hypotheses
    }
}

fn size(base: Base, scales: &Scales, rig: &Rig<f64>) -> f64 {
    let ratio = rig.gearbox.ratio;
    let Scales {
        torque,
        speed,
        load,
        duration,
        ..
    } = *scales;
    match base {
        Base::One => 1.0,
        Base::Torque => torque,
        Base::TorqueOverSpeed => torque / speed,
        Base::TorqueOverSpeedSquared => torque / (speed * speed),
        Base::StiffnessOverTwistSquared => 1.0 / (torque * torque),
        Base::Shaft1StiffnessOverTwistSquared => {
            let stiffness = rig.disc1.map_or(0.0, |disc1| disc1.shaft.stiffness);
            stiffness.powi(3) / (torque * torque)
        }
        Base::Twist => torque,
        Base::MotorTorque => torque / ratio,
        Base::MotorTorqueOverSpeed => torque / (ratio * ratio * speed),
        Base::PerDuration => 60.0 / duration,
        Base::Load => load,
        Base::Time => 1.0,
    }
}

fn push(
    h: &mut Hypothesis,
    section: &str,
    key: &str,
    (origin, scale): (f64, f64),
    (low, high): (f64, f64),
    value: f64,
) {
    h.free.push(Free::Value {
        name: format!("{section}.{key}"),
        origin,
        scale,
        low,
        high,
    });
    h.x.push((value - origin) / scale);
}

fn switch_on(hypothesis: &mut Hypothesis, section: &str, values: &[(&str, f64)]) {
    let value = |info: &'static ParameterInfo| {
        let given = values
            .iter()
            .find(|(key, _)| *key == info.key)
            .map_or(0.0, |(_, v)| *v);
        Ok::<f64, Infallible>(given)
    };
    let _ = hypothesis.rig.insert_effect(section, value);
}
