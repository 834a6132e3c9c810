//! Effects that a person names: fitted on top of the model without asking whether they are right.

use super::amend::{AmendError, NOT_APPLICABLE};
use super::breakaway::{Breakaways, STICTION};
use super::catalogue::{Entry, entry};
use super::close_up::CloseUp;
use super::data::Data;
use super::decide::fit_base;
use super::fit::Fit;
use super::hypothesis::Hypothesis;
use super::law_fits::fit_named;
use super::search::LITTLE_ROUGHNESS;
use stickslip::plant::ModelFile;

/// Effects that a person named, fitted.
#[derive(Clone, Debug)]
pub struct Forced {
    /// The model with them.
    pub fit: Fit,
    /// The records that it is fitted to: where friction fluctuates, windows may break away at levels of their own.
    pub data: Data,
}

/// Fits the named effects one after the other on top of `model`, keeping each. Where friction fluctuates in what comes out,
/// stiction is fitted to the breakaways.
///
/// # Errors
/// [`AmendError`] where an effect is unknown or cannot be added.
pub fn fit_effects(
    data: &Data,
    model: &ModelFile,
    names: &[String],
    progress: &mut dyn FnMut(&str),
) -> Result<Forced, AmendError> {
    let plain = fit_each(data, model, names, false, progress)?;
    let fluctuates = plain.fit.disturbance.relative > LITTLE_ROUGHNESS;
    if fluctuates && names.iter().any(|name| name == STICTION) {
        return fit_each(data, model, names, true, progress);
    }
    Ok(plain)
}

fn fit_each(
    data: &Data,
    model: &ModelFile,
    names: &[String],
    to_breakaways: bool,
    progress: &mut dyn FnMut(&str),
) -> Result<Forced, AmendError> {
    progress("nominal parameters");
    let mut forced = Forced {
        fit: fit_base(data, Hypothesis::base(model)),
        data: data.clone(),
    };
    for name in names {
        let entry = entry(name).ok_or_else(|| AmendError::UnknownEffect(name.clone()))?;
        progress(entry.name);
        let breakaways = (to_breakaways && name == STICTION)
            .then(|| Breakaways::above_sliding(&forced.data, &forced.fit))
            .flatten();
        if let Some(breakaways) = breakaways {
            forced.fit = breakaways.stiction.1;
            forced.data = breakaways.told;
            continue;
        }
        let close_up = CloseUp::of(&forced.data, &forced.fit);
        let fitted = fit_named(&close_up, entry).ok_or_else(|| AmendError::NotApplicable {
            effect: name.clone(),
            reason: NOT_APPLICABLE,
        })?;
        forced.fit = not_stuck(&close_up, entry, fitted);
    }
    Ok(forced)
}

/// `fitted`, or the better one from every start where a law of many numbers does not explain the records and may have got stuck.
fn not_stuck(close_up: &CloseUp<'_>, entry: &Entry, fitted: Fit) -> Fit {
    if !entry.is_costly() || fitted.is_explained_but_rough(close_up.data) {
        return fitted;
    }
    match close_up.fit_entry_from_every_start(entry) {
        Some(another) if another.loss < fitted.loss => another,
        _ => fitted,
    }
}
