//! The catalogue of effects in words: what each is, what it looks like in records, what its numbers are called there, and what
//! it can be mistaken for. How each enters a model is in `inference::effects`.

/// One physical effect that a model may lack.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Name in findings.
    pub name: &'static str,
    /// What it is.
    pub description: &'static str,
    /// What it looks like in records.
    pub signature: &'static str,
    /// Names of effects that look alike.
    pub confusable: &'static [&'static str],
    /// Dotted model parameter and the short name that the records use for it.
    pub symbols: &'static [(&'static str, &'static str)],
}

impl Entry {
    /// Whether the effect replaces the friction law.
    #[must_use]
    pub fn is_law(&self) -> bool {
        let mut effects = inference::effects::EFFECTS.iter();
        effects.any(|effect| effect.name == self.name && effect.is_law())
    }
}

/// All effects that can be named, in a fixed order.
pub const CATALOGUE: &[Entry] = &[
    Entry {
        name: "bearing_friction",
        description: "dry friction of the disc's bearings, present without normal force",
        signature: "a constant torque against the motion, also in runs without brake; it sticks",
        confusable: &["load_cell_bias", "load_exponent"],
        symbols: &[("bearing_friction.torque", "bearing_T")],
    },
    Entry {
        name: "normal_force_wobble",
        description: "a normal force that varies once per turn of the disc",
        signature: "residual torque at the first order of the disc angle, in proportion to the normal force",
        confusable: &["unbalance", "position_friction"],
        symbols: &[
            ("normal_force_wobble.amplitude", "wobble_a"),
            ("normal_force_wobble.phase", "wobble_ph"),
        ],
    },
    Entry {
        name: "position_friction",
        description: "friction that varies twice per turn of the disc",
        signature: "residual torque at the second order of the disc angle, in proportion to the normal force",
        confusable: &["normal_force_wobble"],
        symbols: &[
            ("position_friction.amplitude", "amplitude"),
            ("position_friction.phase", "phase"),
        ],
    },
    Entry {
        name: "unbalance",
        description: "a disc whose centre of mass is off the axis",
        signature: "residual torque at the first order of the disc angle, also without brake",
        confusable: &["normal_force_wobble"],
        symbols: &[
            ("unbalance.torque", "unbal_T"),
            ("unbalance.phase", "unbal_ph"),
        ],
    },
    Entry {
        name: "viscous_drag",
        description: "viscous drag on the disc",
        signature: "residual torque in proportion to the disc's speed",
        confusable: &["quadratic_drag", "bearing_friction"],
        symbols: &[("viscous_drag.coefficient", "visc")],
    },
    Entry {
        name: "quadratic_drag",
        description: "aerodynamic drag on the disc",
        signature: "residual torque that grows with the square of the disc's speed",
        confusable: &["viscous_drag"],
        symbols: &[("quadratic_drag.coefficient", "quad")],
    },
    Entry {
        name: "shaft_hardening",
        description: "a shaft that stiffens with its twist",
        signature: "residual torque that grows with the cube of the twist, opposite on disc and motor",
        confusable: &[],
        symbols: &[("shaft_hardening.cubic_stiffness", "k3")],
    },
    Entry {
        name: "shaft_hysteresis",
        description: "internal friction of the shaft",
        signature: "a loop of torque over twist that changes with frequency",
        confusable: &["viscous_drag"],
        symbols: &[
            ("shaft_hysteresis.stiffness", "stiffness"),
            ("shaft_hysteresis.relaxation_time", "relaxation_time"),
        ],
    },
    Entry {
        name: "backlash",
        description: "play in the shaft's coupling",
        signature: "no shaft torque around zero twist",
        confusable: &["shaft_hardening"],
        symbols: &[("backlash.gap", "backlash")],
    },
    Entry {
        name: "gear_ripple",
        description: "torque ripple of motor or gears",
        signature: "residual motor torque at a fixed number of cycles per turn of the motor; 1, 2, 3, 4, 6, 8, 12 and 24 are tried",
        confusable: &[],
        symbols: &[
            ("gear_ripple.torque", "cog_T"),
            ("gear_ripple.phase", "phase"),
        ],
    },
    Entry {
        name: "motor_viscous",
        description: "viscous friction of the motor beyond the nominal one",
        signature: "a lower steady speed at a given voltage; the same as a larger back-EMF constant",
        confusable: &["supply_sag"],
        symbols: &[("motor_viscous.coefficient", "motor_visc")],
    },
    Entry {
        name: "supply_sag",
        description: "a supply whose voltage is lower than commanded",
        signature: "a lower steady speed; the same as back-EMF constant and resistance larger by one factor",
        confusable: &["motor_viscous"],
        symbols: &[("supply_sag.factor", "uscale")],
    },
    Entry {
        name: "resistance_drift",
        description: "an armature that warms up",
        signature: "residual motor torque that grows with time and current",
        confusable: &["friction_wear"],
        symbols: &[("resistance_drift.rate_per_minute", "dRdt")],
    },
    Entry {
        name: "load_cell_bias",
        description: "a load cell with an offset",
        signature: "friction too high or too low by the same torque at every normal force",
        confusable: &["bearing_friction", "load_exponent"],
        symbols: &[("load_cell_bias.bias", "cell_bias")],
    },
    Entry {
        name: "friction_wear",
        description: "friction that changes with time",
        signature: "residual torque that grows with time, in proportion to the friction",
        confusable: &["resistance_drift"],
        symbols: &[("friction_wear.rate_per_minute", "dmudt")],
    },
    Entry {
        name: "load_exponent",
        description: "friction that is not proportional to the normal force",
        signature: "friction too high at small and too low at large normal force, or the reverse",
        confusable: &["load_cell_bias", "bearing_friction"],
        symbols: &[("load_exponent.exponent", "load_exp")],
    },
    Entry {
        name: "sensor_delay",
        description: "disc sensors that lag",
        signature: "disc readings that fit when shifted in time; residual in proportion to speed and acceleration",
        confusable: &[],
        symbols: &[("sensor_delay.delay", "delay")],
    },
    Entry {
        name: "presliding",
        description: "a sticking contact that gives way like a spring",
        signature: "a disc that sticks moves a little with the shaft's torque and rings after it has come to rest",
        confusable: &["backlash"],
        symbols: &[
            ("presliding.stiffness", "stiffness"),
            ("presliding.damping", "damping"),
        ],
    },
    Entry {
        name: "stiction",
        description: "a breakaway torque above the sliding torque",
        signature: "longer sticking and a jump of torque at breakaway",
        confusable: &["stribeck", "acceleration_hysteresis"],
        symbols: &[("contact.mu_s", "mu_s")],
    },
    Entry {
        name: "stribeck",
        description: "sliding friction that falls with the slip velocity",
        signature: "residual torque over velocity, the same while speeding up and slowing down",
        confusable: &["stiction", "acceleration_hysteresis"],
        symbols: &[
            ("contact.mu_c", "mu_c"),
            ("contact.mu_s", "mu_s"),
            ("contact.omega_s", "omega_s"),
        ],
    },
    Entry {
        name: "acceleration_hysteresis",
        description: "friction that depends on the phase-plane angle of velocity and acceleration (Eq. 6-2)",
        signature: "residual torque over velocity with different branches for speeding up and slowing down",
        confusable: &["stribeck"],
        symbols: &[],
    },
    Entry {
        name: "bearing_friction1",
        description: "dry friction of disc D1's bearings in the full rig, present without normal force",
        signature: "a constant torque against the motion of disc D1, also in runs without brake; it sticks",
        confusable: &["bearing_friction"],
        symbols: &[("bearing_friction1.torque", "bearing_T")],
    },
    Entry {
        name: "unbalance1",
        description: "a disc D1 of the full rig whose centre of mass is off the axis",
        signature: "residual torque on disc D1 at the first order of its angle, also without brake",
        confusable: &["unbalance"],
        symbols: &[
            ("unbalance1.torque", "unbal_T"),
            ("unbalance1.phase", "unbal_ph"),
        ],
    },
    Entry {
        name: "viscous_drag1",
        description: "viscous drag on disc D1 of the full rig",
        signature: "residual torque in proportion to the speed of disc D1",
        confusable: &["viscous_drag", "quadratic_drag1"],
        symbols: &[("viscous_drag1.coefficient", "visc")],
    },
    Entry {
        name: "quadratic_drag1",
        description: "aerodynamic drag on disc D1 of the full rig",
        signature: "residual torque that grows with the square of the speed of disc D1",
        confusable: &["quadratic_drag", "viscous_drag1"],
        symbols: &[("quadratic_drag1.coefficient", "quad")],
    },
    Entry {
        name: "normal_force_wobble1",
        description: "a normal force on disc D1 of the full rig that varies once per turn of it",
        signature: "residual torque on disc D1 at the first order of its angle, in proportion to the normal force",
        confusable: &["unbalance1", "normal_force_wobble"],
        symbols: &[
            ("normal_force_wobble1.amplitude", "wobble_a"),
            ("normal_force_wobble1.phase", "wobble_ph"),
        ],
    },
    Entry {
        name: "shaft_hardening1",
        description: "a shaft between the discs of the full rig that stiffens with its twist",
        signature: "residual torque that grows with the cube of the twist between the discs, opposite on both",
        confusable: &["shaft_hardening"],
        symbols: &[("shaft_hardening1.cubic_stiffness", "k3")],
    },
];

/// The catalogue's entry of this name.
pub fn entry(name: &str) -> Option<&'static Entry> {
    CATALOGUE.iter().find(|entry| entry.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_of_the_engine_is_described() {
        let described: Vec<&str> = CATALOGUE.iter().map(|entry| entry.name).collect();
        let known: Vec<&str> = inference::effects::EFFECTS
            .iter()
            .map(|effect| effect.name)
            .collect();
        assert_eq!(described, known);
    }
}
