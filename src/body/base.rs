//! What small plants that move by themselves have before any effect is added.

use super::{Dimension, Kind};
use crate::parameter::Range;

/// A parameter of a base or an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Key in the model file.
    pub key: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Where it may lie.
    pub range: Range,
    /// What it is.
    pub description: &'static str,
    /// Where a fit may start, if a file says so [SI].
    pub guess: Option<f64>,
}

/// Shorthand for a parameter.
#[must_use]
pub const fn parameter(
    key: &'static str,
    dimension: Dimension,
    range: Range,
    description: &'static str,
) -> Parameter {
    Parameter {
        key,
        dimension,
        range,
        description,
        guess: None,
    }
}

/// inertia·a + viscous·v + offset = force.
pub const DRIVE: [Parameter; 3] = [
    parameter(
        "inertia",
        Dimension::Inertia,
        Range::Positive,
        "mass or moment of inertia",
    ),
    parameter(
        "viscous",
        Dimension::ForcePerSpeed,
        Range::Finite,
        "viscous friction",
    ),
    parameter(
        "offset",
        Dimension::Force,
        Range::Finite,
        "constant force, such as an amplifier's offset",
    ),
];

/// a + stiffness·sin(x − rest) + viscous·v = 0, all over the moment of inertia.
pub const PENDULUM: [Parameter; 3] = [
    parameter(
        "stiffness",
        Dimension::ForcePerPosition,
        Range::Positive,
        "weight's moment over moment of inertia: square of the small swing's angular frequency",
    ),
    parameter("rest", Dimension::Angle, Range::Finite, "angle at rest"),
    parameter(
        "viscous",
        Dimension::ForcePerSpeed,
        Range::Finite,
        "viscous drag over moment of inertia",
    ),
];

/// a + stiffness·sin(x − rest) + viscous·v = connected·(gain·voltage − back_emf·v), all over the moment of inertia.
pub const JOINT: [Parameter; 5] = [
    parameter(
        "stiffness",
        Dimension::ForcePerPosition,
        Range::Positive,
        "weight's moment over moment of inertia, which includes the motor's times the ratio's square",
    ),
    parameter(
        "rest",
        Dimension::Angle,
        Range::Finite,
        "angle at which the arm hangs",
    ),
    parameter(
        "viscous",
        Dimension::ForcePerSpeed,
        Range::Finite,
        "viscous drag over moment of inertia",
    ),
    parameter(
        "gain",
        Dimension::ForcePerVoltage,
        Range::Finite,
        "torque over voltage at standstill, over moment of inertia",
    ),
    parameter(
        "back_emf",
        Dimension::ForcePerSpeed,
        Range::Finite,
        "torque that the motor loses over speed, over moment of inertia",
    ),
];

/// Parameters of what a plant of this kind is before any effect is added; `None` where it does not move by itself.
#[must_use]
pub fn base(kind: Kind) -> Option<&'static [Parameter]> {
    match kind {
        Kind::Drive => Some(&DRIVE),
        Kind::Pendulum => Some(&PENDULUM),
        Kind::Joint => Some(&JOINT),
        Kind::Contact | Kind::Balance | Kind::Fmu => None,
    }
}
