//! Two Gaussians through points over the phase-plane angle (Figs 6.2, 6.3, 6.8, 6.9).

use std::f64::consts::PI;

use super::local_polynomial::solve;

/// a1 exp(−((α − b1)/c1)²) + a2 exp(−((α − b2)/c2)²).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoGaussians {
    /// a1, b1, c1, a2, b2, c2.
    pub parameters: [f64; 6],
}

impl TwoGaussians {
    /// Value at the angle α [rad].
    #[must_use]
    pub fn at(&self, angle: f64) -> f64 {
        let [a1, b1, c1, a2, b2, c2] = self.parameters;
        a1 * (-((angle - b1) / c1).powi(2)).exp() + a2 * (-((angle - b2) / c2).powi(2)).exp()
    }

    fn gradient(&self, angle: f64) -> [f64; 6] {
        let mut gradient = [0.0; 6];
        for (part, slots) in self
            .parameters
            .chunks_exact(3)
            .zip(gradient.chunks_exact_mut(3))
        {
            let distance = (angle - part[1]) / part[2];
            let bell = (-distance * distance).exp();
            slots[0] = bell;
            slots[1] = part[0] * bell * 2.0 * distance / part[2];
            slots[2] = part[0] * bell * 2.0 * distance * distance / part[2];
        }
        gradient
    }

    fn cost(&self, angle: &[f64], value: &[f64]) -> f64 {
        angle
            .iter()
            .zip(value)
            .map(|(x, y)| (y - self.at(*x)).powi(2))
            .sum()
    }

    /// Root mean square distance from points.
    #[must_use]
    pub fn residual(&self, angle: &[f64], value: &[f64]) -> f64 {
        (self.cost(angle, value) / angle.len() as f64).sqrt()
    }

    /// The best fit with heights up to twice the highest value, from several starts by Levenberg and Marquardt's method; `None` with fewer than seven points.
    #[must_use]
    pub fn fit(angle: &[f64], value: &[f64]) -> Option<Self> {
        if angle.len() < 7 || angle.len() != value.len() {
            return None;
        }
        let highest = value.iter().fold(f64::NEG_INFINITY, |high, y| high.max(*y));
        let mut best: Option<(f64, Self)> = None;
        for first in [-3.0, -1.5, 0.0] {
            for second in [0.5, 1.5, 3.0] {
                for width in [1.0, 2.5] {
                    let start = Self {
                        parameters: [0.5 * highest, first, width, 0.5 * highest, second, width],
                    };
                    let (cost, found) = start.improve(2.0 * highest, angle, value);
                    if best.is_none_or(|(least, _)| cost < least) {
                        best = Some((cost, found));
                    }
                }
            }
        }
        best.map(|(_, found)| found)
    }

    /// Keeps peaks within a radian of −π … π, widths from 0.05 to 2π and heights from 0 to `height`: without bounds, two
    /// Gaussians far outside the range imitate any smooth curve and the parameters mean nothing.
    fn confine(&mut self, height: f64) {
        for part in self.parameters.chunks_exact_mut(3) {
            part[0] = part[0].clamp(0.0, height);
            part[1] = part[1].clamp(-PI - 1.0, PI + 1.0);
            part[2] = part[2].abs().clamp(0.05, 2.0 * PI);
        }
    }

    fn improve(self, height: f64, angle: &[f64], value: &[f64]) -> (f64, Self) {
        let mut here = self;
        let mut cost = here.cost(angle, value);
        let mut damping = 1e-3;
        for _ in 0..300 {
            let mut matrix = vec![vec![0.0; 7]; 6];
            for (x, y) in angle.iter().zip(value) {
                let gradient = here.gradient(*x);
                let rest = y - here.at(*x);
                for row in 0..6 {
                    for column in 0..6 {
                        matrix[row][column] += gradient[row] * gradient[column];
                    }
                    matrix[row][6] += gradient[row] * rest;
                }
            }
            for (row, entries) in matrix.iter_mut().enumerate() {
                entries[row] = entries[row] * (1.0 + damping) + 1e-12;
            }
            let Some(step) = solve(matrix) else { break };
            let mut next = here;
            for (parameter, change) in next.parameters.iter_mut().zip(&step) {
                *parameter += change;
            }
            next.confine(height);
            let next_cost = next.cost(angle, value);
            if next_cost < cost {
                let gain = (cost - next_cost) / cost;
                (here, cost) = (next, next_cost);
                damping *= 0.3;
                if gain < 1e-12 {
                    break;
                }
            } else {
                damping *= 4.0;
                if damping > 1e12 {
                    break;
                }
            }
        }
        (cost, here)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_gaussians_are_found_in_noise() {
        let truth = TwoGaussians {
            parameters: [0.27, -3.07, 1.29, 0.186, 0.48, 2.62],
        };
        let mut random = inference::random::Random::new(11);
        let angle: Vec<f64> = (0..400)
            .map(|k| -3.1 + 6.2 * f64::from(k) / 399.0)
            .collect();
        let value: Vec<f64> = angle
            .iter()
            .map(|x| truth.at(*x) + 0.002 * random.normal())
            .collect();
        let found = TwoGaussians::fit(&angle, &value).unwrap();
        assert!(found.residual(&angle, &value) < 0.0022, "{found:?}");
        assert!((found.at(0.5) - truth.at(0.5)).abs() < 1e-3);
    }
}
