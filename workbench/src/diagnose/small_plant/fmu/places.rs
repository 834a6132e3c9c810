//! The effects that an FMU can have at its ports: those of the catalogue at each port, what changes the FMU's own friction, parameters that
//! drift, and columns that are off.

use stickslip::body::{Dimension, Kind, Parameter, Path, parameter};
use stickslip::parameter::Range;

use super::ports::{Input, Port, Ports};
use crate::diagnose::small_plant::catalogue::{CATALOGUE, two_gaussians};
use crate::diagnose::small_plant::term::{Entry, Formula, Place, Role};

/// An effect of an FMU without anything that only some have.
const PLAIN: Entry = Entry {
    name: "",
    description: "",
    signature: "",
    confusable: &[],
    kinds: &[Kind::Fmu],
    path: None,
    needs_load: false,
    role: Role::Added,
    parameters: &[],
    formula: Formula::Code {
        force: |_, _, _| 0.0,
        starts: &[],
    },
    own: false,
    place: Place::Everywhere,
};

/// What changes the FMU's own friction, where an output gives that.
const OF_FRICTION: [Entry; 4] = [
    Entry {
        name: "normal_force_wobble",
        description: "friction that varies once per turn: the FMU's friction times cosine and sine of the position",
        signature: "a residual that repeats with the angle and grows with the friction",
        confusable: &["unbalance"],
        path: Some(Path::Turn),
        parameters: &[
            parameter(
                "cosine",
                Dimension::Ratio,
                Range::Finite,
                "share that goes with the angle's cosine",
            ),
            parameter(
                "sine",
                Dimension::Ratio,
                Range::Finite,
                "share that goes with the angle's sine",
            ),
        ],
        formula: Formula::Code {
            force: |p, s, friction| friction * (p[0] * s.position.cos() + p[1] * s.position.sin()),
            starts: &[&[0.1, 0.1]],
        },
        ..PLAIN
    },
    Entry {
        name: "stribeck",
        description: "friction that falls as the motion sets in: the FMU's friction times excess·exp(−|v|/speed)",
        signature: "a residual over the velocity with a peak on both sides of zero that grows with the friction",
        confusable: &["acceleration_hysteresis"],
        parameters: &[
            parameter(
                "excess",
                Dimension::Ratio,
                Range::Finite,
                "share of the FMU's friction by which that at no speed is higher",
            ),
            parameter(
                "speed",
                Dimension::Speed,
                Range::Positive,
                "speed over which it falls by 63 %",
            ),
        ],
        formula: Formula::Code {
            force: |p, s, _| s.own_friction * p[0] * (-s.velocity.abs() / p[1]).exp(),
            starts: &[&[0.1, 0.1], &[0.1, 0.3]],
        },
        ..PLAIN
    },
    Entry {
        name: "load_exponent",
        description: "friction with a power of the load: the FMU's friction times (load/mean load)^exponent",
        signature: "a residual that follows the load",
        confusable: &["friction_wear"],
        needs_load: true,
        parameters: &[parameter(
            "exponent",
            Dimension::Ratio,
            Range::Finite,
            "what the power has beyond the FMU's",
        )],
        formula: Formula::Code {
            force: |p, s, _| {
                let power = if s.load > 0.0 { s.load.powf(p[0]) } else { 1.0 };
                s.own_friction * (power - 1.0)
            },
            starts: &[&[0.1], &[-0.1]],
        },
        ..PLAIN
    },
    Entry {
        name: "acceleration_hysteresis",
        description: "friction over the angle α of the plane of velocity and acceleration, two Gaussians (Eqs 6-1, 6-2) times the load, instead of the FMU's",
        signature: "friction that differs between speeding up and slowing down at the same speed",
        confusable: &["stribeck", "sensor_delay"],
        needs_load: true,
        role: Role::Law,
        parameters: &[
            parameter(
                "a1",
                Dimension::Force,
                Range::Positive,
                "height of the first Gaussian at the mean load",
            ),
            parameter(
                "b1",
                Dimension::Angle,
                Range::Between(-4.2, 4.2),
                "its place",
            ),
            parameter(
                "c1",
                Dimension::Angle,
                Range::Between(0.05, 9.0),
                "its width",
            ),
            parameter(
                "a2",
                Dimension::Force,
                Range::Positive,
                "height of the second Gaussian at the mean load",
            ),
            parameter(
                "b2",
                Dimension::Angle,
                Range::Between(-4.2, 4.2),
                "its place",
            ),
            parameter(
                "c2",
                Dimension::Angle,
                Range::Between(0.05, 9.0),
                "its width",
            ),
            parameter(
                "centre",
                Dimension::Speed,
                Range::Positive,
                "centre of the ellipse and its semi-axis in velocity",
            ),
            parameter(
                "semi_axis",
                Dimension::Acceleration,
                Range::Positive,
                "semi-axis of the ellipse in acceleration",
            ),
        ],
        formula: Formula::Code {
            force: |p, s, _| two_gaussians(&[p, &[0.0]].concat(), s, 0.0),
            starts: &[
                &[1.0, -2.5, 1.5, 1.0, 2.5, 2.2, 1.0, 1.0],
                &[1.0, -1.2, 1.5, 1.0, 2.0, 2.2, 0.7, 1.0],
                &[1.0, -3.0, 2.0, 0.5, 0.5, 2.0, 1.0, 2.0],
            ],
        },
        ..PLAIN
    },
];

/// The effects beside those of the catalogue, or instead of them where there are several ports; `parameters` are those that are uncertain.
#[must_use]
pub fn effects(ports: &Ports, parameters: &[Parameter]) -> Vec<&'static Entry> {
    let names: Vec<&str> = ports
        .ports
        .iter()
        .filter_map(|port| port.name.as_deref())
        .collect();
    let mut all: Vec<Entry> = Vec::new();
    for (at, port) in ports.ports.iter().enumerate() {
        let place = |mut entry: Entry| {
            if names.len() > 1 {
                entry = placed(&entry, at, names[at]);
            }
            entry
        };
        let own = of_port(port);
        if names.len() > 1 {
            let shared = CATALOGUE
                .iter()
                .filter(|entry| entry.kinds.contains(&Kind::Fmu));
            let shared = shared.filter(|entry| own.iter().all(|own| own.name != entry.name));
            all.extend(shared.map(|entry| place(*entry)));
        }
        all.extend(own.into_iter().map(place));
    }
    let drifts = |own: &Parameter| ports.drifts.iter().any(|name| name == own.key);
    for (at, own) in parameters.iter().enumerate().filter(|(_, own)| drifts(own)) {
        all.push(Entry {
            name: leaked(format!("{}_drift", plain_name(own.key))),
            description: leaked(format!(
                "{} that changes by a share of its value in a minute",
                own.key
            )),
            signature: "a residual that drifts as the parameter's influence does",
            parameters: alone(parameter(
                "rate_per_minute",
                Dimension::PerMinute,
                Range::Finite,
                "share by which it changes in a minute",
            )),
            formula: Formula::Drift(at),
            ..PLAIN
        });
    }
    let inputs = ports.inputs.iter().filter(|(_, input)| input.may_be_offset);
    for (at, (name, input)) in inputs.enumerate() {
        all.push(of_input(at, name, input));
    }
    all.into_iter()
        .map(|entry| &*Box::leak(Box::new(entry)))
        .collect()
}

/// An effect at each of several ports.
#[must_use]
pub fn at_each(entry: &'static Entry, names: &[&str]) -> Vec<&'static Entry> {
    let ports = names.iter().enumerate();
    ports
        .map(|(at, name)| &*Box::leak(Box::new(placed(entry, at, name))))
        .collect()
}

/// An effect at one of several ports.
#[must_use]
pub fn placed(entry: &Entry, at: usize, port: &str) -> Entry {
    let there = |name: &str| leaked(format!("{name}_at_{port}"));
    Entry {
        name: there(entry.name),
        description: leaked(format!("at {port}: {}", entry.description)),
        confusable: entry
            .confusable
            .iter()
            .map(|name| there(name))
            .collect::<Vec<_>>()
            .leak(),
        place: Place::Port(at),
        ..*entry
    }
}

/// What a port's friction and its teeth make possible.
fn of_port(port: &Port) -> Vec<Entry> {
    let mut all = Vec::new();
    if port.friction.is_some() {
        all.extend(OF_FRICTION);
    }
    for often in &port.repeats {
        let name = format!("ripple_{often}").replace('.', "_");
        all.push(Entry {
            name: leaked(name),
            description: leaked(format!(
                "force that varies {often} times per turn, as cosine and sine"
            )),
            signature: "a residual that repeats many times per turn",
            path: Some(Path::Turn),
            parameters: const {
                &[
                    parameter(
                        "cosine",
                        Dimension::Force,
                        Range::Finite,
                        "part that goes with the cosine",
                    ),
                    parameter(
                        "sine",
                        Dimension::Force,
                        Range::Finite,
                        "part that goes with the sine",
                    ),
                ]
            },
            formula: Formula::Repeats(*often),
            ..PLAIN
        });
    }
    all
}

/// A column that is off by a constant.
fn of_input(at: usize, name: &str, input: &Input) -> Entry {
    let unit = leaked(input.unit.clone());
    Entry {
        name: leaked(format!("{}_offset", plain_name(name))),
        description: leaked(format!(
            "column {} that is off by a constant: the plant has the reading and the constant",
            input.column
        )),
        signature: "a residual that changes as the input's influence does",
        parameters: alone(parameter(
            "offset",
            Dimension::Own { unit, size: 1.0 },
            Range::Finite,
            "what the plant has beyond the reading",
        )),
        formula: Formula::Offset(at),
        ..PLAIN
    }
}

/// A name of letters, digits and underscores.
fn plain_name(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    name.chars().map(plain).collect()
}

// An entry lives as long as the program, as those of the catalogue do: a case has a few dozen, of a few hundred bytes each.
fn leaked(text: String) -> &'static str {
    text.leak()
}

fn alone(parameter: Parameter) -> &'static [Parameter] {
    vec![parameter].leak()
}
