//! The number types that a simulation can run on.

use super::power_series::RECIPROCAL;
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A real number: `f64` for plain runs, [`Dual`](super::Dual) for runs that carry derivatives.
///
/// Transcendental functions come from one portable implementation, so that a run gives the same
/// bits on every platform.
pub trait Scalar:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + AddAssign
    + SubAssign
{
    /// The number zero with zero derivatives.
    const ZERO: Self;
    /// Whether the number carries derivatives.
    const HAS_DERIVATIVES: bool;

    /// A number whose derivatives are zero.
    fn constant(value: f64) -> Self;
    /// The number without its derivatives.
    fn value(self) -> f64;
    /// Raises each derivative to `factor` × the size of that of `number` if it is smaller: a way to the
    /// largest sizes among several numbers.
    fn enlarge(&mut self, factor: f64, number: &Self);
    /// The largest of the derivatives over those of `whole`, all of them sizes; zero where both are, and
    /// for numbers without derivatives.
    fn largest_share(&self, whole: &Self) -> f64;
    /// Number of quantities differentiated by.
    const SLOTS: usize;
    /// Derivative with respect to quantity number `slot`.
    fn slot(&self, slot: usize) -> f64;
    /// Adds to the derivative with respect to quantity number `slot`.
    fn add_to_slot(&mut self, slot: usize, amount: f64);
    /// Whether any derivative differs from zero.
    fn varies(&self) -> bool {
        (0..Self::SLOTS).any(|slot| self.slot(slot) != 0.0)
    }
    /// The same derivatives with another value.
    fn with_value(self, value: f64) -> Self;
    /// Replaces the value and keeps the derivatives.
    fn set_value(&mut self, value: f64);
    /// The derivatives of Σ factor × number, the factors held; the value is left zero.
    fn combined<const M: usize>(terms: [(f64, &Self); M]) -> Self;
    /// As [`Self::combined`] for two slices of equal length.
    fn weighted(factors: &[f64], numbers: &[Self]) -> Self;
    /// As [`Self::combined`] for Σ factors\[last − j\] numbers\[j\].
    fn filtered(factors: &[f64], numbers: &[Self]) -> Self;
    /// Σ a\[j\] b\[last − j\] over the whole of two slices of equal length.
    fn convolution(a: &[Self], b: &[Self]) -> Self;
    /// Σ weighted\[j\] e\[k − j\]/k over 0 < j < k: coefficient `k` of e = exp(q), where
    /// `weighted`\[j\] = j q\[j\], short of its one term in q\[k\].
    fn earlier_exponential(k: usize, weighted: &[Self], e: &[Self]) -> Self;
    /// Value of the polynomial with these coefficients, at most [`TERMS`](super::TERMS) of them, at `tau`.
    fn polynomial(coefficients: &[Self], tau: Self) -> Self;
    /// Natural exponential.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    /// Four-quadrant angle of the point (`x`, `self`) in (−π, π].
    fn atan2(self, x: Self) -> Self;

    /// `self` raised to `exponent`, for positive `self`.
    fn powf(self, exponent: Self) -> Self {
        (exponent * self.ln()).exp()
    }
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;
    const HAS_DERIVATIVES: bool = false;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self
    }
    #[inline(always)]
    fn enlarge(&mut self, _: f64, _: &Self) {}
    #[inline(always)]
    fn largest_share(&self, _: &Self) -> f64 {
        0.0
    }
    const SLOTS: usize = 0;
    #[inline(always)]
    fn slot(&self, _: usize) -> f64 {
        0.0
    }
    #[inline(always)]
    fn add_to_slot(&mut self, _: usize, _: f64) {}
    #[inline(always)]
    fn with_value(self, value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn set_value(&mut self, value: f64) {
        *self = value;
    }
    #[inline(always)]
    fn combined<const M: usize>(_: [(f64, &Self); M]) -> Self {
        0.0
    }
    #[inline(always)]
    fn weighted(_: &[f64], _: &[Self]) -> Self {
        0.0
    }
    #[inline(always)]
    fn filtered(_: &[f64], _: &[Self]) -> Self {
        0.0
    }
    #[inline(always)]
    fn convolution(a: &[Self], b: &[Self]) -> Self {
        // Four accumulators: the sum is otherwise bound by the latency of the addition.
        let n = a.len().min(b.len());
        let (a, b) = (&a[..n], &b[..n]);
        let mut sums = [0.0; 4];
        let mut j = 0;
        while j + 4 <= n {
            sums[0] += a[j] * b[n - 1 - j];
            sums[1] += a[j + 1] * b[n - 2 - j];
            sums[2] += a[j + 2] * b[n - 3 - j];
            sums[3] += a[j + 3] * b[n - 4 - j];
            j += 4;
        }
        while j < n {
            sums[0] += a[j] * b[n - 1 - j];
            j += 1;
        }
        (sums[0] + sums[1]) + (sums[2] + sums[3])
    }
    #[inline(always)]
    fn earlier_exponential(k: usize, weighted: &[Self], e: &[Self]) -> Self {
        Self::convolution(&weighted[1..k], &e[1..k]) * RECIPROCAL[k]
    }
    #[inline(always)]
    fn polynomial(coefficients: &[Self], tau: Self) -> Self {
        // Even and odd powers side by side, as one chain of Horner's scheme waits on itself.
        let square = tau * tau;
        let (mut even, mut odd) = (0.0, 0.0);
        let pairs = coefficients.chunks_exact(2);
        if let [last] = pairs.remainder() {
            even = *last;
        }
        for pair in pairs.rev() {
            even = even * square + pair[0];
            odd = odd * square + pair[1];
        }
        even + odd * tau
    }
    #[inline]
    fn exp(self) -> Self {
        libm::exp(self)
    }
    #[inline]
    fn ln(self) -> Self {
        libm::log(self)
    }
    #[inline]
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        libm::atan2(self, x)
    }
}
