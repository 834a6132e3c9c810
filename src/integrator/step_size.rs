//! Length of a segment from the decay of its coefficients (Jorba and Zou 2005).

/// Natural logarithm of a positive number to about 1e-3: the step needs no more.
fn rough_ln(x: f64) -> f64 {
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as f64 - 1023.0;
    let m = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000);
    // Padé form of ln m on [1, 2).
    let z = (m - 1.0) / (m + 1.0);
    exponent * std::f64::consts::LN_2 + 2.0 * z * (1.0 + z * z * (1.0 / 3.0 + 0.2 * z * z))
}

/// Exponential of a number to about 1e-3.
fn rough_exp(x: f64) -> f64 {
    let doublings = (x * std::f64::consts::LOG2_E).clamp(-1022.0, 1022.0);
    let whole = libm::floor(doublings);
    let z = (doublings - whole) * std::f64::consts::LN_2;
    let m = 1.0 + z * (1.0 + z * (0.5 + z * (1.0 / 6.0 + z * (1.0 / 24.0))));
    m * f64::from_bits(((whole as i64 + 1023) as u64) << 52)
}

/// The longest step at which neither of the last two terms of a series exceeds the tolerance.
///
/// `last` and `before` are the largest |coefficient|/tolerance of orders `order` and `order` − 1.
pub(crate) fn from_last_terms(last: f64, before: f64, order: usize) -> f64 {
    let mut exponent = f64::INFINITY;
    if last > 0.0 {
        exponent = -rough_ln(last) / order as f64;
    }
    if before > 0.0 {
        exponent = exponent.min(-rough_ln(before) / (order - 1) as f64);
    }
    if exponent == f64::INFINITY {
        f64::INFINITY
    } else {
        rough_exp(exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn geometric_series_steps_to_the_tolerance() {
        // Coefficients 2^k: at order 20 the term (2h)^20 equals 1e-12.
        let h = from_last_terms(2f64.powi(20) / 1e-12, 0.0, 20);
        assert!(((2.0 * h).powi(20) / 1e-12 - 1.0).abs() < 0.05);
    }

    #[test]
    fn a_polynomial_may_step_for_ever() {
        assert_eq!(from_last_terms(0.0, 0.0, 20), f64::INFINITY);
    }
}
