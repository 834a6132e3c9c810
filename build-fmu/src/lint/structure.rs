//! Model structure, default experiment, date and what must not be missing.

use std::collections::BTreeSet;

use super::description::{Description, Unknown};
use super::finding::{Finding, Rule};
use crate::platform::FmiVersion;

pub(super) fn check(description: &Description) -> Vec<Finding> {
    let mut findings = required(description);
    findings.extend(outputs(description));
    findings.extend(
        description
            .unknowns
            .iter()
            .filter_map(|unknown| dependencies(description, unknown)),
    );
    findings.extend(experiment(description));
    findings.extend(date(description));
    findings
}

fn required(description: &Description) -> Vec<Finding> {
    let token = match description.version {
        FmiVersion::Fmi2 => "guid",
        FmiVersion::Fmi3 => "instantiationToken",
    };
    let mut findings: Vec<Finding> = [token, "modelName"]
        .into_iter()
        .filter(|name| {
            description
                .root
                .get(*name)
                .is_none_or(|text| text.trim().is_empty())
        })
        .map(|name| {
            Finding::new(
                Rule::Missing,
                format!("attribute {name} is missing or empty"),
            )
        })
        .collect();
    if description.interfaces.is_empty() {
        let message = "neither CoSimulation nor ModelExchange nor ScheduledExecution is there";
        findings.push(Finding::new(Rule::Missing, message));
    }
    for (interface, identifier) in &description.interfaces {
        let identifier = identifier.as_deref().unwrap_or_default();
        let is_c = !identifier.is_empty()
            && identifier
                .chars()
                .all(|c| c.is_ascii_alphanumeric() || c == '_')
            && !identifier.starts_with(|c: char| c.is_ascii_digit());
        if !is_c {
            let message = format!("{interface}: modelIdentifier {identifier:?} is no C identifier");
            findings.push(Finding::new(Rule::Missing, message));
        }
    }
    findings
}

fn reference(unknown: &Unknown) -> &str {
    let attributes = &unknown.attributes;
    attributes
        .get("index")
        .or_else(|| attributes.get("valueReference"))
        .map_or("", String::as_str)
}

fn outputs(description: &Description) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut find = |message: String| findings.push(Finding::new(Rule::Structure, message));
    let mut listed = BTreeSet::new();
    for unknown in description
        .unknowns
        .iter()
        .filter(|unknown| unknown.list == "Output")
    {
        match description.referenced(reference(unknown)) {
            None => find(format!("Output {} is no variable", reference(unknown))),
            Some(variable) => {
                if variable.get("causality") != Some("output") {
                    find(format!(
                        "{} is listed as an output but is none",
                        variable.name()
                    ));
                }
                if !listed.insert(variable.name()) {
                    find(format!("output {} is listed twice", variable.name()));
                }
            }
        }
    }
    for variable in &description.variables {
        if variable.get("causality") == Some("output") && !listed.contains(variable.name()) {
            find(format!(
                "output {} is not listed in the model structure",
                variable.name()
            ));
        }
    }
    findings
}

fn dependencies(description: &Description, unknown: &Unknown) -> Option<Finding> {
    let list = &unknown.list;
    let find = |message: &str| {
        let message = format!("{list} {} {message}", reference(unknown));
        Some(Finding::new(Rule::Structure, message))
    };
    if list != "Output" && description.referenced(reference(unknown)).is_none() {
        return find("is no variable");
    }
    let words = |name: &str| Some(unknown.attributes.get(name)?.split_whitespace());
    let count = words("dependencies").map(Iterator::count);
    if let Some(kinds) = words("dependenciesKind")
        && count != Some(kinds.count())
    {
        return find("has not as many dependencies as dependenciesKind");
    }
    if count? > description.variables.len() {
        return find("has more dependencies than there are variables");
    }
    let stray = words("dependencies")?.find(|word| description.referenced(word).is_none())?;
    find(&format!("depends on {stray}, which is no variable"))
}

fn experiment(description: &Description) -> Vec<Finding> {
    let Some(experiment) = &description.experiment else {
        return Vec::new();
    };
    let number = |name: &str| experiment.get(name)?.parse::<f64>().ok();
    let mut findings = Vec::new();
    for name in ["startTime", "stopTime", "tolerance", "stepSize"] {
        if experiment.contains_key(name) && !number(name).is_some_and(f64::is_finite) {
            let message = format!(
                "{name} is {:?}, which is no finite number",
                experiment.get(name)
            );
            findings.push(Finding::new(Rule::Experiment, message));
        }
    }
    let start = number("startTime").unwrap_or(0.0);
    if let Some(stop) = number("stopTime")
        && stop < start
    {
        let message = format!("stopTime {stop} is before startTime {start}");
        findings.push(Finding::new(Rule::Experiment, message));
    }
    for name in ["tolerance", "stepSize"] {
        if let Some(value) = number(name)
            && value <= 0.0
        {
            findings.push(Finding::new(
                Rule::Experiment,
                format!("{name} is {value}; it must be above 0"),
            ));
        }
    }
    findings
}

fn date(description: &Description) -> Option<Finding> {
    let text = description.root.get("generationDateAndTime")?;
    let reason = match parse_date(text) {
        None => "is no date as 2026-01-31T12:00:00Z",
        Some(date) if date > today() + 1 => "lies in the future",
        Some(_) => return None,
    };
    Some(Finding::new(
        Rule::Date,
        format!("generationDateAndTime {text:?} {reason}"),
    ))
}

/// Days since 1970-01-01 of an `xs:dateTime`.
fn parse_date(text: &str) -> Option<i64> {
    let (date, time) = text.split_once('T')?;
    let digits = |text: &str, length: usize| -> Option<i64> {
        (text.len() == length && text.bytes().all(|byte| byte.is_ascii_digit()))
            .then(|| text.parse().ok())?
    };
    let mut parts = date.split('-');
    let (year, month, day) = (
        digits(parts.next()?, 4)?,
        digits(parts.next()?, 2)?,
        digits(parts.next()?, 2)?,
    );
    let zone = time.find(['Z', '+', '-']).unwrap_or(time.len());
    let (clock, zone) = time.split_at(zone);
    let mut parts = clock.split(':');
    let (hour, minute, second) = (
        digits(parts.next()?, 2)?,
        digits(parts.next()?, 2)?,
        parts.next()?,
    );
    let second: f64 = second.parse().ok()?;
    let zone_is_right = matches!(zone, "" | "Z")
        || zone[1..]
            .split_once(':')
            .is_some_and(|(h, m)| digits(h, 2).is_some() && digits(m, 2).is_some());
    let leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    let lengths = [
        31,
        if leap { 29 } else { 28 },
        31,
        30,
        31,
        30,
        31,
        31,
        30,
        31,
        30,
        31,
    ];
    let length = *lengths.get(usize::try_from(month).ok()?.checked_sub(1)?)?;
    let in_range =
        (1..=length).contains(&day) && hour <= 24 && minute < 60 && (0.0..61.0).contains(&second);
    if !(in_range && zone_is_right) || parts.next().is_some() {
        return None;
    }
    let before: i64 = lengths[..usize::try_from(month - 1).ok()?].iter().sum();
    let last = year - 1;
    let leap_days = (last / 4 - last / 100 + last / 400) - 477;
    Some((year - 1970) * 365 + leap_days + before + day - 1)
}

fn today() -> i64 {
    let now = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .unwrap_or_default();
    i64::try_from(now.as_secs() / 86_400).unwrap_or(i64::MAX - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_counted_from_1970() {
        assert_eq!(parse_date("1970-01-01T00:00:00Z"), Some(0));
        assert_eq!(parse_date("2000-03-01T00:00:00Z"), Some(11_017));
        assert_eq!(parse_date("2024-02-29T23:59:59.5+02:00"), Some(19_782));
    }

    #[test]
    fn dates_that_are_none() {
        for text in [
            "2026-13-01T00:00:00Z",
            "2026-02-29T00:00:00Z",
            "yesterday",
            "2026-01-01",
            "2026-1-1T0:0:0Z",
        ] {
            assert_eq!(parse_date(text), None, "{text}");
        }
    }
}
