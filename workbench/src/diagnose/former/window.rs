//! Windows: stretches of a record over which the model is restarted from the measured motion.

use super::run::Run;
use stickslip::plant::{Rig, RigState, STATES, index};

/// Length of a window [s].
const LENGTH: f64 = 0.5;
/// Length of a window over which even a wrong model stays near the measured motion [s].
pub const SHORT: f64 = 0.15;
/// Length of the pieces over which a disturbance torque is held [s].
pub const PIECE: f64 = 0.05;
/// Acceleration from which on it is clear whether the disc speeds up or slows down [rad/s²].
const CLEAR_ACCELERATION: f64 = 4.0;
/// State components that a window may start from: all of the reduced rig, the relaxing torque and the bristles, for which
/// see [`super::bristle_start`].
pub const START_COMPONENTS: [usize; 7] = [
    index::THETA,
    index::OMEGA,
    index::THETA3,
    index::OMEGA3,
    index::CURRENT,
    index::RELAXING_TORQUE,
    index::BRISTLE,
];

/// Standard deviation of the velocity of a disc that sticks: it does not move at all [rad/s].
const AT_REST: f64 = 1e-6;

/// Standard deviation of the deflection of a sticking disc's bristles about that at which it rests [rad].
const BRISTLE: f64 = 0.003;

/// A window of one record.
#[derive(Clone, Debug)]
pub struct Window {
    /// Which record.
    pub run: usize,
    /// First sample.
    pub first: usize,
    /// Last sample.
    pub last: usize,
    /// State at the first sample as measured.
    pub anchor: RigState<f64>,
    /// Acceleration of the disc at the first sample as measured [rad/s²]: on which branch of a law
    /// with branches the window starts.
    pub acceleration: f64,
    /// Standard deviations with which the anchor is known, in the order of [`START_COMPONENTS`].
    pub deviations: [f64; START_COMPONENTS.len()],
    /// Breakaway in this window over that of the law: friction that fluctuates does so there too.
    pub breakaway: f64,
}

impl Window {
    /// Whether the disc sticks somewhere in the window of `run`, under a pin that presses.
    pub fn sticks(&self, run: &Run) -> bool {
        (self.first..=self.last).any(|at| motion(run, at) == Motion::Stuck)
    }

    /// `start` moved by `change`, in the order of [`START_COMPONENTS`]. A disc that sticks stays exactly at rest: the
    /// smallest velocity would be slip, and a law with branches would go on from there on one of them.
    pub fn moved(
        &self,
        start: &RigState<f64>,
        change: &[f64; START_COMPONENTS.len()],
    ) -> RigState<f64> {
        let mut moved = *start;
        for ((component, change), deviation) in START_COMPONENTS
            .into_iter()
            .zip(change)
            .zip(self.deviations)
        {
            if component != index::OMEGA || deviation > AT_REST {
                moved[component] += change;
            }
        }
        moved
    }
}

/// How the disc moves about a sample, as far as the readings tell.
#[derive(Clone, Copy, PartialEq)]
enum Motion {
    Stuck,
    Sliding,
    Unclear,
}

/// Where windows are wanted to start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begin {
    /// Where it is clear whether the disc sticks or slides, and if possible whether it speeds up or
    /// slows down: a law with branches goes on from there on the branch that was measured.
    Clear,
    /// Where the disc sticks or speeds up: a component that is given a state and nothing else
    /// begins on that branch.
    SpeedingUp,
}

impl Begin {
    /// How far the search for a good place may go, in lengths of a window.
    fn reach(self) -> f64 {
        match self {
            Self::Clear => 0.5,
            Self::SpeedingUp => 2.0,
        }
    }

    fn is_good(self, run: &Run, at: usize) -> bool {
        match motion(run, at) {
            Motion::Unclear => false,
            Motion::Stuck => true,
            Motion::Sliding => {
                let (_, omega, acceleration) = line(run, 0, 1, at);
                let along = acceleration * omega.signum();
                match self {
                    Self::Clear => along.abs() > CLEAR_ACCELERATION,
                    Self::SpeedingUp => along > CLEAR_ACCELERATION,
                }
            }
        }
    }
}

/// How records are cut into windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Length of a window [s].
    pub length: f64,
    /// Where windows are wanted to start.
    pub begin: Begin,
    /// Back-EMF constant seen from the gearbox output [V s/rad].
    pub back_emf: f64,
    /// Armature resistance [Ω].
    pub resistance: f64,
}

impl Cut {
    /// Windows of the usual length for records of this rig.
    pub fn of(rig: &Rig<f64>, begin: Begin) -> Self {
        Self {
            length: LENGTH,
            begin,
            back_emf: rig.gearbox.ratio * rig.motor.back_emf_constant,
            resistance: rig.motor.resistance,
        }
    }

    /// Cuts a record into windows that start where they are wanted, as far as there is such a place.
    pub fn windows(&self, run_index: usize, run: &Run) -> Vec<Window> {
        let per_window = (self.length / run.interval()).round().max(4.0) as usize;
        let reach = (per_window as f64 * self.begin.reach()) as usize;
        let mut windows = Vec::new();
        let mut first = 0;
        while first + per_window / 2 < run.len() {
            let mut last = (first + per_window).min(run.len() - 1);
            let within = |d: &usize| last + d < run.len();
            let good = (0..reach)
                .take_while(within)
                .find(|d| self.begin.is_good(run, last + d))
                .or_else(|| {
                    (0..per_window / 2)
                        .take_while(within)
                        .find(|d| motion(run, last + d) != Motion::Unclear)
                });
            last += good.unwrap_or(0);
            last = last.min(run.len() - 1);
            windows.push(self.window(run_index, run, first, last));
            first = last;
        }
        windows
    }

    fn window(&self, run_index: usize, run: &Run, first: usize, last: usize) -> Window {
        let mut anchor = [0.0; STATES];
        if first == 0 && starts_at_rest(run) {
            let tiny = 1e-9;
            return Window {
                run: run_index,
                first,
                last,
                anchor,
                acceleration: 0.0,
                deviations: [tiny; START_COMPONENTS.len()],
                breakaway: 1.0,
            };
        }
        let stuck = motion(run, first) == Motion::Stuck;
        let (theta, omega, acceleration) = line(run, 0, 1, first);
        let (theta3, omega3, _) = line(run, 2, 3, first);
        anchor[index::THETA] = theta;
        anchor[index::OMEGA] = if stuck { 0.0 } else { omega };
        anchor[index::THETA3] = theta3;
        anchor[index::OMEGA3] = omega3;
        let voltage = run.voltage[first.saturating_sub(1)];
        anchor[index::CURRENT] = (voltage - self.back_emf * omega3) / self.resistance;
        let disc_velocity = if stuck { AT_REST } else { 1.0 };
        Window {
            run: run_index,
            first,
            last,
            anchor,
            acceleration,
            deviations: [0.5, disc_velocity, 0.1, 0.3, 2.0, 0.05, BRISTLE],
            breakaway: 1.0,
        }
    }
}

/// Whether a run starts at rest with angles zero, as every record does; a stretch after a hole has turned on.
fn starts_at_rest(run: &Run) -> bool {
    let begin = 3.min(run.len());
    let slow = run.readings[1][..begin].iter().all(|w| w.abs() < 0.3);
    let at_zero = [0, 2]
        .iter()
        .all(|&angle| run.readings[angle][0].abs() < 0.02);
    slow && at_zero
}

/// Angle, velocity and acceleration at a sample from the readings around it: the angles less the course that the
/// velocities describe give the angle, a line through the velocities the velocity and its rate.
fn line(run: &Run, angle: usize, velocity: usize, at: usize) -> (f64, f64, f64) {
    let low = at.saturating_sub(3);
    let high = (at + 3).min(run.len() - 1);
    let n = (high - low + 1) as f64;
    let t0 = run.time[at];
    let (mut st, mut stt, mut sv, mut stv) = (0.0, 0.0, 0.0, 0.0);
    for j in low..=high {
        let t = run.time[j] - t0;
        let v = run.readings[velocity][j];
        st += t;
        stt += t * t;
        sv += v;
        stv += t * v;
    }
    let determinant = n * stt - st * st;
    let slope = (n * stv - st * sv) / determinant;
    let omega = (sv - slope * st) / n;
    let mut theta = 0.0;
    for j in low..=high {
        let t = run.time[j] - t0;
        theta += run.readings[angle][j] - omega * t - 0.5 * slope * t * t;
    }
    (theta / n, omega, slope)
}

fn motion(run: &Run, at: usize) -> Motion {
    let low = at.saturating_sub(6);
    let high = (at + 6).min(run.len() - 1);
    let omega = &run.readings[1][low..=high];
    let mean = omega.iter().sum::<f64>() / omega.len() as f64;
    let theta = &run.readings[0][low..=high];
    let span = theta.iter().fold(f64::MIN, |a, b| a.max(*b))
        - theta.iter().fold(f64::MAX, |a, b| a.min(*b));
    let slowest = omega.iter().fold(f64::MAX, |a, b| a.min(b.abs()));
    // Nothing holds a disc whose pins are lifted but bearings that stick, which take it up within a sample: where it seems
    // to rest it may as well be turning back.
    let is_held = run.normal_force[at] > 0.0;
    if mean.abs() < 0.06 && span < 0.008 {
        if is_held {
            Motion::Stuck
        } else {
            Motion::Unclear
        }
    } else if slowest > 0.5 {
        Motion::Sliding
    } else {
        Motion::Unclear
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resting(angle: f64) -> Run {
        let samples = 200;
        Run {
            name: "rest".to_owned(),
            time: (0..samples).map(|j| 0.01 * f64::from(j)).collect(),
            voltage: vec![0.0; 200],
            normal_force: vec![30.0; 200],
            readings: [
                vec![angle; 200],
                vec![0.0; 200],
                vec![angle; 200],
                vec![0.0; 200],
            ],
        }
    }

    #[test]
    fn a_disc_seems_to_rest_only_where_a_pin_can_hold_it() {
        let cut = Cut {
            length: LENGTH,
            begin: Begin::Clear,
            back_emf: 0.5,
            resistance: 0.3,
        };
        let mut run = resting(31.4);
        assert_eq!(cut.windows(0, &run)[1].deviations[1], AT_REST);
        run.normal_force.fill(0.0);
        assert!(cut.windows(0, &run)[1].deviations[1] > 0.1);
    }

    #[test]
    fn a_stretch_after_a_hole_starts_where_the_disc_is() {
        let cut = Cut {
            length: LENGTH,
            begin: Begin::Clear,
            back_emf: 0.5,
            resistance: 0.3,
        };
        let from_zero = cut.windows(0, &resting(0.0));
        assert_eq!(from_zero[0].anchor[index::THETA], 0.0);
        assert!(from_zero[0].deviations[0] < 1e-6);
        let turned_on = cut.windows(0, &resting(31.4));
        assert!((turned_on[0].anchor[index::THETA] - 31.4).abs() < 1e-9);
        assert!(turned_on[0].deviations[0] > 0.1);
    }
}
