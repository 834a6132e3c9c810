//! What a solver from outside needs of a description: states with their derivatives, event indicators, and the unknowns of the
//! initialisation.

use std::collections::BTreeSet;

use super::description::{Description, Unknown, Variable};
use super::finding::{Finding, Rule};
use crate::platform::FmiVersion;

/// Kinds of dependency in both standards.
const KINDS: [&str; 5] = ["dependent", "constant", "fixed", "tunable", "discrete"];
/// Those that the standards allow of an unknown of the initialisation.
const INITIAL_KINDS: [&str; 2] = ["dependent", "constant"];
const DERIVATIVE: &str = "ContinuousStateDerivative";

pub(super) fn check(description: &Description) -> Vec<Finding> {
    let mut messages = derivatives(description);
    messages.extend(states(description));
    messages.extend(initial_unknowns(description));
    messages.extend(description.unknowns.iter().filter_map(kinds));
    if description
        .interfaces
        .iter()
        .any(|(interface, _)| interface == "ModelExchange")
    {
        messages.extend(indicators(description));
    }
    let found = |message| Finding::new(Rule::ModelExchange, message);
    messages.into_iter().map(found).collect()
}

/// The reference of an entry of the model structure.
fn reference(unknown: &Unknown) -> &str {
    let attributes = &unknown.attributes;
    let reference = attributes
        .get("index")
        .or_else(|| attributes.get("valueReference"));
    reference.map_or("", String::as_str)
}

/// The variables of one list of the model structure.
fn listed<'a>(description: &'a Description, list: &'a str) -> impl Iterator<Item = &'a Variable> {
    let unknowns = description
        .unknowns
        .iter()
        .filter(move |unknown| unknown.list == list);
    unknowns.filter_map(|unknown| description.referenced(reference(unknown)))
}

fn is_real(variable: &Variable) -> bool {
    matches!(variable.kind.as_str(), "Real" | "Float64" | "Float32")
}

/// Derivatives are listed once each, and each is that of one state.
fn derivatives(description: &Description) -> Vec<String> {
    let mut messages = Vec::new();
    let mut names = BTreeSet::new();
    for variable in listed(description, DERIVATIVE) {
        if variable.get("derivative").is_none() {
            messages.push(format!(
                "{} is listed as a derivative but has no attribute derivative that names its state",
                variable.name()
            ));
        }
        if !names.insert(variable.name()) {
            messages.push(format!("derivative {} is listed twice", variable.name()));
        }
    }
    let mut states = BTreeSet::new();
    for variable in &description.variables {
        let Some(state) = variable.get("derivative") else {
            continue;
        };
        let name = variable.name();
        if !names.contains(name) {
            messages.push(format!(
                "{name} is a derivative but not listed in the model structure"
            ));
        }
        if !matches!(variable.get("causality"), None | Some("local" | "output")) {
            messages.push(format!("derivative {name} must be a local or an output"));
        }
        match description.referenced(state) {
            None => messages.push(format!(
                "{name} is the derivative of {state}, which is no variable"
            )),
            Some(variable) if !is_real(variable) => {
                messages.push(format!(
                    "{name} is the derivative of {}, which is no real",
                    variable.name()
                ));
            }
            Some(variable) if !states.insert(variable.name()) => {
                messages.push(format!("{} has two derivatives", variable.name()));
            }
            Some(_) => {}
        }
    }
    messages
}

/// States are continuous and nothing else is reinitialised.
fn states(description: &Description) -> Vec<String> {
    let of = |variable: &Variable| description.referenced(variable.get("derivative")?);
    let states: BTreeSet<&str> = description
        .variables
        .iter()
        .filter_map(of)
        .map(Variable::name)
        .collect();
    let mut messages = Vec::new();
    for variable in &description.variables {
        let name = variable.name();
        let is_state = states.contains(name);
        if is_state && !matches!(variable.get("variability"), None | Some("continuous")) {
            messages.push(format!("state {name} must be continuous"));
        }
        if is_state && !matches!(variable.get("causality"), None | Some("local" | "output")) {
            messages.push(format!("state {name} must be a local or an output"));
        }
        if !is_state && variable.get("reinit").is_some() {
            messages.push(format!("{name} has the attribute reinit but is no state"));
        }
    }
    messages
}

/// Outputs, states and derivatives that are calculated at the start are listed, and nothing that is known.
fn initial_unknowns(description: &Description) -> Vec<String> {
    let known: BTreeSet<&str> = listed(description, "InitialUnknown")
        .map(Variable::name)
        .collect();
    let needed = listed(description, "Output").chain(listed(description, DERIVATIVE));
    let mut messages = Vec::new();
    for variable in needed {
        let calculated = matches!(variable.get("initial"), Some("calculated" | "approx"))
            || variable.get("initial").is_none()
                && !matches!(variable.get("variability"), Some("constant"))
                && variable.get("start").is_none();
        if calculated && !known.contains(variable.name()) {
            messages.push(format!(
                "{} is calculated at the start but not listed among the InitialUnknowns",
                variable.name()
            ));
        }
    }
    for variable in listed(description, "InitialUnknown") {
        if variable.get("initial") == Some("exact") {
            messages.push(format!(
                "{} is an InitialUnknown, but its start value is exact",
                variable.name()
            ));
        }
    }
    messages
}

/// Kinds of dependency are words of the standard.
fn kinds(unknown: &Unknown) -> Option<String> {
    let words = unknown.attributes.get("dependenciesKind")?;
    let allowed: &[&str] = match unknown.list.as_str() {
        "InitialUnknown" => &INITIAL_KINDS,
        _ => &KINDS,
    };
    let stray = words
        .split_whitespace()
        .find(|word| !allowed.contains(word))?;
    Some(format!(
        "{} {}: dependenciesKind {stray:?} is none of {}",
        unknown.list,
        reference(unknown),
        allowed.join(", ")
    ))
}

/// Event indicators are counted (FMI 2), or listed once each (FMI 3).
fn indicators(description: &Description) -> Vec<String> {
    if description.version == FmiVersion::Fmi2 {
        let count = description.root.get("numberOfEventIndicators");
        // The attribute may be absent: there are none then.
        let is_count = count.is_none_or(|count| count.parse::<u32>().is_ok());
        return if is_count {
            Vec::new()
        } else {
            vec![format!(
                "numberOfEventIndicators {count:?} is no number of indicators"
            )]
        };
    }
    let mut messages = Vec::new();
    let mut names = BTreeSet::new();
    for unknown in description
        .unknowns
        .iter()
        .filter(|unknown| unknown.list == "EventIndicator")
    {
        match description.referenced(reference(unknown)) {
            None => messages.push(format!(
                "EventIndicator {} is no variable",
                reference(unknown)
            )),
            Some(variable) if !is_real(variable) => {
                messages.push(format!("event indicator {} is no real", variable.name()));
            }
            Some(variable) if !names.insert(variable.name()) => {
                messages.push(format!(
                    "event indicator {} is listed twice",
                    variable.name()
                ));
            }
            Some(_) => {}
        }
    }
    messages
}
