//! What an FMU of any origin says of the files related to it, and the experiments among them.
//!
//! The format of experiments is a draft: start, end and step stand in an element `TransientSimulation` of their own, and stood in
//! `Experiment` itself when FMI-LS-REF 1.0.0-beta.1 came out. Both are read.

use roxmltree::{Document, Node};
use thiserror::Error;

use super::address::resolve;
use super::{CSV, EXPERIMENTS, NAMESPACE, PARAMETERS, manifest_file};
use crate::component::document;

/// Roles of related files; `experiment` and `serialized-state` have parts behind a slash.
const ROLES: [&str; 17] = [
    "document",
    "requirement",
    "specification",
    "model",
    "parameter",
    "system",
    "testcase",
    "result",
    "method",
    "rationale",
    "report",
    "request",
    "delivery",
    "configuration",
    "signature",
    "meta-data",
    "other",
];
/// Most related files, and most experiments of a file.
const MOST: usize = 1000;

/// Why a manifest or a file of experiments cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ReadError {
    /// The text is not sound XML.
    #[error("{0}")]
    Xml(String),
    /// The outermost element is another.
    #[error("has the root element <{found}>, not <{expected}>")]
    Root {
        /// What is there.
        found: String,
        /// What should be.
        expected: &'static str,
    },
    /// An attribute is missing or empty.
    #[error("<{element}> has no {attribute}")]
    Missing {
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
    },
    /// An attribute says what it cannot.
    #[error("<{element}> has {attribute} = {text:?}; {expected} is needed")]
    Value {
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
        /// What it says.
        text: String,
        /// What it might say.
        expected: &'static str,
    },
    /// Two experiments have one name.
    #[error("has two experiments called {0}")]
    Twice(String),
    /// There is too much of something.
    #[error("has more than {MOST} <{0}>")]
    Many(&'static str),
    /// A file of experiments has none.
    #[error("has no <Experiment>")]
    NoExperiment,
}

/// What the manifest of any layered standard says of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Standard {
    /// `fmi-ls-name`.
    pub name: String,
    /// `fmi-ls-version`.
    pub version: String,
}

/// A file that is named by another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Its MIME type.
    pub kind: String,
    /// The address, as it stands there.
    pub address: String,
    /// Its name inside the FMU; `None` where the address leads elsewhere.
    pub file: Option<String>,
}

/// A related file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Related {
    /// Which file.
    pub source: Source,
    /// What it is for.
    pub role: String,
}

impl Related {
    /// Whether it holds experiments that whoever imports the FMU can repeat to check the import.
    #[must_use]
    pub fn is_check(&self) -> bool {
        let roles = [
            "experiment",
            "experiment/smoke-test",
            "experiment/validation",
        ];
        roles.contains(&self.role.as_str())
    }

    /// Whether its content is in the Experiments Format.
    #[must_use]
    pub fn has_experiments(&self) -> bool {
        self.source.kind == EXPERIMENTS || self.source.address.ends_with(".exp")
    }
}

/// An experiment as its file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// Its name.
    pub name: String,
    /// Start [s].
    pub start: Option<f64>,
    /// End [s].
    pub stop: Option<f64>,
    /// Communication step [s].
    pub step: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
    /// Whether it is a run over time, not a search for a steady state or for parameters.
    pub over_time: bool,
    /// Values of parameters.
    pub parameters: Option<Source>,
    /// Inputs over time.
    pub stimuli: Option<Source>,
    /// Results over time.
    pub references: Option<Source>,
}

/// Values of parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ParameterSet {
    /// Real parameters in the FMU's own units.
    pub values: Vec<(String, f64)>,
    /// Names of those of other types or in units, which are not read.
    pub others: Vec<String>,
}

/// Reads what the manifest of any layered standard must say.
///
/// # Errors
/// [`ReadError`].
pub fn standard(text: &str) -> Result<Standard, ReadError> {
    let document = document(text).map_err(ReadError::Xml)?;
    let root = document.root_element();
    let stated = |attribute: &'static str| match root.attribute((NAMESPACE, attribute)) {
        Some(text) if !text.trim().is_empty() => Ok(text.to_owned()),
        _ => Err(missing(root, attribute)),
    };
    let standard = Standard {
        name: stated("fmi-ls-name")?,
        version: stated("fmi-ls-version")?,
    };
    stated("fmi-ls-description")?;
    let numbers = standard.version.split(['-', '+']).next();
    let is_version = numbers.is_some_and(|numbers| {
        let parts: Vec<&str> = numbers.split('.').collect();
        parts.len() == 3 && parts.iter().all(|part| part.parse::<u32>().is_ok())
    });
    if is_version {
        Ok(standard)
    } else {
        Err(value(
            root,
            "fmi-ls-version",
            &standard.version,
            "a version such as 1.0.0",
        ))
    }
}

/// Reads the related files from the manifest of FMI-LS-REF.
///
/// # Errors
/// [`ReadError`].
pub fn related(text: &str) -> Result<Vec<Related>, ReadError> {
    let document = document(text).map_err(ReadError::Xml)?;
    let root = root(&document, "fmiReferences")?;
    let manifest = manifest_file();
    let mut files = Vec::new();
    for node in children(root, "Related") {
        if files.len() == MOST {
            return Err(ReadError::Many("Related"));
        }
        let role = needed(node, "role")?;
        let (main, part) = match role.split_once('/') {
            Some((main, part)) => (main, Some(part)),
            None => (role, None),
        };
        let known = match (main, part) {
            ("experiment", Some(part)) => {
                ["smoke-test", "validation", "uncertainty-analysis"].contains(&part)
            }
            ("experiment" | "serialized-state", _) => true,
            (main, None) => ROLES.contains(&main),
            _ => false,
        };
        if !known {
            return Err(value(node, "role", role, "one of the standard's roles"));
        }
        files.push(Related {
            source: source(node, &manifest, "application/octet-stream")?,
            role: role.to_owned(),
        });
    }
    Ok(files)
}

/// Reads the experiments of the file `name`.
///
/// # Errors
/// [`ReadError`].
pub fn experiments(text: &str, name: &str) -> Result<Vec<Stated>, ReadError> {
    let document = document(text).map_err(ReadError::Xml)?;
    let root = root(&document, "Experiments")?;
    let mut experiments: Vec<Stated> = Vec::new();
    for node in children(root, "Experiment") {
        if experiments.len() == MOST {
            return Err(ReadError::Many("Experiment"));
        }
        let experiment = experiment(node, name)?;
        if experiments
            .iter()
            .any(|known| known.name == experiment.name)
        {
            return Err(ReadError::Twice(experiment.name));
        }
        experiments.push(experiment);
    }
    if experiments.is_empty() {
        return Err(ReadError::NoExperiment);
    }
    Ok(experiments)
}

fn experiment(node: Node<'_, '_>, file: &str) -> Result<Stated, ReadError> {
    let other = node.children().any(|child| {
        let name = child.tag_name().name();
        child.is_element()
            && ![
                "TransientSimulation",
                "Parameters",
                "Stimuli",
                "References",
                "Annotations",
            ]
            .contains(&name)
    });
    let transient = children(node, "TransientSimulation").next();
    let times = transient.unwrap_or(node);
    let experiment = Stated {
        name: needed(node, "name")?.to_owned(),
        start: number(times, "startTime", |_| true)?,
        stop: number(times, "stopTime", |_| true)?,
        step: number(times, "stepSize", |step| step > 0.0)?,
        tolerance: number(node, "tolerance", |tolerance| tolerance > 0.0)?,
        over_time: !other,
        parameters: child_source(node, "Parameters", file, PARAMETERS)?,
        stimuli: child_source(node, "Stimuli", file, CSV)?,
        references: child_source(node, "References", file, CSV)?,
    };
    match (experiment.start.unwrap_or(0.0), experiment.stop) {
        (start, Some(stop)) if stop <= start => Err(value(
            times,
            "stopTime",
            &stop.to_string(),
            "a time after the start",
        )),
        _ => Ok(experiment),
    }
}

/// Reads a parameter set (SSV).
///
/// # Errors
/// [`ReadError`].
pub fn parameters(text: &str) -> Result<ParameterSet, ReadError> {
    let document = document(text).map_err(ReadError::Xml)?;
    let root = root(&document, "ParameterSet")?;
    let mut set = ParameterSet::default();
    let list = children(root, "Parameters").next();
    for node in list
        .into_iter()
        .flat_map(|list| children(list, "Parameter"))
    {
        let name = needed(node, "name")?.to_owned();
        match children(node, "Real").next() {
            Some(real) if real.attribute("unit").is_none() => {
                match number(real, "value", |_| true)? {
                    Some(number) => set.values.push((name, number)),
                    None => return Err(missing(real, "value")),
                }
            }
            _ => set.others.push(name),
        }
    }
    Ok(set)
}

fn root<'a, 'i>(
    document: &'a Document<'i>,
    expected: &'static str,
) -> Result<Node<'a, 'i>, ReadError> {
    let root = document.root_element();
    if root.tag_name().name() == expected {
        return Ok(root);
    }
    Err(ReadError::Root {
        found: root.tag_name().name().to_owned(),
        expected,
    })
}

fn children<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children()
        .filter(move |child| child.is_element() && child.tag_name().name() == name)
}

fn missing(node: Node<'_, '_>, attribute: &'static str) -> ReadError {
    ReadError::Missing {
        element: node.tag_name().name().to_owned(),
        attribute,
    }
}

fn value(
    node: Node<'_, '_>,
    attribute: &'static str,
    text: &str,
    expected: &'static str,
) -> ReadError {
    ReadError::Value {
        element: node.tag_name().name().to_owned(),
        attribute,
        text: text.to_owned(),
        expected,
    }
}

fn needed<'a>(node: Node<'a, '_>, attribute: &'static str) -> Result<&'a str, ReadError> {
    match node.attribute(attribute) {
        Some(text) if !text.trim().is_empty() => Ok(text),
        _ => Err(missing(node, attribute)),
    }
}

fn number(
    node: Node<'_, '_>,
    attribute: &'static str,
    fits: fn(f64) -> bool,
) -> Result<Option<f64>, ReadError> {
    let Some(text) = node.attribute(attribute) else {
        return Ok(None);
    };
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() && fits(number) => Ok(Some(number)),
        _ => Err(value(
            node,
            attribute,
            text,
            "a number that makes sense there",
        )),
    }
}

fn child_source(
    node: Node<'_, '_>,
    name: &'static str,
    file: &str,
    kind: &'static str,
) -> Result<Option<Source>, ReadError> {
    children(node, name)
        .next()
        .map(|child| source(child, file, kind))
        .transpose()
}

fn source(node: Node<'_, '_>, file: &str, kind: &'static str) -> Result<Source, ReadError> {
    let address = needed(node, "source")?;
    Ok(Source {
        kind: node.attribute("type").unwrap_or(kind).to_owned(),
        address: address.to_owned(),
        file: resolve(file, address),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_places_of_the_times_are_read() {
        let old = r#"<Experiments name="a"><Experiment name="b" startTime="1" stopTime="2" stepSize="0.1" tolerance="1e-6">
            <References source="r.csv"/></Experiment></Experiments>"#;
        let new = r#"<Experiments name="a"><Experiment name="b" tolerance="1e-6">
            <TransientSimulation startTime="1" stopTime="2" stepSize="0.1"/><References source="r.csv"/>
            </Experiment></Experiments>"#;
        let old = experiments(old, "x/a.exp").unwrap();
        assert_eq!(old, experiments(new, "x/a.exp").unwrap());
        assert_eq!((old[0].start, old[0].stop), (Some(1.0), Some(2.0)));
        assert_eq!((old[0].step, old[0].tolerance), (Some(0.1), Some(1e-6)));
        assert!(old[0].over_time);
        let file = old[0].references.as_ref().unwrap().file.as_deref();
        assert_eq!(file, Some("x/r.csv"));
    }

    #[test]
    fn another_analysis_is_no_run_over_time() {
        let text = r#"<Experiments name="a"><Experiment name="b"><SteadyState/></Experiment></Experiments>"#;
        assert!(!experiments(text, "a.exp").unwrap()[0].over_time);
    }

    #[test]
    fn parameters_with_units_or_of_other_types_are_set_apart() {
        let text = r#"<s:ParameterSet xmlns:s="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0"
            name="p"><s:Parameters><s:Parameter name="a"><s:Real value="1.5"/></s:Parameter>
            <s:Parameter name="b"><s:Real value="1" unit="mm"/></s:Parameter>
            <s:Parameter name="c"><s:Integer value="1"/></s:Parameter></s:Parameters></s:ParameterSet>"#;
        let set = parameters(text).unwrap();
        assert_eq!(set.values, [("a".to_owned(), 1.5)]);
        assert_eq!(set.others, ["b", "c"]);
    }
}
