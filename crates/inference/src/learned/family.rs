//! Where a free function may act, over which coordinate, and what torque it makes.

use crate::gram::Place;
use crate::scales::Scales;
use crate::units::PlantUnits;
use std::f64::consts::TAU;
use stickslip::expression::Coordinate;
use stickslip::plant::Port;

/// Least factor by which the friction of a run is divided to tell the friction without the function: a factor near zero leaves
/// nothing to tell it from.
const LEAST_FACTOR: f64 = 0.1;

/// Where a free function acts, and over which coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Family {
    /// Where it acts.
    pub port: Port,
    /// What it is a function of: of velocities, their magnitude.
    pub over: Coordinate,
    /// What it is multiplied by.
    pub times: Option<Coordinate>,
}

const fn family(port: Port, over: Coordinate, times: Option<Coordinate>) -> Family {
    Family { port, over, times }
}

/// A factor of the friction that is a function of the speed: a law without acceleration.
pub const FRICTION_OVER_SPEED: Family = family(Port::DiscFriction, Coordinate::Velocity, None);

/// All families.
pub const FAMILIES: [Family; 14] = [
    family(Port::DiscFriction, Coordinate::Angle, None),
    FRICTION_OVER_SPEED,
    family(Port::DiscFriction, Coordinate::Load, None),
    family(Port::DiscFriction, Coordinate::Time, None),
    family(Port::DiscTorque, Coordinate::Angle, None),
    family(Port::DiscTorque, Coordinate::Time, None),
    family(
        Port::DiscTorque,
        Coordinate::Velocity,
        Some(Coordinate::Velocity),
    ),
    family(Port::ShaftTorque, Coordinate::Twist, None),
    family(Port::ShaftTorque, Coordinate::Time, Some(Coordinate::Twist)),
    family(Port::MotorTorque, Coordinate::Angle, None),
    family(Port::MotorTorque, Coordinate::Time, None),
    family(Port::MotorTorque, Coordinate::Current, None),
    family(
        Port::MotorTorque,
        Coordinate::Time,
        Some(Coordinate::Current),
    ),
    family(
        Port::MotorTorque,
        Coordinate::Velocity,
        Some(Coordinate::Velocity),
    ),
];

impl Family {
    /// Name of the effect.
    #[must_use]
    pub fn name(self) -> String {
        let port = self.port.name().replace('.', "_");
        format!("learned_{port}_over_{}", self.over.name())
    }

    pub(super) fn is_periodic(self) -> bool {
        self.over == Coordinate::Angle
    }

    /// The coordinate where the motion is, in the plant's units.
    pub(super) fn coordinate(self, place: &Place, ratio: f64) -> f64 {
        let is_motor = self.port == Port::MotorTorque;
        match self.over {
            Coordinate::Angle if is_motor => (ratio * place.gear_angle).rem_euclid(TAU),
            Coordinate::Angle => place.disc_angle.rem_euclid(TAU),
            Coordinate::Velocity if is_motor => (ratio * place.gear_speed).abs(),
            Coordinate::Velocity => place.speed.abs(),
            Coordinate::Twist => place.twist,
            Coordinate::Current => place.current,
            Coordinate::Load => place.normal_force,
            _ => place.time,
        }
    }

    /// Torques on the disc and at the gearbox's output per unit of the function, where its value is `present`.
    pub(super) fn torques(self, place: &Place, ratio: f64, present: f64) -> (f64, f64) {
        let slides = if place.sliding {
            place.speed.signum()
        } else {
            0.0
        };
        match (self.port, self.times) {
            (Port::DiscFriction, _) => {
                let factor = (1.0 + present).max(LEAST_FACTOR);
                (-slides * place.friction / factor, 0.0)
            }
            (Port::DiscTorque, Some(_)) => (-place.speed, 0.0),
            (Port::DiscTorque, None) => (1.0, 0.0),
            (Port::ShaftTorque, Some(_)) => (-place.twist, place.twist),
            (Port::ShaftTorque, None) => (-1.0, 1.0),
            (_, Some(Coordinate::Current)) => (0.0, ratio * place.current),
            (_, Some(_)) => (0.0, -ratio * ratio * place.gear_speed),
            _ => (0.0, ratio),
        }
    }

    /// A function as large as what it acts on.
    pub(super) fn size(self, scales: &Scales, ratio: f64) -> f64 {
        let torque = scales.torque;
        match (self.port, self.times) {
            (Port::DiscFriction, _) => 1.0,
            (Port::DiscTorque, Some(_)) => torque / scales.speed,
            (Port::ShaftTorque, Some(_)) => torque / scales.twist,
            (Port::MotorTorque, Some(Coordinate::Current)) => torque / (ratio * scales.current),
            (Port::MotorTorque, Some(_)) => torque / (ratio * ratio * scales.speed),
            (Port::MotorTorque, None) => torque / ratio,
            _ => torque,
        }
    }

    /// Units of coordinate and function: SI values of the plant's, and their names.
    pub(super) fn units(self, units: &PlantUnits) -> ([f64; 2], [&'static str; 2]) {
        let (x, x_name) = match self.over {
            Coordinate::Velocity => (1.0 / units.time, "rad/s"),
            Coordinate::Load => (units.force, "N"),
            Coordinate::Current => (units.current, "A"),
            Coordinate::Time => (units.time, "s"),
            _ => (1.0, "rad"),
        };
        let (y, y_name) = match (self.port, self.times) {
            (Port::DiscFriction, _) => (1.0, "1"),
            (_, Some(Coordinate::Velocity)) => (units.torque * units.time, "N.m.s/rad"),
            (_, Some(Coordinate::Twist)) => (units.torque, "N.m/rad"),
            (_, Some(Coordinate::Current)) => (units.torque / units.current, "N.m/A"),
            _ => (units.torque, "N.m"),
        };
        ([x, y], [x_name, y_name])
    }

    pub(super) fn equation(self) -> String {
        let name = self.over.name();
        let term = if self.over == Coordinate::Velocity {
            format!("share*term(abs({name}))")
        } else {
            format!("share*term({name})")
        };
        match self.times {
            None if self.port == Port::DiscFriction => format!("1 + {term}"),
            None => term,
            Some(Coordinate::Velocity) => format!("-{term}*velocity"),
            Some(times) => format!("{term}*{}", times.name()),
        }
    }
}
