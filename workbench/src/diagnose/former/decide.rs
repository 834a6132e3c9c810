//! From gains to a verdict.

use super::breakaway::{Breakaways, STICTION};
use super::catalogue::{Entry, entry};
use super::close_up::{CloseUp, close_up};
use super::data::Data;
use super::fit::{Fit, fit};
use super::gain::LEAST_GAIN;
use super::hypothesis::{Estimate, Hypothesis};
use super::restated::refitting_closes_a_gap;
use super::robust::Robust;
use super::rounds::Rounds;
use super::search::{LITTLE_ROUGHNESS, Tried, WRONG};
use super::structure::{Structure, structures};

/// Share of the most that an effect gained from which on another one may have been the one to begin with.
const NEARLY_FIRST: f64 = 0.9;

/// Share of the loss of a law's fit that it must leave at most when fitted from every start to count as another one.
const ANOTHER_FIT: f64 = 0.9;

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
    /// The records that the fits are of: where friction fluctuates, windows may break away at levels of their own.
    pub data: Data,
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
    /// Friction fluctuates and the disc breaks away above what it slides at: all is tried once more with that.
    Breakaways,
    /// Nothing explains the records, and the fit of this law may have got stuck: it is fitted once more, from every start.
    EveryStart(&'a str),
    /// Nothing explains the records, and this effect may be a stand-in: all is tried once more without it.
    Without(&'a str),
}

/// What may have gone wrong where nothing has been found that explains the records.
#[derive(Default)]
struct Doubt {
    /// A law of many numbers that did nearly most on top of the analyst's model, with its fit: it may have got stuck.
    law: Option<(&'static Entry, Fit)>,
    /// The effect that may be a stand-in.
    stand_in: Option<&'static str>,
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
        direct = direct.further(data, steps);
    }
    if direct.misfit(data) < WRONG {
        return direct.further(data, MANY_STEPS);
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
/// Where friction fluctuates, breakaways may tell of stiction that the rest of the records does not show.
///
/// Where nothing explains the records, the fit of a law of many numbers may have got stuck; it is fitted from every start then. Or
/// an effect may have been a stand-in: the one whose numbers are not certain although nothing
/// is left, or the one that did most on top of the analyst's model although another did nearly as much. What is found without it
/// then counts if it explains them.
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
    let (found, doubt) = explain(data, &base, None, None, &structure, without, progress);
    let may_be_stiction = found.amended.disturbance.relative > LITTLE_ROUGHNESS
        && !without.iter().any(|name| name == STICTION);
    if may_be_stiction && let Some(breakaways) = Breakaways::above_sliding(data, &base) {
        progress(Progress::Breakaways);
        let told = &breakaways.told;
        let (anew, _) = explain(
            told,
            &base,
            Some(&breakaways),
            None,
            &structure,
            without,
            progress,
        );
        if anew.verdict == Verdict::Named || anew.verdict == Verdict::Ambiguous {
            return anew;
        }
    }
    if let Some((law, stuck)) = doubt.law {
        progress(Progress::EveryStart(law.name));
        let another = CloseUp::of(data, &base)
            .fit_entry_from_every_start(law)
            .filter(|another| another.loss < ANOTHER_FIT * stuck.loss);
        if let Some(another) = another {
            let known = Some((law, another));
            let (anew, _) = explain(data, &base, None, known, &structure, without, progress);
            if anew.verdict == Verdict::Named || anew.verdict == Verdict::Ambiguous {
                return with_the_rest_of(anew, found.ranking);
            }
        }
    }
    let Some(stand_in) = doubt.stand_in else {
        return found;
    };
    progress(Progress::Without(stand_in));
    let mut without = without.to_vec();
    without.push(stand_in.to_owned());
    let (other, _) = explain(data, &base, None, None, &structure, &without, progress);
    match other.verdict {
        Verdict::Named | Verdict::Ambiguous => Diagnosis {
            ranking: found.ranking,
            ..other
        },
        _ => found,
    }
}

/// The finding with the lines of an earlier `ranking` below its own.
fn with_the_rest_of(mut found: Diagnosis, ranking: Vec<Ranked>) -> Diagnosis {
    for ranked in ranking {
        if found.ranking.iter().all(|own| own.name != ranked.name) {
            found.ranking.push(ranked);
        }
    }
    found
}

/// What `base`, fitted to the records, needs to explain them, and where that has not been found what may have gone wrong.
fn explain(
    data: &Data,
    base: &Fit,
    breakaways: Option<&Breakaways>,
    known: Option<(&'static Entry, Fit)>,
    structure: &[Structure],
    without: &[String],
    progress: &mut dyn FnMut(Progress<'_>),
) -> (Diagnosis, Doubt) {
    let known = known.into_iter().collect();
    let mut rounds = Rounds::of(
        data,
        base,
        breakaways,
        known,
        without,
        &mut |name, round| progress(Progress::Trying { name, round }),
    );
    rounds.drop_superfluous(data);
    progress(Progress::Locating);
    let left = rounds.what_is_left(data, structure);
    let Rounds {
        base,
        current,
        additions,
        ranking,
        ..
    } = rounds;
    let uncertain = additions
        .iter()
        .map(|addition| addition.name)
        .find(|name| !current.is_wholly_certain_of(data, name));
    let alternatives = additions.first().map_or(Vec::new(), |a| a.rivals.clone());
    let verdict = if left.counts || uncertain.is_some() {
        Verdict::NotInCatalogue
    } else if additions.is_empty() {
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
    let effects = additions
        .iter()
        .map(|addition| Named {
            name: addition.name,
            probability: 1.0 / (1.0 + addition.rivals.len() as f64),
            estimates: belonging(addition.name, &added),
        })
        .collect();
    let doubt = if verdict == Verdict::NotInCatalogue {
        Doubt {
            law: law_nearly_first(&ranking),
            stand_in: uncertain
                .filter(|_| !left.counts)
                .or_else(|| first_by_little(&ranking)),
        }
    } else {
        Doubt::default()
    };
    let ranking = ranking
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
        data: data.clone(),
    };
    (diagnosis, doubt)
}

/// The law of many numbers that gained most on top of the analyst's model or nearly so.
fn law_nearly_first(ranking: &[Tried]) -> Option<(&'static Entry, Fit)> {
    let most = ranking.iter().map(|t| t.gain).fold(LEAST_GAIN, f64::max);
    ranking
        .iter()
        .filter(|t| t.gain > NEARLY_FIRST * most)
        .filter_map(|t| Some((entry(t.name)?, t.fit.clone())))
        .find(|(entry, _)| entry.is_costly())
}

/// What gained most on top of the analyst's model, if another effect gained nearly as much.
fn first_by_little(ranking: &[Tried]) -> Option<&'static str> {
    let (best, others) = ranking.split_first()?;
    let by_little = others.iter().any(|t| t.gain > NEARLY_FIRST * best.gain);
    (best.gain > LEAST_GAIN && by_little).then_some(best.name)
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
