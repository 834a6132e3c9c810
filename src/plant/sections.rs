//! The parts of a rig and their parameters.

use crate::parameter::{BUILT_IN, Range, section};

section! {
    /// A rigid disc.
    pub struct Disc {
        /// Moment of inertia of the disc
        inertia: "kg.m2", Range::Positive, BUILT_IN;
    }
}

section! {
    /// A flexible shaft between two bodies.
    pub struct Shaft {
        /// Torsional stiffness
        stiffness: "N.m/rad", Range::NonNegative;
        /// Torsional viscous damping
        damping: "N.m.s/rad", Range::NonNegative;
    }
}

section! {
    /// The gearbox between motor and shaft.
    pub struct Gearbox {
        /// Motor speed over output speed
        ratio: "1", Range::Positive, BUILT_IN;
    }
}

section! {
    /// The DC motor, quantities on the motor's own shaft.
    pub struct Motor {
        /// Moment of inertia of the rotor
        inertia: "kg.m2", Range::Positive, BUILT_IN;
        /// Armature resistance
        resistance: "Ohm", Range::Positive;
        /// Armature inductance
        inductance: "H", Range::Positive, BUILT_IN;
        /// Torque constant
        torque_constant: "N.m/A", Range::NonNegative;
        /// Back-EMF constant
        back_emf_constant: "V.s/rad", Range::NonNegative;
        /// Coulomb friction torque inside the motor
        coulomb_torque: "N.m", Range::NonNegative;
        /// Viscous friction inside the motor (speed regulation)
        viscous_damping: "N.m.s/rad", Range::NonNegative;
    }
}

section! {
    /// Where the pin touches the disc.
    pub struct ContactRadius {
        /// Distance from the pin to the axis of rotation
        radius: "m", Range::Positive, BUILT_IN;
    }
}
