//! Where names and references of a model description lead: looked up once for each of a hundred thousand variables.

use std::collections::HashMap;

use super::description::{Unit, Variable};
use crate::platform::FmiVersion;

/// Places in the lists of a description; of what is there twice, the first.
#[derive(Debug, Default)]
pub(super) struct Index {
    variables: HashMap<String, usize>,
    references: HashMap<String, usize>,
    types: HashMap<String, usize>,
    units: HashMap<String, usize>,
}

impl Index {
    pub(super) fn new(
        version: FmiVersion,
        variables: &[Variable],
        types: &[Variable],
        units: &[Unit],
    ) -> Self {
        Self {
            variables: first(variables.iter().map(|variable| Some(variable.name()))),
            // In FMI 2 aliases share a value reference, and the model structure counts variables.
            references: match version {
                FmiVersion::Fmi2 => HashMap::new(),
                FmiVersion::Fmi3 => first(
                    variables
                        .iter()
                        .map(|variable| variable.get("valueReference")),
                ),
            },
            types: first(types.iter().map(|declared| Some(declared.name()))),
            units: first(units.iter().map(|unit| Some(unit.name.as_str()))),
        }
    }

    pub(super) fn variable(&self, name: &str) -> Option<usize> {
        self.variables.get(name).copied()
    }

    pub(super) fn reference(&self, reference: &str) -> Option<usize> {
        self.references.get(reference).copied()
    }

    pub(super) fn declared_type(&self, name: &str) -> Option<usize> {
        self.types.get(name).copied()
    }

    pub(super) fn unit(&self, name: &str) -> Option<usize> {
        self.units.get(name).copied()
    }
}

fn first<'a>(names: impl Iterator<Item = Option<&'a str>>) -> HashMap<String, usize> {
    let mut places = HashMap::new();
    for (place, name) in names.enumerate() {
        if let Some(name) = name {
            places.entry(name.to_owned()).or_insert(place);
        }
    }
    places
}
