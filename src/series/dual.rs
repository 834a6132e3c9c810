//! Dual numbers: a value with its derivatives with respect to `N` quantities.

use super::Scalar;
use super::power_series::{RECIPROCAL, TERMS, evaluate_derivative};
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

/// Σ over j < `count` of the products factor × derivatives that `terms` gives, a few slots at a time
/// so that their sums stay in registers.
#[inline(always)]
fn weighted_sum<'a, const N: usize, const M: usize>(
    count: usize,
    terms: impl Fn(usize) -> [(f64, &'a [f64; N]); M],
) -> [f64; N] {
    let mut sums = [0.0; N];
    let (eights, rest) = sums.as_chunks_mut::<8>();
    let done = 8 * eights.len();
    for (block, sum) in eights.iter_mut().enumerate() {
        *sum = block_sum(
            count,
            |j, m| {
                let (factor, derivatives) = terms(j)[m];
                (factor, &derivatives.as_chunks::<8>().0[block])
            },
            M,
        );
    }
    let (fours, ones) = rest.as_chunks_mut::<4>();
    let left = ones.len();
    for sum in fours.iter_mut() {
        *sum = block_sum(
            count,
            |j, m| {
                let (factor, derivatives) = terms(j)[m];
                (factor, &derivatives[done..].as_chunks::<4>().0[0])
            },
            M,
        );
    }
    for (place, sum) in ones.iter_mut().enumerate() {
        let slot = N - left + place;
        for j in 0..count {
            for (factor, derivatives) in terms(j) {
                *sum += factor * derivatives[slot];
            }
        }
    }
    sums
}

/// Σ over j < `count` and m < `products` of factor × derivatives. The first products start the sums, as
/// adding to zeros costs as much as any other addition.
#[inline(always)]
fn block_sum<'a, const W: usize>(
    count: usize,
    term: impl Fn(usize, usize) -> (f64, &'a [f64; W]),
    products: usize,
) -> [f64; W] {
    let product = |j: usize| {
        let (factor, derivatives) = term(j, 0);
        let mut now = [0.0; W];
        for (now, derivative) in now.iter_mut().zip(derivatives) {
            *now = factor * derivative;
        }
        for m in 1..products {
            let (factor, derivatives) = term(j, m);
            for (now, derivative) in now.iter_mut().zip(derivatives) {
                *now += factor * derivative;
            }
        }
        now
    };
    if count == 0 {
        return [0.0; W];
    }
    let mut sums = product(0);
    for j in 1..count {
        for (sum, now) in sums.iter_mut().zip(product(j)) {
            *sum += now;
        }
    }
    sums
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
    #[inline(always)]
    fn enlarge(&mut self, factor: f64, number: &Self) {
        for (size, d) in self.derivative.iter_mut().zip(&number.derivative) {
            let other = factor * d.abs();
            *size = if other > *size { other } else { *size };
        }
    }
    fn largest_share(&self, whole: &Self) -> f64 {
        let mut share = 0.0_f64;
        for (size, whole) in self.derivative.iter().zip(&whole.derivative) {
            if *size > 0.0 {
                share = share.max(size / whole);
            }
        }
        share
    }
    const SLOTS: usize = N;
    #[inline(always)]
    fn slot(&self, slot: usize) -> f64 {
        self.derivative[slot]
    }
    #[inline(always)]
    fn add_to_slot(&mut self, slot: usize, amount: f64) {
        self.derivative[slot] += amount;
    }
    #[inline(always)]
    fn varies(&self) -> bool {
        self.derivative != [0.0; N]
    }
    #[inline(always)]
    fn with_value(self, value: f64) -> Self {
        Self {
            value,
            derivative: self.derivative,
        }
    }
    #[inline(always)]
    fn set_value(&mut self, value: f64) {
        self.value = value;
    }
    #[inline(always)]
    fn combined<const M: usize>(terms: [(f64, &Self); M]) -> Self {
        Self {
            value: 0.0,
            derivative: weighted_sum(M, |j| [(terms[j].0, &terms[j].1.derivative)]),
        }
    }
    #[inline(always)]
    fn weighted(factors: &[f64], numbers: &[Self]) -> Self {
        let n = factors.len().min(numbers.len());
        let (factors, numbers) = (&factors[..n], &numbers[..n]);
        Self {
            value: 0.0,
            derivative: weighted_sum(n, |j| [(factors[j], &numbers[j].derivative)]),
        }
    }
    #[inline(always)]
    fn filtered(factors: &[f64], numbers: &[Self]) -> Self {
        let n = factors.len().min(numbers.len());
        let (factors, numbers) = (&factors[..n], &numbers[..n]);
        Self {
            value: 0.0,
            derivative: weighted_sum(n, |j| [(factors[n - 1 - j], &numbers[j].derivative)]),
        }
    }
    #[inline]
    fn convolution(a: &[Self], b: &[Self]) -> Self {
        let n = a.len().min(b.len());
        let (a, b) = (&a[..n], &b[..n]);
        let mut sums = [0.0; 4];
        for j in 0..n {
            sums[j % 4] += a[j].value * b[n - 1 - j].value;
        }
        Self {
            value: (sums[0] + sums[1]) + (sums[2] + sums[3]),
            derivative: weighted_sum(n, |j| {
                let (a, b) = (&a[j], &b[n - 1 - j]);
                [(b.value, &a.derivative), (a.value, &b.derivative)]
            }),
        }
    }
    /// Since d exp(q) = exp(q) dq, one product per term does where differentiating the sum takes two.
    #[inline]
    fn earlier_exponential(k: usize, weighted: &[Self], e: &[Self]) -> Self {
        if e[0].value == 0.0 {
            return Self::convolution(&weighted[1..k], &e[1..k]) * RECIPROCAL[k];
        }
        let (weighted, e) = (&weighted[..k], &e[..k]);
        let mut value = 0.0;
        for j in 1..k {
            value += weighted[j].value * e[k - j].value;
        }
        value *= RECIPROCAL[k];
        let mut derivative = weighted_sum(k.max(1) - 1, |j| {
            let j = j + 1;
            [(e[k - j].value * RECIPROCAL[j], &weighted[j].derivative)]
        });
        // The derivatives of the leading coefficient move all others in proportion.
        let share = value / e[0].value;
        for (sum, first) in derivative.iter_mut().zip(&e[0].derivative) {
            *sum += share * first;
        }
        Self { value, derivative }
    }
    #[inline]
    fn polynomial(coefficients: &[Self], tau: Self) -> Self {
        let n = coefficients.len().min(TERMS);
        let mut plain = [0.0; TERMS];
        for (plain, c) in plain.iter_mut().zip(coefficients) {
            *plain = c.value;
        }
        // Few of the last orders carry derivatives where these are computed apart.
        let mut carried = n;
        while carried > 0 && coefficients[carried - 1].derivative == [0.0; N] {
            carried -= 1;
        }
        let square = tau.value * tau.value;
        let mut powers = [1.0; TERMS];
        powers[1] = tau.value;
        for k in 2..carried {
            powers[k] = powers[k - 2] * square;
        }
        let mut derivative = weighted_sum(carried, |k| [(powers[k], &coefficients[k].derivative)]);
        if tau.varies() {
            let slope = evaluate_derivative(&plain[..n], tau.value);
            for (sum, shift) in derivative.iter_mut().zip(&tau.derivative) {
                *sum += slope * shift;
            }
        }
        Self {
            value: f64::polynomial(&plain[..n], tau.value),
            derivative,
        }
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
