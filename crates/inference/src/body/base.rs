//! What an analyst's model of a small plant consists of before anything is added.

use stickslip::body::{self, Dimension, Kind, Parameter, parameter};
use stickslip::parameter::Range;

use super::term::{Entry, Formula, Place, Pursued, Role, Sample};

/// M·a + viscous·v + offset = force.
pub const DRIVE: Entry = Entry {
    name: "drive",
    description: "mass or inertia with viscous friction under a known force",
    signature: "",
    confusable: &[],
    kinds: &[Kind::Drive],
    path: None,
    needs_load: false,
    role: Role::Added,
    parameters: &body::DRIVE,
    formula: Formula::Code {
        force: |p, s, _| p[0] * s.acceleration + p[1] * s.velocity + p[2],
        starts: &[],
        linear: &[0, 1, 2],
    },
    own: false,
    place: Place::Everywhere,
};

/// a + stiffness·sin(x − rest) + viscous·v = 0, all over the moment of inertia.
pub const PENDULUM: Entry = Entry {
    name: "pendulum",
    description: "body that swings freely, with viscous drag",
    signature: "",
    confusable: &[],
    kinds: &[Kind::Pendulum],
    path: None,
    needs_load: false,
    role: Role::Added,
    parameters: &body::PENDULUM,
    formula: Formula::Code {
        force: |p, s, _| p[0] * (s.position - p[1]).sin() + p[2] * s.velocity,
        starts: &[],
        linear: &[0, 2],
    },
    own: false,
    place: Place::Everywhere,
};

/// (sliding + (breakaway − sliding)·exp(−|v|/speed))·sign v: Stribeck's law.
pub const CONTACT: Entry = Entry {
    name: "contact",
    description: "friction law in the speed alone",
    signature: "",
    confusable: &[],
    kinds: &[Kind::Contact],
    path: None,
    needs_load: false,
    role: Role::Law,
    parameters: &[
        parameter(
            "sliding",
            Dimension::Force,
            Range::Finite,
            "friction at high speed",
        ),
        parameter(
            "breakaway",
            Dimension::Force,
            Range::Finite,
            "friction at no speed",
        ),
        parameter(
            "speed",
            Dimension::Speed,
            Range::Positive,
            "speed over which it falls from one to the other by 63 %",
        ),
    ],
    formula: Formula::Code {
        force: |p, s, _| (p[0] + (p[1] - p[0]) * (-s.velocity.abs() / p[2]).exp()) * s.direction,
        starts: &[],
        linear: &[0, 1],
    },
    own: false,
    place: Place::Everywhere,
};

/// scale·predicted = force.
pub const BALANCE: Entry = Entry {
    name: "balance",
    description: "what somebody's own model predicts",
    signature: "",
    confusable: &[],
    kinds: &[Kind::Balance],
    path: None,
    needs_load: false,
    role: Role::Added,
    parameters: &[parameter(
        "scale",
        Dimension::Ratio,
        Range::Positive,
        "measured over predicted force; 1 where both have the same unit and the model is right",
    )],
    formula: Formula::Code {
        force: |p, s, _| p[0] * s.predicted,
        starts: &[],
        linear: &[0],
    },
    own: false,
    place: Place::Everywhere,
};

/// Σ slope·(parameter − its value in the FMU) = force that the FMU lacks, with the parameters that its ports file calls uncertain.
#[must_use]
pub fn of_fmu(parameters: Vec<Parameter>) -> &'static Entry {
    // An entry lives as long as the program, as those of the other kinds do: a case has one, of a few hundred bytes.
    Box::leak(Box::new(Entry {
        name: PARAMETERS,
        description: "the FMU's parameters that are uncertain",
        signature: "",
        confusable: &[],
        kinds: &[Kind::Fmu],
        path: None,
        needs_load: false,
        role: Role::Added,
        parameters: Vec::leak(parameters),
        formula: Formula::Pursued(Pursued::Parameters),
        own: false,
        place: Place::Everywhere,
    }))
}

/// a + stiffness·sin(x − rest) + viscous·v = gain·u − back_emf·v, all over the moment of inertia; without the right side where the
/// motor's terminals are open.
pub const JOINT: Entry = Entry {
    name: "joint",
    description: "arm with gravity that a motor turns, with viscous drag",
    signature: "",
    confusable: &[],
    kinds: &[Kind::Joint],
    path: None,
    needs_load: false,
    role: Role::Added,
    parameters: &body::JOINT,
    formula: Formula::Code {
        force: |p, s, _| s.load + p[2] * s.velocity - s.motor,
        starts: &[],
        linear: &[],
    },
    own: false,
    place: Place::Everywhere,
};

/// Torque of a joint's motor and moment of its weight, over the moment of inertia [rad/s²], from its base's numbers.
#[must_use]
pub fn joint_loads(numbers: &[f64], sample: &Sample) -> (f64, f64) {
    let [stiffness, rest, _, gain, back_emf] = *numbers else {
        return (0.0, 0.0);
    };
    let motor = sample.connected * (gain * sample.voltage - back_emf * sample.velocity);
    (motor, stiffness * (sample.position - rest).sin())
}

/// Section of an FMU's uncertain parameters.
pub const PARAMETERS: &str = "parameters";

/// The base of a kind; `None` of an FMU, whose parameters its own file names.
#[must_use]
pub fn base(kind: Kind) -> Option<&'static Entry> {
    Some(match kind {
        Kind::Drive => &DRIVE,
        Kind::Pendulum => &PENDULUM,
        Kind::Contact => &CONTACT,
        Kind::Balance => &BALANCE,
        Kind::Joint => &JOINT,
        Kind::Fmu => return None,
    })
}
