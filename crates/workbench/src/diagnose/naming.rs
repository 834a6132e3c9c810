//! From a case to a finding: what the engine decides, in SI units and in the terms of `finding.json`.

use inference::diagnosis::{Diagnosis, Rival, Verdict, diagnose};
use inference::fit::Fit;
use inference::hypothesis::{Estimate, Free};
use inference::problem::Problem;
use inference::search::{Candidate, Objection, fit_effects};
use inference::sets::is_told;
use inference::structure::structures;

use super::amend::{AmendError, FittedRig, NOT_APPLICABLE, found_effects, refitted};
use super::case::Case;
use super::console::{number, readable};
use super::disagreements::disagreements;
use super::experiment::propose;
use super::finding::{CheckResult, Experiment, Finding, NO_EFFECT, Ranked, VerdictName};
use super::learning::explain_without_cause;
use crate::files::record::Record;

/// File of the inputs of a proposed experiment, beside the finding.
pub const EXPERIMENT_FILE: &str = "experiment.csv";
/// Standard errors from the middle to the end of a 95 % interval.
const TO_95_PERCENT: f64 = 1.96;
/// What is said of intervals that replicas could not widen.
const NOT_REPLAYED: &str = "the fitted model cannot run through the records as a whole: the intervals are those of the windows alone, and may be too narrow";

/// Names what is missing; with a verdict that leaves several names, also the inputs of an experiment that tells them apart.
///
/// # Errors
/// The fitted model cannot be built.
pub fn name(
    case: &Case,
    progress: &mut dyn FnMut(&str),
) -> anyhow::Result<(Finding, Option<Record>)> {
    let problem = case.problem()?;
    let found = diagnose(&problem, &mut |what| progress(&described(what)));
    let mut finding = finding(case, &problem, &found)?;
    if found.verdict == Verdict::NotInCatalogue {
        progress("looking at the held-out record");
        let learned = found.learned.as_ref();
        explain_without_cause(case, &problem, &found.base, learned, &mut finding)?;
    }
    if found.verdict != Verdict::Ambiguous {
        return Ok((finding, None));
    }
    progress("looking for an experiment that decides");
    let rivals: Vec<Fit> = told(&found)
        .skip(1)
        .filter_map(|rival| fit_effects(&problem, &rival.effects, &mut |_| {}))
        .map(|candidate| candidate.fit)
        .collect();
    let proposal = propose(&problem, &found.best, &rivals)?;
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

/// What the engine is doing, in words: most of it is trying effects.
fn described(what: &str) -> String {
    if what.starts_with("what ") {
        format!("looking at {what}")
    } else {
        format!("trying {}", readable(what))
    }
}

/// The sets that are worth telling, the best first.
fn told(found: &Diagnosis) -> impl Iterator<Item = &Rival> {
    let is_worth = |rival: &&Rival| is_told(&rival.effects, rival.probability, &found.effects);
    found.ranking.iter().filter(is_worth)
}

/// A set's effects as a ranking has them.
#[must_use]
pub fn joined(effects: &[&str]) -> String {
    if effects.is_empty() {
        NO_EFFECT.to_owned()
    } else {
        effects.join(" + ")
    }
}

fn finding(case: &Case, problem: &Problem, found: &Diagnosis) -> anyhow::Result<Finding> {
    let verdict = VerdictName::from(found.verdict);
    // Effects that do not explain the records are not added: the model keeps its refitted parameters alone.
    let effects: Vec<(String, f64)> = match verdict {
        VerdictName::Named | VerdictName::Ambiguous => found
            .effects
            .iter()
            .map(|name| ((*name).to_owned(), found.probability_of(name)))
            .collect(),
        _ => Vec::new(),
    };
    let (fit, estimates) = (found.amended(), &found.numbers.estimates);
    let mut finding = from_fit(case, problem, verdict, &effects, fit, estimates)?;
    if verdict == VerdictName::Ambiguous {
        finding.alternatives = told(found).map(|rival| joined(&rival.effects)).collect();
    }
    finding.ranking = found.ranking.iter().map(ranked).collect();
    finding.structure = disagreements(&found.structure, &problem.units);
    finding.structure_left = disagreements(&found.structure_left, &problem.units);
    finding.check = Some(CheckResult {
        p_value: found.check.p_value,
        misfit: finite(found.check.misfit).unwrap_or_default(),
        windows: found.check.missed.windows,
        missed_windows: found.check.missed.missed,
        structure: finite(found.check.structure).unwrap_or_default(),
    });
    finding.notes.extend(off(case, found));
    finding.notes.extend(fates(found));
    if !found.numbers.is_replayed {
        finding.notes.push(NOT_REPLAYED.to_owned());
    }
    Ok(finding)
}

/// Nominal parameters that are further off than what was known of them allows to overlook, or, where nothing was, than chance.
fn off(case: &Case, found: &Diagnosis) -> Option<String> {
    if !found.is_doubting && found.verdict != Verdict::Parameters {
        return None;
    }
    let hypothesis = &found.amended().hypothesis;
    let told: Vec<String> = hypothesis
        .free
        .iter()
        .filter_map(|free| {
            let Free::Nominal { name, nominal, .. } = free else {
                return None;
            };
            let change = hypothesis.value(name)? / nominal - 1.0;
            let stated = case.uncertainties.iter().find(|(own, _)| own == name);
            let (deviation, known) = match stated {
                Some((_, own)) => (*own, format!("known to {} %", number(100.0 * own))),
                None => {
                    let mut estimates = found.numbers.estimates.iter();
                    let estimate = estimates.find(|own| own.name == *name)?;
                    (
                        estimate.deviation / nominal,
                        "no uncertainty stated".to_owned(),
                    )
                }
            };
            (change.abs() > TO_95_PERCENT * deviation)
                .then(|| format!("{name} {:+.1} %, {known}", 100.0 * change))
        })
        .collect();
    let doubt = match found.is_doubting {
        true => {
            "; what the model states of its numbers contradicts the records, so that all of it counts a tenth as much"
        }
        false => "",
    };
    Some(format!(
        "numbers of the model that are off: {}{doubt}",
        told.join("; ")
    ))
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn ranked(rival: &Rival) -> Ranked {
    let gain = finite(rival.gain).unwrap_or_default();
    let reach = TO_95_PERCENT * finite(rival.gain_error).unwrap_or_default();
    Ranked {
        name: joined(&rival.effects),
        gain,
        interval95: [gain - reach, gain + reach],
        score: match rival.objection {
            None => finite(rival.score),
            Some(_) => None,
        },
        probability: finite(rival.probability),
        margin: finite(rival.margin),
        margin_error: finite(rival.margin_error),
    }
}

/// What became of sets that came first, or would have: a failed check, an objection, a fit that did not converge.
fn fates(found: &Diagnosis) -> Vec<String> {
    let mut notes = Vec::new();
    let Some(best) = found.ranking.first() else {
        return notes;
    };
    let name = readable(&joined(&best.effects));
    if found.verdict == Verdict::NotInCatalogue {
        let place = found.structure_left.first().map_or(String::new(), |place| {
            format!(
                "; most is structured over the {}",
                readable(place.coordinate.name())
            )
        });
        let first = if best.effects.is_empty() {
            "no effect of the catalogue gains anything, and the model with its parameters refitted"
                .to_owned()
        } else {
            format!(
                "{name} came first, with a gain of {} in ln likelihood, but",
                number(best.gain)
            )
        };
        notes.push(format!(
            "{first} does not explain the records: {}{place}",
            found.check.reasons.join("; ")
        ));
    }
    if !best.effects.is_empty() && !best.is_converged {
        notes.push(format!("the fit of {name} did not converge: its numbers may be off by more than their intervals"));
    }
    let leading = found.ranking.iter().filter(|rival| rival.score > 0.0);
    let rejected = leading
        .filter_map(|rival| Some((rival, rival.objection.as_ref()?)))
        .max_by(|a, b| a.0.score.total_cmp(&b.0.score));
    if let Some((rival, objection)) = rejected {
        notes.push(format!(
            "{} would come first, {} ahead in log evidence, but is no answer: {}",
            readable(&joined(&rival.effects)),
            number(rival.score),
            in_words(objection)
        ));
    }
    notes
}

fn in_words(objection: &Objection) -> String {
    match objection {
        Objection::AtAnEnd(numbers) => format!(
            "the best value of its number {} is the end of its range",
            numbers.join(", ")
        ),
        Objection::MayVanish(effects) => format!(
            "{} may as well be absent, since the 95 % interval of its size contains zero",
            readable(&joined(effects))
        ),
        Objection::ByChance(p_value) => format!(
            "replicas of the records, made without what it adds, gain as much with a probability of {}",
            number(*p_value)
        ),
    }
}

/// Where the model and the records disagree, with the nominal parameters refitted; no verdict is reached.
///
/// # Errors
/// The fitted model cannot be built.
pub fn located_finding(case: &Case, progress: &mut dyn FnMut(&str)) -> anyhow::Result<Finding> {
    let problem = case.problem()?;
    let base = fitted(&problem, &[], progress)?;
    progress("where they disagree");
    let estimates = base.fit.estimates(&problem.long);
    let mut finding = from_fit(
        case,
        &problem,
        VerdictName::Located,
        &[],
        &base.fit,
        &estimates,
    )?;
    finding.structure = disagreements(&structures(&problem.long, &base.fit), &problem.units);
    Ok(finding)
}

fn fitted(
    problem: &Problem,
    names: &[&str],
    progress: &mut dyn FnMut(&str),
) -> Result<Candidate, AmendError> {
    fit_effects(problem, names, progress).ok_or_else(|| AmendError::NotApplicable {
        effect: names.join(" with "),
        reason: NOT_APPLICABLE,
    })
}

/// A finding with effects that a person named, fitted whether they gain or not; ranking and places come from the finding there
/// was.
///
/// # Errors
/// The fitted model cannot be built, or an effect cannot be added to it.
pub fn forced_finding(
    case: &Case,
    names: &[String],
    earlier: Option<Finding>,
    progress: &mut dyn FnMut(&str),
) -> anyhow::Result<Finding> {
    let problem = case.problem()?;
    let own: Vec<&str> = names.iter().map(String::as_str).collect();
    let forced = fitted(&problem, &own, progress)?;
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
    let numbers = forced.fit.replayed_estimates(&problem);
    let mut finding = from_fit(
        case,
        &problem,
        VerdictName::Named,
        &effects,
        &forced.fit,
        &numbers.estimates,
    )?;
    finding.notes.push(format!(
        "the effects were given by --effect: {}",
        names.join(", ")
    ));
    if !numbers.is_replayed {
        finding.notes.push(NOT_REPLAYED.to_owned());
    }
    if let Some(earlier) = earlier {
        finding.ranking = earlier.ranking;
        finding.structure = earlier.structure;
    }
    Ok(finding)
}

fn from_fit(
    case: &Case,
    problem: &Problem,
    verdict: VerdictName,
    effects: &[(String, f64)],
    fit: &Fit,
    estimates: &[Estimate],
) -> anyhow::Result<Finding> {
    let fitted = FittedRig::of(&fit.hypothesis.rig_at()?, estimates, &problem.units)?;
    Ok(Finding {
        verdict,
        effects: found_effects(&fitted, effects),
        alternatives: Vec::new(),
        experiment: None,
        ranking: Vec::new(),
        structure: Vec::new(),
        structure_left: Vec::new(),
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
