//! A hypothesis: a rig with some effects, and which of its numbers are free.

use stickslip::parameter::ParameterError;
use stickslip::plant::{ModelFile, Rig};
use stickslip::series::{Dual, Scalar};

/// One or two numbers that a fit may change, and how they enter the model.
#[derive(Clone, Debug, PartialEq)]
pub enum Free {
    /// A nominal parameter, known to a relative standard deviation; the number is its relative
    /// change.
    Nominal {
        /// Dotted name.
        name: String,
        /// Value in the analyst's model.
        nominal: f64,
        /// Relative standard deviation of what is known.
        deviation: f64,
    },
    /// A parameter of an effect; the number is its value over `scale`.
    Value {
        /// Dotted name.
        name: String,
        /// Size of a full effect, which makes numbers comparable.
        scale: f64,
        /// Smallest value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// An amplitude and its phase, as the two numbers amplitude × (cos, sin)/`scale`.
    Polar {
        /// Dotted name of the amplitude.
        amplitude: String,
        /// Dotted name of the phase.
        phase: String,
        /// Size of a full effect.
        scale: f64,
        /// Largest amplitude.
        high: f64,
    },
}

impl Free {
    /// How many numbers it takes.
    pub fn width(&self) -> usize {
        if matches!(self, Self::Polar { .. }) {
            2
        } else {
            1
        }
    }
}

/// A model with free numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// Names of the effects added to the analyst's model.
    pub effects: Vec<String>,
    /// The rig with the effects switched on.
    pub rig: Rig<f64>,
    /// What is free.
    pub free: Vec<Free>,
    /// Values of the free numbers.
    pub x: Vec<f64>,
}

/// Distance from the end of its range, over its scale, within which a number has reached it.
const END: f64 = 1e-9;
/// How far a nominal parameter may move, in standard deviations of what is known of it.
const REACH: f64 = 12.0;

/// Relative standard deviations [1] of the nominal parameters where the model file states none: what the
/// records' description gives for the dissertation's rig.
const NOMINAL_DEVIATIONS: [(&str, f64); 14] = [
    ("disc.inertia", 0.006),
    ("shaft.stiffness", 0.02),
    ("shaft.damping", 0.06),
    ("motor.resistance", 0.02),
    ("motor.torque_constant", 0.02),
    ("motor.back_emf_constant", 0.01),
    ("motor.coulomb_torque", 0.04),
    ("contact.mu_c", 0.02),
    ("contact.mu_s", 0.02),
    ("contact.a1", 0.02),
    ("contact.a2", 0.02),
    ("disc1.inertia", 0.006),
    ("shaft1.stiffness", 0.02),
    ("shaft1.damping", 0.06),
];

impl Hypothesis {
    /// The analyst's model with its nominal parameters free within their uncertainty.
    pub fn base(model: &ModelFile) -> Self {
        let mut free = Vec::new();
        for parameter in model.rig.parameters() {
            let stated = model
                .provenance
                .get(&parameter.name)
                .and_then(|p| p.relative_uncertainty);
            let usual = NOMINAL_DEVIATIONS
                .iter()
                .find(|(name, _)| *name == parameter.name)
                .map(|(_, d)| *d);
            let nominal = model.rig.parameter(&parameter.name).unwrap_or(0.0);
            if let Some(deviation) = stated.or(usual).filter(|d| *d > 0.0 && nominal != 0.0) {
                free.push(Free::Nominal {
                    name: parameter.name,
                    nominal,
                    deviation,
                });
            }
        }
        let x = vec![0.0; free.len()];
        Self {
            effects: Vec::new(),
            rig: model.rig,
            free,
            x,
        }
    }

    /// Number of free numbers.
    pub fn dimension(&self) -> usize {
        self.x.len()
    }

    /// Prior precisions of the free numbers.
    pub fn prior_precisions(&self) -> Vec<f64> {
        let mut precisions = Vec::with_capacity(self.x.len());
        for free in &self.free {
            match free {
                Free::Nominal { deviation, .. } => precisions.push(1.0 / (deviation * deviation)),
                // An effect may well be ten times its usual size.
                Free::Value { .. } => precisions.push(1e-2),
                Free::Polar { .. } => precisions.extend([1e-2, 1e-2]),
            }
        }
        precisions
    }

    /// The present value of a free parameter or amplitude; `None` if it is not free.
    pub fn value(&self, dotted: &str) -> Option<f64> {
        let mut at = 0;
        for free in &self.free {
            match free {
                Free::Nominal { name, nominal, .. } if name == dotted => {
                    return Some(nominal * (1.0 + self.x[at]));
                }
                Free::Value { name, scale, .. } if name == dotted => {
                    return Some(scale * self.x[at]);
                }
                Free::Polar {
                    amplitude, scale, ..
                } if amplitude == dotted => {
                    return Some(scale * self.x[at].hypot(self.x[at + 1]));
                }
                _ => at += free.width(),
            }
        }
        None
    }

    /// Takes over the values of what is free in both.
    pub fn take_over(&mut self, other: &Self) {
        let mut at = 0;
        for free in &self.free {
            match free {
                Free::Nominal { name, nominal, .. } => {
                    if let Some(value) = other.value(name) {
                        self.x[at] = value / nominal - 1.0;
                    }
                }
                Free::Value { name, scale, .. } => {
                    if let Some(value) = other.value(name) {
                        self.x[at] = value / scale;
                    }
                }
                Free::Polar { .. } => {
                    if let Some(place) = other.place(free) {
                        self.x[at..at + 2].copy_from_slice(&other.x[place..place + 2]);
                    }
                }
            }
            at += free.width();
        }
    }

    /// Where the numbers of `wanted` begin.
    fn place(&self, wanted: &Free) -> Option<usize> {
        let before = self.free.iter().position(|free| free == wanted)?;
        Some(self.free[..before].iter().map(Free::width).sum())
    }

    /// The lowest value of a number that may go down to `low`: nothing breaks away below what it slides at.
    fn lowest(&self, name: &str, low: f64) -> f64 {
        let sliding = (name == "contact.mu_s").then(|| {
            self.value("contact.mu_c")
                .or_else(|| self.rig.parameter("contact.mu_c"))
        });
        sliding.flatten().map_or(low, |sliding| low.max(sliding))
    }

    /// What one step of a fit may change of each free number: not more than is within its range, nor so much that windows
    /// stick that did not, of which no derivative tells.
    pub fn step_ranges(&self) -> Vec<(f64, f64)> {
        let mut at = 0;
        let mut ranges = Vec::with_capacity(self.x.len());
        for free in &self.free {
            let x = self.x[at];
            match free {
                Free::Nominal { deviation, .. } => {
                    let reach = (REACH * deviation).min(0.9);
                    let most = 2.0 * deviation;
                    ranges.push(((-reach - x).clamp(-most, 0.0), (reach - x).clamp(0.0, most)));
                }
                Free::Value {
                    name,
                    scale,
                    low,
                    high,
                } => ranges.push((
                    (self.lowest(name, *low) / scale - x).clamp(-1.0, 0.0),
                    (high / scale - x).clamp(0.0, 1.0),
                )),
                Free::Polar { .. } => ranges.extend([(-1.0, 1.0), (-1.0, 1.0)]),
            }
            at += free.width();
        }
        ranges
    }

    /// Whether a number whose dotted name begins with `prefix` is where its range ends, so that its best value is none that it
    /// may have.
    pub fn has_reached_an_end(&self, prefix: &str) -> bool {
        let mut at = 0;
        self.free.iter().any(|free| {
            let x = self.x[at];
            at += free.width();
            match free {
                Free::Value {
                    name,
                    scale,
                    low,
                    high,
                } if name.starts_with(prefix) => {
                    let is_at = |end: f64| (x - end / scale).abs() < END;
                    is_at(self.lowest(name, *low)) || is_at(*high)
                }
                _ => false,
            }
        })
    }

    /// Moves the free numbers into what their ranges allow.
    pub fn clamp(&mut self) {
        let mut at = 0;
        for j in 0..self.free.len() {
            match &self.free[j] {
                Free::Nominal { deviation, .. } => {
                    let reach = (REACH * deviation).min(0.9);
                    self.x[at] = self.x[at].clamp(-reach, reach);
                }
                Free::Value {
                    name,
                    scale,
                    low,
                    high,
                } => {
                    let lowest = self.lowest(name, *low) / scale;
                    self.x[at] = self.x[at].clamp(lowest, (high / scale).max(lowest));
                }
                Free::Polar { scale, high, .. } => {
                    let size = self.x[at].hypot(self.x[at + 1]);
                    if size > high / scale {
                        let shrink = high / scale / size;
                        self.x[at] *= shrink;
                        self.x[at + 1] *= shrink;
                    }
                }
            }
            at += self.free[j].width();
        }
    }

    /// The rig at the present values.
    pub fn rig_at(&self) -> Result<Rig<f64>, ParameterError> {
        self.build(&self.x.clone())
    }

    /// The rig with derivatives with respect to the free numbers in the slots from `first` on.
    pub fn rig_with_slots<const N: usize>(
        &self,
        first: usize,
    ) -> Result<Rig<Dual<N>>, ParameterError> {
        let x: Vec<Dual<N>> = self
            .x
            .iter()
            .enumerate()
            .map(|(j, &value)| {
                if first + j < N {
                    Dual::variable(value, first + j)
                } else {
                    Dual::constant(value)
                }
            })
            .collect();
        self.build(&x)
    }

    fn build<S: Scalar>(&self, x: &[S]) -> Result<Rig<S>, ParameterError> {
        let mut rig: Rig<S> = self.rig.lift();
        let mut at = 0;
        for free in &self.free {
            match free {
                Free::Nominal { name, nominal, .. } => {
                    rig.set_parameter(name, (x[at] + 1.0) * *nominal)?;
                }
                Free::Value { name, scale, .. } => rig.set_parameter(name, x[at] * *scale)?,
                Free::Polar {
                    amplitude,
                    phase,
                    scale,
                    ..
                } => {
                    let (c, s) = (x[at], x[at + 1]);
                    let size = (c * c + s * s + 1e-18).sqrt();
                    rig.set_parameter(amplitude, size * *scale)?;
                    rig.set_parameter(phase, s.atan2(c))?;
                }
            }
            at += free.width();
        }
        Ok(rig)
    }

    /// Values and standard deviations of the parameters of what is free, by dotted name, from the
    /// covariance of the free numbers.
    pub fn estimates(&self, covariance: impl Fn(usize, usize) -> f64) -> Vec<Estimate> {
        let mut estimates = Vec::new();
        let mut at = 0;
        for free in &self.free {
            match free {
                Free::Nominal { name, nominal, .. } => estimates.push(Estimate {
                    name: name.clone(),
                    value: nominal * (1.0 + self.x[at]),
                    deviation: nominal.abs() * covariance(at, at).max(0.0).sqrt(),
                    is_nominal: true,
                }),
                Free::Value { name, scale, .. } => estimates.push(Estimate {
                    name: name.clone(),
                    value: scale * self.x[at],
                    deviation: scale.abs() * covariance(at, at).max(0.0).sqrt(),
                    is_nominal: false,
                }),
                Free::Polar {
                    amplitude,
                    phase,
                    scale,
                    ..
                } => {
                    let (c, s) = (self.x[at], self.x[at + 1]);
                    let size = c.hypot(s).max(1e-12);
                    let (ec, es) = (c / size, s / size);
                    let (cc, cs, ss) = (
                        covariance(at, at),
                        covariance(at, at + 1),
                        covariance(at + 1, at + 1),
                    );
                    let along = ec * ec * cc + 2.0 * ec * es * cs + es * es * ss;
                    let across = es * es * cc - 2.0 * ec * es * cs + ec * ec * ss;
                    estimates.push(Estimate {
                        name: amplitude.clone(),
                        value: scale * size,
                        deviation: scale * along.max(0.0).sqrt(),
                        is_nominal: false,
                    });
                    estimates.push(Estimate {
                        name: phase.clone(),
                        value: s.atan2(c).rem_euclid(std::f64::consts::TAU),
                        deviation: across.max(0.0).sqrt() / size,
                        is_nominal: false,
                    });
                }
            }
            at += free.width();
        }
        estimates
    }
}

/// An estimated parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Dotted name.
    pub name: String,
    /// Value, SI.
    pub value: f64,
    /// Standard deviation, SI.
    pub deviation: f64,
    /// Whether it is a nominal parameter, not one of an added effect.
    pub is_nominal: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_effects_own_numbers_reach_an_end() {
        let text = include_str!("../../../../modelDescription/reduced-rig.toml");
        let model = ModelFile::parse(text, "rig").unwrap();
        let mut hypothesis = Hypothesis::base(&model);
        hypothesis.free.push(Free::Value {
            name: "shaft_hysteresis.relaxation_time".to_owned(),
            scale: 0.7,
            low: 0.01,
            high: 3.0,
        });
        for (beyond, reached) in [(-1.0, true), (0.5, false), (9.0, true)] {
            let mut fitted = hypothesis.clone();
            fitted.x.push(beyond);
            fitted.clamp();
            assert_eq!(
                fitted.has_reached_an_end("shaft_hysteresis"),
                reached,
                "{beyond}"
            );
            assert!(!fitted.has_reached_an_end("unbalance"));
        }
    }
}
