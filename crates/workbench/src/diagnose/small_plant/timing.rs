//! When force or voltage takes effect, within a sampling interval.
//!
//! A controller holds its output between its own samples, so that the motion of a drive or joint lags behind the column by a part of a
//! sample. That belongs to the records, as the instruments do, and is no effect of the plant.

use super::case::SmallCase;
use super::showing::balance;
use crate::diagnose::console::number;
use crate::diagnose::finding::FoundEffect;
use inference::body::evidence::Errors;
use inference::body::least_squares::Fit;
use inference::body::naming::{Naming, fit_base};
use inference::body::problem::square;
use inference::policy::{LN_PRIOR_ODDS, sure_odds};
use stickslip::body::Kind;

/// The effect of readings that come late.
const DELAY: &str = "sensor_delay";

impl SmallCase {
    /// The case where force or voltage takes effect this share of a sampling interval later than it stands in the records.
    #[must_use]
    pub fn driven_later(&self, share: f64) -> Self {
        let records = self.records.iter();
        Self {
            records: records.map(|own| own.driven_later(share)).collect(),
            held_out: self.held_out.driven_later(share),
            driven_later: share,
            ..self.clone()
        }
    }
}

/// The share of a sampling interval, up to one half, by which force or voltage takes effect later or earlier, where that explains the
/// records better: surely so beside what was named, or more likely than the delay that stands in for it.
pub fn share_of_a_sample(case: &SmallCase, naming: &Naming) -> Option<f64> {
    if !matches!(case.kind(), Kind::Drive | Kind::Joint) {
        return None;
    }
    let best = naming.best();
    let stands_in = best.names.contains(&DELAY);
    let (model, prior, least) = match stands_in {
        true => (best.fit.model.without_effect(DELAY), -LN_PRIOR_ODDS, 0.0),
        false => (best.fit.model.clone(), 0.0, sure_odds()),
    };
    let fitted = |case: &SmallCase| fit_base(&balance(case), &model, &case.scales);
    let misfit = |share: f64| square(&fitted(&case.driven_later(share)).residuals);
    // Residuals go straight with the share, so that their squares lie on a parabola.
    let [before, none, after] = [-0.5, 0.0, 0.5].map(misfit);
    let bend = before - 2.0 * none + after;
    let share = (0.25 * (before - after) / bend).clamp(-0.5, 0.5);
    let errors = |case: &SmallCase, fit: &Fit| Errors::left_out(&balance(case), fit, &case.scales);
    let moved = case.driven_later(share);
    let own = fit_base(&balance(case), &best.fit.model, &case.scales);
    let gain = errors(&moved, &fitted(&moved)).gain_over(&errors(case, &own));
    (bend > 0.0 && gain.odds(prior) > least).then_some(share)
}

/// What is said where force or voltage was read later or earlier by a share of a sampling interval.
#[must_use]
pub fn taking_effect(share: f64) -> Option<String> {
    (share != 0.0).then(|| {
        format!(
            "what drives the plant takes effect {:.2} of a sampling interval {} its reading, as where a controller holds it; it was read so",
            share.abs(),
            if share > 0.0 { "after" } else { "before" }
        )
    })
}

/// What else a delay of less than a sample may be.
#[must_use]
pub fn within_a_sample(case: &SmallCase, effects: &[FoundEffect]) -> Option<String> {
    let delay = effects.iter().find(|own| own.name == DELAY)?;
    let delay = delay.parameters.get("delay")?.value;
    let interval = case.records.first()?.interval;
    (delay.abs() <= interval).then(|| {
        format!(
            "the delay is {} of the sampling interval of {} s; a force that is held from one sample to the next, or readings at other instants within it, look the same",
            number(delay / interval),
            number(interval)
        )
    })
}
