//! Whether the best set explains the records: what is left, compared with what replicas of the records leave.

use crate::fit::Fit;
use crate::missed::Missed;
use crate::policy::{LN_PRIOR_ODDS, MOST_MISFIT, REPLICAS, SIGNIFICANT};
use crate::problem::Problem;
use crate::replica::{exceeded, settled_on_replica};
use crate::structure::{Structure, structures};

/// What is left of the records.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Probability that records of the fitted model itself leave as much structure; `None` where so little is left that nobody has
    /// to ask.
    pub p_value: Option<f64>,
    /// Squared residuals over their number in the window in the middle of all.
    pub misfit: f64,
    /// Windows of the records, and how many of them the model misses.
    pub missed: Missed,
    /// The most that a free torque over one coordinate gains in log evidence.
    pub structure: f64,
    /// Why the check failed, in words; empty where it did not.
    pub reasons: Vec<String>,
}

impl Check {
    /// Whether what is left is no more than a right model leaves.
    #[must_use]
    pub fn is_passed(&self) -> bool {
        self.reasons.is_empty()
    }
}

/// Checks `fit`, which leaves `structure`.
#[must_use]
pub fn check(
    problem: &Problem,
    fit: &Fit,
    structure: &[Structure],
    progress: &mut dyn FnMut(&str),
) -> Check {
    let misfit = fit.typical_misfit(&problem.long);
    let mut reasons = Vec::new();
    let suspects: Vec<&Structure> = structure
        .iter()
        .filter(|s| s.gain > -LN_PRIOR_ODDS)
        .collect();
    let missed = Missed::by(fit, &problem.long);
    let mut least: Option<(&Structure, f64)> = None;
    match Replicas::asked(problem, fit, &suspects, missed, progress) {
        None => reasons.push(
            "the fitted model cannot run through the records to tell whether what it leaves is chance".to_owned(),
        ),
        Some(replicas) => {
            let judged = suspects.iter().filter_map(|own| Some((*own, replicas.p_value(own)?)));
            least = judged.min_by(|a, b| a.1.total_cmp(&b.1));
            let chance = missed.chance(replicas.missed);
            if chance < SIGNIFICANT {
                reasons.push(format!(
                    "it misses {} of {} windows; {REPLICAS} replicas of the records give so many a probability of {chance:.0e}",
                    missed.missed, missed.windows
                ));
            }
        }
    }
    if let Some((suspect, p_value)) = least
        && p_value < SIGNIFICANT
    {
        reasons.push(format!(
            "a free torque over {} would still gain {:.0} in log evidence; {REPLICAS} replicas of the records give so much a \
             probability of {p_value:.0e}",
            suspect.coordinate.name().replace('_', " "),
            suspect.gain
        ));
    }
    if misfit > MOST_MISFIT {
        reasons.push(format!(
            "the squared residuals are {misfit:.2} times what the instruments explain"
        ));
    }
    if fit.fluctuates_most() {
        reasons.push(format!(
            "friction would have to fluctuate by {:.0} % or more",
            100.0 * fit.disturbance.relative
        ));
    }
    Check {
        p_value: least.map(|(_, p_value)| p_value),
        misfit,
        missed,
        structure: structure.first().map_or(0.0, |s| s.gain),
        reasons,
    }
}

/// What replicas of the records leave.
struct Replicas {
    structures: Vec<Vec<Structure>>,
    missed: Missed,
}

impl Replicas {
    /// Replicas until they leave as much structure as every one of the `suspects` and as many missed windows as to say that so many are
    /// no surprise, [`REPLICAS`] at most; `None` where the model cannot run through the records.
    fn asked(
        problem: &Problem,
        fit: &Fit,
        suspects: &[&Structure],
        missed: Missed,
        progress: &mut dyn FnMut(&str),
    ) -> Option<Self> {
        let mut replicas = Self {
            structures: Vec::new(),
            // Those that are not asked miss none.
            missed: Missed {
                windows: REPLICAS as usize * missed.windows,
                missed: 0,
            },
        };
        for seed in 1..=REPLICAS {
            let is_reached = |own: &&Structure| replicas.gains(own).any(|gain| gain >= own.gain);
            if suspects.iter().all(is_reached) && missed.chance(replicas.missed) >= SIGNIFICANT {
                break;
            }
            progress("what replicas of the records leave");
            let (settled, data) = settled_on_replica(problem, fit, seed)?;
            replicas.missed.missed += Missed::by(&settled, &data).missed;
            if !suspects.is_empty() {
                replicas
                    .structures
                    .push(structures(&data.divided(), &settled));
            }
        }
        Some(replicas)
    }

    /// Probability that a replica leaves as much as this; `None` where none can tell.
    fn p_value(&self, own: &Structure) -> Option<f64> {
        exceeded(own.gain, self.gains(own).collect())
    }

    fn gains(&self, own: &Structure) -> impl Iterator<Item = f64> {
        let coordinate = own.coordinate;
        self.structures.iter().map(move |left| {
            let there = left.iter().find(|other| other.coordinate == coordinate);
            there.map_or(f64::NEG_INFINITY, |other| other.gain)
        })
    }
}
