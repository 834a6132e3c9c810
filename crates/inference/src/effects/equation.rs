//! An effect that a file describes by an equation, as a hypothesis: which of its numbers make it vanish, how large it is as a
//! share of what the records show, and from where fits of it start. All of it follows from the equation and its units.

use super::{BOUND, NARROW, NEAR, USUAL, push, switch_on};
use crate::hypothesis::{Free, Hypothesis};
use crate::scales::Scales;
use crate::units::PlantUnits;
use stickslip::expression::{Coordinate, Dimension};
use stickslip::parameter::{ParameterError, ParameterInfo, Range};
use stickslip::plant::{Definition, Port, Rig, Supposition};

/// Places at which an equation is looked at: enough for means of a few per cent.
const PLACES: usize = 97;
/// The root of x⁹ = x + 1. Multiples of its powers fill a space of eight coordinates evenly (M. Roberts, *The unreasonable
/// effectiveness of quasirandom sequences*, 2018).
const EVEN: f64 = 1.085_070_245_491_450_8;
/// Differences, as a share of what they are compared with, that are rounding.
const ROUNDING: f64 = 1e-9;
/// Share of itself by which a number moves to see what it does.
const MOVE: f64 = 1e-4;
/// Most starts of one effect.
const MOST_STARTS: usize = 24;
/// Phases from which fits start that do not begin with hardly any effect.
const PHASES: [f64; 4] = [0.0, 1.6, 3.1, 4.7];

/// One number of the effect.
#[derive(Clone, Debug, PartialEq)]
enum Number {
    /// It is `origin` where there is no effect.
    Amplitude { origin: f64, scale: f64 },
    /// The angle at which the effect is largest.
    Phase,
    /// It says at which place or how wide the effect is: where fits start, and what is known of it.
    Shape {
        starts: Vec<f64>,
        origin: f64,
        scale: f64,
        bounds: (f64, f64),
    },
}

/// An effect by equation on a plant of known size.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Equation {
    definition: &'static Definition,
    numbers: Vec<Number>,
}

/// How large the coordinates of an equation are in the records, and what it acts on, SI units.
struct Magnitudes {
    places: Vec<[f64; Coordinate::ALL.len()]>,
    base: f64,
    /// SI values of a mass, a length, a time and a current of the plant's size.
    sizes: [f64; 4],
    duration: f64,
}

impl Magnitudes {
    fn of(port: Port, rig: &Rig<f64>, scales: &Scales, units: &PlantUnits) -> Self {
        let ratio = rig.gearbox.ratio;
        let torque = scales.torque * units.torque;
        let speed = scales.speed / units.time;
        let current = scales.current * units.current;
        let volts = scales.current * rig.motor.resistance
            + rig.motor.back_emf_constant * ratio * scales.speed;
        let volts = volts * units.voltage();
        let force = if scales.load > 0.0 {
            scales.load * units.force
        } else {
            torque / (rig.contact.radius * units.torque / units.force)
        };
        let duration = scales.duration * units.time;
        let of_motor = matches!(port, Port::MotorTorque | Port::MotorVoltage);
        let velocity = if of_motor { ratio * speed } else { speed };
        let largest = |coordinate| match coordinate {
            Coordinate::Angle => std::f64::consts::TAU,
            Coordinate::Velocity => velocity,
            Coordinate::Twist => scales.twist,
            Coordinate::TwistRate => speed,
            Coordinate::Current => current,
            Coordinate::Voltage => volts,
            Coordinate::Load => scales.load * units.force,
            Coordinate::Time => duration,
        };
        let places = (0..PLACES)
            .map(|place| {
                std::array::from_fn(|j| {
                    let share = (0.5 + (place + 1) as f64 * EVEN.powi(-(j as i32 + 1))).fract();
                    let signed = match Coordinate::ALL[j] {
                        Coordinate::TwistRate => 2.0 * share - 1.0,
                        Coordinate::Velocity | Coordinate::Twist => 1.2 * share - 0.2,
                        _ => share,
                    };
                    signed * largest(Coordinate::ALL[j])
                })
            })
            .collect();
        let base = match port {
            Port::DiscTorque | Port::Disc1Torque | Port::ShaftTorque | Port::Shaft1Torque => torque,
            Port::MotorTorque => torque / ratio,
            Port::MotorVoltage => volts,
            Port::MotorResistance => {
                current * rig.motor.resistance * units.voltage() / units.current
            }
            Port::DiscFriction | Port::Disc1Friction => 1.0,
        };
        let length = torque / force;
        let time = 1.0 / speed;
        let mass = force * time * time / length;
        Self {
            places,
            base,
            sizes: [mass, length, time, current],
            duration,
        }
    }

    /// Values of the equation over the places, less that of no effect.
    fn values(&self, definition: &Definition, parameters: &[f64]) -> Vec<f64> {
        let neutral = definition.port().neutral();
        let value = |place: &[f64; Coordinate::ALL.len()]| {
            definition.value(|coordinate| place[coordinate as usize], parameters) - neutral
        };
        self.places.iter().map(value).collect()
    }

    /// A number of the parameter's unit that is as large as such numbers are on this plant.
    fn natural(&self, definition: &Definition, info: &ParameterInfo) -> f64 {
        if info.unit == "s" && definition.uses(Coordinate::Time) {
            return self.duration;
        }
        Dimension::of_unit(info.unit).map_or(1.0, |dimension| dimension.scale(self.sizes))
    }
}

fn size(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    size(&differences)
}

impl Equation {
    /// The effect on a plant of this size.
    ///
    /// # Errors
    /// No value of its numbers makes it vanish, so that it cannot be compared with no effect, or the rig cannot have it.
    pub fn of(
        supposition: &Supposition,
        rig: &Rig<f64>,
        scales: &Scales,
        units: &PlantUnits,
    ) -> Result<Self, ParameterError> {
        let definition = supposition.definition;
        let mut with = *rig;
        with.equations.add(definition)?;
        if definition.port().is_outer() && rig.outer.is_none() {
            let message = "it acts on disc D1 or its shaft, and this model is the reduced rig, which has neither";
            return Err(wrong(definition, message));
        }
        let is_on = rig
            .equations
            .active()
            .any(|other| other.definition == definition);
        if is_on {
            return Err(wrong(definition, "the model has this effect already"));
        }
        let magnitudes = Magnitudes::of(definition.port(), rig, scales, units);
        let usual = shapes(supposition, &magnitudes);
        let typical: Vec<f64> = usual
            .iter()
            .map(|shape| shape.0[shape.0.len() / 2])
            .collect();
        let origins = amplitudes(definition, &magnitudes, &typical).ok_or_else(|| {
            wrong(
                definition,
                "no value of a parameter makes the equation vanish, so that the records cannot be asked whether they need it; \
                 multiply the equation by a parameter",
            )
        })?;
        let base = magnitudes.base;
        let mut numbers = Vec::new();
        let mut held = typical.clone();
        for (place, origin) in origins.iter().enumerate() {
            if let Some(origin) = origin {
                held[place] = *origin;
            }
        }
        for (place, (starts, origin, scale, bounds)) in usual.into_iter().enumerate() {
            numbers.push(match origins[place] {
                Some(origin) => {
                    let step = MOVE * magnitudes.natural(definition, &definition.infos()[place]);
                    let mut moved = held.clone();
                    moved[place] += step;
                    let slope = size(&magnitudes.values(definition, &moved)) / step;
                    Number::Amplitude {
                        origin,
                        scale: USUAL * base / slope,
                    }
                }
                None => Number::Shape {
                    starts,
                    origin,
                    scale,
                    bounds,
                },
            });
        }
        if origins.iter().flatten().count() == 1
            && let Some(place) = phase(definition, &magnitudes, &origins, &typical)
        {
            numbers[place] = Number::Phase;
        }
        Ok(Self {
            definition,
            numbers,
        })
    }

    pub fn name(&self) -> &'static str {
        self.definition.name()
    }

    /// Whether some of its numbers shape it, of which no derivative tells before there is an effect.
    pub fn has_shape(&self) -> bool {
        self.numbers
            .iter()
            .any(|number| matches!(number, Number::Shape { .. }))
    }

    /// The hypotheses from which fits start on top of `base`.
    pub fn starts(&self, base: &Hypothesis) -> Vec<Hypothesis> {
        let mut sets: Vec<Vec<f64>> = vec![Vec::new()];
        for number in &self.numbers {
            let own = match number {
                Number::Amplitude { origin, scale } if scale.is_finite() => {
                    vec![origin + NEAR * scale]
                }
                // Nothing of it shows at these speeds, loads and times.
                Number::Amplitude { .. } => Vec::new(),
                Number::Phase => vec![0.0],
                Number::Shape { starts, .. } => starts.clone(),
            };
            sets = sets
                .iter()
                .flat_map(|set| own.iter().map(|value| [&set[..], &[*value]].concat()))
                .collect();
        }
        let every = sets.len().div_ceil(MOST_STARTS).max(1);
        sets.iter()
            .step_by(every)
            .filter_map(|values| self.start(base, values))
            .collect()
    }

    fn start(&self, base: &Hypothesis, values: &[f64]) -> Option<Hypothesis> {
        let mut h = base.clone();
        h.rig.equations.add(self.definition).ok()?;
        let infos = self.definition.infos();
        let named: Vec<(&str, f64)> = infos
            .iter()
            .map(|i| i.key)
            .zip(values.iter().copied())
            .collect();
        switch_on(&mut h, self.name(), &named);
        let phase = self.numbers.iter().position(|n| *n == Number::Phase);
        for (place, number) in self.numbers.iter().enumerate() {
            let Number::Amplitude { origin, scale } = *number else {
                continue;
            };
            let (info, reach) = (&infos[place], BOUND * scale);
            let low = match info.range {
                Range::Positive => NARROW * NEAR * scale,
                range => range
                    .minimum()
                    .map_or(origin - reach, |low| low.max(origin - reach)),
            };
            let high = info
                .range
                .maximum()
                .map_or(origin + reach, |high| high.min(origin + reach));
            if let Some(phase) = phase {
                h.free.push(Free::Polar {
                    amplitude: format!("{}.{}", self.name(), info.key),
                    phase: format!("{}.{}", self.name(), infos[phase].key),
                    scale,
                    high,
                });
                h.x.extend([NEAR, 0.0]);
            } else {
                let value = values[place];
                push(
                    &mut h,
                    self.name(),
                    info.key,
                    (origin, scale),
                    (low, high),
                    value,
                );
            }
        }
        for (place, number) in self.numbers.iter().enumerate() {
            if let Number::Shape {
                origin,
                scale,
                bounds,
                ..
            } = *number
            {
                let (key, value) = (infos[place].key, values[place]);
                push(&mut h, self.name(), key, (origin, scale), bounds, value);
            }
        }
        Some(h)
    }
}

fn wrong(definition: &Definition, message: &str) -> ParameterError {
    ParameterError::Inconsistent {
        section: format!("effect {}", definition.name()),
        message: message.to_owned(),
    }
}

/// Of every number, if it were one of the shape: starts, middle and standard deviation of what is known, and its range.
type Shape = (Vec<f64>, f64, f64, (f64, f64));

fn shapes(supposition: &Supposition, magnitudes: &Magnitudes) -> Vec<Shape> {
    let definition = supposition.definition;
    definition
        .infos()
        .iter()
        .zip(supposition.guesses)
        .map(|(info, guess)| {
            let natural = magnitudes.natural(definition, info);
            let (starts, origin, scale, bounds) = match info.range {
                Range::Between(low, high) => {
                    let width = high - low;
                    let starts = [1.0, 3.0, 5.0].map(|sixth| low + width * sixth / 6.0);
                    (
                        starts.to_vec(),
                        0.5 * (low + high),
                        0.5 * width,
                        (low, high),
                    )
                }
                Range::Positive | Range::NonNegative => (
                    [0.1, 0.3, 1.0].map(|share| share * natural).to_vec(),
                    natural,
                    3.0 * natural,
                    (NARROW * natural, BOUND * natural),
                ),
                Range::Finite => (
                    if info.unit == "rad" {
                        PHASES.to_vec()
                    } else {
                        [0.2, 0.5, 0.8].map(|share| share * natural).to_vec()
                    },
                    0.0,
                    natural,
                    (-BOUND * natural, BOUND * natural),
                ),
            };
            match guess {
                Some(guess) => (
                    vec![guess],
                    origin,
                    scale,
                    (bounds.0.min(guess), bounds.1.max(guess)),
                ),
                None => (starts, origin, scale, bounds),
            }
        })
        .collect()
}

/// Of every number the value at which the effect vanishes, where it is one that decides that: one number, if possible one to which the
/// effect is proportional, else the fewest that must vanish together.
fn amplitudes(
    definition: &Definition,
    magnitudes: &Magnitudes,
    typical: &[f64],
) -> Option<Vec<Option<f64>>> {
    let count = typical.len();
    let whole = size(&magnitudes.values(definition, typical));
    let naturals: Vec<f64> = definition
        .infos()
        .iter()
        .map(|info| magnitudes.natural(definition, info))
        .collect();
    let vanishes = |origins: &[Option<f64>]| {
        let at: Vec<f64> = typical
            .iter()
            .zip(origins)
            .map(|(typical, origin)| origin.unwrap_or(*typical))
            .collect();
        let may_be = |(info, origin): (&ParameterInfo, &Option<f64>)| {
            origin.is_none_or(|origin| {
                info.range.minimum().is_none_or(|low| low <= origin)
                    && info.range.maximum().is_none_or(|high| origin <= high)
            })
        };
        if !definition.infos().iter().zip(origins).all(may_be) {
            return false;
        }
        let left = size(&magnitudes.values(definition, &at));
        left <= ROUNDING * whole.max(f64::MIN_POSITIVE) || (whole.is_nan() && left == 0.0)
    };
    let is_proportional = |place: usize| {
        let at = |share: f64| {
            let mut at = typical.to_vec();
            at[place] = share * MOVE * naturals[place];
            magnitudes.values(definition, &at)
        };
        let (one, two) = (at(1.0), at(2.0));
        let doubled: Vec<f64> = one.iter().map(|v| 2.0 * v).collect();
        difference(&doubled, &two) <= 1e3 * ROUNDING * size(&two)
    };
    let only = |place: usize, origin: f64| {
        let mut origins = vec![None; count];
        origins[place] = Some(origin);
        origins
    };
    let single: Vec<Vec<Option<f64>>> = (0..count)
        .flat_map(|place| [0.0, 1.0].map(|origin| (place, origin)))
        .filter(|&(place, origin)| {
            let info = &definition.infos()[place];
            let may_be_one = Dimension::of_unit(info.unit) == Ok(Dimension::NONE);
            origin == 0.0 || may_be_one
        })
        .map(|(place, origin)| only(place, origin))
        .filter(|origins| vanishes(origins))
        .collect();
    let proportional = single.iter().find(|origins| {
        let place = origins.iter().position(Option::is_some);
        place.is_some_and(|place| origins[place] == Some(0.0) && is_proportional(place))
    });
    if let Some(found) = proportional.or(single.first()) {
        return Some(found.clone());
    }
    let mut sets: Vec<usize> = (1..1usize << count).collect();
    sets.sort_by_key(|set| set.count_ones());
    sets.into_iter()
        .map(|set| {
            (0..count)
                .map(|place| (set >> place & 1 == 1).then_some(0.0))
                .collect::<Vec<_>>()
        })
        .find(|origins| vanishes(origins))
}

/// The number that turns the effect: its cosine times the effect at zero, and its sine times the effect a quarter of a turn on.
fn phase(
    definition: &Definition,
    magnitudes: &Magnitudes,
    origins: &[Option<f64>],
    typical: &[f64],
) -> Option<usize> {
    let amplitude = origins.iter().position(Option::is_some)?;
    let info = &definition.infos()[amplitude];
    if origins[amplitude] != Some(0.0) || matches!(info.range, Range::Between(low, _) if low > 0.0)
    {
        return None;
    }
    (0..typical.len()).find(|&place| {
        let info = &definition.infos()[place];
        let turned = |phase: f64| {
            let mut at = typical.to_vec();
            at[amplitude] = MOVE * magnitudes.natural(definition, &definition.infos()[amplitude]);
            at[place] = phase;
            magnitudes.values(definition, &at)
        };
        let (along, across) = (turned(0.0), turned(std::f64::consts::FRAC_PI_2));
        let is_turned = |phase: f64| {
            let (s, c) = phase.sin_cos();
            let sum: Vec<f64> = along
                .iter()
                .zip(&across)
                .map(|(a, b)| c * a + s * b)
                .collect();
            difference(&sum, &turned(phase)) <= 1e3 * ROUNDING * size(&sum)
        };
        place != amplitude
            && info.range == Range::Finite
            && Dimension::of_unit(info.unit) == Ok(Dimension::NONE)
            && [0.7, 2.1, 4.0].into_iter().all(is_turned)
    })
}
