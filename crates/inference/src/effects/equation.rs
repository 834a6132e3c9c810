//! An effect that a file describes by an equation, as a hypothesis: which of its numbers make it vanish, how large it is as a
//! share of what the records show, and from where fits of it start. All of it follows from the equation and its units.

use super::{NEAR, push, switch_on};
use crate::hypothesis::{Free, Hypothesis};
use crate::numbers::{self, BOUND, Known, NARROW, Number, USUAL, recognise, starts};
use crate::scales::Scales;
use crate::units::PlantUnits;
use stickslip::expression::{Coordinate, Dimension};
use stickslip::parameter::{ParameterError, ParameterInfo, Range};
use stickslip::plant::{Definition, Port, Rig, Supposition};

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
        let signed = |coordinate, share: f64| match coordinate {
            Coordinate::TwistRate => 2.0 * share - 1.0,
            Coordinate::Velocity | Coordinate::Twist => 1.2 * share - 0.2,
            _ => share,
        };
        let places = numbers::places()
            .iter()
            .map(|shares: &[f64; Coordinate::ALL.len()]| {
                std::array::from_fn(|j| {
                    let coordinate = Coordinate::ALL[j];
                    signed(coordinate, shares[j]) * largest(coordinate)
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
        let by_size =
            Dimension::of_unit(info.unit).map_or(1.0, |dimension| dimension.scale(self.sizes));
        let uses_time = definition.uses(Coordinate::Time);
        numbers::natural(info.unit, uses_time, self.duration, by_size)
    }
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
        if definition.port().is_on_disc1() && rig.disc1.is_none() {
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
        let infos = definition.infos().iter().zip(supposition.guesses);
        let known: Vec<Known<'_>> = infos
            .map(|(info, guess)| Known {
                range: info.range,
                unit: info.unit,
                natural: magnitudes.natural(definition, info),
                guess,
            })
            .collect();
        let values = |parameters: &[f64]| magnitudes.values(definition, parameters);
        let numbers = recognise(&known, USUAL * magnitudes.base, &values).ok_or_else(|| {
            wrong(
                definition,
                "no value of a parameter makes the equation vanish, so that the records cannot be asked whether they need it; \
                 multiply the equation by a parameter",
            )
        })?;
        Ok(Self {
            definition,
            numbers,
        })
    }

    pub fn name(&self) -> &'static str {
        self.definition.name()
    }

    /// Keys of the numbers that make it vanish, with the values where they do.
    pub fn vanishing(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let numbers = self.definition.infos().iter().zip(&self.numbers);
        numbers.filter_map(|(info, number)| match *number {
            Number::Amplitude { origin, .. } => Some((info.key, origin)),
            _ => None,
        })
    }

    /// Whether some of its numbers shape it, of which no derivative tells before there is an effect.
    pub fn has_shape(&self) -> bool {
        self.numbers
            .iter()
            .any(|number| matches!(number, Number::Shape { .. }))
    }

    /// The hypotheses from which fits start on top of `base`.
    pub fn starts(&self, base: &Hypothesis) -> Vec<Hypothesis> {
        starts(&self.numbers, NEAR, &[0.0])
            .iter()
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
