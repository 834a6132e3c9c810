//! Whether the best set explains the records: what is left, compared with what replicas of the records leave.

use crate::fit::Fit;
use crate::missed::{Encounter, FromRest};
use crate::policy::{LN_PRIOR_ODDS, MOST_MISFIT, REPLICAS, SIGNIFICANT};
use crate::problem::Problem;
use crate::replica::{exceeded, left_of_replica};
use crate::structure::{Coordinate, Structure};

/// What is left of the records.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Probability that records of the fitted model itself leave as much structure; `None` where so little is left that nobody has
    /// to ask.
    pub p_value: Option<f64>,
    /// Squared residuals over their number in the window in the middle of all.
    pub misfit: f64,
    /// Windows from rest in the records and in the held-out one, and how many of them the model misses.
    pub from_rest: FromRest,
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
    let beside = beside_replicas(problem, fit, &suspects, progress);
    if beside.is_none() {
        reasons.push(
            "it leaves structure, and the fitted model cannot run through the records to tell whether that is chance".to_owned(),
        );
    }
    let least = beside.iter().flatten().min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((suspect, p_value)) = least
        && *p_value < SIGNIFICANT
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
    let encounter = Encounter::new(problem, fit);
    let from_rest = encounter.of_records();
    match chance(&encounter, from_rest, progress) {
        Some(p_value) if p_value >= SIGNIFICANT => {}
        Some(p_value) => reasons.push(format!(
            "it misses {} of {} windows that start from rest; {REPLICAS} replicas of the records give so many a probability of {p_value:.0e}",
            from_rest.missed, from_rest.windows
        )),
        None => reasons.push(format!(
            "it misses {} of {} windows that start from rest, and the fitted model cannot run through the records to tell whether that is chance",
            from_rest.missed, from_rest.windows
        )),
    }
    if fit.fluctuates_most() {
        reasons.push(format!(
            "friction would have to fluctuate by {:.0} % or more",
            100.0 * fit.disturbance.relative
        ));
    }
    Check {
        p_value: least.map(|(_, p_value)| *p_value),
        misfit,
        from_rest,
        structure: structure.first().map_or(0.0, |s| s.gain),
        reasons,
    }
}

/// The `suspects`, each with the probability that a replica of the records leaves as much; `None` where the model cannot run
/// through the records. Once a replica leaves as much of every one of them, the others are not needed.
fn beside_replicas<'a>(
    problem: &Problem,
    fit: &Fit,
    suspects: &[&'a Structure],
    progress: &mut dyn FnMut(&str),
) -> Option<Vec<(&'a Structure, f64)>> {
    let mut replicas: Vec<Vec<Structure>> = Vec::new();
    let gains = |replicas: &[Vec<Structure>], own: &Structure| -> Vec<f64> {
        let over = |left: &Vec<Structure>| gain_over(left, own.coordinate);
        replicas.iter().map(over).collect()
    };
    for seed in 1..=REPLICAS {
        let is_matched = |own: &&Structure| gains(&replicas, own).iter().any(|g| *g >= own.gain);
        if suspects.iter().all(is_matched) {
            break;
        }
        progress("what replicas of the records leave");
        replicas.push(left_of_replica(problem, fit, seed)?);
    }
    let p_value = |own: &&'a Structure| Some((*own, exceeded(own.gain, gains(&replicas, own))?));
    suspects.iter().map(p_value).collect()
}

/// Probability that as many windows from rest are missed as of the records; `None` where the model cannot run through them. Where
/// no replica could make it small, none is asked.
fn chance(
    encounter: &Encounter<'_>,
    from_rest: FromRest,
    progress: &mut dyn FnMut(&str),
) -> Option<f64> {
    let mut replicas = FromRest {
        windows: REPLICAS as usize * from_rest.windows,
        missed: 0,
    };
    for seed in 1..=REPLICAS {
        if from_rest.chance(replicas) >= SIGNIFICANT {
            break;
        }
        progress("what the model misses of replicas of the records");
        replicas.missed += encounter.of_replica(seed)?.missed;
    }
    Some(from_rest.chance(replicas))
}

fn gain_over(left: &[Structure], coordinate: Coordinate) -> f64 {
    left.iter()
        .find(|s| s.coordinate == coordinate)
        .map_or(f64::NEG_INFINITY, |s| s.gain)
}
