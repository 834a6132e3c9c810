//! The force of what opposes the motion, constant over one step.
//!
//! Over a step of length h the force f is constant. The velocity v at its start, the inertia J of the port and the acceleration a₀ that
//! all other forces give make the velocity v + h(a₀ + f/J) at its end. What opposes the motion is taken in the middle of the step, and f
//! solves the implicit midpoint rule. Where the motion comes to rest within the step, each direction has its part of it; and where a force that
//! jumps with the direction holds against all others, f is the force that brings the velocity to zero, so that the plant sticks.

/// A moment of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time [s].
    pub time: f64,
    /// Position [m or rad].
    pub position: f64,
    /// Velocity [m/s or rad/s].
    pub velocity: f64,
    /// Acceleration [m/s² or rad/s²].
    pub acceleration: f64,
    /// Direction of motion: −1 or 1.
    pub direction: f64,
}

/// Most steps of the search for the force, and how near to a solution it ends.
const MOST_TRIALS: usize = 20;
const NEAR: f64 = 1e-13;

/// What opposes the motion of an inertia.
pub struct Coupling<F> {
    /// Force against the motion at a moment [N or N m].
    pub against: F,
    /// Inertia [kg or kg m²], > 0.
    pub inertia: f64,
}

impl<F: FnMut(&Moment) -> f64> Coupling<F> {
    /// Force along the motion over a step of `length` [s] from a moment of which time, position and velocity count, where all others
    /// give the acceleration `free`; `last` is a first guess.
    pub fn force(&mut self, from: &Moment, length: f64, free: f64, last: f64) -> f64 {
        let (velocity, inertia) = (from.velocity, self.inertia);
        let gained = |force: f64| free + force / inertia;
        if velocity == 0.0 {
            let forward = self.sliding(from, length, free, 1.0, last);
            if gained(forward) > 0.0 {
                return forward;
            }
            let backward = self.sliding(from, length, free, -1.0, last);
            return if gained(backward) < 0.0 {
                backward
            } else {
                -inertia * free
            };
        }
        let onward = velocity.signum();
        let before = self.sliding(from, length, free, onward, last);
        let ending = velocity + length * gained(before);
        if onward * ending > 0.0 {
            return before;
        }
        // The motion comes to rest on the way, and turns there if the other forces are strong enough.
        let after = self.sliding(from, length, free, -onward, last);
        if onward * gained(after) < 0.0 {
            let part = velocity / (velocity - ending);
            part * before + (1.0 - part) * after
        } else {
            -inertia * (velocity / length + free)
        }
    }

    /// The force while the motion has this direction: a root of force + what opposes it, by secants.
    fn sliding(
        &mut self,
        from: &Moment,
        length: f64,
        free: f64,
        direction: f64,
        guess: f64,
    ) -> f64 {
        let mut before = guess;
        let mut missed = before + self.opposed(from, length, free, direction, before);
        let mut force = before - missed;
        for _ in 0..MOST_TRIALS {
            let misses = force + self.opposed(from, length, free, direction, force);
            if misses.abs() <= NEAR * force.abs() || misses == missed {
                break;
            }
            let next = force - misses * (force - before) / (misses - missed);
            (before, missed, force) = (force, misses, next);
        }
        force
    }

    /// What opposes the motion in the middle of the step.
    fn opposed(
        &mut self,
        from: &Moment,
        length: f64,
        free: f64,
        direction: f64,
        force: f64,
    ) -> f64 {
        let acceleration = free + force / self.inertia;
        let half = 0.5 * length;
        (self.against)(&Moment {
            time: from.time + half,
            position: from.position + half * (from.velocity + 0.5 * half * acceleration),
            velocity: from.velocity + half * acceleration,
            acceleration,
            direction,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit mass on a unit spring from x = 1 under friction, in steps of `length`: position and velocity at `end`.
    fn swing(friction: f64, length: f64, end: f64) -> (f64, f64) {
        let (mut x, mut v, mut free, mut last) = (1.0, 0.0, -1.0, 0.0);
        for step in 0..(end / length).round() as usize {
            let from = Moment {
                time: step as f64 * length,
                position: x,
                velocity: v,
                acceleration: 0.0,
                direction: 0.0,
            };
            // The motion under a constant force is exact, and the force is sought until it fits, as with an original that goes back.
            let mut moved = (x, v);
            for _ in 0..5 {
                let mut coupling = Coupling {
                    against: |at: &Moment| friction * at.direction,
                    inertia: 1.0,
                };
                last = coupling.force(&from, length, free, last);
                let (sine, cosine) = length.sin_cos();
                moved = (
                    last + (x - last) * cosine + v * sine,
                    v * cosine - (x - last) * sine,
                );
                free = (moved.1 - v) / length - last;
            }
            (x, v) = moved;
        }
        (x, v)
    }

    #[test]
    fn dry_friction_takes_its_share_of_every_swing_and_holds_at_last() {
        // Each half swing loses 2·0.15; after three, at x = −0.1·… the spring is weaker than friction: 1 − 6·0.15 = 0.1 from zero.
        let (x, v) = swing(0.15, 0.01, 40.0);
        assert!((x + 0.1).abs() < 2e-3, "{x}");
        assert!(v.abs() < 1e-12, "{v}");
        let later = swing(0.15, 0.01, 80.0);
        assert_eq!(later.0, x, "it creeps");
    }

    #[test]
    fn errors_fall_with_the_square_of_the_step() {
        // Through two turns into the third half swing, from 0.4 about 0.15; the turns fall between steps.
        let end = 8.0;
        let exact = 0.15 + 0.25 * (end - std::f64::consts::TAU).cos();
        let error = |count: f64| {
            let (x, _) = swing(0.15, end / count, end);
            (x - exact).abs()
        };
        let (coarse, fine) = (error(100.0), error(1600.0));
        assert!(coarse < 2e-4, "{coarse}");
        let order = (coarse / fine).ln() / 16f64.ln();
        assert!(order > 1.8, "{coarse} {fine}: order {order}");
    }
}
