//! Two Gaussians of the phase-plane angle α = atan2(a/A, (ω − V_c)/V_c): what Eqs 6-1 and 6-2 share.
//!
//! α lies in (−π, π]: 0 at the highest velocity, π where the contact breaks away, −π where it comes
//! to rest; 0 < α < π while it speeds up. Below the ellipse's centre the level jumps where the
//! acceleration changes sign.

use crate::series::{RECIPROCAL, Scalar, Series, TERMS, convolution};
use std::f64::consts::PI;

/// Two Gaussians over the angle of an ellipse in the plane of velocity and acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoGaussian<S> {
    /// Heights a1, a2 [1 or N m].
    pub heights: [S; 2],
    /// Peaks b1, b2 [rad].
    pub peaks: [S; 2],
    /// Widths c1, c2 [rad].
    pub widths: [S; 2],
    /// Centre and semi-axis of the velocity [rad/s].
    pub omega_centre: S,
    /// Semi-axis of the acceleration [rad/s²].
    pub acceleration_semi_axis: S,
}

/// Phase-plane angle [rad] in (−π, π] of a slip speed [rad/s] and its rate [rad/s²].
pub fn acceleration_angle(speed: f64, rate: f64, omega_centre: f64, semi_axis: f64) -> f64 {
    libm::atan2(rate / semi_axis, (speed - omega_centre) / omega_centre)
}

/// Series that the recurrences work on.
pub(super) const WORKSPACE: usize = 11;

impl<S: Scalar> TwoGaussian<S> {
    /// The same without derivatives.
    pub fn plain(&self) -> TwoGaussian<f64> {
        TwoGaussian {
            heights: self.heights.map(Scalar::value),
            peaks: self.peaks.map(Scalar::value),
            widths: self.widths.map(Scalar::value),
            omega_centre: self.omega_centre.value(),
            acceleration_semi_axis: self.acceleration_semi_axis.value(),
        }
    }

    /// Level at the angle `alpha`.
    pub fn at_angle(&self, alpha: S) -> S {
        self.gaussian(0, alpha) * self.heights[0] + self.gaussian(1, alpha) * self.heights[1]
    }

    /// Level at breakaway: the larger of the values at α = ±π.
    pub fn breakaway(&self) -> S {
        let [from_below, from_above] = self.levels_at_rest();
        if from_below.value() > from_above.value() {
            from_below
        } else {
            from_above
        }
    }

    /// Levels at α = π (just speeding up) and α = −π (just slowing down).
    pub fn levels_at_rest(&self) -> [S; 2] {
        [
            self.at_angle(S::constant(PI)),
            self.at_angle(S::constant(-PI)),
        ]
    }

    /// Whether the level jumps at zero acceleration when the slip speed is `speed`.
    pub fn jumps_at(&self, speed: f64) -> bool {
        speed < self.omega_centre.value()
    }

    /// Level and its derivative with respect to the acceleration [per rad/s²].
    pub fn level_and_slope(&self, speed: S, acceleration: S) -> (S, S) {
        let x = (speed - self.omega_centre) / self.omega_centre;
        let y = acceleration / self.acceleration_semi_axis;
        let alpha = y.atan2(x);
        let along_y = x / ((x * x + y * y) * self.acceleration_semi_axis);
        let (mut level, mut slope) = (S::ZERO, S::ZERO);
        for m in 0..2 {
            let bell = self.heights[m] * self.gaussian(m, alpha);
            level += bell;
            slope += bell * self.log_slope(m) * (alpha - self.peaks[m]) * along_y;
        }
        (level, slope)
    }

    fn gaussian(&self, m: usize, alpha: S) -> S {
        let z = (alpha - self.peaks[m]) / self.widths[m];
        (-(z * z)).exp()
    }

    fn log_slope(&self, m: usize) -> S {
        S::constant(-2.0) / (self.widths[m] * self.widths[m])
    }

    /// Coefficient `k` of the level as far as it is known before coefficient `k` of the
    /// acceleration, and the factor with which that coefficient enters.
    pub(super) fn known_coefficient(
        &self,
        k: usize,
        speed: &Series<S>,
        acceleration_0: S,
        work: &mut [Series<S>],
    ) -> (S, S) {
        let [x, wx, y, wy, square, alpha, wa, g1, p1, g2, p2, ..] = work else {
            return (S::ZERO, S::ZERO);
        };
        if k == 0 {
            x[0] = (speed[0] - self.omega_centre) / self.omega_centre;
            y[0] = acceleration_0 / self.acceleration_semi_axis;
            alpha[0] = y[0].atan2(x[0]);
            for (m, (g, p)) in [(g1, p1), (g2, p2)].into_iter().enumerate() {
                g[0] = self.gaussian(m, alpha[0]);
                p[0] = g[0] * (alpha[0] - self.peaks[m]);
            }
        } else {
            x[k] = speed[k] / self.omega_centre;
            wx[k] = x[k] * k as f64;
            (y[k], wy[k]) = (S::ZERO, S::ZERO);
            let numerator = convolution(&wy[1..=k], &x[..k])
                - convolution(&wx[1..=k], &y[..k])
                - convolution(&wa[1..k], &square[1..k]);
            wa[k] = numerator / square[0];
            alpha[k] = wa[k] * RECIPROCAL[k];
            for (m, (g, p)) in [(g1, &*p1), (g2, &*p2)].into_iter().enumerate() {
                g[k] = self.log_slope(m) * convolution(&wa[1..=k], &p[..k]) * RECIPROCAL[k];
            }
        }
        let [x, _, y, _, _, _, _, g1, p1, g2, p2, ..] = work else {
            return (S::ZERO, S::ZERO);
        };
        let radius = x[0] * x[0] + y[0] * y[0];
        let along_y = x[0] / (radius * self.acceleration_semi_axis);
        let slope = along_y
            * (self.heights[0] * self.log_slope(0) * p1[0]
                + self.heights[1] * self.log_slope(1) * p2[0]);
        (self.heights[0] * g1[k] + self.heights[1] * g2[k], slope)
    }

    /// Takes coefficient `k` of the acceleration into account and completes order `k`.
    pub(super) fn complete(&self, k: usize, acceleration_k: S, work: &mut [Series<S>]) {
        let [x, _, y, wy, square, alpha, wa, g1, p1, g2, p2, ..] = work else {
            return;
        };
        if k == 0 {
            square[0] = x[0] * x[0] + y[0] * y[0];
            return;
        }
        y[k] = acceleration_k / self.acceleration_semi_axis;
        wy[k] = y[k] * k as f64;
        let correction = x[0] * y[k] / square[0];
        alpha[k] += correction;
        wa[k] = alpha[k] * k as f64;
        square[k] = convolution(&x[..=k], &x[..=k]) + convolution(&y[..=k], &y[..=k]);
        for (m, (g, p)) in [(g1, p1), (g2, p2)].into_iter().enumerate() {
            g[k] += self.log_slope(m) * p[0] * correction;
            p[k] = convolution(&g[..=k], &alpha[..=k]) - self.peaks[m] * g[k];
        }
    }
}

/// Series of the level's partial derivatives: `by_motion` by slip speed and acceleration, and by the
/// `wanted` ones of a1, b1, c1, a2, b2, c2, V_c and A; from the series that the recurrences worked on.
pub(super) fn slopes(
    law: &TwoGaussian<f64>,
    speed: &Series<f64>,
    work: &[Series<f64>],
    order: usize,
    by_motion: &mut [Series<f64>; 2],
    by_parameter: &mut [Series<f64>],
    wanted: &[bool],
) {
    let [x, _, y, _, square, alpha, _, g1, p1, g2, p2, ..] = work else {
        return;
    };
    let (centre, semi_axis) = (law.omega_centre, law.acceleration_semi_axis);
    let steepness = [0, 1].map(|m| law.heights[m] * law.log_slope(m));
    // ∂level/∂α over the square of the radius: dα = (x dy − y dx)/(x² + y²).
    let mut by_alpha = [0.0; TERMS];
    let [by_speed, by_rate] = by_motion;
    for k in 0..=order {
        let direct = steepness[0] * p1[k] + steepness[1] * p2[k];
        let earlier = convolution(&square[1..=k], &by_alpha[..k]);
        by_alpha[k] = (direct - earlier) / square[0];
        by_speed[k] = -convolution(&by_alpha[..=k], &y[..=k]) / centre;
        by_rate[k] = convolution(&by_alpha[..=k], &x[..=k]) / semi_axis;
    }
    for (m, (g, p)) in [(g1, p1), (g2, p2)].into_iter().enumerate() {
        let [by_height, by_peak, by_width] = [3 * m, 3 * m + 1, 3 * m + 2];
        if wanted[by_height] {
            by_parameter[by_height] = *g;
        }
        if wanted[by_peak] {
            by_parameter[by_peak] = p.map(|p| -steepness[m] * p);
        }
        if wanted[by_width] {
            let scale = -steepness[m] / law.widths[m];
            for k in 0..=order {
                let product = convolution(&p[..=k], &alpha[..=k]) - law.peaks[m] * p[k];
                by_parameter[by_width][k] = scale * product;
            }
        }
    }
    if wanted[6] {
        for k in 0..=order {
            by_parameter[6][k] = -convolution(&by_speed[..=k], &speed[..=k]) / centre;
        }
    }
    if wanted[7] {
        for k in 0..=order {
            by_parameter[7][k] = -convolution(&by_rate[..=k], &y[..=k]);
        }
    }
}
