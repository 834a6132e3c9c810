//! A small plant's answer on one screen.

use std::fmt::Write as _;

use super::amend::STRUCTURED;
use super::finding::{ErrorSize, SmallFinding};
use crate::diagnose::console::{candidates, gain_line, number, percent, readable, undecided};
use crate::diagnose::finding::{FoundEffect, VerdictName};

/// The answer in sentences, most important first.
#[must_use]
pub fn answer(found: &SmallFinding) -> Vec<String> {
    let finding = &found.finding;
    let mut lines = Vec::new();
    let added = |lines: &mut Vec<String>, what: &str| {
        for effect in &finding.effects {
            lines.push(format!("{what}: {}.", described(effect)));
        }
    };
    match finding.verdict {
        VerdictName::NothingMissing => {
            lines.push(
                "Nothing is missing: no effect of the catalogue explains more than chance does."
                    .to_owned(),
            );
        }
        VerdictName::Parameters => {
            lines.push(
                "No effect is missing: other nominal parameters explain the records.".to_owned(),
            );
        }
        VerdictName::Located => {
            lines.push("Where the model is wrong was looked at, not why.".to_owned());
        }
        VerdictName::Named => added(&mut lines, "Missing"),
        VerdictName::Ambiguous => {
            lines.push(undecided(finding));
            added(&mut lines, "Added to the model");
        }
        VerdictName::NotInCatalogue => {
            lines.push("Something is missing that no effect of the catalogue explains.".to_owned());
            added(&mut lines, "Added on the way");
            let share = found.small_plant.share_left;
            if let Some(place) = finding
                .structure_left
                .first()
                .filter(|_| share > STRUCTURED)
            {
                lines.push(format!(
                    "What is left is structured over the {}: a free function explains {} of it.",
                    readable(&place.coordinate),
                    percent(share)
                ));
            } else if let Some(place) = finding.structure.first().filter(|own| own.significant) {
                lines.push(format!(
                    "A free function of the {} alone explains more of the records.",
                    readable(&place.coordinate)
                ));
            }
        }
    }
    if let Some(share) = found.lasts() {
        lines.push(format!(
            "What is left is no noise: {} of the force goes on for longer than noise does.",
            percent(share)
        ));
    }
    if let [first, .., last] = &found.small_plant.steps[..] {
        lines.push(format!(
            "Error of the {} on the held-out record: {} before, {} after; its mean magnitude: {} before, {} after.",
            found.small_plant.quantity,
            size(&first.held_out, &found.small_plant.unit),
            size(&last.held_out, &found.small_plant.unit),
            number(first.held_out.mean),
            number(last.held_out.mean)
        ));
    }
    lines
}

/// An error in its unit and as a share.
#[must_use]
pub fn size(error: &ErrorSize, unit: &str) -> String {
    format!(
        "{} {unit} ({:.3} %)",
        number(error.rmse),
        100.0 * error.relative
    )
}

fn described(effect: &FoundEffect) -> String {
    let mut text = format!("{} ({})", readable(&effect.name), effect.description);
    for (key, value) in &effect.parameters {
        let _ = write!(text, "; {key} = {} {}", number(value.value), value.unit);
        if let Some([low, high]) = value.interval95 {
            let _ = write!(text, " [{} … {}]", number(low), number(high));
        }
    }
    text
}

/// The whole screen.
#[must_use]
pub fn screen(case: &str, found: &SmallFinding) -> String {
    let finding = &found.finding;
    let mut text = format!(
        "{case} ({}): {}\n\n",
        found.small_plant.kind,
        finding.verdict.word()
    );
    for line in answer(found) {
        let _ = writeln!(text, "  {line}");
    }
    let places: Vec<String> = finding
        .structure
        .iter()
        .filter(|place| place.significant)
        .take(4)
        .map(|place| readable(&place.coordinate))
        .collect();
    if !places.is_empty() {
        let _ = writeln!(text, "\n  where they disagree  {}", places.join(", "));
    }
    text.push_str(&candidates(&finding.ranking));
    if !found.small_plant.gains.is_empty() {
        text.push_str("\n  gain over the same set without\n");
    }
    for named in &found.small_plant.gains {
        text.push_str(&gain_line(named));
    }
    let steps = &found.small_plant.steps;
    if !steps.is_empty() {
        let unit = &found.small_plant.unit;
        let _ = writeln!(
            text,
            "\n  {:28}{:>26}{:>26}",
            "model", "learned from", "held out"
        );
        for step in steps {
            let name = step
                .effect
                .as_ref()
                .map_or("the analyst's, refitted".to_owned(), |effect| {
                    format!("+ {effect}")
                });
            let _ = writeln!(
                text,
                "  {name:28}{:>26}{:>26}",
                size(&step.learned, unit),
                size(&step.held_out, unit)
            );
        }
    }
    if !finding.parameters.is_empty() {
        let _ = writeln!(
            text,
            "\n  {:28}{:>12}   95 % interval",
            "numbers of the model", "refitted"
        );
    }
    for (name, own) in &finding.parameters {
        let interval = own.interval95.map_or("–".to_owned(), |[low, high]| {
            format!("{} … {} {}", number(low), number(high), own.unit)
        });
        let _ = writeln!(text, "  {name:28}{:>12}   {interval}", number(own.value));
    }
    for note in &finding.notes {
        let _ = writeln!(text, "\n  note: {note}");
    }
    text
}
