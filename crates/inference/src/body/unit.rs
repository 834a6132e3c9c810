//! Usual sizes of what parameters measure.

use std::f64::consts::TAU;

use stickslip::body::{Dimension, Path};
use stickslip::expression::Dimension as SiDimension;

use super::motion::Scales;

/// A dimension whose numbers have a usual size on given records.
pub trait Usual {
    /// Usual size of such a number on records of these sizes.
    #[must_use]
    fn scale(self, scales: &Scales) -> f64;

    /// By how much the plant passes such a number between two samples.
    #[must_use]
    fn in_a_sample(self, scales: &Scales) -> f64;
}

impl Usual for Dimension {
    fn scale(self, scales: &Scales) -> f64 {
        let Scales {
            position,
            speed,
            acceleration,
            force,
            duration,
            voltage,
            ..
        } = *scales;
        match self {
            Self::Inertia => force / acceleration,
            Self::Force => force,
            Self::ForcePerSpeed => force / speed,
            Self::ForcePerSpeedSquared => force / (speed * speed),
            Self::ForcePerPosition => force / position,
            Self::ForcePerPositionSquared => force / (position * position),
            Self::Position => position,
            Self::Speed => speed,
            Self::Acceleration => acceleration,
            Self::Delay => 0.1 * speed / acceleration,
            Self::Duration => duration,
            Self::PerMinute => 60.0 / duration,
            Self::Angle | Self::Ratio => 1.0,
            Self::PerForce => 1.0 / force,
            Self::ForcePerVoltage => force / voltage,
            Self::Si { unit, path } => {
                // Radians are pure numbers, so that a turn has no length.
                let (length, time) = match path {
                    Path::Line => (position, position / speed),
                    Path::Turn => (1.0, 1.0 / speed),
                };
                let mass = force * time * time / length;
                let current = force * speed / voltage;
                let dimension = SiDimension::of_unit(unit).unwrap_or_default();
                dimension.scale([mass, length, time, current])
            }
            Self::Own { size, .. } => size,
        }
    }

    fn in_a_sample(self, scales: &Scales) -> f64 {
        match self {
            Self::Duration | Self::Delay => scales.interval,
            _ => TAU * scales.interval / scales.period * self.scale(scales),
        }
    }
}
