//! Effects that a person names: fitted on top of the model without asking whether they are right.

use super::amend::{AmendError, NOT_APPLICABLE};
use super::catalogue::entry;
use super::data::Data;
use super::decide::fit_base;
use super::fit::Fit;
use super::hypothesis::Hypothesis;
use super::law_fits::fit_named;
use stickslip::plant::ModelFile;

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
        best = fit_named(data, &best, entry).ok_or_else(|| AmendError::NotApplicable {
            effect: name.clone(),
            reason: NOT_APPLICABLE,
        })?;
    }
    Ok(best)
}
