//! The amended model of a small plant, and the finding that says what was added.

use std::collections::BTreeMap;

use super::case::SmallCase;
use super::evidence::{gain, left_out_errors, unit};
use super::finding::{Course, SmallFinding};
use super::least_squares::Fit;
use super::model_file::{SmallModel, dotted};
use super::naming::{Kept, LEAST_GAIN, Naming};
use super::problem::Problem;
use super::showing::{balance, final_intervals, polished};
use super::structure::structures;
use crate::diagnose::finding::{Finding, FoundEffect, ParameterValue, Ranked, VerdictName};
use stickslip::body::{Dimension, Kind};
use stickslip::parameter::Provenance;

/// Share of what is left that a free function of one coordinate may explain before something counts as missing still: most of it.
const STRUCTURED: f64 = 0.5;
/// Standard deviations by which a number must have moved to count as wrong.
const MOVED: f64 = 2.0;

/// The finding of what naming came to.
#[must_use]
pub fn named(case: &SmallCase, naming: &Naming) -> SmallFinding {
    let mut found = described(case, &naming.base, &naming.amended, &naming.kept);
    found.finding.ranking = naming
        .ranking
        .iter()
        .map(|tried| Ranked {
            name: tried.entries.iter().map(|entry| entry.name).collect(),
            gain: tried.gain.value,
            interval95: tried.gain.interval95,
            ..Ranked::default()
        })
        .collect();
    found
}

/// The finding of a base and a model with effects that were kept, or that a person named (without gain and rivals), both fitted to the
/// balance.
#[must_use]
pub fn described(case: &SmallCase, base: &Fit, last: &Fit, kept: &[Kept]) -> SmallFinding {
    let balance = balance(case);
    let ports = case.model.port_names();
    let before = structures(&balance, &base.model, &case.scales, &ports);
    let after = structures(&balance, &last.model, &case.scales, &ports);
    let share_left = after
        .iter()
        .filter(|left| left.located.significant)
        .map(|left| left.share)
        .fold(0.0, f64::max);
    let explained = left_out_errors(&balance, last, &case.scales);
    let unit = unit(&balance.residuals(&last.model));
    let is_outdone = before.iter().any(|free| {
        let there = balance.pieces_at(free.port).into_iter().chain([true]);
        let explained: Vec<f64> = explained
            .iter()
            .zip(there)
            .filter_map(|(error, own)| own.then_some(*error))
            .collect();
        let more = gain(&explained, &free.errors, unit, before.len());
        more.value > LEAST_GAIN && more.sure > 0.0
    });
    let (effects, parameters) = numbers(case, &polished(case, last), kept);
    let alternatives: Vec<String> = kept
        .iter()
        .filter(|kept| !kept.rivals.is_empty())
        .flat_map(|kept| std::iter::once(kept.entry.name).chain(kept.rivals.iter().copied()))
        .map(str::to_owned)
        .collect();
    let verdict = if is_outdone || share_left > STRUCTURED {
        VerdictName::NotInCatalogue
    } else if !alternatives.is_empty() {
        VerdictName::Ambiguous
    } else if !kept.is_empty() {
        VerdictName::Named
    } else if numbers_moved(case, &parameters) {
        VerdictName::Parameters
    } else {
        VerdictName::NothingMissing
    };
    SmallFinding {
        finding: Finding {
            verdict,
            effects,
            alternatives,
            experiment: None,
            ranking: Vec::new(),
            check: None,
            structure: before.into_iter().map(|left| left.located).collect(),
            structure_left: after.into_iter().map(|left| left.located).collect(),
            learned: None,
            parameters,
            gap: None,
            friction_fluctuation: 0.0,
            without: case.without.clone(),
            notes: case.notes.clone(),
            seconds: 0.0,
        },
        small_plant: Course {
            kind: case.kind().word().to_owned(),
            quantity: quantity(case.kind()).to_owned(),
            unit: match case.kind() {
                kind if kind.runs_alone() => "rad",
                kind => Dimension::Force.unit(kind, case.model.model.path),
            }
            .to_owned(),
            share_left,
            gains: kept
                .iter()
                .map(|kept| Ranked {
                    name: kept.entry.name.to_owned(),
                    gain: kept.gain.value,
                    interval95: kept.gain.interval95,
                    ..Ranked::default()
                })
                .collect(),
            steps: Vec::new(),
        },
    }
}

fn quantity(kind: Kind) -> &'static str {
    match kind {
        Kind::Drive => "force that the measured motion needs",
        Kind::Pendulum => "angle in a free run",
        Kind::Joint => "angle in a run under the measured voltage",
        Kind::Contact => "force that the contact opposes to the measured motion",
        Kind::Balance => "force that prediction and effects give",
        Kind::Fmu => "force that the FMU lacks to move as measured",
    }
}

type Numbers = (Vec<FoundEffect>, BTreeMap<String, ParameterValue>);

fn numbers(case: &SmallCase, last: &Fit, kept: &[Kept]) -> Numbers {
    let intervals = final_intervals(case, last);
    let (kind, path) = (case.kind(), case.model.model.path);
    let mut effects = Vec::new();
    let mut nominal = BTreeMap::new();
    for (at, term) in last.model.terms().iter().enumerate() {
        let values = term
            .entry
            .parameters
            .iter()
            .zip(&term.values)
            .enumerate()
            .map(|(j, (parameter, value))| {
                let mut intervals = intervals.iter();
                let interval = intervals.find(|own| (own.term, own.number) == (at, j));
                let number = ParameterValue {
                    value: *value,
                    interval95: interval.map(|own| own.ends),
                    unit: parameter.dimension.unit(kind, path).to_owned(),
                    model_parameter: dotted(term.entry, parameter.key),
                };
                (parameter.key.to_owned(), number)
            });
        if case.model.model.has(term.entry.name) {
            nominal.extend(values.map(|(_, number)| (number.model_parameter.clone(), number)));
        } else {
            let rivals = kept.iter().find(|kept| kept.entry.name == term.entry.name);
            effects.push(FoundEffect {
                name: term.entry.name.to_owned(),
                description: term.entry.description.to_owned(),
                probability: rivals.map_or(0.0, |kept| 1.0 / (1.0 + kept.rivals.len() as f64)),
                parameters: values.collect(),
            });
        }
    }
    (effects, nominal)
}

/// Whether any number of stated uncertainty has moved by more than that allows.
fn numbers_moved(case: &SmallCase, refitted: &BTreeMap<String, ParameterValue>) -> bool {
    case.model.model.terms().iter().any(|term| {
        term.entry
            .parameters
            .iter()
            .zip(&term.values)
            .any(|(parameter, &before)| {
                let name = dotted(term.entry, parameter.key);
                let stated = case
                    .model
                    .origins
                    .get(&name)
                    .and_then(|origin| origin.relative_uncertainty);
                let after = refitted.get(&name).map(|number| number.value);
                match (stated, after) {
                    (Some(share), Some(after)) => {
                        (after - before).abs() > MOVED * share * before.abs()
                    }
                    _ => false,
                }
            })
    })
}

/// Text of the amended model that a finding describes.
///
/// # Errors
/// Where the finding names what the catalogue does not have, or lacks a number.
pub fn amended_text(case: &SmallCase, found: &SmallFinding) -> Result<String, String> {
    let mut amended: SmallModel = case.model.clone();
    let source = format!(
        "fitted by stickslip diagnose to {}",
        case.records
            .iter()
            .map(|record| record.name.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    );
    for effect in &found.finding.effects {
        let entry = case.effect(&effect.name)?;
        let values: Result<Vec<f64>, String> = entry
            .parameters
            .iter()
            .map(|parameter| {
                let number = effect.parameters.get(parameter.key);
                number.map(|number| number.value).ok_or_else(|| {
                    format!(
                        "finding.json: effect {} lacks {}",
                        effect.name, parameter.key
                    )
                })
            })
            .collect();
        amended.model = amended.model.with(entry, values?);
    }
    if let (Some(ports), Some(chased)) = (&mut amended.ports, &case.chased) {
        for (at, port) in ports.ports.iter_mut().enumerate() {
            let mut there = case.records.iter().filter(|own| own.port == at);
            let known = there.find_map(|own| own.pursuit.as_ref());
            port.inertia = known.map(|known| known.sense * known.inertia);
            // A step that a person chose stays.
            port.coupling_step.get_or_insert(chased.step());
        }
    }
    let terms = amended.model.terms().to_vec();
    for (at, term) in terms.iter().enumerate() {
        for (j, parameter) in term.entry.parameters.iter().enumerate() {
            let name = dotted(term.entry, parameter.key);
            let own = found
                .finding
                .effects
                .iter()
                .flat_map(|effect| effect.parameters.values());
            let number = own
                .chain(found.finding.parameters.values())
                .find(|number| number.model_parameter == name);
            if let Some(number) = number {
                amended.model.set(at, j, number.value);
                amended.origins.insert(
                    name,
                    Provenance {
                        source: Some(source.clone()),
                        status: Some("fitted".to_owned()),
                        relative_uncertainty: None,
                        interval95: number.interval95,
                    },
                );
            }
        }
    }
    let names: Vec<&str> = found
        .finding
        .effects
        .iter()
        .map(|effect| effect.name.as_str())
        .collect();
    let added = if names.is_empty() {
        "nothing".to_owned()
    } else {
        names.join(", ")
    };
    Ok(amended.to_toml(&format!(
        "Written by stickslip diagnose: the model of {} with {added} added and its numbers refitted.",
        case.name
    )))
}
