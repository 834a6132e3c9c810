//! `finding.json` of a small plant: what the rig's has, and the error after each effect.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::diagnose::finding::{self, Finding, FindingError, Ranked, VerdictName};
use inference::policy::NEGLIGIBLE;

/// What a diagnosis of a small plant found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SmallFinding {
    /// What every diagnosis has; `gap` stays empty, since it is measured through FMUs.
    #[serde(flatten)]
    pub finding: Finding,
    /// What is particular to a small plant.
    pub small_plant: Course,
}

/// The errors on the way from the analyst's to the amended model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Course {
    /// `drive`, `pendulum` or `contact`.
    pub kind: String,
    /// What the errors are of, in words.
    pub quantity: String,
    /// Unit of `rmse`.
    pub unit: String,
    /// Share of a sampling interval by which force or voltage was read later than it stands in the records ([`SmallCase::driven_later`]).
    #[serde(default)]
    pub driven_later: f64,
    /// Share of what is left that a free function of one coordinate or two explains, on what it was not fitted to.
    pub share_left: f64,
    /// What is left and is no noise, since it goes on for longer than the filters make noise go on: root mean square over that of the
    /// measured force, where one was measured.
    #[serde(default)]
    pub lasting: Option<f64>,
    /// The effects of the best set, each with the set's gain over what is left without it.
    pub gains: Vec<Ranked>,
    /// The analyst's model with its numbers refitted, then the model after each effect; empty before the stage `show`.
    pub steps: Vec<Step>,
}

/// A model on the way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// The effect that came in with it; absent for the analyst's model.
    pub effect: Option<String>,
    /// On the records learned from.
    pub learned: ErrorSize,
    /// On the held-out record.
    pub held_out: ErrorSize,
}

/// Size of an error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ErrorSize {
    /// Root mean square.
    pub rmse: f64,
    /// ‖y − ŷ‖/‖y‖.
    pub relative: f64,
    /// Mean magnitude.
    #[serde(default)]
    pub mean: f64,
}

impl SmallFinding {
    /// Reads `finding.json` of a directory.
    ///
    /// # Errors
    /// [`FindingError`], naming the file and what is wrong.
    pub fn read(directory: &Path) -> Result<Self, FindingError> {
        finding::read(directory)
    }

    /// Writes `finding.json` into a directory, whole or not at all.
    ///
    /// # Errors
    /// [`FindingError`].
    pub fn write(&self, directory: &Path) -> Result<(), FindingError> {
        finding::write(self, directory)
    }

    /// The part of the measured force that is left and no noise, where it is more than a right model leaves.
    #[must_use]
    pub fn lasts(&self) -> Option<f64> {
        self.small_plant.lasting.filter(|share| *share > NEGLIGIBLE)
    }

    /// Whether the model is now right as far as the records tell.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        let improved = match (
            self.small_plant.steps.first(),
            self.small_plant.steps.last(),
        ) {
            (Some(first), Some(last)) => last.held_out.rmse <= first.held_out.rmse,
            _ => true,
        };
        match self.finding.verdict {
            VerdictName::NothingMissing => true,
            VerdictName::NotInCatalogue => false,
            VerdictName::Parameters
            | VerdictName::Named
            | VerdictName::Ambiguous
            | VerdictName::Located => improved,
        }
    }
}
