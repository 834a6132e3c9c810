//! The first instant at which a polynomial loses its sign.

use super::TERMS;
use super::power_series::evaluate_derivative;

/// Bisections after which an interval counts as a point.
const DEPTH: u32 = 48;
/// Bisections after which it is asked whether a polynomial differs from zero by more than rounding: where it does not, no
/// bound decides an interval, and halving would go on for all 2^48 of them.
const FLAT_DEPTH: u32 = DEPTH - 8;
/// Rounding of a coefficient that was shifted through an expansion, in units of the polynomial's size.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The smallest τ in \[0, `width`\] at which a polynomial that starts positive becomes negative,
/// or `None` if it provably stays positive.
///
/// Intervals are discarded by a rigorous lower bound and halved otherwise, so that two roots close
/// to each other are never missed. A polynomial that starts at or below zero loses its sign at 0; one with a coefficient
/// that is not finite has no sign to lose.
pub fn first_loss_of_sign(coefficients: &[f64], width: f64) -> Option<f64> {
    let start = coefficients.first().copied().unwrap_or(0.0);
    if start <= 0.0 {
        return Some(0.0);
    }
    if !width.is_finite() || coefficients.iter().any(|c| !c.is_finite()) {
        return None;
    }
    search(
        coefficients,
        width,
        DEPTH,
        ROUNDING * size(coefficients, width),
    )
}

/// Bound of the polynomial's magnitude on \[0, `width`\].
fn size(p: &[f64], width: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * width + c.abs())
}

/// `rounding` is the magnitude below which the polynomial cannot be told from zero.
fn search(p: &[f64], width: f64, depth: u32, rounding: f64) -> Option<f64> {
    let (mut lower, mut steepest, mut power) = (p[0], p.get(1).copied().unwrap_or(0.0), width);
    for (k, &c) in p.iter().enumerate().skip(1) {
        lower += (c * power).min(0.0);
        if k >= 2 {
            steepest += (k as f64 * c * power / width).max(0.0);
        }
        power *= width;
    }
    if lower > 0.0 {
        return None;
    }
    if steepest < 0.0 {
        return if evaluate(p, width) > 0.0 {
            None
        } else {
            Some(bracketed_root(p, width))
        };
    }
    if depth == 0 || depth <= FLAT_DEPTH && size(p, width) <= rounding {
        return (evaluate(p, width) <= 0.0).then_some(width);
    }
    let half = 0.5 * width;
    if let Some(root) = search(p, half, depth - 1, rounding) {
        return Some(root);
    }
    let mut shifted = [0.0; TERMS];
    let shifted = &mut shifted[..p.len()];
    shifted.copy_from_slice(p);
    for first in 0..p.len() {
        for k in (first..p.len() - 1).rev() {
            shifted[k] += half * shifted[k + 1];
        }
    }
    if shifted[0] <= 0.0 {
        return Some(half);
    }
    search(shifted, half, depth - 1, rounding).map(|root| half + root)
}

/// Value by Horner's scheme in one chain: next to a root its rounding errors are the smallest.
fn evaluate(p: &[f64], tau: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * tau + c)
}

/// Newton's method kept inside a bracket on which the polynomial decreases through zero.
fn bracketed_root(p: &[f64], width: f64) -> f64 {
    let (mut low, mut high) = (0.0, width);
    let mut tau = width * p[0] / (p[0] - evaluate(p, width));
    for _ in 0..60 {
        let value = evaluate(p, tau);
        if value > 0.0 {
            low = tau
        } else {
            high = tau
        }
        let newton = tau - value / evaluate_derivative(p, tau);
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - tau).abs() <= 1e-16 * width {
            return next;
        }
        tau = next;
    }
    tau
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(roots: &[f64]) -> Vec<f64> {
        // Π (1 − τ/r): positive at 0.
        let mut p = vec![1.0];
        for r in roots {
            p.push(0.0);
            for k in (1..p.len()).rev() {
                p[k] -= p[k - 1] / r;
            }
        }
        p
    }

    #[test]
    fn finds_the_first_of_several_roots() {
        let p = polynomial(&[0.3, 0.300_01, 0.9]);
        let root = first_loss_of_sign(&p, 1.0).unwrap();
        // The slope at the root is 7e-5: rounding of the coefficients alone moves it by 5e-12.
        assert!((root - 0.3).abs() < 5e-11, "{root}");
    }

    #[test]
    fn does_not_take_a_near_miss_for_a_root() {
        // (1 − τ/0.5)² + 1e-9 stays positive.
        let mut p = polynomial(&[0.5, 0.5]);
        p[0] += 1e-9;
        assert_eq!(first_loss_of_sign(&p, 1.0), None);
    }

    #[test]
    fn a_root_of_high_multiplicity_ends_the_search() {
        // Flat within rounding over a twentieth of the interval: halving that to points would take years.
        let mut p = polynomial(&[0.5; 12]);
        let root = first_loss_of_sign(&p, 1.0);
        assert!(
            root.is_none_or(|root| (root - 0.5).abs() < 0.15),
            "{root:?}"
        );
        p[0] -= 1e-6;
        let crossing = 0.5 - 0.5 * 1e-6_f64.powf(1.0 / 12.0);
        let root = first_loss_of_sign(&p, 1.0).unwrap();
        assert!((root - crossing).abs() < 1e-5, "{root} {crossing}");
    }

    #[test]
    fn what_is_not_finite_has_no_sign_to_lose() {
        assert_eq!(first_loss_of_sign(&[f64::NAN, 1.0, -1.0], 1.0), None);
        assert_eq!(
            first_loss_of_sign(&[1.0, f64::NEG_INFINITY, 1.0], 1.0),
            None
        );
        assert_eq!(first_loss_of_sign(&[1.0, -2.0], f64::NAN), None);
    }

    #[test]
    fn root_outside_the_interval_is_not_reported() {
        assert_eq!(first_loss_of_sign(&polynomial(&[1.5]), 1.0), None);
    }
}
