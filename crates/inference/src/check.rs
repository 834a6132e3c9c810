//! Whether the best set explains the records: what is left, compared with what a right model leaves.

use crate::fit::Fit;
use crate::policy::{MOST_LEFT, MOST_MISFIT, PRIOR_ODDS_OF_STRUCTURE};
use crate::problem::Problem;
use crate::structure::Structure;

/// What is left of the records.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Probability that nothing is missing which the catalogue does not have, from what a free torque gains.
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
pub fn check(problem: &Problem, fit: &Fit, structure: &[Structure]) -> Check {
    let strongest = structure.first().map_or(0.0, |s| s.gain);
    let misfit = fit.typical_misfit(&problem.long);
    let mut reasons = Vec::new();
    if let Some(first) = structure.first().filter(|s| s.gain > MOST_LEFT) {
        reasons.push(format!(
            "a free torque over {} would still gain {:.0} in log evidence",
            first.coordinate.name().replace('_', " "),
            first.gain
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
        p_value: 1.0 / (1.0 + (strongest + PRIOR_ODDS_OF_STRUCTURE).exp()),
        misfit,
        structure: strongest,
        reasons,
    }
}
