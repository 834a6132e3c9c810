//! The instant at which a quantity known by its Taylor series reaches a vertical tangent.

use super::TERMS;
use super::root::first_loss_of_sign;

/// How far beyond a purely square-root-like tangent, which lies at 2, the inverse is searched.
const REACH: f64 = 4.0;
/// Largest share of the last terms of the inverse's slope at which its zero is trusted.
const CONVERGED: f64 = 0.05;

/// The first τ > 0 at which a(τ), given by its coefficients, has a vertical tangent like
/// a_f − c √(τ_f − τ); `None` if none is near enough to be told from the series.
///
/// There the series of a does not converge any more, but that of the inverse function τ(a) does, and
/// the tangent is a zero of dτ/da. Far from the tangent the inverse has not converged either; then
/// `None` is the answer, and a later, nearer expansion gives the instant.
pub fn first_vertical_tangent(coefficients: &[f64]) -> Option<f64> {
    let (&[_, first, second, ..], order) = (coefficients, coefficients.len() - 1) else {
        return None;
    };
    // Time in units of the distance of a purely square-root-like tangent.
    let unit = first / (4.0 * second);
    if !(unit > 0.0 && unit.is_finite()) {
        return None;
    }
    let mut scaled = [0.0; TERMS];
    let mut power = 1.0;
    for (s, c) in scaled.iter_mut().zip(coefficients).skip(1) {
        *s = c * power / first;
        power *= unit;
    }
    let inverse = reversed(&scaled[..=order]);
    let mut slope = [0.0; TERMS];
    for k in 1..=order {
        slope[k - 1] = k as f64 * inverse[k];
    }
    let slope = &slope[..order];
    let reached = first_loss_of_sign(slope, REACH)?;
    let tail: f64 = [order - 2, order - 1]
        .iter()
        .map(|&k| (slope[k] * reached.powi(k as i32)).abs())
        .sum();
    (tail < CONVERGED).then(|| unit * super::evaluate(&inverse[..=order], reached))
}

/// Coefficients of the inverse of Σ c_k τ^k with c_0 = 0 and c_1 = 1.
fn reversed(c: &[f64]) -> [f64; TERMS] {
    let order = c.len() - 1;
    let mut inverse = [0.0; TERMS];
    inverse[1] = 1.0;
    // powers[j][k]: coefficient k of the inverse raised to j.
    let mut powers = [[0.0; TERMS]; TERMS];
    powers[1][1] = 1.0;
    for k in 2..=order {
        let mut sum = 0.0;
        for j in 2..=k {
            let mut term = 0.0;
            for i in 1..k {
                term += inverse[i] * powers[j - 1][k - i];
            }
            powers[j][k] = term;
            sum += c[j] * term;
        }
        inverse[k] = -sum;
        powers[1][k] = -sum;
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients of p − √(τ_f − τ) + q (τ_f − τ) − 0.3 (τ_f − τ)^1.5 about τ = 0.
    fn tangent_at(time: f64) -> Vec<f64> {
        let mut series = vec![0.0; 22];
        for (exponent, factor) in [(0.5, -1.0), (1.0, 0.7), (1.5, -0.3)] {
            let mut c = factor * time.powf(exponent);
            for (k, s) in series.iter_mut().enumerate() {
                *s += c;
                c *= -(exponent - k as f64) / ((k + 1) as f64 * time);
            }
        }
        series
    }

    #[test]
    fn finds_the_end_of_a_square_root() {
        for time in [1e-8, 1e-4, 1e-2] {
            let found = first_vertical_tangent(&tangent_at(time)).unwrap();
            assert!((found / time - 1.0).abs() < 1e-9, "{found} against {time}");
        }
    }

    #[test]
    fn a_smooth_function_has_none() {
        let mut exponential = vec![1.0; 22];
        for k in 1..22 {
            exponential[k] = exponential[k - 1] / k as f64;
        }
        assert_eq!(first_vertical_tangent(&exponential), None);
        let geometric = vec![1.0; 22];
        assert_eq!(first_vertical_tangent(&geometric), None);
    }
}
