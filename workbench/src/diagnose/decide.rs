//! From gains to a verdict.

use super::catalogue::{Entry, entry};
use super::companions::companions;
use super::data::Data;
use super::fit::{Fit, fit};
use super::gain::LEAST_GAIN;
use super::hypothesis::{Estimate, Hypothesis};
use super::law_fits::with_costly_law_last;
use super::left::{Left, jumps};
use super::restated::refitting_closes_a_gap;
use super::rivals::{counts, indistinguishable, least_astray, simplest};
use super::robust::Robust;
use super::search::{LITTLE_ROUGHNESS, Tried, WRONG, close_up, try_all, try_known};
use super::structure::{Structure, structures};
use super::superfluous::drop_superfluous;

/// The same as [`LEAST_GAIN`] for an effect on top of others.
const LEAST_FURTHER_GAIN: f64 = 20.0;
/// The same where friction fluctuates: a few windows in which it happens to be high or low gain half as much.
const LEAST_ROUGH_GAIN: f64 = 40.0;
/// Share of what an effect explains that it must still do where the rest of the model has been shown the way.
const STILL_WANTED: f64 = 0.4;
/// Most effects that are added one after the other.
const MOST_EFFECTS: usize = 3;
/// Effects that must have explained something together for another one to be looked for.
const FIRST_EFFECTS: usize = 2;
/// Share of the loss that they leave if they have not.
const LITTLE_EXPLAINED: f64 = 0.9;
/// Share of the most that an effect gained from which on another one may have been the one to begin with.
const NEARLY_FIRST: f64 = 0.9;

/// What the records say about the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The model explains the records as it stands.
    NothingMissing,
    /// It does with other nominal parameters than the analyst's.
    Parameters,
    /// It does with the effects that were added.
    Named,
    /// It does with one of several effects that these records cannot tell apart.
    Ambiguous,
    /// No effect of the catalogue explains them.
    NotInCatalogue,
}

/// An effect that was added.
#[derive(Clone, Debug)]
pub struct Named {
    /// Name of the effect.
    pub name: &'static str,
    /// Probability of being the right one among the catalogue's.
    pub probability: f64,
    /// Its parameters.
    pub estimates: Vec<Estimate>,
}

/// One line of the ranking.
#[derive(Clone, Debug)]
pub struct Ranked {
    /// Name of the effect.
    pub name: &'static str,
    /// Gain in ln likelihood on windows not fitted to.
    pub gain: f64,
    /// Interval that covers the gain with 95 % probability.
    pub interval95: [f64; 2],
}

/// The whole finding.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The verdict.
    pub verdict: Verdict,
    /// Effects that were added, strongest first.
    pub effects: Vec<Named>,
    /// Names that cannot be told apart from the first effect.
    pub alternatives: Vec<&'static str>,
    /// Every candidate on top of the analyst's model.
    pub ranking: Vec<Ranked>,
    /// Where the analyst's model leaves structure, strongest first.
    pub structure: Vec<Structure>,
    /// Where the amended model still does, strongest first.
    pub structure_left: Vec<Structure>,
    /// Nominal parameters, refitted.
    pub nominal: Vec<Estimate>,
    /// The analyst's model with its parameters refitted.
    pub base: Fit,
    /// The amended model.
    pub amended: Fit,
}

/// What happens in the course of a diagnosis, for a display.
#[derive(Clone, Debug, PartialEq)]
pub enum Progress<'a> {
    /// The nominal parameters are being fitted.
    Base,
    /// This effect is being tried as number `round` + 1.
    Trying {
        /// Name of the effect.
        name: &'a str,
        /// Effects added so far.
        round: usize,
    },
    /// It is being looked for structure in what is left.
    Locating,
    /// Nothing explains the records, and this effect may be a stand-in: all is tried once more without it.
    Without(&'a str),
}

/// Steps after which it is known whether the analyst's model is far from explaining the records.
const FIRST_STEPS: usize = 2;
/// Misfit per residual above which it is.
const FAR: f64 = 3.0;
/// Steps after which it is known whether it can explain them.
const FEW_STEPS: usize = 6;
/// Steps within which its fit converges if it can.
const MANY_STEPS: usize = 15;

/// Fits the analyst's model within the stated uncertainty of its parameters.
pub fn fit_base(data: &Data, hypothesis: Hypothesis) -> Fit {
    let judging = Robust::JUDGING;
    let mut direct = fit(
        data,
        hypothesis.clone(),
        data.anchors(),
        FIRST_STEPS,
        judging,
    );
    if direct.misfit(data) < FAR {
        let steps = FEW_STEPS - FIRST_STEPS;
        direct = fit(data, direct.hypothesis, direct.starts, steps, judging);
    }
    if direct.misfit(data) < WRONG {
        return fit(data, direct.hypothesis, direct.starts, MANY_STEPS, judging);
    }
    // Over short windows a model that lacks an effect still leads to the nominal parameters that are nearest.
    let (_, near) = close_up(data, &hypothesis);
    let careful = fit(data, near.hypothesis, data.anchors(), FEW_STEPS, judging);
    if careful.loss < direct.loss {
        careful
    } else {
        direct
    }
}

/// Finds what is missing in `hypothesis`; effects named in `without` are not considered.
///
/// Where nothing explains the records and another effect did nearly as much on top of the analyst's model as the one that did
/// most, that may have been a stand-in: what is found without it then counts if it explains them.
pub fn diagnose(
    data: &Data,
    hypothesis: Hypothesis,
    without: &[String],
    progress: &mut dyn FnMut(Progress<'_>),
) -> Diagnosis {
    progress(Progress::Base);
    let base = fit_base(data, hypothesis);
    progress(Progress::Locating);
    let structure = structures(data, &base);
    let (found, stand_in) = explain(data, &base, &structure, without, progress);
    let Some(stand_in) = stand_in else {
        return found;
    };
    progress(Progress::Without(stand_in));
    let mut without = without.to_vec();
    without.push(stand_in.to_owned());
    let (other, _) = explain(data, &base, &structure, &without, progress);
    match other.verdict {
        Verdict::Named | Verdict::Ambiguous => Diagnosis {
            ranking: found.ranking,
            ..other
        },
        _ => found,
    }
}

/// What `base`, fitted to the records, needs to explain them, and where that has not been found the effect that did most on
/// top of `base` although another one did nearly as much.
fn explain(
    data: &Data,
    base: &Fit,
    structure: &[Structure],
    without: &[String],
    progress: &mut dyn FnMut(Progress<'_>),
) -> (Diagnosis, Option<&'static str>) {
    let mut base = base.clone();
    let mut current = base.clone();
    let mut ranking: Option<Vec<Tried>> = None;
    let mut rivals: Vec<Vec<&'static str>> = Vec::new();
    let mut gains = Vec::new();
    let mut names: Vec<&'static str> = Vec::new();
    let mut guided = 0;
    let mut looked: Option<Left> = None;
    let mut beside_law: Vec<(&'static Entry, Fit)> = Vec::new();
    while names.len() < MOST_EFFECTS && !have_done_too_little(names.len(), &base, &current) {
        let round = names.len();
        let beside: Vec<&str> = beside_law.iter().map(|(entry, _)| entry.name).collect();
        let tried = if beside_law.iter().any(|(_, both)| both.is_explained(data)) {
            try_known(data, &current, beside_law.clone())
        } else {
            try_all(data, &current, without, beside_law.clone(), &mut |name| {
                progress(Progress::Trying { name, round })
            })
        };
        let is_rough = current.disturbance.relative > LITTLE_ROUGHNESS;
        let least_gain = if is_rough {
            LEAST_ROUGH_GAIN
        } else if names.is_empty() {
            LEAST_GAIN
        } else {
            LEAST_FURTHER_GAIN
        };
        // Clean records never gain as much in all; on top of another effect, what that one leaves may.
        let elsewhere = if names.is_empty() {
            LEAST_GAIN
        } else {
            2.0 * least_gain
        };
        let accepted = tried
            .iter()
            .filter(|t| t.is_finalist)
            .find(|t| counts(data, t))
            .filter(|best| best.gains_surely(least_gain, elsewhere))
            .map(|best| match round {
                0 => best,
                _ => least_astray(data, best, &tried),
            })
            .cloned();
        // An effect of no size that fits better has only shown the rest of the model the way.
        let immaterial = tried
            .iter()
            .take_while(|t| t.is_finalist)
            .find(|t| t.gain > LEAST_GAIN && !counts(data, t));
        if let Some(guide) = immaterial
            && guided < names.len() + 1
            && let Some(better) = guide.fit.without_last_effect(data, &current)
        {
            guided = names.len() + 1;
            let still_wanted = accepted.as_ref().is_some_and(|best| {
                let explained = current.loss - best.fit.loss;
                better.loss - best.fit.loss > STILL_WANTED * explained
            });
            if names.is_empty() {
                base = better.clone();
            }
            current = better;
            if !still_wanted {
                looked = (jumps(&current) && !names.is_empty())
                    .then(|| Left::by(data, &current, gains.iter().sum()));
                if looked.as_ref().is_some_and(|left| !left.counts) {
                    break;
                }
                continue;
            }
        }
        if let Some(best) = &accepted {
            let further = LEAST_FURTHER_GAIN.max(least_gain);
            let simple = simplest(data, best, &tried, further);
            let mut others = indistinguishable(data, simple, &tried);
            others.retain(|name| *name != best.name);
            rivals.push(others);
            gains.push(simple.gain);
            names.push(simple.name);
            current = if beside.contains(&simple.name) {
                simple.fit.clone()
            } else {
                with_costly_law_last(data, &base, &names, simple.fit.clone())
            };
            looked = None;
        }
        let ranking = ranking.get_or_insert(tried);
        if accepted.is_none() || current.is_explained(data) && round > 0 {
            break;
        }
        let nearly_all = names.len() >= FIRST_EFFECTS && current.typical_misfit(data) < WRONG;
        looked =
            (jumps(&current) || nearly_all).then(|| Left::by(data, &current, gains.iter().sum()));
        if looked.as_ref().is_some_and(|left| !left.counts) {
            break;
        }
        beside_law = match names[..] {
            [law] => companions(data, &base, law, &current, ranking, &mut |name| {
                progress(Progress::Trying { name, round: 1 })
            }),
            _ => Vec::new(),
        };
    }
    let added = names.len();
    drop_superfluous(
        data,
        &base,
        &mut current,
        &mut names,
        &mut gains,
        &mut rivals,
        ranking.as_deref().unwrap_or_default(),
    );
    progress(Progress::Locating);
    let explained: f64 = gains.iter().sum();
    let mut left = match looked.filter(|_| names.len() == added) {
        Some(left) => left,
        None if names.is_empty() => Left::among(data, &current, structure.to_vec(), explained),
        None => Left::by(data, &current, explained),
    };
    // Of effects that the gains cannot tell apart, one that leaves nothing is better than one that leaves structure.
    if left.counts && names.len() == 1 {
        let stand_in = rivals[0].iter().find_map(|&name| {
            let fitted = &ranking.as_ref()?.iter().find(|t| t.name == name)?.fit;
            let left = Left::by(data, fitted, explained);
            (!left.counts).then(|| (name, fitted.clone(), left))
        });
        if let Some((name, fitted, nothing)) = stand_in {
            rivals[0].retain(|rival| *rival != name);
            rivals[0].push(names[0]);
            names[0] = name;
            current = fitted;
            left = nothing;
        }
    }
    let alternatives = rivals.first().cloned().unwrap_or_default();
    let all_certain = names
        .iter()
        .all(|name| current.is_wholly_certain_of(data, name));
    let verdict = if left.counts || !all_certain {
        Verdict::NotInCatalogue
    } else if names.is_empty() {
        if parameters_moved(&base) || refitting_closes_a_gap(data, &base) {
            Verdict::Parameters
        } else {
            Verdict::NothingMissing
        }
    } else if !alternatives.is_empty() {
        Verdict::Ambiguous
    } else {
        Verdict::Named
    };
    let (nominal, added): (Vec<Estimate>, Vec<Estimate>) = current
        .estimates(data)
        .into_iter()
        .partition(|e| e.is_nominal);
    let effects = names
        .iter()
        .zip(&rivals)
        .map(|(&name, rivals)| Named {
            name,
            probability: 1.0 / (1.0 + rivals.len() as f64),
            estimates: belonging(name, &added),
        })
        .collect();
    let stand_in = ranking
        .as_deref()
        .filter(|_| verdict == Verdict::NotInCatalogue)
        .and_then(first_by_little);
    let ranking = ranking
        .unwrap_or_default()
        .iter()
        .map(|t| Ranked {
            name: t.name,
            gain: t.gain,
            interval95: t.interval95,
        })
        .collect();
    let diagnosis = Diagnosis {
        verdict,
        effects: if verdict == Verdict::NotInCatalogue {
            Vec::new()
        } else {
            effects
        },
        alternatives,
        ranking,
        structure: structure.to_vec(),
        structure_left: left.structures,
        nominal,
        base,
        amended: current,
    };
    (diagnosis, stand_in)
}

/// What gained most on top of the analyst's model, if another effect gained nearly as much.
fn first_by_little(ranking: &[Tried]) -> Option<&'static str> {
    let (best, others) = ranking.split_first()?;
    let by_little = others.iter().any(|t| t.gain > NEARLY_FIRST * best.gain);
    (best.gain > LEAST_GAIN && by_little).then_some(best.name)
}

/// Whether the first `added` effects leave nearly all that there was: a further one would stand in as they do.
fn have_done_too_little(added: usize, base: &Fit, current: &Fit) -> bool {
    added >= FIRST_EFFECTS && current.loss > LITTLE_EXPLAINED * base.loss
}

/// The estimates that belong to an effect: those of its own section, or the law's.
fn belonging(name: &str, estimates: &[Estimate]) -> Vec<Estimate> {
    let prefix = entry(name).map_or(name, |entry| entry.prefix());
    estimates
        .iter()
        .filter(|e| e.name.starts_with(prefix))
        .cloned()
        .collect()
}

/// Whether any nominal parameter moved by more than its stated uncertainty allows to overlook.
fn parameters_moved(base: &Fit) -> bool {
    let precisions = base.hypothesis.prior_precisions();
    base.hypothesis
        .x
        .iter()
        .zip(precisions)
        .any(|(x, p)| x * x * p > 4.0)
}
