//! The number types that a simulation can run on.

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
    /// Whether, for each quantity differentiated by, the derivatives of `differences` are at most
    /// `tolerance` × the largest derivative among `reference`. True for numbers without derivatives.
    fn derivatives_vanish(differences: &[Self], reference: &[Self], tolerance: f64) -> bool;
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
    fn derivatives_vanish(_: &[Self], _: &[Self], _: f64) -> bool {
        true
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
