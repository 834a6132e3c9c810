//! Which components a system has and how they are connected.

use stickslip::cosim::{Causality, Variable, VariableTable};
use thiserror::Error;

use crate::build::Source;

/// Components that are connected where an output and an input share their name.
pub struct System {
    components: Vec<Source>,
    starts: Vec<(usize, String, f64)>,
    exposed: bool,
}

/// Why components make no system.
#[derive(Debug, Error)]
pub enum SystemError {
    /// Nothing to pack.
    #[error("a system needs a component")]
    Empty,
    /// Two components of one name.
    #[error("two components are {name}; each kind of model may occur once")]
    SameComponent {
        /// The name.
        name: String,
    },
    /// Two outputs of one name.
    #[error(
        "both {first} and {second} have an output `{output}`: which one to connect is not clear"
    )]
    SameOutput {
        /// The output.
        output: String,
        /// A component that has it.
        first: String,
        /// Another one.
        second: String,
    },
    /// Nothing to connect.
    #[error("no output of these components shares its name with an input of another: {components}")]
    Unconnected {
        /// The components' names.
        components: String,
    },
    /// A start value for nothing, or for what is connected or fixed otherwise.
    #[error("no component has a free input or a parameter `{name}`; free inputs are {free}")]
    UnknownStart {
        /// The name.
        name: String,
        /// The free inputs.
        free: String,
    },
    /// A start value for a parameter that several components have.
    #[error(
        "{first} and {second} both have `{name}`; name the component too: {first}.{name}={value}"
    )]
    AmbiguousStart {
        /// The name.
        name: String,
        /// The value.
        value: f64,
        /// A component that has it.
        first: String,
        /// Another one.
        second: String,
    },
    /// A start value of which there is one already.
    #[error("{name} = {value}: it has the start value {first} already; one is needed")]
    Twice {
        /// The variable.
        name: String,
        /// The value.
        value: f64,
        /// The earlier value.
        first: f64,
    },
    /// A value that the variable does not allow.
    #[error("{name} = {value}: {allowed} is needed")]
    Value {
        /// The variable.
        name: String,
        /// The value.
        value: f64,
        /// What is right.
        allowed: String,
    },
}

/// A connection from component to component, both by their place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Connection {
    pub(super) variable: String,
    pub(super) from: usize,
    pub(super) to: usize,
}

impl System {
    /// The system of these components, or of a single one.
    ///
    /// # Errors
    /// [`SystemError`] where it is not clear what to connect.
    pub fn new(components: Vec<Source>) -> Result<Self, SystemError> {
        if components.is_empty() {
            return Err(SystemError::Empty);
        }
        let system = Self {
            components,
            starts: Vec::new(),
            exposed: false,
        };
        for (place, name) in system.names().enumerate() {
            if system.names().skip(place + 1).any(|other| other == name) {
                return Err(SystemError::SameComponent {
                    name: name.to_owned(),
                });
            }
        }
        for (second, output) in system.all(Causality::Output) {
            let same = system
                .all(Causality::Output)
                .find(|(first, other)| *first < second && other.name == output.name);
            if let Some((first, _)) = same {
                return Err(SystemError::SameOutput {
                    output: output.name.clone(),
                    first: system.component_name(first).to_owned(),
                    second: system.component_name(second).to_owned(),
                });
            }
        }
        if system.components.len() > 1 && system.connections().is_empty() {
            let names: Vec<&str> = system.names().collect();
            return Err(SystemError::Unconnected {
                components: names.join(", "),
            });
        }
        Ok(system)
    }

    /// Gives the system itself connectors for its free inputs and all outputs. FMPy needs them; ecos and
    /// libcosim refuse connections that end at the system.
    pub fn expose(&mut self) {
        self.exposed = true;
    }

    pub(super) fn is_exposed(&self) -> bool {
        self.exposed
    }

    /// Gives a free input or a parameter, with or without the name of its component, a start value.
    ///
    /// # Errors
    /// [`SystemError`] if there is no such variable, it has a start value already or does not allow this one.
    pub fn start(&mut self, name: &str, value: f64) -> Result<(), SystemError> {
        let found: Vec<(usize, Variable)> = (0..self.components.len())
            .flat_map(|place| {
                let own = name.strip_prefix(&format!("{}.", self.component_name(place)));
                let variable = self.table(place).find(own.unwrap_or(name));
                variable.map(|variable| (place, variable.clone()))
            })
            .filter(|(place, variable)| match variable.causality {
                Causality::Input => self.is_free(*place, &variable.name),
                Causality::Parameter => true,
                _ => false,
            })
            .collect();
        let [(place, variable)] = &found[..] else {
            return Err(match &found[..] {
                [(first, _), (second, _), ..] => SystemError::AmbiguousStart {
                    name: name.to_owned(),
                    value,
                    first: self.component_name(*first).to_owned(),
                    second: self.component_name(*second).to_owned(),
                },
                _ => SystemError::UnknownStart {
                    name: name.to_owned(),
                    free: self
                        .free_inputs()
                        .map(|(_, v)| v.name.as_str())
                        .collect::<Vec<_>>()
                        .join(", "),
                },
            });
        };
        if !variable.allows(value) {
            return Err(SystemError::Value {
                name: name.to_owned(),
                value,
                allowed: variable.allowed(),
            });
        }
        let earlier = self
            .starts(*place)
            .find(|(known, _)| known.name == variable.name)
            .map(|(_, first)| first);
        if let Some(first) = earlier {
            return Err(SystemError::Twice {
                name: name.to_owned(),
                value,
                first,
            });
        }
        self.starts.push((*place, variable.name.clone(), value));
        Ok(())
    }

    /// Name of the system: those of its components. An identifier, since OMSimulator takes names apart at other
    /// signs.
    pub fn name(&self) -> String {
        self.names().collect::<Vec<_>>().join("_")
    }

    pub(super) fn components(&self) -> &[Source] {
        &self.components
    }

    pub(super) fn component_name(&self, place: usize) -> &'static str {
        self.components[place].facts().identity.model_identifier
    }

    pub(super) fn table(&self, place: usize) -> &VariableTable {
        self.components[place].facts().table
    }

    /// Start values of a component.
    pub(super) fn starts(&self, place: usize) -> impl Iterator<Item = (&Variable, f64)> {
        self.starts
            .iter()
            .filter(move |(owner, ..)| *owner == place)
            .filter_map(move |(_, name, value)| Some((self.table(place).find(name)?, *value)))
    }

    /// Start values of the system's own inputs, which are its free ones.
    pub(super) fn input_starts(&self) -> impl Iterator<Item = (&Variable, f64)> {
        (0..self.components.len())
            .flat_map(|place| self.starts(place))
            .filter(|(variable, _)| variable.causality == Causality::Input)
    }

    fn names(&self) -> impl Iterator<Item = &'static str> {
        (0..self.components.len()).map(|place| self.component_name(place))
    }

    /// All variables of a causality, with the places of their components.
    pub(super) fn all(&self, causality: Causality) -> impl Iterator<Item = (usize, &Variable)> {
        (0..self.components.len()).flat_map(move |place| {
            let variables = self.table(place).variables().iter();
            variables
                .filter(move |variable| variable.causality == causality)
                .map(move |variable| (place, variable))
        })
    }

    /// All connections, in the order of the outputs.
    pub(super) fn connections(&self) -> Vec<Connection> {
        let mut connections = Vec::new();
        for (from, output) in self.all(Causality::Output) {
            for (to, input) in self.all(Causality::Input) {
                if from != to && input.name == output.name {
                    connections.push(Connection {
                        variable: output.name.clone(),
                        from,
                        to,
                    });
                }
            }
        }
        connections
    }

    /// Whether anything is connected, be it to the system's own connectors.
    pub(super) fn has_connections(&self) -> bool {
        self.exposed || !self.connections().is_empty()
    }

    fn is_free(&self, place: usize, input: &str) -> bool {
        let connections = self.connections();
        !connections
            .iter()
            .any(|c| c.to == place && c.variable == input)
    }

    /// Inputs that no component drives.
    pub(super) fn free_inputs(&self) -> impl Iterator<Item = (usize, &Variable)> {
        self.all(Causality::Input)
            .filter(|(place, input)| self.is_free(*place, &input.name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn source(name: &str) -> Source {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../modelDescription");
        Source::read(&folder.join(name)).unwrap()
    }

    fn loop_of(names: &[&str]) -> Result<System, SystemError> {
        System::new(names.iter().map(|name| source(name)).collect())
    }

    #[test]
    fn outputs_go_to_inputs_of_the_same_name_and_the_rest_is_free() {
        let system = loop_of(&["reduced-rig.toml", "soft-torque.toml"]).unwrap();
        let connections: Vec<(String, usize, usize)> = system
            .connections()
            .into_iter()
            .map(|c| (c.variable, c.from, c.to))
            .collect();
        let expected = [("theta3_dot", 0, 1), ("i", 0, 1), ("u", 1, 0)];
        assert_eq!(
            connections,
            expected.map(|(name, from, to)| (name.to_owned(), from, to))
        );
        let free: Vec<&str> = system.free_inputs().map(|(_, v)| v.name.as_str()).collect();
        assert_eq!(free, ["N2", "omega_ref"]);
    }

    #[test]
    fn a_single_component_is_a_system_whose_inputs_are_all_free() {
        let mut system = loop_of(&["reduced-rig.toml"]).unwrap();
        assert_eq!(system.name(), "ReducedRig");
        assert_eq!(system.connections(), []);
        assert_eq!(system.free_inputs().count(), 2);
        system.start("N2", 50.0).unwrap();
        system.start("disc.inertia", 0.02).unwrap();
        let starts: Vec<(&str, f64)> = system
            .input_starts()
            .map(|(v, value)| (v.name.as_str(), value))
            .collect();
        assert_eq!(starts, [("N2", 50.0)]);
    }

    #[test]
    fn what_is_not_clear_is_refused() {
        let refused = |names: &[&str]| loop_of(names).err().unwrap();
        assert!(matches!(refused(&[]), SystemError::Empty));
        assert!(matches!(
            refused(&["reduced-rig.toml", "full-rig.toml"]),
            SystemError::SameOutput { .. }
        ));
        let twice = refused(&["soft-torque.toml", "soft-torque.toml"]);
        assert!(matches!(twice, SystemError::SameComponent { .. }));
        let both = refused(&["soft-torque.toml", "speed-controller.toml"]);
        assert!(matches!(both, SystemError::SameOutput { ref output, .. } if output == "u"));
        let mut system = loop_of(&["reduced-rig.toml", "soft-torque.toml"]).unwrap();
        let mut refused = |name: &str, value| system.start(name, value).err().unwrap();
        assert!(matches!(
            refused("u", 1.0),
            SystemError::UnknownStart { .. }
        ));
        assert!(matches!(
            refused("theta", 1.0),
            SystemError::UnknownStart { .. }
        ));
        assert!(matches!(
            refused("gearbox.ratio", 9.0),
            SystemError::AmbiguousStart { .. }
        ));
        assert!(matches!(
            refused("disc.inertia", -1.0),
            SystemError::Value { .. }
        ));
        system.start("SoftTorque.gearbox.ratio", 9.0).unwrap();
        assert!(matches!(
            system.start("SoftTorque.gearbox.ratio", 8.0),
            Err(SystemError::Twice { first: 9.0, .. })
        ));
        assert_eq!(system.starts(1).count(), 1);
    }
}
