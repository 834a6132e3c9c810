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

/// Where the search for a force begins.
#[derive(Clone, Copy, Debug)]
pub struct Guess {
    /// The force.
    pub force: f64,
    /// By how much it misses more if it grows by one: 1 where nothing opposes the motion that it makes. That of a step serves the next.
    pub slope: f64,
}

impl Guess {
    /// Of a force, where nothing else is known.
    #[must_use]
    pub const fn new(force: f64) -> Self {
        Self { force, slope: 1.0 }
    }
}

/// Most steps of the search for the force, and how near to a solution it ends: far below the error of the midpoint rule, and above what
/// rounding leaves of a small force between large ones, where a closer search goes round without end.
const MOST_TRIALS: usize = 20;
const NEAR: f64 = 1e-10;

/// What opposes the motion of an inertia; of several at once, each in a lane of its own, so that an equation is read once for all.
pub struct Coupling<F> {
    /// Force against the motion at a moment of each lane [N or N m].
    pub against: F,
    /// Inertia [kg or kg m²], > 0.
    pub inertia: f64,
}

/// A step in so many lanes.
struct Step<'a, const LANES: usize> {
    from: &'a [Moment; LANES],
    length: f64,
    free: [f64; LANES],
}

impl<F> Coupling<F> {
    /// Force along the motion over a step of `length` [s] from a moment of which time, position and velocity count, where all others
    /// give the acceleration `free`; `last` is a first guess. The answer is a guess for the next step too.
    pub fn force<const LANES: usize>(
        &mut self,
        from: &[Moment; LANES],
        length: f64,
        free: [f64; LANES],
        last: [Guess; LANES],
    ) -> [Guess; LANES]
    where
        F: FnMut(&[Moment; LANES]) -> [f64; LANES],
    {
        let inertia = self.inertia;
        let step = Step { from, length, free };
        let gained = |lane: usize, force: f64| free[lane] + force / inertia;
        // From rest the motion begins forward, if the forces let it.
        let onward = from.each_ref().map(|own| match own.velocity {
            0.0 => 1.0,
            velocity => velocity.signum(),
        });
        let before = self.sliding(&step, onward, last, [true; LANES]);
        let ending = |lane: usize| from[lane].velocity + length * gained(lane, before[lane].force);
        let ends: [bool; LANES] = std::array::from_fn(|lane| onward[lane] * ending(lane) <= 0.0);
        if !ends.contains(&true) {
            return before;
        }
        // The motion comes to rest on the way, and turns there if the other forces are strong enough.
        let after = self.sliding(&step, onward.map(|own| -own), last, ends);
        std::array::from_fn(|lane| {
            let velocity = from[lane].velocity;
            let [first, second] = [before[lane], after[lane]];
            let force = if !ends[lane] {
                first.force
            } else if onward[lane] * gained(lane, second.force) < 0.0 {
                let part = match velocity {
                    0.0 => 0.0,
                    _ => velocity / (velocity - ending(lane)),
                };
                part * first.force + (1.0 - part) * second.force
            } else {
                -inertia * (velocity / length + free[lane])
            };
            Guess { force, ..first }
        })
    }

    /// The force while the motion has this direction, in the lanes that are open: a root of force + what opposes it, by secants.
    fn sliding<const LANES: usize>(
        &mut self,
        step: &Step<'_, LANES>,
        direction: [f64; LANES],
        guess: [Guess; LANES],
        mut open: [bool; LANES],
    ) -> [Guess; LANES]
    where
        F: FnMut(&[Moment; LANES]) -> [f64; LANES],
    {
        let mut before = guess.map(|own| own.force);
        let mut first = guess.map(|own| own.slope);
        let mut missed = self.missed(step, direction, before);
        let mut force: [f64; LANES] =
            std::array::from_fn(|lane| before[lane] - missed[lane] / first[lane]);
        for trial in 0..MOST_TRIALS {
            let misses = self.missed(step, direction, force);
            for lane in 0..LANES {
                let (own, miss) = (force[lane], misses[lane]);
                open[lane] &= miss.abs() > NEAR * own.abs() && miss != missed[lane];
                if open[lane] {
                    let slope = (miss - missed[lane]) / (own - before[lane]);
                    force[lane] -= miss / slope;
                    if trial == 0 {
                        // Rounding counts least over the longest of the steps.
                        first[lane] = slope;
                    }
                    (before[lane], missed[lane]) = (own, miss);
                }
            }
            if !open.contains(&true) {
                break;
            }
        }
        std::array::from_fn(|lane| Guess {
            force: force[lane],
            slope: first[lane],
        })
    }

    /// The force and what opposes the motion in the middle of the step, which a root makes zero.
    fn missed<const LANES: usize>(
        &mut self,
        step: &Step<'_, LANES>,
        direction: [f64; LANES],
        force: [f64; LANES],
    ) -> [f64; LANES]
    where
        F: FnMut(&[Moment; LANES]) -> [f64; LANES],
    {
        let half = 0.5 * step.length;
        let opposed = (self.against)(&std::array::from_fn(|lane| {
            let from = step.from[lane];
            let acceleration = step.free[lane] + force[lane] / self.inertia;
            Moment {
                time: from.time + half,
                position: from.position + half * (from.velocity + 0.5 * half * acceleration),
                velocity: from.velocity + half * acceleration,
                acceleration,
                direction: direction[lane],
            }
        }));
        std::array::from_fn(|lane| force[lane] + opposed[lane])
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
                    against: |[at]: &[Moment; 1]| [friction * at.direction],
                    inertia: 1.0,
                };
                let [found] = coupling.force(&[from], length, [free], [Guess::new(last)]);
                last = found.force;
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
