//! `modelDescription.xml` of an FMU around an FMU: that of the original, with what the effects change.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::ops::Range;

use roxmltree::{Document, Node};
use stickslip::parameter::units::Unit;

use crate::component::FmiVersion;

/// A variable that the original does not have.
#[derive(Debug, Clone)]
pub struct Added {
    /// Name.
    pub name: String,
    /// Value reference.
    pub reference: u32,
    /// What it is.
    pub description: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// Start value of a parameter; `None` for what is computed.
    pub start: Option<f64>,
}

/// What the description says instead of the original's.
#[derive(Debug, Clone)]
pub struct Changes {
    /// Version of the standard.
    pub version: FmiVersion,
    /// `modelName`.
    pub model_name: String,
    /// `modelIdentifier`.
    pub identifier: String,
    /// `guid` or `instantiationToken`.
    pub token: String,
    /// `generationTool`.
    pub tool: String,
    /// Names of variables that start with other values, with these.
    pub starts: Vec<(String, f64)>,
    /// Further variables, in order.
    pub added: Vec<Added>,
}

/// What the original can, as far as a step needs to know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Abilities {
    /// It saves and restores its state.
    pub can_restore: bool,
    /// It takes steps of any length.
    pub can_vary_steps: bool,
}

/// What the description `text` says that its FMU can.
pub fn abilities(text: &str) -> Abilities {
    let document = Document::parse(text);
    let says = |names: &[&str]| {
        let root = document.as_ref().map(Document::root_element).ok();
        let interface = root.and_then(|root| child(root, "CoSimulation"));
        interface.is_some_and(|node| {
            names
                .iter()
                .any(|name| matches!(node.attribute(*name), Some("true" | "1")))
        })
    };
    Abilities {
        can_restore: says(&["canGetAndSetFMUstate", "canGetAndSetFMUState"]),
        can_vary_steps: says(&["canHandleVariableCommunicationStepSize"]),
    }
}

/// The description of the FMU around the original whose description is `text`.
///
/// # Errors
/// What is missing or wrong in `text`.
pub fn changed(text: &str, changes: &Changes) -> Result<String, String> {
    let document = Document::parse(text).map_err(|error| format!("is not sound XML: {error}"))?;
    let root = document.root_element();
    let interface = child(root, "CoSimulation").ok_or("offers no co-simulation")?;
    let variables = child(root, "ModelVariables").ok_or("has no ModelVariables")?;
    let token = match changes.version {
        FmiVersion::Two => "guid",
        FmiVersion::Three => "instantiationToken",
    };
    let mut edits: Vec<(Range<usize>, String)> = vec![
        attribute(text, root, token, &changes.token),
        attribute(text, root, "modelName", &changes.model_name),
        attribute(text, root, "generationTool", &changes.tool),
        (interface.range(), co_simulation(interface, changes)),
    ];
    // Neither is provided: the effects act between communication points.
    for name in ["ModelExchange", "ScheduledExecution"] {
        edits.extend(child(root, name).map(|node| (node.range(), String::new())));
    }
    for (name, value) in &changes.starts {
        let node = variables
            .children()
            .find(|node| node.attribute("name") == Some(name))
            .ok_or_else(|| format!("has no variable `{name}`"))?;
        let typed = match changes.version {
            FmiVersion::Two => child(node, "Real").unwrap_or(node),
            FmiVersion::Three => node,
        };
        edits.push(attribute(text, typed, "start", &format!("{value:?}")));
    }
    edits.push((
        inner_end(text, variables)..inner_end(text, variables),
        variables_text(changes),
    ));
    let definitions = child(root, "UnitDefinitions");
    let known: BTreeSet<&str> = definitions
        .iter()
        .flat_map(Node::children)
        .filter_map(|unit| unit.attribute("name"))
        .collect();
    let units = units_text(changes, &known);
    if !units.is_empty() {
        edits.push(match definitions {
            Some(node) if node.has_children() => {
                (inner_end(text, node)..inner_end(text, node), units)
            }
            Some(node) => (
                node.range(),
                format!("<UnitDefinitions>{units}\n  </UnitDefinitions>"),
            ),
            None => {
                let ends = ["ModelExchange", "CoSimulation", "ScheduledExecution"].iter();
                let last = ends.filter_map(|name| Some(child(root, name)?.range().end));
                let at = last.max().unwrap_or(interface.range().end);
                (
                    at..at,
                    format!("\n  <UnitDefinitions>{units}\n  </UnitDefinitions>"),
                )
            }
        });
    }
    // From the end, so that places before it stay; where two meet, the later one in the list comes after.
    edits.sort_by_key(|(range, _)| range.start);
    let mut changed = text.to_owned();
    for (range, new) in edits.into_iter().rev() {
        changed.replace_range(range, &new);
    }
    Ok(changed)
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// The edit that gives an element's start tag an attribute.
fn attribute(text: &str, node: Node<'_, '_>, name: &str, value: &str) -> (Range<usize>, String) {
    match node.attribute_node(name) {
        Some(own) => (own.range_value(), escaped(value)),
        None => {
            let start = node.range().start;
            let tag = text[start + 1..]
                .find(|c: char| c.is_whitespace() || c == '>' || c == '/')
                .unwrap_or_default();
            let at = start + 1 + tag;
            (at..at, format!(" {name}=\"{}\"", escaped(value)))
        }
    }
}

/// Where the content of an element that has some ends.
fn inner_end(text: &str, node: Node<'_, '_>) -> usize {
    let range = node.range();
    text[range.clone()]
        .rfind("</")
        .map_or(range.end, |at| range.start + at)
}

/// The element of the interface, with its own name and without what the effects take away.
fn co_simulation(node: Node<'_, '_>, changes: &Changes) -> String {
    let gone: &[&str] = match changes.version {
        FmiVersion::Two => &[
            "canInterpolateInputs",
            "canRunAsynchronuously",
            "maxOutputDerivativeOrder",
            "providesDirectionalDerivative",
        ],
        FmiVersion::Three => &[
            "canReturnEarlyAfterIntermediateUpdate",
            "hasEventMode",
            "maxOutputDerivativeOrder",
            "mightReturnEarlyFromDoStep",
            "providesAdjointDerivatives",
            "providesDirectionalDerivatives",
            "providesEvaluateDiscreteStates",
            "providesIntermediateUpdate",
            "providesPerElementDependencies",
            "recommendedIntermediateInputSmoothness",
        ],
    };
    let mut text = "<CoSimulation".to_owned();
    for own in node.attributes() {
        let value = match own.name() {
            "modelIdentifier" => changes.identifier.as_str(),
            name if gone.contains(&name) => continue,
            _ => own.value(),
        };
        let _ = write!(text, " {}=\"{}\"", own.name(), escaped(value));
    }
    text + "/>"
}

fn variables_text(changes: &Changes) -> String {
    let mut text = String::new();
    for own in &changes.added {
        let unit = match own.unit.as_str() {
            "" | "1" => String::new(),
            unit => format!(" unit=\"{}\"", escaped(unit)),
        };
        let start = own
            .start
            .map_or(String::new(), |start| format!(" start=\"{start:?}\""));
        let kind = if own.start.is_some() {
            "causality=\"parameter\" variability=\"tunable\""
        } else {
            "causality=\"local\""
        };
        let head = format!(
            "name=\"{}\" valueReference=\"{}\" description=\"{}\" {kind}",
            escaped(&own.name),
            own.reference,
            escaped(&own.description)
        );
        let _ = match changes.version {
            FmiVersion::Two => writeln!(
                text,
                "  <ScalarVariable {head}><Real{unit}{start}/></ScalarVariable>"
            ),
            FmiVersion::Three => writeln!(text, "  <Float64 {head}{unit}{start}/>"),
        };
    }
    text
}

/// Definitions of units that the original does not define; a unit that is no product of SI units is defined by its name alone.
fn units_text(changes: &Changes, known: &BTreeSet<&str>) -> String {
    let needed: BTreeSet<&str> = changes.added.iter().map(|own| own.unit.as_str()).collect();
    let mut text = String::new();
    for unit in needed {
        if unit.is_empty() || unit == "1" || known.contains(unit) {
            continue;
        }
        let factor = if unit == "1/min" {
            format!(" factor=\"{:?}\"", 1.0 / 60.0)
        } else {
            String::new()
        };
        let base = Unit::parse(&unit.replace("min", "s")).map(|parsed| {
            let base = parsed.base;
            let exponents = [
                ("kg", base.kg),
                ("m", base.m),
                ("s", base.s),
                ("A", base.a),
                ("K", base.k),
                ("rad", base.rad),
            ];
            let written = exponents.iter().filter(|(_, exponent)| *exponent != 0);
            written
                .map(|(name, exponent)| format!(" {name}=\"{exponent}\""))
                .collect::<String>()
        });
        let content = base.map_or("/>".to_owned(), |base| {
            format!("><BaseUnit{base}{factor}/></Unit>")
        });
        let _ = write!(text, "\n    <Unit name=\"{}\"{content}", escaped(unit));
    }
    text
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\n', "&#10;")
        .replace('\t', "&#9;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changes(version: FmiVersion) -> Changes {
        Changes {
            version,
            model_name: "Axis <with effects>".to_owned(),
            identifier: "Axis_with_effects".to_owned(),
            token: "{2}".to_owned(),
            tool: "stickslip".to_owned(),
            starts: vec![("x".to_owned(), 2.5)],
            added: vec![
                Added {
                    name: "effects.drag".to_owned(),
                    reference: 8,
                    description: "drag".to_owned(),
                    unit: "N.m.s/rad".to_owned(),
                    start: Some(0.5),
                },
                Added {
                    name: "effects.force".to_owned(),
                    reference: 9,
                    description: "force".to_owned(),
                    unit: "N.m".to_owned(),
                    start: None,
                },
            ],
        }
    }

    #[test]
    fn all_of_the_original_stays_and_the_effects_variables_are_there() {
        let text = "<?xml version=\"1.0\"?>\n<!-- made by hand -->\n<fmiModelDescription fmiVersion=\"2.0\" modelName=\"Axis\" \
                    guid=\"{1}\">\n  <ModelExchange modelIdentifier=\"A\"/>\n  <CoSimulation modelIdentifier=\"Axis\" \
                    canGetAndSetFMUstate=\"true\" maxOutputDerivativeOrder=\"1\"><SourceFiles/></CoSimulation>\n  \
                    <UnitDefinitions><Unit name=\"N.m\"/></UnitDefinitions>\n  <ModelVariables>\n    <!-- one -->\n    \
                    <ScalarVariable name=\"x\" valueReference=\"7\"><Real/></ScalarVariable>\n  </ModelVariables>\n  \
                    <ModelStructure/>\n</fmiModelDescription>";
        let new = changed(text, &changes(FmiVersion::Two)).unwrap();
        let document = Document::parse(&new).unwrap();
        let root = document.root_element();
        assert_eq!(root.attribute("modelName"), Some("Axis <with effects>"));
        assert_eq!(root.attribute("guid"), Some("{2}"));
        assert_eq!(root.attribute("generationTool"), Some("stickslip"));
        assert!(child(root, "ModelExchange").is_none());
        let interface = child(root, "CoSimulation").unwrap();
        assert_eq!(
            interface.attribute("modelIdentifier"),
            Some("Axis_with_effects")
        );
        assert_eq!(interface.attribute("canGetAndSetFMUstate"), Some("true"));
        assert_eq!(interface.attribute("maxOutputDerivativeOrder"), None);
        let names: Vec<&str> = child(root, "ModelVariables")
            .unwrap()
            .children()
            .filter_map(|node| node.attribute("name"))
            .collect();
        assert_eq!(names, ["x", "effects.drag", "effects.force"]);
        let units = child(root, "UnitDefinitions").unwrap();
        let names: Vec<&str> = units
            .children()
            .filter_map(|node| node.attribute("name"))
            .collect();
        assert_eq!(names, ["N.m", "N.m.s/rad"]);
        assert!(new.contains("<Real start=\"2.5\"/>"), "{new}");
        assert!(new.contains("<!-- made by hand -->") && new.contains("<!-- one -->"));
        let found = abilities(&new);
        assert_eq!(found, abilities(text));
        assert!(found.can_restore && !found.can_vary_steps, "{found:?}");
    }

    #[test]
    fn units_are_defined_where_the_original_defines_none() {
        let text = "<fmiModelDescription fmiVersion=\"3.0\" modelName=\"Axis\" instantiationToken=\"1\">\
                    <CoSimulation modelIdentifier=\"Axis\" hasEventMode=\"true\"/><ModelVariables><Float64 name=\"x\" \
                    valueReference=\"7\"/></ModelVariables></fmiModelDescription>";
        let new = changed(text, &changes(FmiVersion::Three)).unwrap();
        let document = Document::parse(&new).unwrap();
        let sections: Vec<&str> = document
            .root_element()
            .children()
            .filter(Node::is_element)
            .map(|node| node.tag_name().name())
            .collect();
        assert_eq!(
            sections,
            ["CoSimulation", "UnitDefinitions", "ModelVariables"]
        );
        assert!(
            new.contains("<BaseUnit kg=\"1\" m=\"2\" s=\"-1\" rad=\"-1\"/>"),
            "{new}"
        );
        assert!(!new.contains("hasEventMode"));
    }
}
