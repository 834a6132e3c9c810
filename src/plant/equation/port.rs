//! The places of a rig at which an equation may act.

use crate::expression::Coordinate;

/// Where an effect acts, which decides its unit, its sign and what its equation may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// Torque on disc D2, positive forward [N m].
    DiscTorque,
    /// Torque on disc D1, positive forward [N m].
    Disc1Torque,
    /// Further torque of the shaft between gearbox and D2, positive where a positive twist turns D2 back [N m].
    ShaftTorque,
    /// The same of the shaft between D2 and D1.
    Shaft1Torque,
    /// Torque on the motor's own shaft, positive forward [N m].
    MotorTorque,
    /// Voltage added to the commanded one [V].
    MotorVoltage,
    /// Resistance added to the armature's [Ω].
    MotorResistance,
    /// Factor of the friction between D2 and its pin; never below zero.
    DiscFriction,
    /// Factor of the friction between D1 and its pin.
    Disc1Friction,
}

impl Port {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::DiscTorque,
        Self::Disc1Torque,
        Self::ShaftTorque,
        Self::Shaft1Torque,
        Self::MotorTorque,
        Self::MotorVoltage,
        Self::MotorResistance,
        Self::DiscFriction,
        Self::Disc1Friction,
    ];

    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::DiscTorque => "disc.torque",
            Self::Disc1Torque => "disc1.torque",
            Self::ShaftTorque => "shaft.torque",
            Self::Shaft1Torque => "shaft1.torque",
            Self::MotorTorque => "motor.torque",
            Self::MotorVoltage => "motor.voltage",
            Self::MotorResistance => "motor.resistance",
            Self::DiscFriction => "disc.friction",
            Self::Disc1Friction => "disc1.friction",
        }
    }

    /// Unit of what the equation gives.
    pub fn unit(self) -> &'static str {
        match self {
            Self::MotorVoltage => "V",
            Self::MotorResistance => "Ohm",
            Self::DiscFriction | Self::Disc1Friction => "1",
            _ => "N.m",
        }
    }

    /// What the equation may depend on.
    pub fn coordinates(self) -> &'static [Coordinate] {
        use Coordinate::{Angle, Current, Load, Time, Twist, TwistRate, Velocity, Voltage};
        match self {
            Self::DiscTorque | Self::Disc1Torque | Self::DiscFriction | Self::Disc1Friction => {
                &[Angle, Velocity, Load, Time]
            }
            Self::ShaftTorque | Self::Shaft1Torque => &[Twist, TwistRate, Time],
            Self::MotorTorque => &[Angle, Velocity, Current, Time],
            Self::MotorVoltage => &[Voltage, Current, Velocity, Time],
            Self::MotorResistance => &[Current, Time],
        }
    }

    /// Value of an equation that changes nothing.
    pub fn neutral(self) -> f64 {
        if self.is_friction() { 1.0 } else { 0.0 }
    }

    /// Whether the equation is a factor of friction.
    pub fn is_friction(self) -> bool {
        matches!(self, Self::DiscFriction | Self::Disc1Friction)
    }

    /// Whether only the full rig has it.
    pub fn is_on_disc1(self) -> bool {
        matches!(
            self,
            Self::Disc1Torque | Self::Shaft1Torque | Self::Disc1Friction
        )
    }
}
