//! The instant at which a quantity known by its Taylor series reaches a vertical tangent.

use super::root::first_loss_of_sign;
use super::{TERMS, evaluate};

/// How far beyond a purely square-root-like tangent, which lies at 2, the inverse is searched.
const REACH: f64 = 4.0;
/// Largest share of the last terms of the inverse's slope at which its zero is trusted.
const CONVERGED: f64 = 0.05;

/// Where a quantity a(τ) has a vertical tangent.
#[derive(Clone, Debug)]
pub struct VerticalTangent {
    /// The quantity there.
    value: f64,
    /// Its distance from the start, in units of the slope there times `unit`.
    distance: f64,
    /// Slope at the start.
    slope: f64,
    /// The instant, if the tangent were purely square-root-like.
    unit: f64,
    order: usize,
    inverse: Inverse,
}

/// How τ_f, and the integral of a(τ) up to there, depend on the coefficients of a(τ).
#[derive(Clone, Copy, Debug)]
pub struct TangentWeights {
    /// ∂τ_f/∂a_k.
    pub instant: [f64; TERMS],
    /// Derivative by a_k of the integral.
    pub integral: [f64; TERMS],
}

impl VerticalTangent {
    /// The first τ > 0 at which a(τ), given by its coefficients, has a vertical tangent like
    /// a_f − c √(τ_f − τ); `None` if none is near enough to be told from the series.
    ///
    /// There the series of a does not converge any more, but that of the inverse function τ(a) does, and
    /// the tangent is a zero of dτ/da. Far from the tangent the inverse has not converged either; then
    /// `None` is the answer, and a later, nearer expansion gives the instant.
    pub fn first(coefficients: &[f64]) -> Option<Self> {
        let (&[start, slope, second, ..], order) = (coefficients, coefficients.len() - 1) else {
            return None;
        };
        let unit = slope / (4.0 * second);
        if !(unit > 0.0 && unit.is_finite()) {
            return None;
        }
        let mut scaled = [0.0; TERMS];
        let mut power = 1.0;
        for (s, c) in scaled.iter_mut().zip(coefficients).skip(1) {
            *s = c * power / slope;
            power *= unit;
        }
        let inverse = Inverse::of(&scaled[..=order]);
        let rate = inverse.rate(order);
        let distance = first_loss_of_sign(&rate[..order], REACH)?;
        let tail: f64 = [order - 2, order - 1]
            .iter()
            .map(|&k| (rate[k] * distance.powi(k as i32)).abs())
            .sum();
        (tail < CONVERGED).then_some(Self {
            value: start + slope * unit * distance,
            distance,
            slope,
            unit,
            order,
            inverse,
        })
    }

    /// Instant τ_f of the tangent.
    pub fn instant(&self) -> f64 {
        self.unit * evaluate(&self.inverse.powers[1][..=self.order], self.distance)
    }

    /// How instant and integral depend on the coefficients of a(τ).
    ///
    /// At a held value of a, τ changes by −δa(τ)/(da/dτ). Near the tangent both grow without bounds, but their ratio is analytic in a:
    /// its series in a is the product of those of δa(τ(a)) and dτ/da.
    pub fn weights(&self) -> TangentWeights {
        let (order, rate) = (self.order, self.inverse.rate(self.order));
        let mut weights = TangentWeights {
            instant: [0.0; TERMS],
            integral: [0.0; TERMS],
        };
        let mut power = -1.0;
        for k in 0..order {
            let (mut at_tangent, mut up_to_tangent) = (0.0, 0.0);
            let mut distance = 1.0;
            for m in 0..order {
                let product: f64 = (0..=m)
                    .map(|j| self.inverse.powers[k][j] * rate[m - j])
                    .sum();
                at_tangent += product * distance;
                distance *= self.distance;
                up_to_tangent += product * distance / (m + 1) as f64;
            }
            weights.instant[k] = power / self.slope * at_tangent;
            // ∫ a dτ = a τ − ∫ τ da.
            weights.integral[k] =
                self.value * weights.instant[k] - power * self.unit * up_to_tangent;
            power *= self.unit;
        }
        weights
    }
}

/// The inverse of Σ c_k τ^k with c_0 = 0 and c_1 = 1.
#[derive(Clone, Debug)]
struct Inverse {
    /// powers[j][k]: coefficient k of the inverse raised to j.
    powers: [[f64; TERMS]; TERMS],
}

impl Inverse {
    fn of(c: &[f64]) -> Self {
        let order = c.len() - 1;
        let mut powers = [[0.0; TERMS]; TERMS];
        powers[0][0] = 1.0;
        powers[1][1] = 1.0;
        for k in 2..=order {
            let mut sum = 0.0;
            for j in 2..=k {
                let mut term = 0.0;
                for i in 1..=k - j + 1 {
                    term += powers[1][i] * powers[j - 1][k - i];
                }
                powers[j][k] = term;
                sum += c[j] * term;
            }
            powers[1][k] = -sum;
        }
        Self { powers }
    }

    /// Coefficients up to `order` − 1 of the inverse's slope.
    fn rate(&self, order: usize) -> [f64; TERMS] {
        let mut rate = [0.0; TERMS];
        for k in 1..=order {
            rate[k - 1] = k as f64 * self.powers[1][k];
        }
        rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients of −√(τ_f − τ) + 0.7 (τ_f − τ) − 0.3 (τ_f − τ)^1.5 about τ = 0, each with its derivative by τ_f = `time`.
    fn with_slopes(time: f64) -> [(f64, f64); 22] {
        let mut series = [(0.0, 0.0); 22];
        for (exponent, factor) in [(0.5, -1.0), (1.0, 0.7), (1.5, -0.3)] {
            let mut c = factor * time.powf(exponent);
            for (k, (value, slope)) in series.iter_mut().enumerate() {
                let power = exponent - k as f64;
                *value += c;
                *slope += c * power / time;
                c *= -power / ((k + 1) as f64 * time);
            }
        }
        series
    }

    fn tangent_at(time: f64) -> [f64; 22] {
        with_slopes(time).map(|(value, _)| value)
    }

    #[test]
    fn finds_the_end_of_a_square_root() {
        for time in [1e-8, 1e-4, 1e-2] {
            let found = VerticalTangent::first(&tangent_at(time)).unwrap().instant();
            assert!((found / time - 1.0).abs() < 1e-9, "{found} against {time}");
        }
    }

    #[test]
    fn a_smooth_function_has_none() {
        let mut exponential = vec![1.0; 22];
        for k in 1..22 {
            exponential[k] = exponential[k - 1] / k as f64;
        }
        assert!(VerticalTangent::first(&exponential).is_none());
        let geometric = vec![1.0; 22];
        assert!(VerticalTangent::first(&geometric).is_none());
    }

    #[test]
    fn weights_are_the_derivatives_of_instant_and_integral() {
        let time = 1e-3_f64;
        let tangent = VerticalTangent::first(&tangent_at(time)).unwrap();
        let weights = tangent.weights();
        let sum = |weights: &[f64; TERMS]| {
            let pairs = with_slopes(time).into_iter().zip(weights);
            pairs
                .map(|((_, slope), weight)| slope * weight)
                .sum::<f64>()
        };
        let (instant, integral) = (sum(&weights.instant), sum(&weights.integral));
        // The integral is that of −√x + 0.7 x − 0.3 x^1.5 from 0 to τ_f.
        let expected = -time.sqrt() + 0.7 * time - 0.3 * time.powf(1.5);
        assert!((instant - 1.0).abs() < 1e-7, "{instant}");
        assert!(
            (integral / expected - 1.0).abs() < 1e-7,
            "{integral}, {expected}"
        );
    }
}
