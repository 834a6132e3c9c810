//! How an effect is switched on, from where its fits start, and what size of it counts.

use std::convert::Infallible;

use super::{Entry, Form};
use crate::diagnose::former::hypothesis::{Free, Hypothesis};
use crate::diagnose::former::law_starts;

/// Smallest size worth naming, relative to a full effect.
const LEAST_SIZE: f64 = 0.03;
/// Smallest departure from one worth naming of a factor or an exponent.
const LEAST_DEPARTURE: f64 = 0.005;
/// Stiffness of bristles that give way as much as is a full effect [N m/rad].
const FULL_BRISTLES: f64 = 30.0;
/// Unit of the stiffness of bristles [N m/rad].
const BRISTLES: f64 = 300.0;
/// Starts for the bristles' stiffness [N m/rad] and damping [N m s/rad], about a third of what is critical.
const BRISTLE_STARTS: [(f64, f64); 4] = [(1000.0, 2.5), (300.0, 1.4), (100.0, 0.8), (30.0, 0.45)];
/// Stiffness of a full internal friction of the shaft [N m/rad].
const RELAXING_STIFFNESS: f64 = 0.05;

/// Whether the number of an effect that starts here is a factor or an exponent, which is no effect at one.
fn is_off_at_one(near: f64) -> bool {
    near > 0.5
}

impl Entry {
    /// Whether the effect replaces the friction law.
    pub fn is_law(&self) -> bool {
        matches!(
            self.form,
            Form::Stiction | Form::Stribeck | Form::Hysteresis
        )
    }

    /// What the dotted names of its numbers begin with: its own section, or the law's.
    pub fn prefix(&self) -> &'static str {
        if self.is_law() { "contact." } else { self.name }
    }

    /// Whether it takes many starts with many free numbers to fit the effect.
    pub fn is_costly(&self) -> bool {
        matches!(self.form, Form::Hysteresis)
    }

    /// Name of the law of fewer numbers that this one becomes where a number of its own is zero, and that number.
    pub fn limit(&self) -> Option<(&'static str, &'static str)> {
        matches!(self.form, Form::Stribeck).then_some(("stiction", "contact.omega_s"))
    }

    /// Size of the fitted effect relative to one that is just worth naming: less changes the motion by less than real
    /// friction scatters, and may stand for an imperfection of the method.
    pub fn relative_size(&self, fitted: &Hypothesis) -> f64 {
        let value = |dotted: &str| fitted.value(dotted).unwrap_or(0.0);
        match self.form {
            Form::One {
                section,
                key,
                scale,
                near,
                ..
            } => {
                let size = value(&format!("{section}.{key}")) / scale;
                if is_off_at_one(near) {
                    (size - 1.0).abs() / LEAST_DEPARTURE
                } else {
                    size.abs() / LEAST_SIZE
                }
            }
            Form::Polar {
                section,
                amplitude,
                scale,
                ..
            } => value(&format!("{section}.{amplitude}")) / scale / LEAST_SIZE,
            Form::Relaxation => {
                value("shaft_hysteresis.stiffness") / RELAXING_STIFFNESS / LEAST_SIZE
            }
            Form::Bristles => FULL_BRISTLES / value("presliding.stiffness") / LEAST_SIZE,
            Form::Stiction | Form::Stribeck | Form::Hysteresis => f64::INFINITY,
        }
    }

    /// Names of the numbers that say how large the effect is, each with its value where the effect is none: one of them must
    /// be certain. Of stiction and Stribeck's law no number does.
    pub fn sizes(&self) -> Vec<(String, f64)> {
        match self.form {
            Form::One {
                section,
                key,
                scale,
                near,
                ..
            } => vec![(
                format!("{section}.{key}"),
                if is_off_at_one(near) { scale } else { 0.0 },
            )],
            Form::Polar {
                section, amplitude, ..
            } => vec![(format!("{section}.{amplitude}"), 0.0)],
            Form::Relaxation => vec![("shaft_hysteresis.stiffness".to_owned(), 0.0)],
            Form::Hysteresis => ["contact.a1", "contact.a2"]
                .map(|peak| (peak.to_owned(), 0.0))
                .to_vec(),
            // None is an infinite stiffness: what it gives way by is as certain, relative to itself, as the stiffness is.
            Form::Bristles => vec![("presliding.stiffness".to_owned(), 0.0)],
            Form::Stiction | Form::Stribeck => Vec::new(),
        }
    }

    /// Dotted names of the numbers all of which must differ from zero: a peak of no certain height or width is an offset,
    /// which other laws have too.
    pub fn essentials(&self) -> &'static [&'static str] {
        match self.form {
            Form::Hysteresis => &["contact.a1", "contact.a2", "contact.c1", "contact.c2"],
            _ => &[],
        }
    }

    /// Whether the effect cannot grow from nothing in small steps, so that a poor start says little.
    pub fn is_nonlinear(&self) -> bool {
        match self.form {
            Form::One { far, .. } => !far.is_empty(),
            Form::Bristles | Form::Hysteresis | Form::Stribeck | Form::Stiction => true,
            Form::Polar { .. } | Form::Relaxation => false,
        }
    }

    /// The hypotheses from which fits of this effect on top of `base` start; empty if the effect
    /// makes no sense there.
    ///
    /// With `far`, starts far from no effect are among them; without, only one that is hardly
    /// different from `base` for effects that can grow from nothing.
    pub fn starts(&self, base: &Hypothesis, far: bool) -> Vec<Hypothesis> {
        if base.effects.iter().any(|name| name == self.name) {
            return Vec::new();
        }
        let mut hypotheses = match self.form {
            Form::One {
                section,
                key,
                scale,
                low,
                high,
                near,
                far: distant,
            } => std::iter::once(&near)
                .chain(if far { distant } else { &[] })
                .map(|&start| {
                    let mut h = base.clone();
                    switch_on(&mut h, section, &[(key, start * scale)]);
                    let name = format!("{section}.{key}");
                    h.free.push(Free::Value {
                        name,
                        scale,
                        low,
                        high,
                    });
                    h.x.push(start);
                    h
                })
                .collect(),
            Form::Polar {
                section,
                amplitude,
                scale,
                high,
                held,
            } => {
                let (key, values) = held.first().copied().unwrap_or(("", &[0.0]));
                // Without a choice of orders there is room for starts far from nothing.
                let phases: &[f64] = if far && held.is_empty() {
                    &[0.0, 1.6, 3.1, 4.7]
                } else {
                    &[]
                };
                let near = values.iter().map(|&value| (value, 0.001, 0.0));
                let distant = phases.iter().map(|&phase| (0.0, 0.5, phase));
                near.chain(distant)
                    .map(|(value, size, angle)| {
                        let mut h = base.clone();
                        switch_on(
                            &mut h,
                            section,
                            &[(key, value), (amplitude, size * scale), ("phase", angle)],
                        );
                        h.free.push(Free::Polar {
                            amplitude: format!("{section}.{amplitude}"),
                            phase: format!("{section}.phase"),
                            scale,
                            high,
                        });
                        h.x.extend([size * angle.cos(), size * angle.sin()]);
                        h
                    })
                    .collect()
            }
            Form::Relaxation => [(0.01, 0.1), (0.01, 0.5)]
                .iter()
                .map(|&(stiffness, time)| {
                    with_values(
                        base,
                        "shaft_hysteresis",
                        &[
                            ("stiffness", RELAXING_STIFFNESS, 0.0, 1.0, stiffness),
                            ("relaxation_time", 1.0, 0.01, 3.0, time),
                        ],
                    )
                })
                .collect(),
            Form::Bristles if base.rig.law.band().0 > 0.0 => Vec::new(),
            Form::Bristles => BRISTLE_STARTS
                .iter()
                .map(|&(stiffness, damping)| {
                    let stiffness = stiffness / BRISTLES;
                    with_values(
                        base,
                        "presliding",
                        &[
                            ("stiffness", BRISTLES, 3.0, 6000.0, stiffness),
                            ("damping", 1.0, 0.0, 50.0, damping),
                        ],
                    )
                })
                .collect(),
            Form::Stiction => law_starts::stiction(base),
            Form::Stribeck => law_starts::stribeck(base),
            Form::Hysteresis => law_starts::hysteresis(base),
        };
        for h in &mut hypotheses {
            h.effects.push(self.name.to_owned());
        }
        hypotheses
    }
}

/// `base` with this section switched on and its numbers free: key, scale, smallest and largest value, start over scale.
fn with_values(
    base: &Hypothesis,
    section: &str,
    numbers: &[(&str, f64, f64, f64, f64)],
) -> Hypothesis {
    let mut h = base.clone();
    let values: Vec<(&str, f64)> = numbers
        .iter()
        .map(|&(key, scale, _, _, start)| (key, scale * start))
        .collect();
    switch_on(&mut h, section, &values);
    for &(key, scale, low, high, start) in numbers {
        h.free.push(Free::Value {
            name: format!("{section}.{key}"),
            scale,
            low,
            high,
        });
        h.x.push(start);
    }
    h
}

fn switch_on(hypothesis: &mut Hypothesis, section: &str, values: &[(&str, f64)]) {
    let value = |info: &'static stickslip::parameter::ParameterInfo| {
        let given = values
            .iter()
            .find(|(key, _)| *key == info.key)
            .map_or(0.0, |(_, v)| *v);
        Ok::<f64, Infallible>(given)
    };
    let _ = hypothesis.rig.effects.insert(section, value);
}
