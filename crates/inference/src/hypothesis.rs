//! A hypothesis: a rig with some effects, and which of its numbers are free.

use crate::units::is_level;
use stickslip::parameter::ParameterError;
use stickslip::plant::Rig;
use stickslip::series::{Dual, Scalar};

/// One or two numbers that a fit may change, and how they enter the model.
#[derive(Clone, Debug, PartialEq)]
pub enum Free {
    /// A nominal parameter, known to a relative standard deviation; the number is the logarithm of its change, since products and
    /// quotients of parameters are what records tell.
    Nominal {
        /// Dotted name.
        name: String,
        /// Value in the analyst's model.
        nominal: f64,
        /// Relative standard deviation of what is known.
        deviation: f64,
    },
    /// A parameter of an effect: `origin` + `scale` times the number, whose standard deviation is 1 a priori.
    Value {
        /// Dotted name.
        name: String,
        /// Value where the number is zero.
        origin: f64,
        /// Size of an effect that is as large as effects are.
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
        /// Size of an effect that is as large as effects are.
        scale: f64,
        /// Largest amplitude.
        high: f64,
    },
    /// All levels of the friction law times the exponential of the number: the force to which a load exponent refers.
    Level,
}

/// Furthest that a nominal parameter may move, in standard deviations of what is known of it.
const REACH: f64 = 12.0;
/// Distance from the end of its range, over its scale, within which a number has reached it.
const END: f64 = 1e-9;

impl Free {
    /// How many numbers it takes.
    #[must_use]
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

impl Hypothesis {
    /// `rig` with its nominal parameters free within the relative standard deviations of `uncertainties`.
    #[must_use]
    pub fn base(rig: &Rig<f64>, uncertainties: &[(String, f64)]) -> Self {
        let free: Vec<Free> = uncertainties
            .iter()
            .filter_map(|(name, deviation)| {
                let nominal = rig.parameter(name).filter(|value| *value != 0.0)?;
                (*deviation > 0.0).then(|| Free::Nominal {
                    name: name.clone(),
                    nominal,
                    deviation: *deviation,
                })
            })
            .collect();
        let x = vec![0.0; free.len()];
        Self {
            effects: Vec::new(),
            rig: *rig,
            free,
            x,
        }
    }

    /// Number of free numbers.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.x.len()
    }

    /// Prior precisions of the free numbers.
    #[must_use]
    pub fn prior_precisions(&self) -> Vec<f64> {
        let mut precisions = Vec::with_capacity(self.x.len());
        for free in &self.free {
            match free {
                Free::Nominal { deviation, .. } => precisions.push(1.0 / (deviation * deviation)),
                _ => precisions.extend(std::iter::repeat_n(1.0, free.width())),
            }
        }
        precisions
    }

    /// By how many of their standard deviations the nominal parameters are off.
    #[must_use]
    pub fn nominal_deviations(&self) -> Vec<f64> {
        let mut all = Vec::new();
        let mut at = 0;
        for free in &self.free {
            if let Free::Nominal { deviation, .. } = free {
                all.push(self.x[at] / deviation);
            }
            at += free.width();
        }
        all
    }

    /// The present value of a free parameter or amplitude; `None` if it is not free.
    #[must_use]
    pub fn value(&self, dotted: &str) -> Option<f64> {
        let mut at = 0;
        for free in &self.free {
            match free {
                Free::Nominal { name, nominal, .. } if name == dotted => {
                    return Some(nominal * self.x[at].exp());
                }
                Free::Value {
                    name,
                    origin,
                    scale,
                    ..
                } if name == dotted => return Some(origin + scale * self.x[at]),
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
                        self.x[at] = (value / nominal).ln();
                    }
                }
                Free::Value {
                    name,
                    origin,
                    scale,
                    ..
                } => {
                    if let Some(value) = other.value(name) {
                        self.x[at] = (value - origin) / scale;
                    }
                }
                Free::Polar { .. } | Free::Level => {
                    if let Some(place) = other.place(free) {
                        let width = free.width();
                        self.x[at..at + width].copy_from_slice(&other.x[place..place + width]);
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

    /// First of the free numbers of an effect and how many there are, where the effect is none if all of them are zero.
    #[must_use]
    pub fn numbers_of(&self, effect: &str) -> Option<(usize, usize)> {
        let (mut at, mut first, mut width) = (0, None, 0);
        for free in &self.free {
            let is_own = match free {
                Free::Value { name, .. } => name.split('.').next() == Some(effect),
                Free::Polar { amplitude, .. } => amplitude.split('.').next() == Some(effect),
                Free::Level => effect == "load_exponent",
                Free::Nominal { .. } => false,
            };
            if is_own {
                first.get_or_insert(at);
                width += free.width();
            }
            at += free.width();
        }
        first.map(|first| (first, width))
    }

    /// The lowest value of a number that may go down to `low`: nothing breaks away below what it slides at.
    fn lowest(&self, name: &str, low: f64) -> f64 {
        let sliding = (name == "contact.mu_s").then(|| {
            self.value("contact.mu_c")
                .or_else(|| self.rig.parameter("contact.mu_c"))
        });
        sliding.flatten().map_or(low, |sliding| low.max(sliding))
    }

    /// How far down and up each free number may go within its range.
    #[must_use]
    pub fn step_ranges(&self) -> Vec<(f64, f64)> {
        let mut at = 0;
        let mut ranges = Vec::with_capacity(self.x.len());
        let unbounded = (f64::NEG_INFINITY, f64::INFINITY);
        for free in &self.free {
            let x = self.x[at];
            match free {
                Free::Nominal { deviation, .. } => {
                    let reach = (REACH * deviation).min(0.9);
                    ranges.push((-reach - x, reach - x));
                }
                Free::Value {
                    name,
                    origin,
                    scale,
                    low,
                    high,
                } => ranges.push((
                    ((self.lowest(name, *low) - origin) / scale - x).min(0.0),
                    ((high - origin) / scale - x).max(0.0),
                )),
                Free::Polar { .. } => ranges.extend([unbounded, unbounded]),
                Free::Level => ranges.push(unbounded),
            }
            at += free.width();
        }
        ranges
    }

    /// The most that one step of a fit may change each free number by, so that windows do not stick that did not, of which no
    /// derivative tells.
    #[must_use]
    pub fn longest_step(&self) -> Vec<f64> {
        let mut longest = Vec::with_capacity(self.x.len());
        for free in &self.free {
            match free {
                Free::Nominal { deviation, .. } => longest.push(2.0 * deviation),
                Free::Value { .. } => longest.push(0.5),
                Free::Polar { .. } => longest.extend([0.5, 0.5]),
                Free::Level => longest.push(0.2),
            }
        }
        longest
    }

    /// Names of the numbers that are where their range ends, so that their best value is none that they may have.
    #[must_use]
    pub fn at_an_end(&self) -> Vec<&str> {
        let mut at = 0;
        let mut names = Vec::new();
        for free in &self.free {
            let x = self.x[at];
            at += free.width();
            if let Free::Value {
                name,
                origin,
                scale,
                low,
                high,
            } = free
            {
                let is_at = |end: f64| (x - (end - origin) / scale).abs() < END;
                if is_at(self.lowest(name, *low)) || is_at(*high) {
                    names.push(name.as_str());
                }
            }
        }
        names
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
                    origin,
                    scale,
                    low,
                    high,
                } => {
                    let lowest = (self.lowest(name, *low) - origin) / scale;
                    self.x[at] = self.x[at].clamp(lowest, ((high - origin) / scale).max(lowest));
                }
                Free::Polar { scale, high, .. } => {
                    let size = self.x[at].hypot(self.x[at + 1]);
                    if size > high / scale {
                        let shrink = high / scale / size;
                        self.x[at] *= shrink;
                        self.x[at + 1] *= shrink;
                    }
                }
                Free::Level => {}
            }
            at += self.free[j].width();
        }
    }

    /// The rig at the present values.
    ///
    /// # Errors
    /// A number leaves its range.
    pub fn rig_at(&self) -> Result<Rig<f64>, ParameterError> {
        self.build(&self.x)
    }

    /// The rig with derivatives with respect to the free numbers in the slots from `first` on.
    ///
    /// # Errors
    /// A number leaves its range.
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
        let mut rig: Rig<S> = self.rig.to_scalar();
        let mut at = 0;
        for free in &self.free {
            match free {
                Free::Nominal { name, nominal, .. } => {
                    rig.set_parameter(name, x[at].exp() * *nominal)?;
                }
                Free::Value {
                    name,
                    origin,
                    scale,
                    ..
                } => rig.set_parameter(name, x[at] * *scale + *origin)?,
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
                Free::Level => {}
            }
            at += free.width();
        }
        let mut at = 0;
        for free in &self.free {
            if *free == Free::Level {
                let factor = x[at].exp();
                for parameter in self.rig.parameters().iter().filter(|p| is_level(&p.name)) {
                    if let Some(level) = rig.parameter(&parameter.name) {
                        rig.set_parameter(&parameter.name, level * factor)?;
                    }
                }
            }
            at += free.width();
        }
        Ok(rig)
    }

    /// Values and standard deviations of the parameters of what is free, by dotted name, from the covariance of the free
    /// numbers.
    pub fn estimates(&self, covariance: impl Fn(usize, usize) -> f64) -> Vec<Estimate> {
        let mut estimates = Vec::new();
        let mut at = 0;
        for free in &self.free {
            let mut push = |name: &str, value: f64, deviation: f64, is_nominal: bool| {
                estimates.push(Estimate {
                    name: name.to_owned(),
                    value,
                    deviation,
                    is_nominal,
                });
            };
            let own = covariance(at, at).max(0.0).sqrt();
            match free {
                Free::Nominal { name, nominal, .. } => {
                    let value = nominal * self.x[at].exp();
                    push(name, value, value.abs() * own, true);
                }
                Free::Value {
                    name,
                    origin,
                    scale,
                    ..
                } => push(name, origin + scale * self.x[at], scale.abs() * own, false),
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
                    push(
                        amplitude,
                        scale * size,
                        scale * along.max(0.0).sqrt(),
                        false,
                    );
                    let turn = s.atan2(c).rem_euclid(std::f64::consts::TAU);
                    push(phase, turn, across.max(0.0).sqrt() / size, false);
                }
                Free::Level => {}
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
    /// Value.
    pub value: f64,
    /// Standard deviation.
    pub deviation: f64,
    /// Whether it is a nominal parameter, not one of an added effect.
    pub is_nominal: bool,
}
