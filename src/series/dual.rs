//! Dual numbers: a value with its derivatives with respect to `N` quantities.

use super::Scalar;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A value and its `N` forward derivatives.
///
/// Because the instant of a switch is itself a dual number, the jump of the sensitivities at the
/// switch (the saltation matrix) follows from ordinary dual arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// The number itself.
    pub value: f64,
    /// Its derivatives.
    pub derivative: [f64; N],
}

/// The derivatives that `derivative` gives slot by slot; a plain loop, which the compiler
/// vectorises where it does not vectorise `array::from_fn`.
#[inline(always)]
fn each<const N: usize>(derivative: impl Fn(usize) -> f64) -> [f64; N] {
    let mut derivatives = [0.0; N];
    for (i, d) in derivatives.iter_mut().enumerate() {
        *d = derivative(i);
    }
    derivatives
}

impl<const N: usize> Dual<N> {
    /// The independent quantity number `slot`: derivative 1 with respect to itself.
    pub fn variable(value: f64, slot: usize) -> Self {
        let mut derivative = [0.0; N];
        derivative[slot] = 1.0;
        Self { value, derivative }
    }

    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self {
            value,
            derivative: each(|i| slope * self.derivative[i]),
        }
    }
}

impl<const N: usize> Scalar for Dual<N> {
    const ZERO: Self = Self {
        value: 0.0,
        derivative: [0.0; N],
    };
    const HAS_DERIVATIVES: bool = true;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self {
            value,
            derivative: [0.0; N],
        }
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }
    fn derivatives_vanish(differences: &[Self], reference: &[Self], tolerance: f64) -> bool {
        let largest = |numbers: &[Self], slot: usize| {
            numbers
                .iter()
                .fold(0.0_f64, |size, x| size.max(x.derivative[slot].abs()))
        };
        (0..N).all(|slot| largest(differences, slot) <= tolerance * largest(reference, slot))
    }
    fn exp(self) -> Self {
        let e = libm::exp(self.value);
        self.chain(e, e)
    }
    fn ln(self) -> Self {
        self.chain(libm::log(self.value), 1.0 / self.value)
    }
    fn sqrt(self) -> Self {
        let root = libm::sqrt(self.value);
        self.chain(root, 0.5 / root)
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = libm::sincos(self.value);
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    fn atan2(self, x: Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        let (along_y, along_x) = (x.value / square, -self.value / square);
        Self {
            value: libm::atan2(self.value, x.value),
            derivative: each(|i| along_y * self.derivative[i] + along_x * x.derivative[i]),
        }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            derivative: each(|i| self.derivative[i] + other.derivative[i]),
        }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            derivative: each(|i| self.derivative[i] - other.derivative[i]),
        }
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the product rule adds")]
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            derivative: each(|i| {
                self.derivative[i] * other.value + self.value * other.derivative[i]
            }),
        }
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let reciprocal = 1.0 / other.value;
        Self {
            value,
            derivative: each(|i| (self.derivative[i] - value * other.derivative[i]) * reciprocal),
        }
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            derivative: each(|i| -self.derivative[i]),
        }
    }
}

impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Self {
            value: self.value + other,
            derivative: self.derivative,
        }
    }
}

impl<const N: usize> Sub<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Self {
            value: self.value - other,
            derivative: self.derivative,
        }
    }
}

impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self.chain(self.value * other, other)
    }
}

impl<const N: usize> AddAssign for Dual<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.value += other.value;
        for i in 0..N {
            self.derivative[i] += other.derivative[i];
        }
    }
}

impl<const N: usize> SubAssign for Dual<N> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        self.value -= other.value;
        for i in 0..N {
            self.derivative[i] -= other.derivative[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_central_differences() {
        let function = |x: Dual<1>| {
            let (sin, cos) = (x * x).sin_cos();
            (sin.exp() / (cos + 2.0)).sqrt() + x.ln().atan2(x) - x.powf(x)
        };
        let (x, h) = (0.7, 1e-5);
        let derivative = function(Dual::variable(x, 0)).derivative[0];
        let difference = (function(Dual::constant(x + h)).value
            - function(Dual::constant(x - h)).value)
            / (2.0 * h);
        assert!(
            (derivative - difference).abs() < 1e-9,
            "{derivative} against {difference}"
        );
    }
}
