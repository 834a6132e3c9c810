//! From a case to a finding: what the engine decides, in the terms of `finding.json`.

use stickslip::plant::Rig;

use super::amend::{found_effects, refitted};
use super::case::Case;
use super::data::Data;
use super::decide::{Diagnosis, Progress, Verdict, diagnose, fit_base};
use super::experiment::propose;
use super::finding::{Experiment, Finding, Ranked, VerdictName};
use super::fit::Fit;
use super::forced::Forced;
use super::hypothesis::Hypothesis;
use super::law_fits::refit_with;
use super::located::located;
use super::structure::structures;
use crate::files::record::Record;

/// File of the inputs of a proposed experiment, beside the finding.
pub const EXPERIMENT_FILE: &str = "experiment.csv";

/// Names what is missing; with a verdict that leaves several names, also the inputs of an experiment that tells them apart.
///
/// # Errors
/// The fitted model cannot be built.
pub fn name(
    case: &Case,
    progress: &mut dyn FnMut(&str),
) -> anyhow::Result<(Finding, Option<Record>)> {
    let found = diagnose(
        &case.training(),
        Hypothesis::base(&case.model),
        &case.without,
        &mut |what| progress(&describe(&what)),
    );
    let mut finding = finding(case, &found)?;
    if found.verdict != Verdict::Ambiguous {
        return Ok((finding, None));
    }
    progress("looking for an experiment that decides");
    let rivals: Vec<Fit> = found
        .alternatives
        .iter()
        .filter_map(|name| refit_with(&found.data, &found.base, name))
        .collect();
    let proposal = propose(&found.amended, &rivals, &case.sensors)?;
    let inputs = proposal.map(|proposal| {
        finding.experiment = Some(Experiment {
            file: EXPERIMENT_FILE.to_owned(),
            description: proposal.description.to_owned(),
            expected_power: proposal.power,
        });
        proposal.inputs
    });
    Ok((finding, inputs))
}

/// What the engine is doing, in words.
fn describe(progress: &Progress<'_>) -> String {
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
    let mut finding = from_fit(case, verdict, &effects, fit, &found.data)?;
    if verdict == VerdictName::Ambiguous {
        finding.alternatives = effects
            .iter()
            .take(1)
            .map(|(name, _)| name.clone())
            .chain(found.alternatives.iter().map(|name| (*name).to_owned()))
            .collect();
    }
    finding.ranking = found
        .ranking
        .iter()
        .map(|ranked| Ranked {
            name: ranked.name.to_owned(),
            gain: ranked.gain,
            interval95: ranked.interval95,
        })
        .collect();
    finding.structure = located(&found.structure);
    finding.structure_left = located(&found.structure_left);
    if verdict != VerdictName::NotInCatalogue {
        // Whatever is left, a right model leaves as much.
        let left = &mut finding.structure_left;
        left.iter_mut().for_each(|place| place.significant = false);
        if effects.is_empty() {
            finding.structure = finding.structure_left.clone();
        }
    }
    Ok(finding)
}

/// Where the model and the records disagree, with the nominal parameters refitted.
///
/// # Errors
/// The fitted model cannot be built.
pub fn located_finding(case: &Case, progress: &mut dyn FnMut(&str)) -> anyhow::Result<Finding> {
    let data = case.training();
    progress("nominal parameters");
    let base = fit_base(&data, Hypothesis::base(&case.model));
    progress("where they disagree");
    let structure = located(&structures(&data, &base));
    let verdict = if structure.iter().any(|place| place.significant) {
        VerdictName::NotInCatalogue
    } else {
        VerdictName::Parameters
    };
    let mut finding = from_fit(case, verdict, &[], &base, &data)?;
    finding.structure = structure;
    Ok(finding)
}

/// A finding with effects that a person named; ranking and places come from the finding there was.
///
/// # Errors
/// The fitted model cannot be built.
pub fn forced_finding(
    case: &Case,
    names: &[String],
    forced: &Forced,
    earlier: Option<Finding>,
) -> anyhow::Result<Finding> {
    let effects: Vec<(String, f64)> = names
        .iter()
        .map(|name| {
            let known = earlier
                .iter()
                .flat_map(|finding| &finding.effects)
                .find(|effect| effect.name == *name);
            (name.clone(), known.map_or(0.0, |effect| effect.probability))
        })
        .collect();
    let mut finding = from_fit(
        case,
        VerdictName::Named,
        &effects,
        &forced.fit,
        &forced.data,
    )?;
    finding.notes.push(format!(
        "the effects were given by --effect: {}",
        names.join(", ")
    ));
    if let Some(earlier) = earlier {
        finding.ranking = earlier.ranking;
        finding.structure = earlier.structure;
    }
    Ok(finding)
}

fn from_fit(
    case: &Case,
    verdict: VerdictName,
    effects: &[(String, f64)],
    fit: &Fit,
    data: &Data,
) -> anyhow::Result<Finding> {
    let rig: Rig<f64> = fit.hypothesis.rig_at()?;
    let estimates = fit.estimates(data);
    Ok(Finding {
        verdict,
        effects: found_effects(&rig, effects, &estimates),
        alternatives: Vec::new(),
        experiment: None,
        ranking: Vec::new(),
        structure: Vec::new(),
        structure_left: Vec::new(),
        parameters: refitted(&rig, &estimates),
        gap: None,
        friction_fluctuation: fit.disturbance.relative,
        without: case.without.clone(),
        notes: case.notes.clone(),
        seconds: 0.0,
    })
}
