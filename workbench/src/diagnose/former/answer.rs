//! What the engine of the dissertation's rig answers, in the terms of `finding.json`.

use std::sync::Arc;

use inference::hypothesis::Estimate;
use inference::record::{Instruments, channel};
use inference::search::fit_effects;
use stickslip::plant::RigKind;

use super::data::Data;
use super::decide::{Diagnosis, Progress, Verdict, diagnose};
use super::hypothesis::Hypothesis;
use super::left::STRUCTURE_GAIN;
use super::run::Run;
use super::structure::{Coordinate, Structure};
use super::window::{Begin, Cut};
use crate::diagnose::amend::{FittedRig, found_effects, refitted};
use crate::diagnose::case::Case;
use crate::diagnose::experiment::propose;
use crate::diagnose::finding::{Experiment, Finding, Located, Ranked, VerdictName};
use crate::diagnose::naming::EXPERIMENT_FILE;
use crate::diagnose::sensors::Sensors;
use crate::files::record::Record;

/// Disc inertia [kg m2], shaft stiffness [N m/rad], gear ratio and pin radius [m] of the dissertation's rig.
const RIG: [(&str, f64); 4] = [
    ("disc.inertia", 0.0149),
    ("shaft.stiffness", 0.3482),
    ("gearbox.ratio", 8.0),
    ("contact.radius", 0.075),
];
/// Factor by which a number of the rig may be off and the rig be the dissertation's.
const SAME_RIG: f64 = 1.2;
/// The same for its instruments.
const SAME_INSTRUMENTS: f64 = 1.6;
/// Factor within which an estimate of the rig's own instruments scatters.
const ESTIMATED: f64 = 1.1;
/// Standard deviations between the ends of a 95 % interval.
const INTERVAL_WIDTH: f64 = 2.0 * 1.96;
/// Width of a band of frequencies [Hz]: eight of them, 0.05 Hz apart.
const BAND: f64 = 0.35;

/// Whether a case is of the dissertation's rig with its instruments, all of which were read.
#[must_use]
pub fn is_asked(case: &Case) -> bool {
    let near =
        |value: f64, usual: f64, factor: f64| (usual / factor..=usual * factor).contains(&value);
    let rig = RIG.iter().all(|(name, usual)| {
        let value = case.model.rig.parameter(name);
        value.is_some_and(|value| near(value, *usual, SAME_RIG))
    });
    let usual = Sensors::dissertation()
        .completed(&Instruments::default())
        .deviations();
    let own = case.instruments.deviations();
    let instruments = (0..channel::CURRENT).all(|c| near(own[c], usual[c], SAME_INSTRUMENTS));
    let read = case.records.iter().all(|record| {
        record.readings[..channel::CURRENT]
            .iter()
            .all(|readings| !readings.is_empty())
    });
    // It knows no effects but its own.
    let own = case.catalogue.supposed.is_empty();
    own && rig && instruments && read && case.model.rig.kind() == RigKind::Reduced
}

/// Names what is missing, with the inputs of an experiment where several effects are left.
///
/// # Errors
/// The fitted model cannot be built.
pub fn name(
    case: &Case,
    progress: &mut dyn FnMut(&str),
) -> anyhow::Result<(Finding, Option<Record>)> {
    // What the records tell of the rig's own instruments scatters; what is known of them does not.
    let usual = Sensors::dissertation().completed(&case.instruments);
    let is_usual = (0..channel::CURRENT).all(|c| {
        let share = case.instruments.deviations()[c] / usual.deviations()[c];
        (1.0 / ESTIMATED..=ESTIMATED).contains(&share)
    });
    let instruments = if is_usual { usual } else { case.instruments };
    let [theta, omega, theta3, omega3, ..] = instruments.deviations();
    let runs: Vec<Run> = case
        .records
        .iter()
        .map(|record| Run::of(record, &instruments.step))
        .collect();
    let cut = Cut::of(&case.model.rig, Begin::Clear);
    let data = Data::new(Arc::new(runs), cut, [theta, omega, theta3, omega3]);
    let found = diagnose(
        &data,
        Hypothesis::base(&case.model),
        &case.catalogue.without,
        &mut |what| progress(&described(&what)),
    );
    let mut finding = finding(case, &found)?;
    if found.verdict != Verdict::Ambiguous {
        return Ok((finding, None));
    }
    progress("looking for an experiment that decides");
    let problem = case.problem()?;
    let mut fits = finding
        .alternatives
        .iter()
        .filter_map(|name| fit_effects(&problem, &[name.as_str()], &mut |_| {}))
        .map(|candidate| candidate.fit);
    let Some(best) = fits.next() else {
        return Ok((finding, None));
    };
    let rivals: Vec<_> = fits.collect();
    let proposal = propose(&problem, &best, &rivals)?;
    let inputs = proposal.map(|proposal| {
        finding.experiment = Some(Experiment {
            file: EXPERIMENT_FILE.to_owned(),
            description: proposal.description,
            expected_power: proposal.power,
        });
        proposal.inputs
    });
    Ok((finding, inputs))
}

/// What the engine is doing, in words.
fn described(progress: &Progress<'_>) -> String {
    match progress {
        Progress::Base => "fitting the nominal parameters".to_owned(),
        Progress::Trying { name, round: 0 } => format!("trying {name}"),
        Progress::Trying { name, round } => format!("trying {name} as effect {}", round + 1),
        Progress::Locating => "looking for structure".to_owned(),
        Progress::Breakaways => {
            "the disc breaks away above what it slides at; once more".to_owned()
        }
        Progress::EveryStart(name) => {
            format!("that does not explain it; once more {name}, from every start")
        }
        Progress::Without(name) => format!("that does not explain it; once more without {name}"),
    }
}

fn finding(case: &Case, found: &Diagnosis) -> anyhow::Result<Finding> {
    let verdict = match found.verdict {
        Verdict::NothingMissing => VerdictName::NothingMissing,
        Verdict::Parameters => VerdictName::Parameters,
        Verdict::Named => VerdictName::Named,
        Verdict::Ambiguous => VerdictName::Ambiguous,
        Verdict::NotInCatalogue => VerdictName::NotInCatalogue,
    };
    // Effects that leave structure are not added: the model keeps its refitted parameters alone.
    let fit = if verdict == VerdictName::NotInCatalogue {
        &found.base
    } else {
        &found.amended
    };
    let effects: Vec<(String, f64)> = found
        .effects
        .iter()
        .map(|effect| (effect.name.to_owned(), effect.probability))
        .collect();
    let estimates = fit
        .estimates(&found.data)
        .into_iter()
        .map(|estimate| Estimate {
            name: estimate.name,
            value: estimate.value,
            deviation: estimate.deviation,
            is_nominal: estimate.is_nominal,
        })
        .collect();
    let fitted = FittedRig {
        rig: fit.hypothesis.rig_at()?,
        estimates,
    };
    let mut alternatives = Vec::new();
    if verdict == VerdictName::Ambiguous {
        alternatives.extend(effects.iter().take(1).map(|(name, _)| name.clone()));
        alternatives.extend(found.alternatives.iter().map(|name| (*name).to_owned()));
    }
    let ranking = found
        .ranking
        .iter()
        .map(|ranked| Ranked {
            name: ranked.name.to_owned(),
            gain: ranked.gain,
            interval95: ranked.interval95,
            score: None,
            probability: None,
            margin: None,
            margin_error: None,
        })
        .collect();
    let mut structure = located(&found.structure);
    let mut structure_left = located(&found.structure_left);
    if verdict != VerdictName::NotInCatalogue {
        // Whatever is left, a right model leaves as much.
        for place in &mut structure_left {
            place.significant = false;
        }
        if effects.is_empty() {
            structure.clone_from(&structure_left);
        }
    }
    Ok(Finding {
        verdict,
        effects: found_effects(&fitted, &effects),
        alternatives,
        experiment: None,
        ranking,
        structure,
        structure_left,
        check: None,
        learned: None,
        parameters: refitted(&fitted),
        gap: None,
        friction_fluctuation: fit.disturbance.relative,
        without: case.catalogue.without.clone(),
        notes: case.notes.clone(),
        seconds: 0.0,
    })
}

/// The places in their order; of the bands of frequency only the strongest.
fn located(structures: &[Structure]) -> Vec<Located> {
    let is_band = |structure: &&Structure| matches!(structure.coordinate, Coordinate::Frequency(_));
    let strongest_band = structures
        .iter()
        .filter(is_band)
        .max_by(|a, b| a.gain.total_cmp(&b.gain))
        .map(|structure| structure.coordinate);
    structures
        .iter()
        .filter(|structure| !is_band(structure) || Some(structure.coordinate) == strongest_band)
        .map(place)
        .collect()
}

fn place(structure: &Structure) -> Located {
    let [low, high] = structure.interval95;
    let deviation = (high - low) / INTERVAL_WIDTH;
    Located {
        coordinate: structure.coordinate.name().to_owned(),
        equation: structure.coordinate.equation().to_owned(),
        band: match structure.coordinate {
            Coordinate::Frequency(first) => Some([first, first + BAND]),
            _ => None,
        },
        gain: structure.gain,
        interval95: Some(structure.interval95),
        significance: Some(if deviation > 0.0 {
            structure.gain / deviation
        } else {
            0.0
        }),
        significant: structure.gain > STRUCTURE_GAIN && low > 0.0,
    }
}
