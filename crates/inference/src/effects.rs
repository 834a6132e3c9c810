//! The effects that may be missing: which numbers each has, how large they are as shares of what the records show, and from
//! where fits of them start.

use std::convert::Infallible;

use crate::hypothesis::{Free, Hypothesis};
use crate::law_start::{self, Scatter};
use crate::policy::LEAST_SHARE;
use crate::scales::Scales;
use stickslip::friction::{CoulombStiction, Law, Stribeck, TwoGaussianMu};
use stickslip::parameter::ParameterInfo;
use stickslip::plant::Rig;

/// Share of its base that an effect of usual size has: of the friction torque, of the twist, of the load, of one.
const USUAL: f64 = 0.3;
/// Multiple of the usual size that bounds a number.
const BOUND: f64 = 30.0;
/// Where fits start that begin with hardly any effect, in usual sizes: so little that the best instruments do not see it.
const NEAR: f64 = 1e-5;
/// Smallest and largest share of the speed, of the period or of the stiffness that a number of a law or of a spring may have.
const NARROW: f64 = 1e-3;

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
    OuterStiffnessOverTwistSquared,
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
#[derive(Clone, Copy, Debug, PartialEq)]
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
}

/// One physical effect that a model may lack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect {
    /// Name in findings.
    pub name: &'static str,
    form: Form,
}

const fn one(
    name: &'static str,
    key: &'static str,
    origin: f64,
    base: Base,
    positive: bool,
    far: &'static [f64],
) -> Effect {
    Effect {
        name,
        form: Form::One {
            key,
            origin,
            base,
            positive,
            far,
        },
    }
}

const fn polar(
    name: &'static str,
    amplitude: &'static str,
    base: Base,
    orders: &'static [f64],
    far: &'static [f64],
) -> Effect {
    Effect {
        name,
        form: Form::Polar {
            amplitude,
            base,
            orders,
            far,
        },
    }
}

/// All effects, in a fixed order.
pub const EFFECTS: &[Effect] = &[
    one(
        "bearing_friction",
        "torque",
        0.0,
        Base::Torque,
        true,
        &[0.5, 1.5],
    ),
    polar("normal_force_wobble", "amplitude", Base::One, &[], &[0.6]),
    polar("position_friction", "amplitude", Base::One, &[], &[]),
    polar("unbalance", "torque", Base::Torque, &[], &[1.0]),
    one(
        "viscous_drag",
        "coefficient",
        0.0,
        Base::TorqueOverSpeed,
        false,
        &[],
    ),
    one(
        "quadratic_drag",
        "coefficient",
        0.0,
        Base::TorqueOverSpeedSquared,
        false,
        &[],
    ),
    one(
        "shaft_hardening",
        "cubic_stiffness",
        0.0,
        Base::StiffnessOverTwistSquared,
        false,
        &[],
    ),
    Effect {
        name: "shaft_hysteresis",
        form: Form::Relaxation,
    },
    one("backlash", "gap", 0.0, Base::Twist, true, &[0.5, 1.5]),
    polar(
        "gear_ripple",
        "torque",
        Base::MotorTorque,
        &[1.0, 2.0, 4.0, 6.0],
        &[],
    ),
    one(
        "motor_viscous",
        "coefficient",
        0.0,
        Base::MotorTorqueOverSpeed,
        false,
        &[],
    ),
    one("supply_sag", "factor", 1.0, Base::One, false, &[]),
    one(
        "resistance_drift",
        "rate_per_minute",
        0.0,
        Base::PerDuration,
        false,
        &[],
    ),
    one("load_cell_bias", "bias", 0.0, Base::Load, false, &[]),
    one(
        "friction_wear",
        "rate_per_minute",
        0.0,
        Base::PerDuration,
        false,
        &[],
    ),
    Effect {
        name: "load_exponent",
        form: Form::Exponent,
    },
    one("sensor_delay", "delay", 0.0, Base::Time, true, &[]),
    Effect {
        name: "presliding",
        form: Form::Bristles,
    },
    Effect {
        name: "stiction",
        form: Form::Stiction,
    },
    Effect {
        name: "stribeck",
        form: Form::Stribeck,
    },
    Effect {
        name: "acceleration_hysteresis",
        form: Form::Hysteresis,
    },
    one(
        "bearing_friction1",
        "torque",
        0.0,
        Base::Torque,
        true,
        &[0.5, 1.5],
    ),
    polar("unbalance1", "torque", Base::Torque, &[], &[1.0]),
    one(
        "viscous_drag1",
        "coefficient",
        0.0,
        Base::TorqueOverSpeed,
        false,
        &[],
    ),
    one(
        "quadratic_drag1",
        "coefficient",
        0.0,
        Base::TorqueOverSpeedSquared,
        false,
        &[],
    ),
    polar("normal_force_wobble1", "amplitude", Base::One, &[], &[0.6]),
    one(
        "shaft_hardening1",
        "cubic_stiffness",
        0.0,
        Base::OuterStiffnessOverTwistSquared,
        false,
        &[],
    ),
];

/// The effect of this name.
#[must_use]
pub fn effect(name: &str) -> Option<&'static Effect> {
    EFFECTS.iter().find(|effect| effect.name == name)
}

impl Effect {
    /// Whether the effect replaces the friction law.
    #[must_use]
    pub fn is_law(&self) -> bool {
        matches!(
            self.form,
            Form::Stiction | Form::Stribeck | Form::Hysteresis
        )
    }

    /// Whether a rig has what the effect acts on.
    #[must_use]
    pub fn is_possible(&self, rig: &Rig<f64>) -> bool {
        self.is_law() || rig.effect_names().any(|name| name == self.name)
    }

    /// What the dotted names of its numbers begin with: its own section, or the law's.
    #[must_use]
    pub fn prefix(&self) -> &'static str {
        if self.is_law() { "contact." } else { self.name }
    }

    /// Whether the effect changes what it acts on by too little to be told from what no model of the rig gets right.
    #[must_use]
    pub fn is_immaterial(&self, fitted: &Hypothesis) -> bool {
        if self.is_law() || matches!(self.form, Form::Bristles) {
            return false;
        }
        fitted
            .size_of(self.name)
            .is_some_and(|size| USUAL * size < LEAST_SHARE)
    }

    /// Whether a start is so far from the best numbers that a step or two are needed to see what it promises.
    #[must_use]
    pub fn is_nonlinear(&self) -> bool {
        matches!(
            self.form,
            Form::Bristles | Form::Hysteresis | Form::Stribeck | Form::Stiction | Form::Relaxation
        ) || matches!(self.form, Form::One { far, .. } if !far.is_empty())
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
            Form::Bristles if base.rig.outer.is_some() => Vec::new(),
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
        Base::OuterStiffnessOverTwistSquared => {
            let stiffness = rig.outer.map_or(0.0, |outer| outer.shaft.stiffness);
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

fn stiction(base: &Hypothesis, scatter: Option<&Scatter>) -> Vec<Hypothesis> {
    let Law::Coulomb(law) = base.rig.law else {
        return Vec::new();
    };
    let ratios: &[f64] = if scatter.is_some() {
        &[1.03, 1.15, 1.5]
    } else {
        &[1.03]
    };
    ratios
        .iter()
        .map(|ratio| {
            let mut h = base.clone();
            let mu_s = ratio * base.value("contact.mu_c").unwrap_or(law.mu_c);
            h.rig.law = Law::CoulombStiction(CoulombStiction {
                mu_c: law.mu_c,
                mu_s,
            });
            let of = (law.mu_c, 0.5 * law.mu_c);
            push(&mut h, "contact", "mu_s", of, (0.0, 10.0 * law.mu_c), mu_s);
            h
        })
        .collect()
}

fn stribeck(base: &Hypothesis, scales: &Scales, scatter: Option<&Scatter>) -> Vec<Hypothesis> {
    let (mu_c, mu_s) = match base.rig.law {
        Law::Coulomb(law) => (law.mu_c, 1.3 * law.mu_c),
        Law::CoulombStiction(law) => (law.mu_c, law.mu_s),
        _ => return Vec::new(),
    };
    let mut starts = vec![[mu_c, mu_s, 0.2 * scales.speed]];
    if let Some(scatter) = scatter {
        starts.extend([0.06, 0.6].map(|share| [mu_c, mu_s, share * scales.speed]));
        starts.extend(law_start::stribeck(scatter, scales));
    }
    starts
        .into_iter()
        .map(|[start_c, start_s, omega_s]| {
            let mut h = without_law(base);
            let start_s = start_s.max(1.02 * start_c);
            h.rig.law = Law::Stribeck(Stribeck {
                mu_c: start_c,
                mu_s: start_s,
                omega_s,
            });
            let range = (0.01 * mu_c, 10.0 * mu_c);
            push(
                &mut h,
                "contact",
                "mu_c",
                (mu_c, USUAL * mu_c),
                range,
                start_c,
            );
            push(
                &mut h,
                "contact",
                "mu_s",
                (mu_s, 0.5 * mu_c),
                range,
                start_s,
            );
            let speed = scales.speed;
            let of = (0.2 * speed, USUAL * speed);
            let range = (NARROW * speed, 3.0 * speed);
            push(&mut h, "contact", "omega_s", of, range, omega_s);
            h
        })
        .collect()
}

/// The keys of Eq. 6-2 in their order.
const HYSTERESIS_KEYS: [&str; 8] = [
    "a1",
    "b1",
    "c1",
    "a2",
    "b2",
    "c2",
    "omega_centre",
    "acceleration_semi_axis",
];

fn hysteresis(base: &Hypothesis, scales: &Scales, scatter: Option<&Scatter>) -> Vec<Hypothesis> {
    let level = match base.rig.law {
        Law::Coulomb(law) => law.mu_c,
        Law::CoulombStiction(law) => law.mu_c,
        Law::Stribeck(law) => law.mu_c,
        Law::Karnopp(law) => law.mu_c,
        Law::Switch(law) => law.mu_c,
        Law::Wojewoda(_) | Law::TwoGaussianTorque(_) | Law::TwoGaussianMu(_) => return Vec::new(),
    };
    let Some(scatter) = scatter else {
        return Vec::new();
    };
    let (speed, acceleration) = (scales.speed, scales.acceleration);
    // Prior: centre, standard deviation, smallest and largest value.
    let priors = [
        (level, level, -20.0 * level, 20.0 * level),
        (-1.5, 1.5, -6.0, 6.0),
        (1.5, 1.0, 0.15, 12.0),
        (level, level, -20.0 * level, 20.0 * level),
        (1.5, 1.5, -6.0, 6.0),
        (1.5, 1.0, 0.15, 12.0),
        (0.6 * speed, 0.5 * speed, 0.05 * speed, 5.0 * speed),
        (
            acceleration,
            acceleration,
            0.05 * acceleration,
            20.0 * acceleration,
        ),
    ];
    law_start::hysteresis(scatter, scales)
        .into_iter()
        .filter_map(|values| {
            let mut h = without_law(base);
            let mut next = values.iter();
            let law = TwoGaussianMu::from_values(|_| {
                Ok::<f64, Infallible>(next.next().copied().unwrap_or(1.0))
            });
            let Ok(law) = law;
            h.rig.law = Law::TwoGaussianMu(law);
            h.rig.check().ok()?;
            for ((key, (origin, scale, low, high)), value) in
                HYSTERESIS_KEYS.iter().zip(priors).zip(values)
            {
                push(&mut h, "contact", key, (origin, scale), (low, high), value);
            }
            Some(h)
        })
        .collect()
}

/// Takes the friction law's numbers out of what is free.
fn without_law(base: &Hypothesis) -> Hypothesis {
    let mut h = base.clone();
    let (mut x, mut free, mut at) = (Vec::new(), Vec::new(), 0);
    for f in &base.free {
        let is_law = matches!(f, Free::Nominal { name, .. } | Free::Value { name, .. } if name.starts_with("contact."));
        if !is_law {
            free.push(f.clone());
            x.extend_from_slice(&base.x[at..at + f.width()]);
        }
        at += f.width();
    }
    h.free = free;
    h.x = x;
    h
}
