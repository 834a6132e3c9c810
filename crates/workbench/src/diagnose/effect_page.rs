//! `stickslip effects`: what the catalogue has, and a page on each effect.

use std::fmt::Write as _;
use std::path::PathBuf;

use build_fmu::documentation::equations;
use clap::Args;
use inference::problem::Catalogue;
use stickslip::friction::{CoulombStiction, Stribeck, TwoGaussianMu};
use stickslip::parameter::ParameterInfo;
use stickslip::plant::effect_infos;

use super::amend::law_of;
use super::case::check_effect;
use super::catalogue::{CATALOGUE, Entry};
use crate::files::atomic;
use crate::outcome::Outcome;
use inference::body::catalogue as small_plant;
use inference::body::term::Entry as Term;
use stickslip::body::Path;

/// Arguments of `effects`.
#[derive(Debug, Args)]
pub struct EffectsArguments {
    /// The effect whose page is printed; without it all are listed.
    #[arg(conflicts_with = "out")]
    name: Option<String>,
    /// Directory for a page on each.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Runs the subcommand.
///
/// # Errors
/// A page cannot be written, or no effect has the name.
pub fn command(arguments: &EffectsArguments) -> anyhow::Result<Outcome> {
    match (&arguments.name, &arguments.out) {
        (Some(name), _) => {
            let small = small_plant::entry(name);
            if small.is_none() {
                check_effect(name, &Catalogue::default())?;
            }
            for entry in CATALOGUE.iter().filter(|entry| entry.name == name) {
                print!("{}", page(entry));
            }
            if let Some(entry) = small {
                print!("{}", small_section(entry, 1));
            }
        }
        (None, None) => {
            for entry in CATALOGUE {
                println!("{:24} {}", entry.name, entry.description);
            }
            println!("\nOn small plants:");
            for entry in small_plant::CATALOGUE.iter() {
                println!("{:24} {}", entry.name, entry.description);
            }
        }
        (None, Some(directory)) => {
            for (file, text) in pages() {
                atomic::write_file(&directory.join(&file), text.as_bytes())?;
                println!("{}", directory.join(file).display());
            }
        }
    }
    Ok(Outcome::Done)
}

/// All pages as file name and text, with an index.
#[must_use]
pub fn pages() -> Vec<(String, String)> {
    let mut pages: Vec<(String, String)> = CATALOGUE
        .iter()
        .map(|entry| (format!("{}.md", entry.name), page(entry)))
        .collect();
    let mut index = String::from(
        "# Effects\n\nWhat `stickslip diagnose` can name. Written by `stickslip effects --out docs/effects`.\n\n| effect | what it is |\n|---|---|\n",
    );
    for entry in CATALOGUE {
        let _ = writeln!(
            index,
            "| [{0}]({0}.md) | {1} |",
            entry.name, entry.description
        );
    }
    index.push_str("\nEffects on [small plants](small-plants.md) have a page of their own.\n");
    pages.push(("README.md".to_owned(), index));
    let mut small = String::from(
        "# Effects on small plants\n\nWhat `stickslip diagnose` can name on a drive, a pendulum, a contact, a balance, a joint or an FMU. `x` \
         is the position, `v` the velocity, `a` the acceleration; `direction` in equations is the sign of the velocity, and `friction` \
         the friction of the other effects. Written by `stickslip effects --out docs/effects`.\n",
    );
    for entry in small_plant::CATALOGUE.iter() {
        let _ = write!(small, "\n{}", small_section(entry, 2));
    }
    pages.push(("small-plants.md".to_owned(), small));
    pages
}

fn page(entry: &Entry) -> String {
    let mut text = format!("# {}\n\n{}.\n", entry.name, capital(entry.description));
    let equations = if entry.is_law() {
        equations::law(law_of(entry.name))
    } else {
        equations::effect(entry.name)
    };
    if let Some(equations) = equations {
        text.push_str("\n## Equation\n\n```text\n");
        for equation in equations.equations {
            let _ = writeln!(text, "{equation}");
        }
        let _ = writeln!(text, "```\n\nSource: {}.", equations.source);
    }
    let section = if entry.is_law() {
        "contact"
    } else {
        entry.name
    };
    let _ = writeln!(
        text,
        "\n## Parameters\n\nIn `[{section}]` of the model file.\n"
    );
    text.push_str("| key | in findings | unit | allowed | what |\n|---|---|---|---|---|\n");
    for info in parameters(entry) {
        let dotted = format!("{section}.{}", info.key);
        let symbol = entry
            .symbols
            .iter()
            .find(|(name, _)| *name == dotted)
            .map_or(info.key, |(_, symbol)| symbol);
        let _ = writeln!(
            text,
            "| `{}` | `{symbol}` | {} | {} | {} |",
            info.key,
            info.unit,
            info.range,
            info.description.trim()
        );
    }
    let _ = writeln!(text, "\n## In the records\n\n{}.", capital(entry.signature));
    text.push_str("\n## What it can be confused with\n\n");
    if entry.confusable.is_empty() {
        text.push_str("Nothing in the catalogue.\n");
    }
    for name in entry.confusable {
        let _ = writeln!(text, "- [{name}]({name}.md)");
    }
    text
}

/// An effect on small plants, under a heading of this level.
fn small_section(entry: &Term, level: usize) -> String {
    let kinds: Vec<&str> = entry.kinds.iter().map(|kind| kind.word()).collect();
    let mut text = format!(
        "{} {}\n\n{}.\n\nOn: {}{}. In the records: {}.\n\n| key in `[{}]` | what |\n|---|---|\n",
        "#".repeat(level),
        entry.name,
        capital(entry.description),
        kinds.join(", "),
        if entry.path == Some(Path::Turn) {
            ", where it turns"
        } else {
            ""
        },
        entry.signature,
        entry.name
    );
    for parameter in entry.parameters {
        let _ = writeln!(text, "| `{}` | {} |", parameter.key, parameter.description);
    }
    if let Some(equation) = entry.equation() {
        let _ = writeln!(text, "\nForce against the motion: `{equation}`.");
    }
    if !entry.confusable.is_empty() {
        let _ = writeln!(
            text,
            "\nCan be confused with {}.",
            entry.confusable.join(", ")
        );
    }
    text
}

fn parameters(entry: &Entry) -> &'static [ParameterInfo] {
    if entry.is_law() {
        return match law_of(entry.name) {
            "coulomb_stiction" => CoulombStiction::<f64>::INFOS,
            "stribeck" => Stribeck::<f64>::INFOS,
            _ => TwoGaussianMu::<f64>::INFOS,
        };
    }
    effect_infos(entry.name).unwrap_or_default()
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_has_an_equation_and_parameters_and_known_rivals() {
        for entry in CATALOGUE {
            let text = page(entry);
            assert!(text.contains("## Equation"), "{}", entry.name);
            assert!(!parameters(entry).is_empty(), "{}", entry.name);
            for rival in entry.confusable {
                assert!(
                    CATALOGUE.iter().any(|other| other.name == *rival),
                    "{} names {rival}",
                    entry.name
                );
            }
        }
    }

    #[test]
    fn the_committed_pages_are_those_of_the_catalogue() {
        let directory = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/effects");
        for (file, text) in pages() {
            let committed = std::fs::read_to_string(directory.join(&file)).unwrap_or_default();
            assert!(
                committed == text,
                "docs/effects/{file} is out of date: run `stickslip effects --out docs/effects`"
            );
        }
    }
}
