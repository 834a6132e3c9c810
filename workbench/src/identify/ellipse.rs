//! The ellipse of the phase plane of velocity and acceleration (Fig. 6.1).

use super::local_polynomial::solve;

/// An ellipse with axes along the coordinates: ((ω − centre)/velocity)² + (a/acceleration)² = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipse {
    /// Velocity of the centre [rad/s]; the centre's acceleration is zero, since a cycle returns to its velocity.
    pub centre: f64,
    /// Velocity semi-axis [rad/s].
    pub velocity: f64,
    /// Acceleration semi-axis [rad/s²].
    pub acceleration: f64,
}

impl Ellipse {
    /// The angle α = atan2(a/A, (ω − V_c)/V) of a point of the phase plane [rad].
    #[must_use]
    pub fn angle(&self, velocity: f64, acceleration: f64) -> f64 {
        (acceleration / self.acceleration).atan2((velocity - self.centre) / self.velocity)
    }

    /// The ellipse through points by least squares of p ω² + q a² + r ω = 1 over scaled coordinates; `None` where the points
    /// lie on no ellipse.
    #[must_use]
    pub fn fit(velocity: &[f64], acceleration: &[f64]) -> Option<Self> {
        let largest = |series: &[f64]| series.iter().fold(0.0_f64, |high, x| high.max(x.abs()));
        let (v, a) = (largest(velocity), largest(acceleration));
        if velocity.len() != acceleration.len() || v <= 0.0 || a <= 0.0 {
            return None;
        }
        // An ellipse through the origin (a cycle that sticks) has no constant term, so the term in ω is the one kept at 1.
        let mut matrix = vec![vec![0.0; 4]; 3];
        for (velocity, acceleration) in velocity.iter().zip(acceleration) {
            let (x, y) = (velocity / v, acceleration / a);
            let terms = [x * x, y * y, 1.0];
            for row in 0..3 {
                for column in 0..3 {
                    matrix[row][column] += terms[row] * terms[column];
                }
                matrix[row][3] += terms[row] * x;
            }
        }
        // p x² + q y² + c = x, so (x − 1/2p)² + (q/p) y² = 1/4p² − c/p.
        let [p, q, c] = solve(matrix)?[..] else {
            return None;
        };
        let square = 0.25 / (p * p) - c / p;
        let ratio = q / p;
        (p > 0.0 && square > 0.0 && ratio > 0.0).then(|| Self {
            centre: 0.5 / p * v,
            velocity: square.sqrt() * v,
            acceleration: (square / ratio).sqrt() * a,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_noisy_ellipse_is_found() {
        let mut random = crate::random::Random::new(5);
        let truth = Ellipse {
            centre: 5.9,
            velocity: 6.1,
            acceleration: 31.0,
        };
        let mut noisy = |value: f64, sigma: f64| value + sigma * random.normal();
        let (velocity, acceleration): (Vec<f64>, Vec<f64>) = (0..400)
            .map(|index| f64::from(index) * std::f64::consts::TAU / 400.0)
            .map(|phase| {
                (
                    noisy(truth.centre + truth.velocity * phase.cos(), 0.02),
                    noisy(truth.acceleration * phase.sin(), 0.2),
                )
            })
            .unzip();
        let found = Ellipse::fit(&velocity, &acceleration).unwrap();
        assert!(
            (found.centre / truth.centre - 1.0).abs() < 0.01,
            "{found:?}"
        );
        assert!(
            (found.velocity / truth.velocity - 1.0).abs() < 0.01,
            "{found:?}"
        );
        assert!(
            (found.acceleration / truth.acceleration - 1.0).abs() < 0.01,
            "{found:?}"
        );
    }

    #[test]
    fn the_angle_is_zero_at_the_highest_velocity() {
        let ellipse = Ellipse {
            centre: 6.0,
            velocity: 6.0,
            acceleration: 30.0,
        };
        assert_eq!(ellipse.angle(12.0, 0.0), 0.0);
        assert!((ellipse.angle(0.0, 1e-9) - std::f64::consts::PI).abs() < 1e-9);
        assert!(ellipse.angle(6.0, 10.0) > 0.0);
    }
}
