//! What equations may depend on.

use super::Dimension;

/// What an equation may depend on, whatever the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Name in equations.
    pub name: &'static str,
    /// Where its value stands among those of all coordinates.
    pub place: usize,
    /// Its dimension.
    pub dimension: Dimension,
    /// Whether it is never below zero.
    pub is_positive: bool,
    /// Whether a force changes its rate at once, or that of what it depends on: a jump there is dry friction, which can hold it.
    pub is_rate: bool,
}

/// What an equation of a rig may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// Angle of what the effect acts on [rad].
    Angle,
    /// Its velocity [rad/s].
    Velocity,
    /// Twist of the shaft [rad].
    Twist,
    /// Rate of the twist [rad/s].
    TwistRate,
    /// Armature current [A].
    Current,
    /// Voltage at the terminals, as commanded [V].
    Voltage,
    /// Normal force on the pin [N], ≥ 0.
    Load,
    /// Time [s].
    Time,
}

/// Number of [`Coordinate`]s.
pub(crate) const COORDINATES: usize = 8;

impl Coordinate {
    /// All of them.
    pub const ALL: [Self; COORDINATES] = [
        Self::Angle,
        Self::Velocity,
        Self::Twist,
        Self::TwistRate,
        Self::Current,
        Self::Voltage,
        Self::Load,
        Self::Time,
    ];

    /// Name in equations.
    pub fn name(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::Velocity => "velocity",
            Self::Twist => "twist",
            Self::TwistRate => "twist_rate",
            Self::Current => "current",
            Self::Voltage => "voltage",
            Self::Load => "load",
            Self::Time => "time",
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Angle | Self::Twist => "rad",
            Self::Velocity | Self::TwistRate => "rad/s",
            Self::Current => "A",
            Self::Voltage => "V",
            Self::Load => "N",
            Self::Time => "s",
        }
    }

    /// What equations need to know of it.
    pub fn quantity(self) -> Quantity {
        Quantity {
            name: self.name(),
            place: self as usize,
            dimension: Dimension::of_unit(self.unit()).unwrap_or_default(),
            is_positive: self.is_positive(),
            is_rate: self.is_rate(),
        }
    }

    /// Whether it is never below zero. Time is not among them: a simulation may start before zero.
    fn is_positive(self) -> bool {
        self == Self::Load
    }

    /// Whether a torque changes its rate at once: a jump there is dry friction, which can hold it.
    fn is_rate(self) -> bool {
        matches!(self, Self::Velocity | Self::TwistRate | Self::Current)
    }
}
