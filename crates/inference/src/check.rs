//! Whether the best set explains the records: what is left, compared with what replicas of the records leave.

use crate::fit::Fit;
use crate::policy::{LN_ODDS_OF_STRUCTURE, MOST_MISFIT, REPLICAS, SIGNIFICANT};
use crate::problem::Problem;
use crate::replica::left_of_replica;
use crate::structure::{Coordinate, Structure};

/// What is left of the records.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Probability that records of the fitted model itself leave as much structure.
    pub p_value: f64,
    /// Squared residuals over their number in the window in the middle of all.
    pub misfit: f64,
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
        .filter(|s| s.gain > -LN_ODDS_OF_STRUCTURE)
        .collect();
    let strongest = structure.first().map_or(0.0, |s| s.gain);
    let mut p_value = 1.0;
    for (suspect, p) in beside_replicas(problem, fit, suspects, progress) {
        if p < SIGNIFICANT && reasons.is_empty() {
            reasons.push(format!(
                "a free torque over {} would still gain {:.0} in log evidence, as replicas of the records would leave it with a \
                 probability of {p:.0e}",
                suspect.coordinate.name().replace('_', " "),
                suspect.gain
            ));
        }
        p_value = p.min(p_value);
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
        p_value,
        misfit,
        structure: strongest,
        reasons,
    }
}

/// The `suspects`, each with the probability that a replica of the records leaves as much; 1 where one does.
fn beside_replicas<'a>(
    problem: &Problem,
    fit: &Fit,
    suspects: Vec<&'a Structure>,
    progress: &mut dyn FnMut(&str),
) -> Vec<(&'a Structure, f64)> {
    let mut beside: Vec<(&Structure, Vec<f64>)> =
        suspects.into_iter().map(|own| (own, Vec::new())).collect();
    for seed in 1..=REPLICAS {
        if beside.is_empty() {
            break;
        }
        progress("what replicas of the records leave");
        if let Some(left) = left_of_replica(problem, fit, seed) {
            for (own, gains) in &mut beside {
                gains.push(gain_over(&left, own.coordinate));
            }
            beside.retain(|(own, gains)| gains.iter().all(|gain| *gain < own.gain));
        }
    }
    beside
        .into_iter()
        .map(|(own, gains)| (own, exceeded(own.gain, gains)))
        .collect()
}

fn gain_over(left: &[Structure], coordinate: Coordinate) -> f64 {
    left.iter()
        .find(|s| s.coordinate == coordinate)
        .map_or(f64::NEG_INFINITY, |s| s.gain)
}

/// Probability that a gain in log evidence like those of `replicas` exceeds `gain`: half of them exceed their median, and beyond
/// it, as half of a χ², they fall off exponentially. 0 without replicas, of which the model could run through none.
fn exceeded(gain: f64, mut replicas: Vec<f64>) -> f64 {
    replicas.retain(|gain| gain.is_finite());
    replicas.sort_by(f64::total_cmp);
    let upper = &replicas[replicas.len() / 2..];
    let Some(&median) = upper.first() else {
        return 0.0;
    };
    let beyond: f64 = upper.iter().map(|gain| gain - median).sum();
    let mean = beyond / (upper.len() - 1).max(1) as f64;
    0.5 * (-(gain - median).max(0.0) / mean).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_is_judged_by_how_far_replicas_scatter() {
        let calm = || vec![-12.0, -11.0, -10.0, -9.0, -8.0];
        let heavy = || vec![-12.0, -11.0, -10.0, 5.0, 15.0];
        assert!(exceeded(10.0, calm()) < 1e-5);
        assert!(exceeded(20.0, heavy()) > 0.05);
        assert!((exceeded(-10.0, calm()) - 0.5).abs() < 1e-12);
        assert_eq!(exceeded(10.0, Vec::new()), 0.0);
    }
}
