//! Variables: unique, with roles that the standards allow and numbers that agree.

use std::collections::BTreeMap;

use super::description::{Description, Variable};
use super::finding::{Finding, Rule};
use crate::platform::FmiVersion;

pub(super) fn check(description: &Description) -> Vec<Finding> {
    let mut findings = duplicates(description);
    for variable in &description.variables {
        findings.extend(role(variable));
        findings.extend(numbers(variable, description));
    }
    findings
}

fn duplicates(description: &Description) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut names: BTreeMap<&str, u32> = BTreeMap::new();
    let mut references: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for variable in &description.variables {
        if variable.name().is_empty() {
            findings.push(Finding::new(Rule::Missing, "a variable has no name"));
        }
        *names.entry(variable.name()).or_default() += 1;
        match variable.get("valueReference") {
            Some(reference) => references
                .entry(reference)
                .or_default()
                .push(variable.name()),
            None => {
                let message = format!("variable {} has no valueReference", variable.name());
                findings.push(Finding::new(Rule::Missing, message));
            }
        }
    }
    for (name, count) in names.into_iter().filter(|(_, count)| *count > 1) {
        let message = format!("{count} variables are called {name}");
        findings.push(Finding::new(Rule::DuplicateVariable, message));
    }
    // FMI 2 allows aliases by a shared value reference, FMI 3 has elements for them.
    if description.version == FmiVersion::Fmi3 {
        for (reference, names) in references.into_iter().filter(|(_, names)| names.len() > 1) {
            let message = format!(
                "value reference {reference} is shared by {}",
                names.join(", ")
            );
            findings.push(Finding::new(Rule::DuplicateVariable, message));
        }
    }
    findings
}

fn role(variable: &Variable) -> Vec<Finding> {
    let causality = variable.get("causality").unwrap_or("local");
    let continuous = matches!(variable.kind.as_str(), "Real" | "Float32" | "Float64");
    let usual = if matches!(
        causality,
        "parameter" | "calculatedParameter" | "structuralParameter"
    ) {
        "fixed"
    } else if continuous {
        "continuous"
    } else {
        "discrete"
    };
    let variability = variable.get("variability").unwrap_or(usual);
    let has_start = variable.get("start").is_some();
    let allowed: &[&str] = match causality {
        "parameter" | "calculatedParameter" | "structuralParameter" => &["fixed", "tunable"],
        "input" => &["discrete", "continuous"],
        "output" => &["constant", "discrete", "continuous"],
        "independent" => &["continuous"],
        _ => &["constant", "fixed", "tunable", "discrete", "continuous"],
    };
    let mut findings = Vec::new();
    let mut find = |message: String| {
        findings.push(Finding::new(
            Rule::Role,
            format!("variable {}: {message}", variable.name()),
        ));
    };
    if !allowed.contains(&variability) {
        find(format!(
            "{causality} cannot be {variability}; allowed: {}",
            allowed.join(", ")
        ));
    }
    if variability == "continuous" && !continuous {
        find(format!(
            "only reals can be continuous, not {}",
            variable.kind
        ));
    }
    let needs_start = matches!(causality, "input" | "parameter" | "structuralParameter")
        || variable
            .get("initial")
            .is_some_and(|initial| matches!(initial, "exact" | "approx"));
    if needs_start && !has_start && variable.kind != "Clock" {
        find(format!("{causality} needs a start value"));
    }
    if has_start && (causality == "independent" || variable.get("initial") == Some("calculated")) {
        find("has a start value although it is calculated".to_owned());
    }
    findings
}

fn numbers(variable: &Variable, description: &Description) -> Vec<Finding> {
    let integer = variable.kind.contains("Int");
    if !integer && !matches!(variable.kind.as_str(), "Real" | "Float32" | "Float64") {
        return Vec::new();
    }
    let inherited = variable
        .get("declaredType")
        .and_then(|name| description.type_named(name));
    let get = |name: &str| variable.get(name).or_else(|| inherited?.get(name));
    let mut findings = Vec::new();
    let mut find = |message: String| {
        findings.push(Finding::new(
            Rule::Limits,
            format!("variable {}: {message}", variable.name()),
        ));
    };
    let mut number = |name: &str| -> Option<f64> {
        let text = get(name)?;
        match text.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Some(value),
            _ => {
                find(format!("{name} is {text:?}, which is no finite number"));
                None
            }
        }
    };
    let (minimum, maximum, nominal) = (number("min"), number("max"), number("nominal"));
    let starts: Vec<&str> = get("start")
        .unwrap_or_default()
        .split_whitespace()
        .collect();
    if let (Some(minimum), Some(maximum)) = (minimum, maximum)
        && minimum > maximum
    {
        find(format!("min {minimum} is above max {maximum}"));
    }
    if let Some(nominal) = nominal
        && nominal <= 0.0
    {
        find(format!("nominal is {nominal}; it must be above 0"));
    }
    for start in starts {
        let Ok(value) = start.parse::<f64>() else {
            find(format!("start is {start:?}, which is no number"));
            continue;
        };
        if !value.is_finite() {
            find(format!("start is {start}"));
        }
        if minimum.is_some_and(|minimum| value < minimum) {
            find(format!(
                "start {value} is below min {}",
                minimum.unwrap_or_default()
            ));
        }
        if maximum.is_some_and(|maximum| value > maximum) {
            find(format!(
                "start {value} is above max {}",
                maximum.unwrap_or_default()
            ));
        }
    }
    findings
}
