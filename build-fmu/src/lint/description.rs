//! The parts of a model description that the check looks at, of either standard.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::finding::{Finding, Rule};
use super::index::Index;
use super::package::Package;
use super::xml::{self, Attributes};
use crate::platform::FmiVersion;

/// File name of the description inside the FMU.
pub(super) const DESCRIPTION: &str = "modelDescription.xml";

/// Most elements that are read: of FMI 2, two for each variable.
const MOST_ELEMENTS: usize = 150_000;
/// Most attributes of all elements together.
const MOST_ATTRIBUTES: usize = 500_000;
/// Deepest nesting; the standards' own is below 10.
const DEEPEST: usize = 64;
/// Most display units of a unit.
const MOST_DISPLAY_UNITS: usize = 256;

/// A variable with its attributes; those of the FMI 2 type element are among them.
#[derive(Debug, Clone, Default)]
pub(super) struct Variable {
    /// `Real`, `Float64`, `Boolean` …
    pub(super) kind: String,
    pub(super) attributes: Attributes,
}

impl Variable {
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.attributes.get(name).map(String::as_str)
    }

    pub(super) fn name(&self) -> &str {
        self.get("name").unwrap_or_default()
    }
}

/// A unit: display units with their factors.
#[derive(Debug, Clone, Default)]
pub(super) struct Unit {
    pub(super) name: String,
    pub(super) factor: Option<String>,
    pub(super) display_units: Vec<(String, Option<String>)>,
}

/// An entry of the model structure.
#[derive(Debug, Clone)]
pub(super) struct Unknown {
    /// `Output`, `InitialUnknown`, `ContinuousStateDerivative` … in FMI 3's words.
    pub(super) list: String,
    pub(super) attributes: Attributes,
}

/// What was read.
#[derive(Debug)]
pub(super) struct Description {
    pub(super) version: FmiVersion,
    pub(super) root: Attributes,
    /// Interface (`CoSimulation` …) and model identifier.
    pub(super) interfaces: Vec<(String, Option<String>)>,
    pub(super) units: Vec<Unit>,
    /// Types by name with their kind and unit, in order, twice if defined twice.
    pub(super) types: Vec<Variable>,
    pub(super) experiment: Option<Attributes>,
    pub(super) variables: Vec<Variable>,
    pub(super) unknowns: Vec<Unknown>,
    pub(super) source_files: Vec<String>,
    index: Index,
}

impl Description {
    /// Reads the description of an FMU.
    pub(super) fn read(package: &Package) -> Result<Self, Finding> {
        let broken =
            |reason: String| Finding::new(Rule::Description, format!("{DESCRIPTION}: {reason}"));
        if !package.has(DESCRIPTION) {
            let hint = package.names().find(|name| name.ends_with(DESCRIPTION));
            return Err(broken(match hint {
                Some(place) => format!("is not at the top of the archive but at {place}"),
                None => "is missing".to_owned(),
            }));
        }
        let text = xml::text(package, DESCRIPTION).map_err(broken)?;
        let mut walk = Walk::default();
        walk.run(&text).map_err(broken)?;
        walk.finish()
    }

    /// The variable of this name.
    pub(super) fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.get(self.index.variable(name)?)
    }

    /// Whether a variable has this name.
    pub(super) fn has_variable(&self, name: &str) -> bool {
        self.index.variable(name).is_some()
    }

    /// The variable that a reference of the model structure means.
    pub(super) fn referenced(&self, reference: &str) -> Option<&Variable> {
        let place = match self.version {
            FmiVersion::Fmi2 => reference.parse::<usize>().ok()?.checked_sub(1)?,
            FmiVersion::Fmi3 => self.index.reference(reference)?,
        };
        self.variables.get(place)
    }

    /// The type of this name.
    pub(super) fn type_named(&self, name: &str) -> Option<&Variable> {
        self.types.get(self.index.declared_type(name)?)
    }

    /// The unit of this name.
    pub(super) fn unit_named(&self, name: &str) -> Option<&Unit> {
        self.units.get(self.index.unit(name)?)
    }
}

#[derive(Default)]
struct Walk {
    elements: usize,
    attributes: usize,
    path: Vec<String>,
    root: Attributes,
    interfaces: Vec<(String, Option<String>)>,
    units: Vec<Unit>,
    types: Vec<Variable>,
    experiment: Option<Attributes>,
    variables: Vec<Variable>,
    unknowns: Vec<Unknown>,
    source_files: Vec<String>,
}

impl Walk {
    fn run(&mut self, text: &str) -> Result<(), String> {
        let mut reader = Reader::from_str(text);
        loop {
            match reader.read_event() {
                Ok(Event::Start(_)) if self.path.len() == DEEPEST => {
                    return Err(format!("nests elements deeper than {DEEPEST}"));
                }
                Ok(Event::Start(element)) => {
                    let name = self.open(&element)?;
                    self.path.push(name);
                }
                Ok(Event::Empty(element)) => {
                    self.open(&element)?;
                }
                Ok(Event::End(_)) => {
                    self.path.pop();
                }
                Ok(Event::DocType(_)) => {
                    return Err("declares a document type; entities are refused".to_owned());
                }
                Ok(Event::Eof) if self.path.is_empty() => return Ok(()),
                Ok(Event::Eof) => return Err(format!("ends inside <{}>", self.path.join("><"))),
                Ok(_) => {}
                Err(error) => return Err(format!("is not well-formed: {error}")),
            }
        }
    }

    fn open(&mut self, element: &BytesStart<'_>) -> Result<String, String> {
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            return Err(format!("has more than {MOST_ELEMENTS} elements"));
        }
        let name = element.name().as_ref().to_owned();
        let attributes = xml::attributes(element)?;
        self.attributes += attributes.len();
        if self.attributes > MOST_ATTRIBUTES {
            return Err(format!("has more than {MOST_ATTRIBUTES} attributes"));
        }
        let place: Vec<&str> = self.path.iter().map(String::as_str).collect();
        match (place.as_slice(), name.as_str()) {
            ([], _) => self.root = attributes,
            ([_], "CoSimulation" | "ModelExchange" | "ScheduledExecution") => {
                // Each means that a binary is looked at.
                if self.interfaces.iter().any(|(known, _)| *known == name) {
                    return Err(format!("has <{name}> twice"));
                }
                self.interfaces
                    .push((name.clone(), attributes.get("modelIdentifier").cloned()));
            }
            ([_, _, "SourceFiles"], "File") => {
                self.source_files.extend(attributes.get("name").cloned());
            }
            ([_, "UnitDefinitions"], "Unit") => self.units.push(Unit {
                name: attributes.get("name").cloned().unwrap_or_default(),
                ..Unit::default()
            }),
            ([_, "UnitDefinitions", "Unit"], "BaseUnit") => {
                if let Some(unit) = self.units.last_mut() {
                    unit.factor = attributes.get("factor").cloned();
                }
            }
            ([_, "UnitDefinitions", "Unit"], "DisplayUnit") => {
                if let Some(unit) = self.units.last_mut() {
                    if unit.display_units.len() == MOST_DISPLAY_UNITS {
                        return Err(format!(
                            "has more than {MOST_DISPLAY_UNITS} display units of the unit {}",
                            unit.name
                        ));
                    }
                    let display = attributes.get("name").cloned().unwrap_or_default();
                    unit.display_units
                        .push((display, attributes.get("factor").cloned()));
                }
            }
            ([_, "TypeDefinitions"], _) => {
                let kind = name.trim_end_matches("Type").to_owned();
                self.types.push(Variable { kind, attributes });
            }
            ([_, "TypeDefinitions", "SimpleType"], _) => {
                merge(self.types.last_mut(), &name, attributes)
            }
            ([_], "DefaultExperiment") => self.experiment = Some(attributes),
            ([_, "ModelVariables"], _) => self.variables.push(Variable {
                kind: name.clone(),
                attributes,
            }),
            ([_, "ModelVariables", "ScalarVariable"], "Annotations") => {}
            ([_, "ModelVariables", "ScalarVariable"], _) => {
                merge(self.variables.last_mut(), &name, attributes);
            }
            ([_, "ModelVariables", _], "Start") => {
                if let Some(variable) = self.variables.last_mut() {
                    let value = attributes.get("value").cloned().unwrap_or_default();
                    variable
                        .attributes
                        .entry("start".to_owned())
                        .or_insert(value);
                }
            }
            ([_, "ModelStructure", list], "Unknown") => {
                let list = match *list {
                    "Outputs" => "Output",
                    "InitialUnknowns" => "InitialUnknown",
                    "Derivatives" => "ContinuousStateDerivative",
                    other => other,
                };
                self.unknowns.push(Unknown {
                    list: list.to_owned(),
                    attributes,
                });
            }
            ([_, "ModelStructure"], _) if attributes.contains_key("valueReference") => {
                self.unknowns.push(Unknown {
                    list: name.clone(),
                    attributes,
                });
            }
            _ => {}
        }
        Ok(name)
    }

    fn finish(self) -> Result<Description, Finding> {
        let version = match self.root.get("fmiVersion").map(String::as_str) {
            Some("2.0") => FmiVersion::Fmi2,
            Some(version) if version == "3.0" || version.starts_with("3.0-") => FmiVersion::Fmi3,
            other => {
                let message =
                    format!("fmiVersion is {other:?}; this check knows \"2.0\" and \"3.0\"");
                return Err(Finding::new(Rule::FmiVersion, message));
            }
        };
        let index = Index::new(version, &self.variables, &self.types, &self.units);
        Ok(Description {
            version,
            index,
            root: self.root,
            interfaces: self.interfaces,
            units: self.units,
            types: self.types,
            experiment: self.experiment,
            variables: self.variables,
            unknowns: self.unknowns,
            source_files: self.source_files,
        })
    }
}

/// Puts the attributes of an FMI 2 type element into the variable or type around it.
fn merge(disc1: Option<&mut Variable>, kind: &str, inner: Attributes) {
    if let Some(disc1) = disc1 {
        kind.clone_into(&mut disc1.kind);
        for (name, value) in inner {
            disc1.attributes.entry(name).or_insert(value);
        }
    }
}
