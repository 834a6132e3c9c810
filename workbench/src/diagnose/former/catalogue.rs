//! The catalogue of effects: how each is switched on, which numbers are fitted, from where, what it
//! is called in records, and what it can be mistaken for.

mod starts;

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
    form: Form,
}

/// How an effect enters a hypothesis.
#[derive(Clone, Copy, Debug)]
enum Form {
    /// One number; it starts at `off` (no effect) plus `near`, and where that may lead astray also at
    /// the `far` values, all in units of `scale`.
    One {
        section: &'static str,
        key: &'static str,
        scale: f64,
        low: f64,
        high: f64,
        near: f64,
        far: &'static [f64],
    },
    /// Amplitude and phase; other keys of the section are held at given values, one hypothesis each.
    Polar {
        section: &'static str,
        amplitude: &'static str,
        scale: f64,
        high: f64,
        held: &'static [(&'static str, &'static [f64])],
    },
    /// Stiffness and relaxation time of the shaft's internal friction.
    Relaxation,
    /// Stiffness and damping of the bristles of a sticking pin.
    Bristles,
    /// Breakaway above sliding.
    Stiction,
    /// Sliding friction that falls with speed.
    Stribeck,
    /// Eq. 6-2.
    Hysteresis,
}

/// All effects that can be named, in a fixed order.
pub const CATALOGUE: &[Entry] = &[
    Entry {
        name: "bearing_friction",
        description: "dry friction of the disc's bearings, present without normal force",
        signature: "a constant torque against the motion, also in runs without brake; it sticks",
        confusable: &["load_cell_bias", "load_exponent"],
        symbols: &[("bearing_friction.torque", "bearing_T")],
        form: Form::One {
            section: "bearing_friction",
            key: "torque",
            scale: 0.05,
            low: 0.0,
            high: 2.0,
            near: 0.01,
            far: &[0.3, 1.0],
        },
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
        form: Form::Polar {
            section: "normal_force_wobble",
            amplitude: "amplitude",
            scale: 0.25,
            high: 0.95,
            held: &[],
        },
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
        form: Form::Polar {
            section: "position_friction",
            amplitude: "amplitude",
            scale: 0.25,
            high: 0.95,
            held: &[],
        },
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
        form: Form::Polar {
            section: "unbalance",
            amplitude: "torque",
            scale: 0.04,
            high: 2.0,
            held: &[],
        },
    },
    Entry {
        name: "viscous_drag",
        description: "viscous drag on the disc",
        signature: "residual torque in proportion to the disc's speed",
        confusable: &["quadratic_drag", "bearing_friction"],
        symbols: &[("viscous_drag.coefficient", "visc")],
        form: Form::One {
            section: "viscous_drag",
            key: "coefficient",
            scale: 0.008,
            low: -0.1,
            high: 0.5,
            near: 0.002,
            far: &[],
        },
    },
    Entry {
        name: "quadratic_drag",
        description: "aerodynamic drag on the disc",
        signature: "residual torque that grows with the square of the disc's speed",
        confusable: &["viscous_drag"],
        symbols: &[("quadratic_drag.coefficient", "quad")],
        form: Form::One {
            section: "quadratic_drag",
            key: "coefficient",
            scale: 0.0012,
            low: -0.02,
            high: 0.1,
            near: 0.002,
            far: &[],
        },
    },
    Entry {
        name: "shaft_hardening",
        description: "a shaft that stiffens with its twist",
        signature: "residual torque that grows with the cube of the twist, opposite on disc and motor",
        confusable: &[],
        symbols: &[("shaft_hardening.cubic_stiffness", "k3")],
        form: Form::One {
            section: "shaft_hardening",
            key: "cubic_stiffness",
            scale: 0.03,
            low: -0.3,
            high: 2.0,
            near: 0.002,
            far: &[],
        },
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
        form: Form::Relaxation,
    },
    Entry {
        name: "backlash",
        description: "play in the shaft's coupling",
        signature: "no shaft torque around zero twist",
        confusable: &["shaft_hardening"],
        symbols: &[("backlash.gap", "backlash")],
        form: Form::One {
            section: "backlash",
            key: "gap",
            scale: 0.25,
            low: 0.0,
            high: 3.0,
            near: 0.02,
            far: &[0.2, 0.5, 1.0],
        },
    },
    Entry {
        name: "gear_ripple",
        description: "torque ripple of motor or gears",
        signature: "residual motor torque at a fixed number of cycles per turn of the motor",
        confusable: &[],
        symbols: &[
            ("gear_ripple.torque", "cog_T"),
            ("gear_ripple.phase", "phase"),
        ],
        form: Form::Polar {
            section: "gear_ripple",
            amplitude: "torque",
            scale: 0.06,
            high: 2.0,
            held: &[("order", &[1.0, 2.0, 4.0, 6.0])],
        },
    },
    Entry {
        name: "motor_viscous",
        description: "viscous friction of the motor beyond the nominal one",
        signature: "a lower steady speed at a given voltage; the same as a larger back-EMF constant",
        confusable: &["supply_sag"],
        symbols: &[("motor_viscous.coefficient", "motor_visc")],
        form: Form::One {
            section: "motor_viscous",
            key: "coefficient",
            scale: 0.0006,
            low: -0.005,
            high: 0.05,
            near: 0.002,
            far: &[],
        },
    },
    Entry {
        name: "supply_sag",
        description: "a supply whose voltage is lower than commanded",
        signature: "a lower steady speed; the same as back-EMF constant and resistance larger by one factor",
        confusable: &["motor_viscous"],
        symbols: &[("supply_sag.factor", "uscale")],
        form: Form::One {
            section: "supply_sag",
            key: "factor",
            scale: 1.0,
            low: 0.3,
            high: 1.5,
            near: 0.9995,
            far: &[],
        },
    },
    Entry {
        name: "resistance_drift",
        description: "an armature that warms up",
        signature: "residual motor torque that grows with time and current",
        confusable: &["friction_wear"],
        symbols: &[("resistance_drift.rate_per_minute", "dRdt")],
        form: Form::One {
            section: "resistance_drift",
            key: "rate_per_minute",
            scale: 0.6,
            low: -0.9,
            high: 10.0,
            near: 0.002,
            far: &[],
        },
    },
    Entry {
        name: "load_cell_bias",
        description: "a load cell with an offset",
        signature: "friction too high or too low by the same torque at every normal force",
        confusable: &["bearing_friction", "load_exponent"],
        symbols: &[("load_cell_bias.bias", "cell_bias")],
        form: Form::One {
            section: "load_cell_bias",
            key: "bias",
            scale: 4.0,
            low: -60.0,
            high: 60.0,
            near: 0.002,
            far: &[],
        },
    },
    Entry {
        name: "friction_wear",
        description: "friction that changes with time",
        signature: "residual torque that grows with time, in proportion to the friction",
        confusable: &["resistance_drift"],
        symbols: &[("friction_wear.rate_per_minute", "dmudt")],
        form: Form::One {
            section: "friction_wear",
            key: "rate_per_minute",
            scale: 0.3,
            low: -0.9,
            high: 10.0,
            near: 0.002,
            far: &[],
        },
    },
    Entry {
        name: "load_exponent",
        description: "friction that is not proportional to the normal force",
        signature: "friction too high at small and too low at large normal force, or the reverse",
        confusable: &["load_cell_bias", "bearing_friction"],
        symbols: &[("load_exponent.exponent", "load_exp")],
        form: Form::One {
            section: "load_exponent",
            key: "exponent",
            scale: 1.0,
            low: 0.1,
            high: 3.0,
            near: 0.999,
            far: &[],
        },
    },
    Entry {
        name: "sensor_delay",
        description: "disc sensors that lag",
        signature: "disc readings that fit when shifted in time; residual in proportion to speed and acceleration",
        confusable: &[],
        symbols: &[("sensor_delay.delay", "delay")],
        form: Form::One {
            section: "sensor_delay",
            key: "delay",
            scale: 0.03,
            low: 0.0,
            high: 0.2,
            near: 0.002,
            far: &[],
        },
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
        form: Form::Bristles,
    },
    Entry {
        name: "stiction",
        description: "a breakaway torque above the sliding torque",
        signature: "longer sticking and a jump of torque at breakaway",
        confusable: &["stribeck", "acceleration_hysteresis"],
        symbols: &[("contact.mu_s", "mu_s")],
        form: Form::Stiction,
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
        form: Form::Stribeck,
    },
    Entry {
        name: "acceleration_hysteresis",
        description: "friction that depends on the phase-plane angle of velocity and acceleration (Eq. 6-2)",
        signature: "residual torque over velocity with different branches for speeding up and slowing down",
        confusable: &["stribeck"],
        symbols: &[],
        form: Form::Hysteresis,
    },
];

/// The catalogue's entry of this name.
pub fn entry(name: &str) -> Option<&'static Entry> {
    CATALOGUE.iter().find(|entry| entry.name == name)
}
