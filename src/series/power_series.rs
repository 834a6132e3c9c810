//! Coefficient recurrences of truncated power series.

use super::Scalar;

/// Number of coefficients carried: orders 0 to `TERMS − 1`.
pub const TERMS: usize = 23;

/// Coefficients of a polynomial in local time, lowest order first.
pub type Series<S> = [S; TERMS];

/// 1/k for k < `TERMS` (entry 0 is unused and zero).
pub const RECIPROCAL: [f64; TERMS] = {
    let mut table = [0.0; TERMS];
    let mut k = 1;
    while k < TERMS {
        table[k] = 1.0 / k as f64;
        k += 1;
    }
    table
};

/// The polynomial with these coefficients about a centre that lies `tau` later.
pub fn shifted<const N: usize>(coefficients: &[f64; N], tau: f64) -> [f64; N] {
    let mut c = *coefficients;
    if c.iter().skip(1).any(|coefficient| *coefficient != 0.0) {
        for first in 0..N {
            for k in (first..N - 1).rev() {
                c[k] += tau * c[k + 1];
            }
        }
    }
    c
}

/// Σ a\[j\] b\[last − j\] over the whole of two slices of equal length.
#[inline(always)]
pub fn convolution<S: Scalar>(a: &[S], b: &[S]) -> S {
    S::convolution(a, b)
}

/// Coefficient `k` ≥ 1 of e = exp(q), from `weighted`\[j\] = j q\[j\] (j ≤ k) and e\[0..k\].
#[inline(always)]
pub fn exponential<S: Scalar>(k: usize, weighted: &Series<S>, e: &Series<S>) -> S {
    S::earlier_exponential(k, weighted, e) + weighted[k] * e[0] * RECIPROCAL[k]
}

/// Coefficients `k` ≥ 1 of (cos φ, sin φ) from `weighted`\[j\] = j φ\[j\] (j ≤ k).
#[inline(always)]
pub fn cosine_sine<S: Scalar>(
    k: usize,
    weighted: &Series<S>,
    cosine: &Series<S>,
    sine: &Series<S>,
) -> (S, S) {
    let c = -(convolution(&weighted[1..=k], &sine[..k]) * RECIPROCAL[k]);
    let s = convolution(&weighted[1..=k], &cosine[..k]) * RECIPROCAL[k];
    (c, s)
}

/// Value of the polynomial with these coefficients at `tau`.
#[inline(always)]
pub fn evaluate<S: Scalar>(coefficients: &[S], tau: S) -> S {
    S::polynomial(coefficients, tau)
}

/// A lower bound on \[0, `width`\] of the polynomial with these coefficients: the value that it
/// takes at `width` without its positive terms of order 1 and above.
#[inline(always)]
pub fn lower_bound<S: Scalar>(coefficients: &[S], width: f64) -> f64 {
    let square = width * width;
    let (mut even, mut odd) = (0.0, 0.0);
    let pairs = coefficients.chunks_exact(2);
    if let [last] = pairs.remainder() {
        even = last.value().min(0.0);
    }
    for pair in pairs.rev() {
        even = even * square + pair[0].value().min(0.0);
        odd = odd * square + pair[1].value().min(0.0);
    }
    let start = coefficients.first().map_or(0.0, |c| c.value().max(0.0));
    start + even + odd * width
}

/// First derivative of the polynomial with these coefficients at `tau`.
#[inline(always)]
pub fn evaluate_derivative<S: Scalar>(coefficients: &[S], tau: S) -> S {
    let mut sum = S::ZERO;
    for (k, &c) in coefficients.iter().enumerate().skip(1).rev() {
        sum = sum * tau + c * k as f64;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponential_of_a_polynomial() {
        // exp(0.3 + t − 0.5 t²) against direct evaluation at t = 0.2.
        let mut weighted = [0.0; TERMS];
        weighted[1] = 1.0;
        weighted[2] = -1.0;
        let mut e = [0.0; TERMS];
        e[0] = 0.3f64.exp();
        for k in 1..TERMS {
            e[k] = exponential(k, &weighted, &e);
        }
        let direct = (0.3f64 + 0.2 - 0.5 * 0.04).exp();
        assert!((evaluate(&e, 0.2) - direct).abs() < 1e-15);
    }

    #[test]
    fn cosine_and_sine_of_a_polynomial() {
        let mut weighted = [0.0; TERMS];
        weighted[1] = 2.0;
        weighted[3] = 3.0 * 0.7;
        let (mut c, mut s) = ([0.0; TERMS], [0.0; TERMS]);
        (s[0], c[0]) = (0.4f64.sin(), 0.4f64.cos());
        for k in 1..TERMS {
            (c[k], s[k]) = cosine_sine(k, &weighted, &c, &s);
        }
        let angle: f64 = 0.4 + 2.0 * 0.15 + 0.7 * 0.15f64.powi(3);
        assert!((evaluate(&c, 0.15) - angle.cos()).abs() < 1e-15);
        assert!((evaluate(&s, 0.15) - angle.sin()).abs() < 1e-15);
    }

    #[test]
    fn convolution_is_the_cauchy_product() {
        let a: Vec<f64> = (1..=11).map(f64::from).collect();
        let b: Vec<f64> = (1..=11).map(|j| f64::from(j * j)).collect();
        let expected: f64 = (0..11).map(|j| a[j] * b[10 - j]).sum();
        assert_eq!(convolution(&a, &b), expected);
    }
}
