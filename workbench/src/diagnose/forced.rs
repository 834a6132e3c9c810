//! Effects that a person names: fitted on top of the model without asking whether they are right.

use super::amend::{AmendError, NOT_APPLICABLE};
use super::catalogue::entry;
use super::decide::fit_base;
use super::fit::{Data, Fit, fit};
use super::gram::MOST_FREE;
use super::hypothesis::Hypothesis;
use stickslip::plant::ModelFile;

/// Steps of a first look at a start, and of the fits that are carried to the end.
const FIRST_LOOK: usize = 4;
const TO_THE_END: usize = 25;

/// Fits the named effects one after the other on top of `model`, keeping each.
///
/// # Errors
/// [`AmendError`] where an effect is unknown or cannot be added.
pub fn fit_effects(
    data: &Data,
    model: &ModelFile,
    names: &[String],
    progress: &mut dyn FnMut(&str),
) -> Result<Fit, AmendError> {
    progress("nominal parameters");
    let mut best = fit_base(data, Hypothesis::base(model));
    for name in names {
        let entry = entry(name).ok_or_else(|| AmendError::UnknownEffect(name.clone()))?;
        progress(entry.name);
        let starts = entry.starts(&best.hypothesis, true);
        let first = starts
            .into_iter()
            .filter(|start| start.dimension() <= MOST_FREE)
            .map(|start| fit(data, start, best.starts.clone(), FIRST_LOOK))
            .min_by(|a, b| a.loss.total_cmp(&b.loss))
            .ok_or_else(|| AmendError::NotApplicable {
                effect: name.clone(),
                reason: NOT_APPLICABLE,
            })?;
        best = fit(data, first.hypothesis, first.starts, TO_THE_END);
    }
    Ok(best)
}
