//! Units and types: defined once, used as defined.

use std::collections::BTreeSet;

use super::description::{Description, Variable};
use super::finding::{Finding, Rule};

pub(super) fn check(description: &Description) -> Vec<Finding> {
    let mut findings = definitions(description);
    let mut types = BTreeSet::new();
    for declared in &description.types {
        if !types.insert(declared.name()) {
            let message = format!("type {} is defined twice", declared.name());
            findings.push(Finding::new(Rule::Type, message));
        }
        findings.extend(use_of_units("type", declared, description));
    }
    for variable in &description.variables {
        findings.extend(use_of_units("variable", variable, description));
        findings.extend(use_of_type(variable, description));
    }
    findings
}

fn definitions(description: &Description) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut find = |message| findings.push(Finding::new(Rule::Unit, message));
    let zero = |factor: &Option<String>| {
        factor.as_ref().is_some_and(|text| {
            !text
                .parse::<f64>()
                .is_ok_and(|value| value != 0.0 && value.is_finite())
        })
    };
    let mut names = BTreeSet::new();
    for unit in &description.units {
        if !names.insert(unit.name.as_str()) {
            find(format!("unit {} is defined twice", unit.name));
        }
        if zero(&unit.factor) {
            find(format!(
                "unit {} has a factor that is zero or no number",
                unit.name
            ));
        }
        let mut displayed = BTreeSet::new();
        for (name, factor) in &unit.display_units {
            if !displayed.insert(name.as_str()) {
                find(format!(
                    "display unit {name} of {} is defined twice",
                    unit.name
                ));
            }
            if zero(factor) {
                find(format!(
                    "display unit {name} of {} has a factor that is zero or no number",
                    unit.name
                ));
            }
        }
    }
    findings
}

fn use_of_units(what: &str, variable: &Variable, description: &Description) -> Option<Finding> {
    let inherited = variable
        .get("declaredType")
        .and_then(|name| description.type_named(name));
    let name = variable.get("unit").or_else(|| inherited?.get("unit"));
    let place = format!("{what} {}", variable.name());
    let Some(name) = name else {
        let display = variable.get("displayUnit")?;
        let message = format!("{place} has a display unit {display} but no unit");
        return Some(Finding::new(Rule::Unit, message));
    };
    let Some(unit) = description.unit_named(name) else {
        let message = format!("{place} uses the unit {name}, which is not defined");
        return Some(Finding::new(Rule::Unit, message));
    };
    let display = variable.get("displayUnit")?;
    if unit.display_units.iter().any(|(known, _)| known == display) {
        return None;
    }
    let message = format!("{place} uses the display unit {display}, which {name} does not define");
    Some(Finding::new(Rule::Unit, message))
}

fn use_of_type(variable: &Variable, description: &Description) -> Option<Finding> {
    let name = variable.get("declaredType")?;
    let place = format!("variable {}", variable.name());
    let message = match description.type_named(name) {
        None => format!("{place} has the type {name}, which is not defined"),
        Some(declared) if declared.kind != variable.kind => {
            format!(
                "{place} is {}, its type {name} is {}",
                variable.kind, declared.kind
            )
        }
        Some(_) => return None,
    };
    Some(Finding::new(Rule::Type, message))
}
