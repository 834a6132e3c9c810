//! Whether the analyst's numbers are what is wrong, and not the structure of the model.

use super::data::Data;
use super::fit::{Fit, fit};
use super::gain::{folds, gain};
use super::hypothesis::Hypothesis;

/// Gain in ln likelihood from which on refitted parameters close a gap that the analyst's leave.
const LEAST_GAIN: f64 = 10.0;
/// Steps within which the windows of a model without free numbers find their starts.
const STEPS: usize = 6;

/// Whether the nominal parameters of `refitted` explain windows that they were not fitted to better than the analyst's
/// own numbers do.
pub fn refitting_closes_a_gap(data: &Data, refitted: &Fit) -> bool {
    let as_stated = Hypothesis {
        free: Vec::new(),
        x: Vec::new(),
        ..refitted.hypothesis.clone()
    };
    let judging = refitted.judging;
    let mut stated = fit(data, as_stated, refitted.starts.clone(), STEPS, judging);
    stated.share_starts(data, refitted);
    let folds = folds(data);
    let gained = gain(
        &stated.held_out_losses(data, &folds),
        &refitted.held_out_losses(data, &folds),
    );
    gained.total > LEAST_GAIN && gained.interval95[0] > 0.0
}
