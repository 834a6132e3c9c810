//! The amended model of a small plant, and the finding that says what was added.

use std::collections::BTreeMap;

use super::case::SmallCase;
use super::finding::{Course, SmallFinding};
use super::model_file::{SmallModel, dotted};
use super::showing::{balance, final_intervals, polished};
use super::timing::{taking_effect, within_a_sample};
use crate::diagnose::console::{number, readable};
use crate::diagnose::finding::{
    Disagreement, Finding, FoundEffect, ParameterValue, Ranked, VerdictName,
};
use crate::diagnose::naming::joined;
use inference::body::balance::Balance;
use inference::body::evidence::Errors;
use inference::body::least_squares::Fit;
use inference::body::model::Model;
use inference::body::naming::{Candidate, Naming};
use inference::body::structure::{Left, structures};
use inference::policy::{NAMED, SURELY};
use inference::sets::{EffectSet as _, Verdict, is_told};
use stickslip::body::{Dimension, Kind};
use stickslip::parameter::Provenance;

/// Share of what is left that a free function of one coordinate or two may explain before something counts as missing still: most of it.
pub(super) const STRUCTURED: f64 = 0.5;

/// The finding of what naming came to.
#[must_use]
pub fn named(case: &SmallCase, naming: &Naming) -> SmallFinding {
    let best = naming.best();
    let mut found = described(case, &naming.base.fit, &best.fit);
    for effect in &mut found.finding.effects {
        effect.probability = naming.probability_of(&effect.name);
    }
    let of_effects: Vec<f64> = best
        .names
        .iter()
        .map(|name| naming.probability_of(name))
        .collect();
    // Something from outside, such as another joint, is a function of no coordinate of this one.
    let nothing_helps = best.names.is_empty() && found.lasts().is_some();
    let is_explained = found.finding.verdict != VerdictName::NotInCatalogue && !nothing_helps;
    let have_moved = numbers_moved(case, &found.finding.parameters);
    let verdict = Verdict::of(is_explained, &of_effects, have_moved);
    found.finding.verdict = verdict.into();
    let weighed = || naming.sets.iter().zip(&naming.probabilities);
    if verdict == Verdict::Ambiguous {
        found.finding.alternatives = weighed()
            .filter(|(set, probability)| is_told(&set.names, **probability, &best.names))
            .map(|(set, _)| joined(&set.names))
            .collect();
    }
    let likeliest = weighed().max_by(|a, b| a.1.total_cmp(b.1));
    if let Some((set, probability)) = likeliest
        && set.size() > best.size()
    {
        found.finding.notes.push(format!(
            "{} would be likelier, with a probability of {}; a set of more numbers is named if it is surer than {NAMED}",
            readable(&joined(&set.names)),
            number(*probability)
        ));
    }
    let notes = &mut found.finding.notes;
    notes.extend(within_a_sample(case, &found.finding.effects));
    notes.extend(taking_effect(case.driven_later));
    found.finding.ranking = weighed()
        .map(|(set, probability)| Ranked {
            score: set.is_answer().then(|| set.odds_over(best)),
            probability: Some(*probability),
            ..ranked(joined(&set.names), set, &naming.base)
        })
        .collect();
    found.small_plant.gains = best
        .names
        .iter()
        .filter_map(|name| Some(ranked((*name).to_owned(), best, naming.best_without(name)?)))
        .collect();
    found
}

/// What a set gains over another.
fn ranked(name: String, set: &Candidate, other: &Candidate) -> Ranked {
    let gain = set.errors.gain_over(&other.errors);
    Ranked {
        name,
        gain: gain.value,
        interval95: gain.interval95(),
        ..Ranked::default()
    }
}

/// The finding of a base and a model with effects that a person named, both fitted to the balance: where structure is left, and whether
/// a free function explains more.
#[must_use]
pub fn described(case: &SmallCase, base: &Fit, last: &Fit) -> SmallFinding {
    let balance = balance(case);
    let ports = case.model.port_names();
    let left = |of: &Fit| structures(&balance, &of.model, &case.scales, ports.len());
    let (before, after) = (left(base), left(last));
    let share_left = after
        .iter()
        .filter(|left| left.gain.is_sure())
        .map(|left| left.share)
        .fold(0.0, f64::max);
    let explained = Errors::left_out(&balance, last, &case.scales);
    // Refitted without each part, the analyst's numbers would lose what the function keeps.
    let is_same_model = last.model.terms().len() == base.model.terms().len();
    // A joint's effects were fitted to runs, and a function of forces says nothing against them.
    let is_outdone = case.kind() != Kind::Joint
        && before.iter().filter(|free| !free.is_of_two).any(|free| {
            if is_same_model {
                return free.gain.is_sure();
            }
            let there = explained.part(&balance.pieces_at(free.port));
            free.errors.gain_over(&there).is_sure()
        });
    let (effects, parameters) = numbers(case, &polished(case, last));
    let verdict = match is_outdone || share_left > STRUCTURED {
        true => VerdictName::NotInCatalogue,
        false => VerdictName::Named,
    };
    SmallFinding {
        finding: Finding {
            verdict,
            effects,
            alternatives: Vec::new(),
            experiment: None,
            ranking: Vec::new(),
            check: None,
            structure: before.iter().map(|left| disagreement(case, left)).collect(),
            structure_left: after.iter().map(|left| disagreement(case, left)).collect(),
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
            driven_later: case.driven_later,
            share_left,
            lasting: lasting(&balance, &last.model),
            gains: Vec::new(),
            steps: Vec::new(),
        },
    }
}

/// What a model leaves of the measured force and is no noise, over that force: root mean squares.
fn lasting(balance: &Balance, model: &Model) -> Option<f64> {
    if !matches!(model.kind, Kind::Drive | Kind::Contact | Kind::Balance) {
        return None;
    }
    let (mut left, mut whole) = (0.0, 0.0);
    for own in balance.compared(model) {
        left += (own.measured - own.model).powi(2);
        whole += own.measured * own.measured;
    }
    Some((balance.lasting(model) * left / whole).sqrt())
}

/// Structure as a finding has it, at the equation or the port where it is.
fn disagreement(case: &SmallCase, left: &Left) -> Disagreement {
    let equation = match case.kind() {
        Kind::Drive => "drive",
        Kind::Pendulum => "swing",
        Kind::Contact => "contact",
        Kind::Balance => "balance",
        Kind::Fmu => "port",
        Kind::Joint => "joint",
    };
    let ports = case.model.port_names();
    let gain = left.gain;
    Disagreement {
        coordinate: left.coordinate.clone(),
        equation: (*ports.get(left.port).unwrap_or(&equation)).to_owned(),
        band: None,
        gain: gain.value,
        interval95: Some(gain.interval95()),
        significance: Some(gain.value / gain.error).filter(|own| own.is_finite()),
        significant: gain.is_sure(),
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

fn numbers(case: &SmallCase, last: &Fit) -> Numbers {
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
            effects.push(FoundEffect {
                name: term.entry.name.to_owned(),
                description: term.entry.description.to_owned(),
                probability: 0.0,
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
                        (after - before).abs() > SURELY * share * before.abs()
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
            port.inertia = known.map(|known| known.inertia_at_once);
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
