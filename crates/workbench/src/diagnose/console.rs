//! The answer on one screen.

use std::fmt::Write as _;

use super::finding::{Finding, FoundEffect, NO_EFFECT, Ranked, VerdictName};
use super::gap::Measures;
use inference::policy::{NAMED, RIVAL};

/// Candidates that a screen shows.
const CANDIDATES: usize = 5;

/// The answer in sentences, most important first.
#[must_use]
pub fn answer(finding: &Finding) -> Vec<String> {
    let mut lines = Vec::new();
    match finding.verdict {
        VerdictName::NothingMissing => {
            lines.push(
                "Nothing is missing: the model explains the records within their noise.".to_owned(),
            );
        }
        VerdictName::Parameters => {
            lines.push(
                "No effect is missing: other nominal parameters explain the records.".to_owned(),
            );
        }
        VerdictName::Named => {
            for effect in &finding.effects {
                lines.push(format!("Missing: {}.", described(effect)));
            }
            lines.extend(nearest_rival(finding));
        }
        VerdictName::Ambiguous => {
            lines.push(undecided(finding));
            for effect in &finding.effects {
                lines.push(format!("Added to the model: {}.", described(effect)));
            }
            if let Some(experiment) = &finding.experiment {
                lines.push(format!(
                    "{} would decide it with a probability of {}: {}",
                    experiment.file,
                    percent(experiment.expected_power),
                    experiment.description
                ));
            }
        }
        VerdictName::Located => lines.push(located(finding)),
        VerdictName::NotInCatalogue => {
            lines.push("Something is missing that no effect of the catalogue explains.".to_owned());
            for effect in &finding.effects {
                lines.push(format!("Added on the way: {}.", described(effect)));
            }
            if let Some(learned) = &finding.learned {
                lines.push(format!(
                    "A function of {} at {} was learned for it and is in the amended model. A function is no cause.",
                    learned.coordinate, learned.port
                ));
            } else if finding.effects.is_empty() && finding.gap.is_some() {
                lines.push("The amended model has other nominal parameters only.".to_owned());
            }
            if let Some(place) = finding.structure.iter().find(|place| place.significant)
                && finding.learned.is_none()
            {
                lines.push(format!(
                    "What is left is structured over the {} ({} equation).",
                    readable(&place.coordinate),
                    place.equation
                ));
            }
        }
    }
    if let Some(gap) = &finding.gap {
        let errors = gap.through_fmu.fmi3;
        let noise = if finding.friction_fluctuation > 0.0 {
            format!(
                "noise and a fluctuation of the friction by {}",
                percent(finding.friction_fluctuation)
            )
        } else {
            "noise alone".to_owned()
        };
        lines.push(match errors.closed {
            Some(closed) => format!(
                "On the held-out record, through the FMU, {} of the gap is closed: window error {} before, {} after, {} from {noise}.",
                percent(closed),
                number(errors.before),
                number(errors.after),
                number(errors.noise_floor)
            ),
            None => format!(
                "On the held-out record there is no gap to close: window error {}, and {} from {noise}.",
                number(errors.before),
                number(errors.noise_floor)
            ),
        });
        if finding.verdict != VerdictName::NotInCatalogue && !finding.is_settled() {
            lines.push(
                "That leaves more of the held-out record than noise does: it may show what the others do not."
                    .to_owned(),
            );
        }
    }
    lines
}

/// Where model and records disagree, without a verdict.
fn located(finding: &Finding) -> String {
    match finding.structure.iter().find(|place| place.significant) {
        Some(place) => format!(
            "Model and records disagree most over the {} ({} equation). What is missing was not asked: `stickslip name` does.",
            readable(&place.coordinate),
            place.equation
        ),
        None => "With other nominal parameters model and records agree over every coordinate that was looked at. What is missing was not asked: `stickslip name` does.".to_owned(),
    }
}

/// By how much the best set of effects is ahead of the next one; nothing for a finding without sets.
fn nearest_rival(finding: &Finding) -> Option<String> {
    let best = finding.ranking.first()?;
    // A set that has all of the best one and more does not say otherwise.
    let says_otherwise = |rival: &&Ranked| {
        let own: Vec<&str> = rival.name.split(" + ").collect();
        best.name.split(" + ").any(|name| !own.contains(&name))
    };
    let rival = finding
        .ranking
        .iter()
        .filter(|rival| rival.score.is_some())
        .find(says_otherwise)?;
    let (margin, error) = (rival.margin?, rival.margin_error?);
    let whom = if rival.name == NO_EFFECT {
        "the model as it is".to_owned()
    } else {
        readable(&rival.name)
    };
    Some(format!(
        "{} rather than {whom} by {} ± {} in ln likelihood on windows left out.",
        capital(&readable(&best.name)),
        number(margin),
        number(error)
    ))
}

/// An effect's name, what it is, and how probable it is.
fn described(effect: &FoundEffect) -> String {
    let mut text = format!("{} ({})", readable(&effect.name), effect.description);
    // An effect that a person named has no probability.
    if effect.probability > 0.0 {
        let _ = write!(text, ", probability {:.3}", effect.probability);
    }
    text
}

/// What may be missing, where no answer is sure.
pub fn undecided(finding: &Finding) -> String {
    let names: Vec<String> = finding
        .alternatives
        .iter()
        .map(|name| readable(name))
        .collect();
    match &names[..] {
        [] => format!(
            "Something is missing, and no set of effects that may be it has a probability of {}.",
            percent(RIVAL)
        ),
        [only] => format!(
            "Probably missing: {only}. It is less sure than {}, from which on a name is given, and every rival has less than {}.",
            percent(NAMED),
            percent(RIVAL)
        ),
        _ => format!(
            "Missing is one of: {}. These records cannot tell which.",
            names.join(", ")
        ),
    }
}

/// The effects' numbers, a line for each.
fn numbers(finding: &Finding) -> String {
    let mut text = String::new();
    let all = finding.effects.iter();
    for value in all.flat_map(|effect| effect.parameters.values()) {
        let interval = value.interval95.map_or("held".to_owned(), |[low, high]| {
            format!("{} … {}", number(low), number(high))
        });
        let _ = writeln!(
            text,
            "    {:28}{:>10} {:8} {interval}",
            value.model_parameter,
            number(value.value),
            shown_unit(&value.unit)
        );
    }
    text
}

/// A unit for reading: nothing where there is none, products with a space.
#[must_use]
pub fn shown_unit(unit: &str) -> String {
    if unit == "1" {
        String::new()
    } else {
        unit.replace('.', " ")
    }
}

/// The whole screen.
#[must_use]
pub fn screen(case: &str, finding: &Finding) -> String {
    let mut text = format!("{case}\n\n");
    for line in answer(finding) {
        let _ = writeln!(text, "  {line}");
    }
    let numbers = numbers(finding);
    if !numbers.is_empty() {
        let _ = write!(
            text,
            "\n  {:24}{:>10} {:8} 95 % interval\n{numbers}",
            "what was added", "", "unit"
        );
    }
    let places: Vec<String> = finding
        .structure
        .iter()
        .filter(|place| place.significant)
        .take(4)
        .map(|place| format!("{} ({})", readable(&place.coordinate), place.equation))
        .collect();
    if !places.is_empty() {
        let _ = writeln!(text, "\n  where they disagree  {}", places.join(", "));
    }
    text.push_str(&candidates(&finding.ranking));
    if let Some(gap) = &finding.gap {
        let line = |label: &str, m: &Measures| {
            let cell = |value: Option<f64>| value.map_or("–".to_owned(), number);
            format!(
                "  {label:24}{:>10} {:>10} {:>10} {:>10}\n",
                cell(m.rmse),
                cell(m.nrmse),
                cell(m.pc),
                cell(m.apl)
            )
        };
        let _ = write!(
            text,
            "\n  {:24}{:>10} {:>10} {:>10} {:>10}\n{}{}",
            "free run, held-out",
            "RMSE rad/s",
            "/ω_ref",
            "PC",
            "APL",
            line("before", &gap.free_run.before),
            line("after", &gap.free_run.after)
        );
    }
    for note in &finding.notes {
        let _ = writeln!(text, "\n  note: {note}");
    }
    text
}

/// The first of the candidates with their gains; nothing where there are none.
#[must_use]
pub fn candidates(ranking: &[Ranked]) -> String {
    if ranking.is_empty() {
        return String::new();
    }
    let mut text = format!("\n  {:26}{:>10}   95 % interval\n", "candidates", "gain");
    for ranked in ranking.iter().take(CANDIDATES) {
        text.push_str(&gain_line(ranked));
    }
    text
}

/// A name with its gain and interval.
#[must_use]
pub fn gain_line(ranked: &Ranked) -> String {
    let [low, high] = ranked.interval95;
    format!(
        "  {:26}{:>10}   {} … {}\n",
        ranked.name,
        number(ranked.gain),
        number(low),
        number(high)
    )
}

/// A text that begins with a capital letter.
#[must_use]
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// An effect's or coordinate's name in words.
#[must_use]
pub fn readable(name: &str) -> String {
    name.replace('_', " ")
}

/// A number with four digits that matter.
#[must_use]
pub fn number(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        "–".to_owned()
    } else if size != 0.0 && !(1e-3..1e5).contains(&size) {
        format!("{value:.3e}")
    } else {
        let before_point = if size < 1.0 { 0 } else { size.log10() as usize };
        let digits = if size < 0.1 {
            5
        } else {
            3_usize.saturating_sub(before_point)
        };
        format!("{value:.digits$}")
    }
}

/// A share as per cent with one decimal.
#[must_use]
pub fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::finding::tests::finding;

    #[test]
    fn a_held_out_record_that_stays_unexplained_is_said_to_be() {
        let warning = |closed| {
            let mut finding = finding();
            if let Some(gap) = &mut finding.gap {
                gap.through_fmu.fmi3.closed = Some(closed);
            }
            answer(&finding)
                .concat()
                .contains("held-out record than noise")
        };
        assert!(warning(-0.17) && !warning(0.99));
    }

    #[test]
    fn the_nearest_rival_is_told_with_its_margin() {
        let mut finding = finding();
        let ranked = |name: &str, score, margin| Ranked {
            name: name.into(),
            score,
            margin: Some(margin),
            margin_error: Some(4.5),
            ..Ranked::default()
        };
        finding.ranking = vec![
            ranked("unbalance", Some(0.0), 0.0),
            ranked("unbalance + motor_viscous", Some(-3.0), 0.1),
            ranked("stiction", None, 3.0),
            ranked("normal_force_wobble", Some(-40.0), 38.0),
        ];
        let text = answer(&finding).concat();
        let words = "Unbalance rather than normal force wobble by 38.00 ± 4.500";
        assert!(text.contains(words), "{text}");
        finding.verdict = VerdictName::Located;
        assert!(!answer(&finding).concat().contains("Missing:"));
    }

    #[test]
    fn numbers_keep_the_digits_that_matter() {
        for (value, text) in [
            (0.0, "0.00000"),
            (1234.56, "1235"),
            (12.345, "12.35"),
            (0.5, "0.500"),
            (0.04, "0.04000"),
            (-3.2, "-3.200"),
            (1e-6, "1.000e-6"),
        ] {
            assert_eq!(number(value), text);
        }
        assert_eq!(percent(0.9876), "98.8 %");
    }
}
