//! How certain the numbers of a set's effects are.

use super::least_squares::{Fit, Interval};
use super::model::Model;
use super::motion::Scales;
use super::term::Entry;
use super::unit::Usual as _;
use crate::numbers::Number;
use crate::policy::SURELY;
use stickslip::parameter::Range;

/// How certain the numbers of a set's effects are.
pub struct Certainty {
    /// The effects whose size has zero in its 95 % interval, and those with widths all of which have, or lie beyond their range. Over a width
    /// beyond it nothing changes in the records, so that a plainer effect explains as much. A width that the plant passes between two
    /// samples is none either: it would draw how these lie about a jump. Where one is told, another may be too small for the records:
    /// friction that sets in at a known moment may do so at once. Of a law, all numbers must be told.
    pub unneeded: Vec<&'static str>,
    /// Log of the share of their usual values that places and widths may still have, by Laplace's method: what it costs that they could
    /// have been anything and must be just these.
    pub price: f64,
}

impl Certainty {
    /// Of these effects in a fit whose numbers have these intervals.
    #[must_use]
    pub fn of(scales: &Scales, fit: &Fit, known: &[Interval], entries: &[&'static Entry]) -> Self {
        let mut certainty = Self {
            unneeded: Vec::new(),
            price: 0.0,
        };
        for entry in entries {
            let terms = fit.model.terms();
            let Some(at) = terms.iter().position(|term| term.entry == *entry) else {
                continue;
            };
            let half_width = |number: usize| {
                let own = known
                    .iter()
                    .find(|own| (own.term, own.number) == (at, number));
                own.map(|own| own.half_width)
            };
            let differs = |number: usize, from: f64| {
                let distance = (terms[at].values[number] - from).abs();
                half_width(number).is_some_and(|half| half < distance)
            };
            let Model { kind, path, .. } = fit.model;
            let numbers = entry.numbers(kind, path, scales);
            let (mut sizes, mut widths, mut is_whole) = (Vec::new(), Vec::new(), true);
            for (number, parameter) in entry.parameters.iter().enumerate() {
                let is_positive = parameter.range == Range::Positive;
                match numbers.get(number) {
                    Some(Number::Amplitude { origin, .. }) => sizes.push(differs(number, *origin)),
                    Some(Number::Shape { scale, bounds, .. }) => {
                        let error = half_width(number).map_or(*scale, |half| half / SURELY);
                        certainty.price += (error / scale).min(1.0).ln();
                        let passed = parameter.dimension.in_a_sample(scales);
                        let is_within = (passed..bounds.1).contains(&terms[at].values[number]);
                        widths.extend(is_positive.then(|| is_within && differs(number, 0.0)));
                    }
                    Some(Number::Phase) => {}
                    None => is_whole &= !is_positive || differs(number, 0.0),
                }
            }
            let is_any_told = |numbers: &[bool]| numbers.is_empty() || numbers.contains(&true);
            if !(is_whole && is_any_told(&sizes) && is_any_told(&widths)) {
                certainty.unneeded.push(entry.name);
            }
        }
        certainty
    }
}
