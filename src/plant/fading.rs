//! What is left of fast transients in the derivatives of a segment on the slow manifold.
//!
//! Derivatives obey linear equations, so that a motion on the manifold may carry derivatives that are not: the part of them
//! beside the manifold stays in the fast directions and fades as exp(A_f t), which stands here in closed form. A Taylor series
//! would have to follow it in steps of the motor's time constant.

use super::STATES;
use super::index::{CURRENT, OMEGA, OMEGA1, OMEGA3, THETA, THETA1, THETA3};
use super::slow_manifold::{self, DISC, DISC_1, MOTOR, SlowManifold, TWIST, TWIST_1};
use crate::series::Scalar;

type Matrix = [[f64; 2]; 2];

/// Exponent beyond which what fades is below the rounding of what it started from: e⁻⁴⁰ = 4e-18.
const FADED: f64 = 40.0;
/// Square of the angle z below which cosh √z and sinh √z/√z are summed as series, where their quotients lose digits.
const SMALL: f64 = 1.0;
/// Terms of these series: the tenth is at most 1/18! = 2e-16.
const SERIES_TERMS: usize = 9;

/// Derivatives beside the slow manifold, as a function of the time since the segment's start.
#[derive(Clone, Debug)]
pub(super) struct Fading<S> {
    /// What the fast variables have of it at the start; derivatives only.
    amplitude: [S; 2],
    /// A_f.
    fast: Matrix,
    /// How each state follows the fast variables.
    rows: [[f64; 2]; STATES],
    /// Time [s] after which nothing is left.
    lifetime: f64,
}

impl<S: Scalar> Fading<S> {
    pub fn new<const N: usize>(
        amplitude: [S; 2],
        manifold: &SlowManifold<f64, N>,
        fast: &Matrix,
        following: &Matrix,
    ) -> Self {
        let h = &manifold.slow_from_fast;
        let mut rows = [[0.0; 2]; STATES];
        rows[OMEGA] = h[DISC];
        rows[OMEGA3] = following[MOTOR];
        rows[CURRENT] = following[slow_manifold::CURRENT];
        // An angle is the integral of its velocity that vanishes in the end.
        rows[THETA] = times(&h[DISC], &manifold.fast_inverse);
        let sum = |a: &[f64; 2], sign: f64, b: &[f64; 2]| [a[0] + sign * b[0], a[1] + sign * b[1]];
        rows[THETA3] = sum(&rows[THETA], -1.0, &h[TWIST]);
        if N > DISC_1 {
            rows[OMEGA1] = h[DISC_1];
            rows[THETA1] = sum(&rows[THETA], 1.0, &h[TWIST_1]);
        }
        let (mean, square) = mean_and_square(fast);
        let slowest = -mean - libm::sqrt(square.max(0.0));
        Self {
            amplitude,
            fast: *fast,
            rows,
            lifetime: FADED / slowest,
        }
    }

    /// What the fast variables have of it at the start.
    pub fn amplitude(&self) -> &[S; 2] {
        &self.amplitude
    }

    /// Its share in state number `index` at local time `tau` [s].
    pub fn at(&self, index: usize, tau: f64) -> S {
        if tau > self.lifetime {
            return S::ZERO;
        }
        self.seen_by(&times(&self.rows[index], &exponential(&self.fast, tau)))
    }

    /// The same of the state's rate.
    pub fn rate_at(&self, index: usize, tau: f64) -> S {
        if tau > self.lifetime {
            return S::ZERO;
        }
        let rate = times(&self.rows[index], &self.fast);
        self.seen_by(&times(&rate, &exponential(&self.fast, tau)))
    }

    fn seen_by(&self, row: &[f64; 2]) -> S {
        let [first, second] = &self.amplitude;
        S::combined([(row[0], first), (row[1], second)])
    }
}

fn times(row: &[f64; 2], matrix: &Matrix) -> [f64; 2] {
    std::array::from_fn(|j| row[0] * matrix[0][j] + row[1] * matrix[1][j])
}

/// Mean m of the eigenvalues m ± √z, and z.
fn mean_and_square(matrix: &Matrix) -> (f64, f64) {
    let mean = 0.5 * (matrix[0][0] + matrix[1][1]);
    let half = 0.5 * (matrix[0][0] - matrix[1][1]);
    (mean, half * half + matrix[0][1] * matrix[1][0])
}

/// exp(`matrix` `t`) = e^(m t) (c + s (`matrix` − m) t) with c = cosh √z t and s = sinh √z t/√z t; circular functions where z < 0.
fn exponential(matrix: &Matrix, t: f64) -> Matrix {
    let (mean, square) = mean_and_square(matrix);
    let square_angle = square * t * t;
    let (even, odd) = if square_angle.abs() < SMALL {
        let scale = libm::exp(mean * t);
        let (mut even, mut odd, mut term) = (0.0, 0.0, 1.0);
        for j in 0..SERIES_TERMS {
            even += term;
            term /= (2 * j + 1) as f64;
            odd += term;
            term *= square_angle / (2 * j + 2) as f64;
        }
        (scale * even, scale * odd)
    } else if square_angle > 0.0 {
        // Both exponentials apart: their sum may be small where each factor is not.
        let angle = libm::sqrt(square_angle);
        let (slow, fast) = (libm::exp(mean * t + angle), libm::exp(mean * t - angle));
        (0.5 * (slow + fast), 0.5 * (slow - fast) / angle)
    } else {
        let angle = libm::sqrt(-square_angle);
        let (sin, cos) = libm::sincos(angle);
        let scale = libm::exp(mean * t);
        (scale * cos, scale * sin / angle)
    };
    let mut exponential = *matrix;
    for (i, row) in exponential.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            let own = if i == j { *entry - mean } else { *entry };
            *entry = odd * own * t + if i == j { even } else { 0.0 };
        }
    }
    exponential
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_its_series() {
        let matrices = [
            [[-3.0, 1.0], [2.0, -4.0]],
            [[-1.0, 5.0], [-7.0, -2.0]],
            [[-2.0, 0.0], [0.3, -2.0]],
        ];
        for matrix in &matrices {
            for t in [0.01, 0.3, 1.0] {
                let mut sum = [[1.0, 0.0], [0.0, 1.0]];
                let mut term = sum;
                for j in 1..120 {
                    let scale = t / j as f64;
                    term = term.map(|row| times(&row, matrix).map(|x| x * scale));
                    for (sum, term) in sum.iter_mut().flatten().zip(term.iter().flatten()) {
                        *sum += term;
                    }
                }
                let found = exponential(matrix, t);
                for (found, sum) in found.iter().flatten().zip(sum.iter().flatten()) {
                    assert!((found - sum).abs() < 1e-12, "{matrix:?} {t}: {found} {sum}");
                }
            }
        }
    }
}
