//! One finding against its answer.

use std::f64::consts::PI;

use super::answer::{Answer, Group, NEARLY_PARAMETERS};
use crate::diagnose::finding::{Finding, NO_EFFECT, ParameterValue, VerdictName};

/// How a finding compares with what was hidden.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// What the case is an example of.
    pub group: Group,
    /// Kind in the answers file.
    pub kind: String,
    /// Verdict, or the names it gives: a column of the confusion matrix.
    pub said: String,
    /// Whether the first name is right.
    pub top_1: bool,
    /// Whether exactly the right effects were found.
    pub exact: bool,
    /// Whether it says `named`.
    pub named: bool,
    /// Whether a name is not among the hidden effects.
    pub false_name: bool,
    /// Whether it says `nothing_missing` or `parameters`.
    pub quiet: bool,
    /// Whether it says `not_in_catalogue`.
    pub flagged: bool,
    /// Probability of the first set of the ranking, and whether that is the hidden one; absent where no set is the answer.
    pub first_set: Option<(f64, bool)>,
    /// Relative errors of the effects' sizes.
    pub size_errors: Vec<f64>,
    /// For every number with an interval, whether it covers the true one.
    pub covered: Vec<bool>,
    /// Share of the held-out gap closed through the FMU.
    pub closed: Option<f64>,
    /// Time taken [s].
    pub seconds: f64,
}

/// Compares a finding with its answer.
#[must_use]
pub fn judge(answer: &Answer, finding: &Finding) -> Judgement {
    let expected = answer.names();
    let found: Vec<&str> = finding
        .effects
        .iter()
        .map(|effect| effect.name.as_str())
        .collect();
    let named = finding.verdict == VerdictName::Named;
    let quiet = matches!(
        finding.verdict,
        VerdictName::NothingMissing | VerdictName::Parameters
    );
    // For what is nearly a change of parameters that verdict is right, and so are both names together.
    let accepted = expected
        .first()
        .is_some_and(|name| NEARLY_PARAMETERS.contains(name))
        && expected.len() == 1
        && (finding.verdict == VerdictName::Parameters
            || finding.verdict == VerdictName::Ambiguous
                && NEARLY_PARAMETERS
                    .iter()
                    .all(|name| finding.alternatives.iter().any(|a| a == name)));
    let speaks = named || finding.verdict == VerdictName::Ambiguous;
    let top_1 = accepted || speaks && found.first().is_some_and(|name| expected.contains(name));
    let exact = accepted || named && is_right_set(&found, &expected);
    let false_name = named && found.iter().any(|name| !expected.contains(name));
    let (size_errors, covered) = numbers(answer, finding);
    Judgement {
        group: answer.group(),
        kind: answer.kind.clone(),
        said: if named {
            found.join(" + ")
        } else {
            finding.verdict.word().to_owned()
        },
        top_1,
        exact,
        named,
        false_name,
        quiet,
        flagged: finding.verdict == VerdictName::NotInCatalogue,
        first_set: if speaks || quiet {
            first_set(answer, finding, accepted)
        } else {
            None
        },
        size_errors,
        covered,
        closed: finding
            .gap
            .as_ref()
            .and_then(|gap| gap.through_fmu.fmi3.closed),
        seconds: finding.seconds,
    }
}

/// Probability of the first set of a finding, and whether it is the hidden one or `accepted` for it.
fn first_set(answer: &Answer, finding: &Finding, accepted: bool) -> Option<(f64, bool)> {
    let first = finding.ranking.first()?;
    let expected = answer.names();
    let is_hidden = if first.name == NO_EFFECT {
        answer.group() == Group::Clean
    } else {
        let found: Vec<&str> = first.name.split(" + ").collect();
        !expected.is_empty() && is_right_set(&found, &expected)
    };
    Some((first.probability?, accepted || is_hidden))
}

/// Whether just the hidden effects were found. Beside another effect, one that is nearly a change of parameters may have been
/// left to the parameters.
fn is_right_set(found: &[&str], expected: &[&str]) -> bool {
    let is_needed = |name: &&&str| !NEARLY_PARAMETERS.contains(*name);
    let needed: Vec<&str> = expected.iter().filter(is_needed).copied().collect();
    let holds = |set: &[&str]| found.len() == set.len() && found.iter().all(|n| set.contains(n));
    holds(expected) || !needed.is_empty() && holds(&needed)
}

/// Size errors and coverage of all numbers that the answer knows.
fn numbers(answer: &Answer, finding: &Finding) -> (Vec<f64>, Vec<bool>) {
    let (mut errors, mut covered) = (Vec::new(), Vec::new());
    let expected = answer.names();
    let found = finding
        .effects
        .iter()
        .filter(|effect| expected.contains(&effect.name.as_str()));
    for (symbol, value) in found.flat_map(|effect| &effect.parameters) {
        let Some(&truth) = answer.effects.get(symbol) else {
            continue;
        };
        let is_phase = value.unit == "rad" && value.model_parameter.ends_with("phase");
        if !is_phase {
            // Factors and exponents are no effect at 1.
            let neutral = if matches!(symbol.as_str(), "uscale" | "load_exp") {
                1.0
            } else {
                0.0
            };
            errors.push(((value.value - truth) / (truth - neutral)).abs());
        }
        covered.extend(covers(value, truth, is_phase));
    }
    (errors, covered)
}

fn covers(value: &ParameterValue, truth: f64, is_phase: bool) -> Option<bool> {
    let [low, high] = value.interval95?;
    let mut distance = truth - value.value;
    if is_phase {
        distance = (distance + PI).rem_euclid(2.0 * PI) - PI;
    }
    Some((low - value.value..=high - value.value).contains(&distance))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn phase(value: f64, reach: f64) -> ParameterValue {
        ParameterValue {
            value,
            interval95: Some([value - reach, value + reach]),
            unit: "rad".into(),
            model_parameter: "unbalance.phase".into(),
        }
    }

    #[test]
    fn what_is_nearly_parameters_may_be_left_to_them_beside_another_effect() {
        let pair = ["bearing_friction", "supply_sag"];
        assert!(is_right_set(&pair, &pair));
        assert!(is_right_set(&["bearing_friction"], &pair));
        assert!(!is_right_set(&["supply_sag"], &pair));
        assert!(!is_right_set(&["bearing_friction", "unbalance"], &pair));
        assert!(!is_right_set(&[], &["supply_sag"]));
        assert!(!is_right_set(&["unbalance"], &["unbalance", "backlash"]));
    }

    #[test]
    fn phases_are_compared_around_the_circle() {
        assert_eq!(covers(&phase(6.27, 0.05), 0.01, true), Some(true));
        assert_eq!(covers(&phase(3.0, 0.05), 0.01, true), Some(false));
        assert_eq!(covers(&phase(6.27, 0.05), 0.01, false), Some(false));
    }
}
