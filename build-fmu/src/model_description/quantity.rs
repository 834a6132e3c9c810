//! Quantity types of the model description: what a unit stands for in this rig.

/// A type definition that variables refer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QuantityType {
    /// Name of the type, for example `AngularVelocity`.
    pub name: &'static str,
    /// Physical quantity in the wording of ISO 80000.
    pub quantity: &'static str,
    /// One line for people.
    pub description: &'static str,
}

/// The type that a unit stands for; `None` where the unit does not tell (`1` may be anything).
pub fn quantity_type(unit: &str) -> Option<QuantityType> {
    let (name, quantity, description) = match unit {
        "s" => ("Time", "Time", "Time"),
        "m" => ("Length", "Length", "Length"),
        "rad" => ("Angle", "Angle", "Angle of rotation, positive forward"),
        "rad/s" => (
            "AngularVelocity",
            "AngularVelocity",
            "Angular velocity, positive forward",
        ),
        "rad/s2" => (
            "AngularAcceleration",
            "AngularAcceleration",
            "Angular acceleration",
        ),
        "N" => ("Force", "Force", "Force"),
        "N.m" => ("Torque", "Torque", "Torque"),
        "kg.m2" => ("MomentOfInertia", "MomentOfInertia", "Moment of inertia"),
        "N.m/rad" => (
            "TorsionalStiffness",
            "TorsionalStiffness",
            "Torsional stiffness",
        ),
        "N.m.s/rad" => ("TorsionalDamping", "TorsionalDamping", "Torsional damping"),
        "V" => ("Voltage", "ElectricPotential", "Voltage"),
        "A" => ("Current", "ElectricCurrent", "Electric current"),
        "Ohm" => ("Resistance", "Resistance", "Electric resistance"),
        "H" => ("Inductance", "Inductance", "Inductance"),
        "N.m/A" => (
            "TorqueConstant",
            "TorqueConstant",
            "Motor torque per armature current",
        ),
        "V.s/rad" => (
            "BackEmfConstant",
            "BackEmfConstant",
            "Motor voltage per angular velocity",
        ),
        _ => return None,
    };
    Some(QuantityType {
        name,
        quantity,
        description,
    })
}
