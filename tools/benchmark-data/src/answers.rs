//! `ANSWERS.json`: what was hidden, in the schema of the practice records.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Answers by case name, in order.
pub type Answers = BTreeMap<String, Answer>;

/// Numbers by their names.
pub(crate) fn named<const N: usize>(numbers: [(&str, f64); N]) -> BTreeMap<String, f64> {
    numbers.map(|(name, value)| (name.to_owned(), value)).into()
}

/// What was hidden in one case.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// Name of the effect, or of two joined by `_and_`; `outside_…` is in no catalogue.
    pub kind: String,
    /// Standard deviation of the random friction [-]; 0 = clean.
    pub rough: f64,
    /// Seed of the case.
    pub seed: u64,
    /// Size of the effect over the size in the practice records.
    pub scale: f64,
    /// How far the analyst's parameters are off (0.02 = the stated standard deviations).
    pub spread: f64,
    /// The analyst's friction law.
    pub base: String,
    /// The true friction law.
    pub truth: String,
    /// Values of the hidden effects.
    pub effects: BTreeMap<String, f64>,
    /// True over believed parameter; `mu` is the friction level.
    pub parameter_ratio: BTreeMap<String, f64>,
    /// On the full rig: the disc the effect sits on, `disc1` or `disc2`; the shaft between the discs
    /// belongs to `disc1`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// The same of several effects, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub places: BTreeMap<String, String>,
    /// The true instruments where nobody knows them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensors: Option<BTreeMap<String, f64>>,
    /// What the rig is and does, on rigs that were drawn.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub facts: BTreeMap<String, f64>,
}
