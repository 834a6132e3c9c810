//! Numbers of a model that its author knows, with a standard deviation.

use super::model::Model;

/// A number that is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Place of its term in the model.
    pub term: usize,
    /// Its place among the term's numbers.
    pub number: usize,
    /// The number, as it is known.
    pub value: f64,
    /// Standard deviation with which it is known, above 0.
    pub deviation: f64,
}

/// By how many standard deviations a model's numbers differ from what is known of them.
#[must_use]
pub fn deviations(known: &[Known], model: &Model) -> Vec<f64> {
    known
        .iter()
        .map(|own| (model.value(own.term, own.number) - own.value) / own.deviation)
        .collect()
}

/// Sum of their squares: −2 ln of the prior's density, but for a constant.
#[must_use]
pub fn misfit(known: &[Known], model: &Model) -> f64 {
    deviations(known, model).iter().map(|own| own * own).sum()
}

/// How they grow with one of the numbers.
#[must_use]
pub fn slopes(known: &[Known], (term, number): (usize, usize)) -> Vec<f64> {
    let is_this = |own: &Known| (own.term, own.number) == (term, number);
    known
        .iter()
        .map(|own| f64::from(u8::from(is_this(own))) / own.deviation)
        .collect()
}
