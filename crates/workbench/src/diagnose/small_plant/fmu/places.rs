//! The effects that an FMU can have at its ports: those of the catalogue at each port, what repeats with teeth, parameters that drift, and
//! columns that are off.

use stickslip::body::{Dimension, Kind, Parameter, Path, parameter};
use stickslip::parameter::Range;

use super::ports::{Input, Port, Ports};
use inference::body::catalogue::CATALOGUE;
use inference::body::term::{Entry, Formula, Place, Pursued, Role};

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
        linear: &[],
    },
    own: false,
    place: Place::Everywhere,
};

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
            formula: Formula::Pursued(Pursued::Drift(at)),
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

/// What a port's teeth make possible.
fn of_port(port: &Port) -> Vec<Entry> {
    let mut all = Vec::new();
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
        formula: Formula::Pursued(Pursued::Offset(at)),
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
