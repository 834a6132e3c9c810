//! What an FMU's `modelDescription.xml` says, as far as a run needs it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use roxmltree::{Document, Node, ParsingOptions};
use thiserror::Error;

use super::variable::{Kind, Role, Variable};

/// Most elements, texts and comments together: hundred bytes of memory each.
const MOST_NODES: u32 = 1_000_000;

/// Most attributes of an element. The parser compares each with each, so a hundred thousand would take minutes.
const MOST_ATTRIBUTES: usize = 256;

/// Most attributes of all elements together: some hundred bytes of memory each.
const MOST_ATTRIBUTES_IN_ALL: usize = 500_000;

/// Most namespaces. The parser hands those of an element on to each element inside it, one by one.
const MOST_NAMESPACES: usize = 64;

/// Deepest nesting; the standards' own is below 10. The parser calls itself for each level.
const DEEPEST: usize = 64;

/// Version of the standard that an FMU follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FmiVersion {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

/// Why a description was refused.
#[derive(Debug, Error)]
#[error("{path}: modelDescription.xml {problem}")]
pub struct DescriptionError {
    /// The FMU.
    pub path: PathBuf,
    /// What is wrong.
    pub problem: String,
}

/// An FMU's description.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Version of the standard.
    pub version: FmiVersion,
    /// Name of the model.
    pub model_name: String,
    /// What made the FMU.
    pub generation_tool: String,
    /// Name of the binary.
    pub model_identifier: String,
    /// `guid` of FMI 2, `instantiationToken` of FMI 3.
    pub token: String,
    /// Whether it takes communication steps of any length.
    pub takes_any_step: bool,
    /// Its own step, or else its usual one, where it states either [s]: some FMUs take multiples of it alone.
    pub own_step: Option<f64>,
    /// The variables in the order of the file.
    pub variables: Vec<Variable>,
}

impl Description {
    /// Reads the description from the text of the XML file of the FMU `path`.
    ///
    /// # Errors
    /// [`DescriptionError`] where it is no description of an FMU for co-simulation.
    pub fn parse(text: &str, path: &Path) -> Result<Self, DescriptionError> {
        let refuse = |problem: String| DescriptionError {
            path: path.to_owned(),
            problem,
        };
        let document = document(text).map_err(refuse)?;
        let root = document.root_element();
        let version = match root.attribute("fmiVersion") {
            Some("2.0") => FmiVersion::Two,
            Some(version) if version.starts_with("3.") => FmiVersion::Three,
            Some(other) => {
                return Err(refuse(format!(
                    "has fmiVersion {other}; 2.0 and 3.0 can be run"
                )));
            }
            None => return Err(refuse("has no fmiVersion".to_owned())),
        };
        let Some(interface) = child(root, "CoSimulation") else {
            return Err(refuse("offers no co-simulation".to_owned()));
        };
        let model_identifier = interface
            .attribute("modelIdentifier")
            .unwrap_or_default()
            .to_owned();
        // The name becomes part of a path to a library that is loaded.
        if model_identifier.is_empty()
            || !model_identifier
                .chars()
                .all(|c| c.is_ascii_alphanumeric() || c == '_')
        {
            return Err(refuse(format!(
                "has the modelIdentifier `{model_identifier}`, which is no name in C"
            )));
        }
        let token_name = if version == FmiVersion::Two {
            "guid"
        } else {
            "instantiationToken"
        };
        let Some(token) = root.attribute(token_name) else {
            return Err(refuse(format!("has no {token_name}")));
        };
        let nodes = child(root, "ModelVariables")
            .into_iter()
            .flat_map(|node| node.children())
            .filter(Node::is_element);
        let mut variables = nodes
            .map(|node| match version {
                FmiVersion::Two => read_variable_2(node),
                FmiVersion::Three => read_variable_3(node),
            })
            .collect::<Result<Vec<_>, _>>()
            .map_err(refuse)?;
        let indicators: BTreeSet<u32> = child(root, "ModelStructure")
            .into_iter()
            .flat_map(|node| node.children())
            .filter(|node| node.has_tag_name("EventIndicator"))
            .filter_map(|node| node.attribute("valueReference")?.parse().ok())
            .collect();
        for variable in &mut variables {
            if variable.role == Role::Local && indicators.contains(&variable.reference) {
                variable.role = Role::Other;
            }
        }
        let fixed = interface.attribute("fixedInternalStepSize");
        let experiment = child(root, "DefaultExperiment");
        let usual = experiment.and_then(|node| node.attribute("stepSize"));
        let own_step = fixed.or(usual);
        Ok(Self {
            version,
            model_name: root.attribute("modelName").unwrap_or_default().to_owned(),
            generation_tool: root
                .attribute("generationTool")
                .unwrap_or_default()
                .to_owned(),
            model_identifier,
            token: token.to_owned(),
            takes_any_step: matches!(
                interface.attribute("canHandleVariableCommunicationStepSize"),
                Some("true" | "1")
            ),
            own_step: own_step
                .and_then(|step| step.parse().ok())
                .filter(|step| f64::is_normal(*step) && *step > 0.0),
            variables,
        })
    }
}

/// Parses XML that anybody may have written; the reason where it is refused.
pub(crate) fn document(text: &str) -> Result<Document<'_>, String> {
    if let Some(problem) = Shape::of(text).problem() {
        return Err(problem);
    }
    let options = ParsingOptions {
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(text, options)
        .map_err(|error| format!("is not sound XML: {error}"))
}

/// What an XML text would cost its parser, found without one.
#[derive(Debug, Default, PartialEq, Eq)]
struct Shape {
    /// The largest number of `=` outside quotes within one tag: never fewer than its attributes.
    attributes: usize,
    /// The same of all tags together.
    attributes_in_all: usize,
    /// How deep elements are nested.
    depth: usize,
    /// How often a namespace is declared, or the word for it occurs.
    namespaces: usize,
}

impl Shape {
    /// What the parser cannot be given, if there is anything.
    fn problem(&self) -> Option<String> {
        let limits = [
            (
                self.attributes,
                MOST_ATTRIBUTES,
                "has an element with more attributes than",
            ),
            (
                self.attributes_in_all,
                MOST_ATTRIBUTES_IN_ALL,
                "has more attributes than",
            ),
            (self.depth, DEEPEST, "nests elements deeper than"),
            (
                self.namespaces,
                MOST_NAMESPACES,
                "declares more namespaces than",
            ),
        ];
        limits
            .into_iter()
            .find(|(found, most, _)| found > most)
            .map(|(found, most, problem)| format!("{problem} {most}: {found}"))
    }

    fn of(text: &str) -> Self {
        let mut shape = Self {
            namespaces: text.matches("xmlns").count(),
            ..Self::default()
        };
        let mut open = 0_usize;
        let mut rest = text;
        while let Some(at) = rest.find('<') {
            rest = &rest[at..];
            let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")]
                .into_iter()
                .find(|(begin, _)| rest.starts_with(begin));
            if let Some((begin, end)) = skipped {
                let inside = &rest[begin.len()..];
                rest = inside.find(end).map_or("", |at| &inside[at..]);
                continue;
            }
            let (mut count, mut quote, mut length) = (0, None, rest.len());
            for (at, byte) in rest.bytes().enumerate() {
                match (byte, quote) {
                    (b'"' | b'\'', None) => quote = Some(byte),
                    (_, Some(open)) if byte == open => quote = None,
                    (b'=', None) => count += 1,
                    (b'>', None) => {
                        length = at;
                        break;
                    }
                    _ => {}
                }
            }
            let tag = &rest[..length];
            if tag.starts_with("</") {
                open = open.saturating_sub(1);
            } else if !tag.ends_with('/') {
                open += 1;
            }
            shape.attributes = shape.attributes.max(count);
            shape.attributes_in_all += count;
            shape.depth = shape.depth.max(open);
            rest = &rest[length..];
        }
        shape
    }
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn read_variable_2(node: Node<'_, '_>) -> Result<Variable, String> {
    let typed = node.children().find(Node::is_element);
    let kind = match typed.map(|typed| typed.tag_name().name()) {
        Some("Real") => Kind::Real,
        Some("Boolean") => Kind::Boolean,
        _ => Kind::Other,
    };
    read_variable(node, typed.unwrap_or(node), kind)
}

fn read_variable_3(node: Node<'_, '_>) -> Result<Variable, String> {
    // Arrays are none of this project's business.
    let scalar = child(node, "Dimension").is_none();
    let kind = match node.tag_name().name() {
        "Float64" if scalar => Kind::Real,
        "Boolean" if scalar => Kind::Boolean,
        _ => Kind::Other,
    };
    read_variable(node, node, kind)
}

fn read_variable(node: Node<'_, '_>, typed: Node<'_, '_>, kind: Kind) -> Result<Variable, String> {
    let name = node
        .attribute("name")
        .ok_or("has a variable without a name")?
        .to_owned();
    let reference = node
        .attribute("valueReference")
        .and_then(|text| text.parse().ok());
    let Some(reference) = reference else {
        return Err(format!(
            "gives no usable valueReference for the variable `{name}`"
        ));
    };
    let number = |attribute: &str| match (kind, typed.attribute(attribute)) {
        (Kind::Other, _) | (_, None) => Ok(None),
        (_, Some("true")) => Ok(Some(1.0)),
        (_, Some("false")) => Ok(Some(0.0)),
        (_, Some(text)) => match text.trim().parse::<f64>() {
            Ok(value) => Ok(Some(value)),
            Err(_) => Err(format!(
                "gives the variable `{name}` {attribute} = `{text}`, which is no number"
            )),
        },
    };
    Ok(Variable {
        reference,
        role: match node.attribute("causality") {
            Some("independent") => Role::Time,
            Some("input") => Role::Input,
            Some("output") => Role::Output,
            Some("parameter") => Role::Parameter,
            // What a solver asks for, under the name that Modelica gives it.
            Some("local") | None
                if typed.attribute("derivative").is_some() && name.starts_with("der(") =>
            {
                Role::Other
            }
            Some("local") | None => Role::Local,
            Some(_) => Role::Other,
        },
        kind,
        held: match node.attribute("variability") {
            None => kind != Kind::Real,
            Some(variability) => variability != "continuous",
        },
        is_tunable: node.attribute("variability") == Some("tunable"),
        unit: typed.attribute("unit").unwrap_or_default().to_owned(),
        start: number("start")?,
        minimum: number("min")?,
        maximum: number("max")?,
        description: node.attribute("description").unwrap_or_default().to_owned(),
        name,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Description, DescriptionError> {
        Description::parse(text, Path::new("rig.fmu"))
    }

    #[test]
    fn both_versions_read_alike() {
        let two = parse(
            r#"<fmiModelDescription fmiVersion="2.0" modelName="Rig" guid="{1}"><CoSimulation modelIdentifier="Rig"/>
            <ModelVariables><ScalarVariable name="u" valueReference="1" causality="input" description="voltage">
            <Real unit="V" start="0" min="-24"/></ScalarVariable></ModelVariables></fmiModelDescription>"#,
        )
        .unwrap();
        let three = parse(
            r#"<fmiModelDescription fmiVersion="3.0" modelName="Rig" instantiationToken="{1}">
            <CoSimulation modelIdentifier="Rig"/><ModelVariables>
            <Float64 name="u" valueReference="1" causality="input" description="voltage" unit="V" start="0" min="-24"/>
            </ModelVariables></fmiModelDescription>"#,
        )
        .unwrap();
        assert_eq!(two.variables, three.variables);
        assert_eq!(two.variables[0].minimum, Some(-24.0));
        assert_eq!((two.token, two.version), (three.token, FmiVersion::Two));
    }

    #[test]
    fn attributes_and_depth_are_those_of_tags_only() {
        let shape = |text| {
            let shape = Shape::of(text);
            (shape.attributes, shape.depth)
        };
        let text = "<!-- a=1 b='2 --><a b='=' c=\"<x y='1' z='2' w='3'>\"/><?p q=r?><![CDATA[<a b=c d=e f=g>]]>";
        assert_eq!(shape(text), (2, 0));
        assert_eq!(shape("<a><b><c/></b><b></b></a>"), (0, 2));
        assert_eq!(shape("<a b='1' c='2' d="), (3, 1));
        let whole = Shape::of("<a xmlns:b='c'><d e='' f=''/><g/></a>");
        assert_eq!((whole.attributes_in_all, whole.namespaces), (3, 1));
    }

    #[test]
    fn wrong_descriptions_are_refused_with_the_reason() {
        let reason = |text: &str| parse(text).unwrap_err().to_string();
        assert!(reason("<a").contains("is not sound XML"));
        assert!(reason(r#"<f fmiVersion="1.0"/>"#).contains("fmiVersion 1.0"));
        assert!(reason(r#"<f fmiVersion="2.0" guid="1"/>"#).contains("no co-simulation"));
        let outside =
            r#"<f fmiVersion="2.0" guid="1"><CoSimulation modelIdentifier="../../evil"/></f>"#;
        assert!(reason(outside).contains("no name in C"));
    }
}
