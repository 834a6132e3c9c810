//! The two-Gaussian law: friction follows the acceleration, and the acceleration the friction.

use std::cell::Cell;
use std::f64::consts::{PI, TAU};

/// The coefficient of friction over the phase-plane angle, with the algebraic loop that it makes.
#[derive(Debug)]
pub struct LoopLaw {
    pub a: [f64; 2],
    pub b: [f64; 2],
    pub c: [f64; 2],
    pub omega_centre: f64,
    pub acceleration_semi_axis: f64,
    /// Acceleration and angle of the last solution: the next one is on the same branch, near them.
    pub last: Cell<(f64, f64)>,
}

/// The loop's solution in the slip direction.
#[derive(Clone, Copy, Debug)]
pub struct Solution {
    /// Acceleration [rad/s²].
    pub acceleration: f64,
    /// Phase-plane angle, continued past ±π until the motion switches [rad].
    pub angle: f64,
    /// Its slope over the torque.
    pub per_drive: f64,
    /// Its slope over the velocity.
    pub per_speed: f64,
}

impl LoopLaw {
    /// Coefficient and its slope at an angle.
    fn coefficient(&self, angle: f64) -> (f64, f64) {
        let (mut value, mut slope) = (0.0, 0.0);
        for k in 0..2 {
            let x = (angle - self.b[k]) / self.c[k];
            let bell = self.a[k] * (-x * x).exp();
            value += bell;
            slope -= 2.0 * x / self.c[k] * bell;
        }
        (value, slope)
    }

    /// Coefficient at which a disc at rest breaks away.
    pub fn breakaway(&self) -> f64 {
        self.coefficient(-PI).0.max(self.coefficient(PI).0)
    }

    /// Begins the branch next to the angle `side`, ±π.
    pub fn begin(&self, side: f64, inertia: f64, load: f64, drive: f64) {
        let acceleration = (drive - load * self.coefficient(side).0) / inertia;
        self.last.set((acceleration, side));
    }

    /// Acceleration at a velocity under a torque, by Newton's method.
    pub fn solve(&self, inertia: f64, load: f64, speed: f64, drive: f64) -> Solution {
        let x = (speed - self.omega_centre) / self.omega_centre;
        let (mut acceleration, last) = self.last.get();
        let mut solution = Solution {
            acceleration,
            angle: last,
            per_drive: 0.0,
            per_speed: 0.0,
        };
        for _ in 0..50 {
            let y = acceleration / self.acceleration_semi_axis;
            let principal = y.atan2(x);
            let angle = principal + TAU * ((last - principal) / TAU).round();
            let (mu, slope) = self.coefficient(angle);
            let radius = x * x + y * y;
            let per_acceleration = load * slope * x / (radius * self.acceleration_semi_axis);
            let stiffness = inertia + per_acceleration;
            let step = (drive - inertia * acceleration - load * mu) / stiffness;
            acceleration += step;
            solution = Solution {
                acceleration,
                angle,
                per_drive: 1.0 / stiffness,
                per_speed: load * slope * y / (radius * self.omega_centre) / stiffness,
            };
            if step.abs() <= 1e-14 * (acceleration.abs() + 1.0) {
                break;
            }
        }
        self.last.set((acceleration, solution.angle));
        solution
    }
}
