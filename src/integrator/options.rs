//! How a run is computed.

use crate::series::TERMS;
use std::ops::RangeInclusive;

/// Orders that the recurrences can carry: they write one coefficient beyond the last.
pub(super) const ORDERS: RangeInclusive<usize> = 4..=TERMS - 2;

/// How a run is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Local error of a segment, absolute for angles (rad), relative to 1 + |x| for the rest.
    pub tolerance: f64,
    /// Order of the Taylor polynomials, 4 to `TERMS` − 2.
    pub order: usize,
    /// Longest segment [s].
    pub longest_step: f64,
    /// Segments that one call may spend.
    pub budget: u64,
}

impl Options {
    /// The tolerance of a run that asks for none; the FMUs state it in their default experiment.
    pub const DEFAULT_TOLERANCE: f64 = 1e-10;
}

impl Default for Options {
    fn default() -> Self {
        Self {
            tolerance: Self::DEFAULT_TOLERANCE,
            order: 21,
            longest_step: 1.0,
            budget: 50_000_000,
        }
    }
}
