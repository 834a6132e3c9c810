//! The records cut into short windows: where a model is so wrong that windows of the usual length go astray, short ones still
//! lead to the numbers that are nearest.

use super::catalogue::Entry;
use super::data::Data;
use super::fit::{Fit, fit};
use super::hypothesis::Hypothesis;
use super::robust::Robust;
use super::search::{entry_looks, every_look, first_look, thinning};
use super::window::SHORT;
use std::cell::OnceCell;

/// Short windows that are enough under a law with branches, where every start is followed.
const ENOUGH_SHORT_WINDOWS: usize = 150;

/// Steps after which it shows over short windows which start of an entry promises most.
const LOOK: usize = 2;
/// Steps within which a fit over short windows converges.
const TO_THE_END: usize = 20;
/// Starts, the most promising of all, that are followed to the end where the few of the first look have led to nothing.
const FOLLOWED: usize = 4;

/// A fitted model seen over short windows, to which it is fitted when that is first asked for.
pub struct CloseUp<'a> {
    /// The records in windows of the usual length.
    pub data: &'a Data,
    /// The model, fitted to those.
    pub base: &'a Fit,
    fitted: OnceCell<(Data, Fit)>,
}

impl<'a> CloseUp<'a> {
    /// `base`, which is fitted to the windows of `data`.
    pub fn of(data: &'a Data, base: &'a Fit) -> Self {
        Self {
            data,
            base,
            fitted: OnceCell::new(),
        }
    }

    /// A part of the short windows, and the model fitted to it.
    pub fn fitted(&self) -> (&Data, &Fit) {
        let (close, fitted) = self
            .fitted
            .get_or_init(|| close_up(self.data, &self.base.hypothesis));
        (close, fitted)
    }

    /// The best fit of one entry on top of the model: every start is looked at on the short windows, the best is fitted
    /// there and then to all windows of the usual length. `None` where the effect makes no sense.
    pub fn fit_entry(&self, entry: &Entry) -> Option<Fit> {
        let (close, from) = self.fitted();
        let best = entry_looks(close, from, entry, true)
            .into_iter()
            .map(|look| look.further(close, LOOK))
            .map(|look| (look.promised_loss(close), look))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, look)| look.further(close, TO_THE_END))?;
        Some(self.fit_from(best))
    }

    /// The same with no start left out: the most promising are all followed to the end.
    pub fn fit_entry_from_every_start(&self, entry: &Entry) -> Option<Fit> {
        let (close, from) = self.fitted();
        let mut looked: Vec<(f64, Fit)> = every_look(close, from, entry)
            .into_iter()
            .map(|look| look.further(close, LOOK))
            .map(|look| (look.promised_loss(close), look))
            .collect();
        looked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let best = looked
            .into_iter()
            .take(FOLLOWED)
            .map(|(_, look)| look.further(close, TO_THE_END))
            .min_by(|a, b| a.loss.total_cmp(&b.loss))?;
        Some(self.fit_from(best))
    }

    /// A fit over short windows, carried on over all windows of the usual length.
    fn fit_from(&self, close_fit: Fit) -> Fit {
        first_look(self.data, close_fit.hypothesis, self.base, true).further(self.data, 25)
    }
}

/// A part of the records cut into short windows, and `hypothesis` fitted to it.
pub fn close_up(data: &Data, hypothesis: &Hypothesis) -> (Data, Fit) {
    let close = data.recut(SHORT);
    let mut every = thinning(&close);
    if hypothesis.rig.law.has_branches() {
        every = every.max(close.windows.len() / ENOUGH_SHORT_WINDOWS);
    }
    let kept: Vec<usize> = (0..close.windows.len()).step_by(every).collect();
    let close = close.part(&kept);
    let fitted = fit(
        &close,
        hypothesis.clone(),
        close.anchors(),
        15,
        Robust::JUDGING,
    )
    .judged_by_itself(&close);
    (close, fitted)
}
