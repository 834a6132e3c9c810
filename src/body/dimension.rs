//! What parameters of small plants measure, and the units that these have.

use super::{Kind, Path};
use crate::expression::Dimension as SiDimension;
use crate::parameter::units::UnitError;

/// What a parameter measures, from which its unit and its usual size follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Dimension {
    /// Mass or moment of inertia.
    Inertia,
    /// Force or torque; of a pendulum, torque over inertia.
    Force,
    /// Force over speed.
    ForcePerSpeed,
    /// Force over the square of speed.
    ForcePerSpeedSquared,
    /// Force over position.
    ForcePerPosition,
    /// Force over the square of position.
    ForcePerPositionSquared,
    /// Position.
    Position,
    /// Speed.
    Speed,
    /// Acceleration.
    Acceleration,
    /// Time by which something lags.
    Delay,
    /// Time over which something happens in a record.
    Duration,
    /// Change over a minute, as a share.
    PerMinute,
    /// Angle.
    Angle,
    /// Ratio.
    Ratio,
    /// Over a force.
    PerForce,
    /// Force over a voltage.
    ForcePerVoltage,
    /// That of a unit, on plants of a path.
    Si {
        /// The unit.
        unit: &'static str,
        /// The path.
        path: Path,
    },
    /// That of an FMU's parameter.
    Own {
        /// Its unit as the FMU gives it.
        unit: &'static str,
        /// Its usual size in that unit.
        size: f64,
    },
}

/// How files of effects spell dimensions in terms of the plant.
const WORDS: [(&str, Dimension); 13] = [
    ("force", Dimension::Force),
    ("force/speed", Dimension::ForcePerSpeed),
    ("force/speed2", Dimension::ForcePerSpeedSquared),
    ("force/position", Dimension::ForcePerPosition),
    ("force/position2", Dimension::ForcePerPositionSquared),
    ("inertia", Dimension::Inertia),
    ("position", Dimension::Position),
    ("speed", Dimension::Speed),
    ("acceleration", Dimension::Acceleration),
    ("1/force", Dimension::PerForce),
    ("1/min", Dimension::PerMinute),
    ("rad", Dimension::Angle),
    ("1", Dimension::Ratio),
];

impl Dimension {
    /// The dimension that a file of effects spells so, in terms of the plant or as a unit on plants of this path.
    ///
    /// # Errors
    /// It is neither.
    pub fn of_words(words: &'static str, path: Path) -> Result<Self, UnitError> {
        if let Some((_, dimension)) = WORDS.iter().find(|(known, _)| *known == words) {
            return Ok(*dimension);
        }
        SiDimension::of_unit(words)?;
        Ok(Self::Si { unit: words, path })
    }

    /// SI unit of the dimension for a plant of this kind and path.
    #[must_use]
    pub fn unit(self, kind: Kind, path: Path) -> &'static str {
        let turn = path == Path::Turn;
        let free = kind.runs_alone();
        match self {
            Self::Inertia if turn => "kg.m2",
            Self::Inertia => "kg",
            Self::Force if free => "rad/s2",
            Self::Force if turn => "N.m",
            Self::Force => "N",
            Self::ForcePerSpeed if free => "1/s",
            Self::ForcePerSpeed if turn => "N.m.s/rad",
            Self::ForcePerSpeed => "N.s/m",
            Self::ForcePerSpeedSquared if free => "1/rad",
            Self::ForcePerSpeedSquared if turn => "N.m.s2/rad2",
            Self::ForcePerSpeedSquared => "N.s2/m2",
            Self::ForcePerPosition if free => "1/s2",
            Self::ForcePerPosition if turn => "N.m/rad",
            Self::ForcePerPosition => "N/m",
            Self::ForcePerPositionSquared if free => "1/(rad.s2)",
            Self::ForcePerPositionSquared if turn => "N.m/rad2",
            Self::ForcePerPositionSquared => "N/m2",
            Self::Position if turn => "rad",
            Self::Position => "m",
            Self::Speed if turn => "rad/s",
            Self::Speed => "m/s",
            Self::Acceleration if turn => "rad/s2",
            Self::Acceleration => "m/s2",
            Self::Delay | Self::Duration => "s",
            Self::PerMinute => "1/min",
            Self::Angle => "rad",
            Self::Ratio => "1",
            Self::PerForce if free => "s2/rad",
            Self::PerForce if turn => "1/(N.m)",
            Self::PerForce => "1/N",
            Self::ForcePerVoltage if free => "rad/(s2.V)",
            Self::ForcePerVoltage if turn => "N.m/V",
            Self::ForcePerVoltage => "N/V",
            Self::Own { unit, .. } | Self::Si { unit, .. } => unit,
        }
    }
}

/// A unit without the signs by which writers differ: "N m", "N.m" and "Nm" are one.
#[must_use]
pub fn plain(unit: &str) -> String {
    unit.chars()
        .filter(|c| !c.is_whitespace() && !matches!(c, '.' | '·' | '*'))
        .collect()
}
