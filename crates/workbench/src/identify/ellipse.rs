//! The ellipse of the phase plane of velocity and acceleration (Fig. 6.1).

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

    /// The ellipse of a recorded cycle: its velocities reach from the centre by the semi-axis to either side, and its
    /// acceleration axis is the median of |a|/√(1 − x²), x = (ω − centre)/velocity, over the middle of the range.
    ///
    /// Ranges and median are robust where a least-squares fit is not: the jump of the torque at breakaway and sticking makes
    /// spikes of acceleration that belong to no ellipse. A hundredth of the samples at either end of the range is left out.
    /// `None` with fewer than 50 samples or where nothing moves.
    #[must_use]
    pub fn of_cycle(velocity: &[f64], acceleration: &[f64]) -> Option<Self> {
        if velocity.len() < 50 || velocity.len() != acceleration.len() {
            return None;
        }
        let mut sorted = velocity.to_vec();
        sorted.sort_by(f64::total_cmp);
        let cut = sorted.len() / 100;
        let (low, high) = (sorted[cut], sorted[sorted.len() - 1 - cut]);
        let (centre, semi_axis) = (0.5 * (low + high), 0.5 * (high - low));
        if semi_axis.is_nan() || semi_axis <= 0.0 {
            return None;
        }
        let mut heights: Vec<f64> = velocity
            .iter()
            .zip(acceleration)
            .map(|(velocity, acceleration)| ((velocity - centre) / semi_axis, acceleration))
            .filter(|(x, _)| x.abs() < 0.8)
            .map(|(x, acceleration)| acceleration.abs() / (1.0 - x * x).sqrt())
            .collect();
        heights.sort_by(f64::total_cmp);
        let acceleration = *heights.get(heights.len() / 2)?;
        (acceleration > 0.0).then_some(Self {
            centre,
            velocity: semi_axis,
            acceleration,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_noisy_ellipse_is_found() {
        let mut random = inference::random::Random::new(5);
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
        let found = Ellipse::of_cycle(&velocity, &acceleration).unwrap();
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
