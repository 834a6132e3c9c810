//! Kinds of small plants, their dimensions and the units that columns and parameters have.

use stickslip::expression::Dimension as SiDimension;
use stickslip::parameter::units::UnitError;

use super::motion::Scales;

/// What a small plant is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A mass or an inertia under a known force.
    Drive,
    /// A body that swings freely about a fixed axis.
    Pendulum,
    /// A contact whose force or torque and motion are both measured.
    Contact,
    /// A force or torque that is measured beside the one that somebody's own model predicts.
    Balance,
    /// Anybody's FMU: the force that it lacks to move as was measured.
    Fmu,
    /// An arm with gravity that a motor turns, under a measured voltage.
    Joint,
}

/// Along what it moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Path {
    /// A line: metres and newtons.
    Line,
    /// A turn: radians and newton metres.
    Turn,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 6] = [
        Self::Drive,
        Self::Pendulum,
        Self::Contact,
        Self::Balance,
        Self::Fmu,
        Self::Joint,
    ];

    /// The kind as written in a model file.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Drive => "drive",
            Self::Pendulum => "pendulum",
            Self::Contact => "contact",
            Self::Balance => "balance",
            Self::Fmu => "fmu",
            Self::Joint => "joint",
        }
    }

    /// Whether all its forces are over its moment of inertia, and it is judged by runs of its own.
    #[must_use]
    pub fn runs_alone(self) -> bool {
        matches!(self, Self::Pendulum | Self::Joint)
    }
}

impl Path {
    /// The path as written in a model file.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::Turn => "turn",
        }
    }
}

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

    /// Usual size of such a number on records of these sizes.
    #[must_use]
    pub fn scale(self, scales: &Scales) -> f64 {
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
}

/// A unit without the signs by which writers differ: "N m" and "N.m" are one.
#[must_use]
pub fn plain(unit: &str) -> String {
    unit.chars()
        .filter(|c| !c.is_whitespace() && *c != '.')
        .collect()
}
