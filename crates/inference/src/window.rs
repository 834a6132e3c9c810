//! Windows: stretches of a record over which the model is restarted from the measured motion.

use crate::load_error::LoadLevel;
use crate::record::{Run, channel};
use crate::scales::Scales;
use crate::trace::{Motion, begins_at_rest};
use stickslip::plant::{Rig, RigKind, RigState, STATES, index};
use stickslip::series::Scalar;

/// Length of a window, in radians of the shaft's natural oscillation: 0.38 of its period.
pub const LENGTH: f64 = 2.4;
/// Length of a window over which even a wrong model stays near the measured motion.
pub const SHORT: f64 = 0.8;
/// Length where nothing was measured of the disc: its motion must be told from what it does to the motor.
pub const UNSEEN: f64 = 6.3;
/// Length of the pieces over which a disturbance torque is held.
pub const PIECE: f64 = 0.24;
/// Length of pieces over which coordinates hardly change.
pub const FINE_PIECE: f64 = 0.06;
/// Acceleration from which on it is clear whether the disc speeds up or slows down, as a share of the records'.
const CLEAR_ACCELERATION: f64 = 0.1;
/// Standard deviation of the velocity of a disc that sticks: it does not move at all.
const AT_REST: f64 = 1e-7;
/// Standard deviation of a start that is known exactly.
const EXACT: f64 = 1e-9;

/// State components that a window may start from: all of the reduced rig, the relaxing torque, the bristles, and disc D1 of
/// the full rig.
pub const START_COMPONENTS: [usize; 9] = [
    index::THETA,
    index::OMEGA,
    index::THETA3,
    index::OMEGA3,
    index::CURRENT,
    index::RELAXING_TORQUE,
    index::BRISTLE,
    index::THETA1,
    index::OMEGA1,
];
/// Number of those components.
pub const STARTS: usize = START_COMPONENTS.len();
/// Those of them, at the end, that only the full rig has.
const DISC1_STARTS: usize = 2;

/// Number of the components, from the first, that windows of this rig start from.
#[must_use]
pub fn starts_of<S: Scalar>(rig: &Rig<S>) -> usize {
    match rig.kind() {
        RigKind::Reduced => STARTS - DISC1_STARTS,
        RigKind::Full => STARTS,
    }
}

/// From where, and under which torques of its own, a window runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// State at the first sample.
    pub state: RigState<f64>,
    /// Torque on the disc beside the model's in each piece, from the first on; those that are not there are zero.
    pub torques: Vec<f64>,
}

impl From<RigState<f64>> for Start {
    fn from(state: RigState<f64>) -> Self {
        Self {
            state,
            torques: Vec::new(),
        }
    }
}

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
    /// Accelerations of D2 and D1 at the first sample as measured: on which branch of a law with branches the window starts.
    pub accelerations: [f64; 2],
    /// Standard deviations with which the anchor is known, in the order of [`START_COMPONENTS`].
    pub deviations: [f64; STARTS],
    /// Level of the normal force on D2 in its middle.
    pub load: Option<LoadLevel>,
}

impl Window {
    /// Whether the state at the first sample is known: the rig is at rest there.
    #[must_use]
    pub fn is_start_known(&self) -> bool {
        self.deviations.iter().all(|deviation| *deviation <= EXACT)
    }

    /// `start` moved by `change`, in the order of [`START_COMPONENTS`]. A disc that sticks stays exactly at rest: the
    /// smallest velocity would be slip, and a law with branches would go on from there on one of them.
    #[must_use]
    pub fn moved(&self, start: &RigState<f64>, change: &[f64; STARTS]) -> RigState<f64> {
        let mut moved = *start;
        for ((component, change), deviation) in START_COMPONENTS
            .into_iter()
            .zip(change)
            .zip(self.deviations)
        {
            let is_disc = component == index::OMEGA || component == index::OMEGA1;
            if !is_disc || deviation > AT_REST {
                moved[component] += change;
            }
        }
        moved
    }
}

/// Where windows are wanted to start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begin {
    /// Where it is clear whether the disc sticks or slides, and if possible whether it speeds up or slows down: a law with
    /// branches goes on from there on the branch that was measured.
    Clear,
    /// Where the disc sticks or speeds up: a component that is given a state and nothing else begins on that branch.
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

    fn is_good(self, run: &Run, scales: &Scales, at: usize) -> bool {
        match run.traces.motion[at] {
            _ if !run.traces.is_clear(at) => false,
            Motion::Unclear => false,
            Motion::Stuck => true,
            Motion::Sliding => {
                let disc = &run.traces.disc;
                let along = disc.acceleration[at] * disc.velocity[at].signum();
                let clear = CLEAR_ACCELERATION * scales.acceleration;
                match self {
                    Self::Clear => along.abs() > clear,
                    Self::SpeedingUp => along > clear,
                }
            }
        }
    }
}

/// How records are cut into windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Length of a window.
    pub length: f64,
    /// Where windows are wanted to start.
    pub begin: Begin,
    /// Sizes of the records.
    pub scales: Scales,
    /// Back-EMF constant seen from the gearbox output.
    pub back_emf: f64,
    /// Armature resistance.
    pub resistance: f64,
    /// Current that carries friction and motor.
    pub current: f64,
}

impl Cut {
    /// Windows of `length` for records of this rig.
    #[must_use]
    pub fn of(rig: &Rig<f64>, scales: &Scales, length: f64, begin: Begin) -> Self {
        let (ratio, motor) = (rig.gearbox.ratio, &rig.motor);
        let back_emf = ratio * motor.back_emf_constant;
        let carried = scales.torque + ratio * motor.coulomb_torque;
        let current = carried / (ratio * motor.torque_constant)
            + 0.1 * back_emf * scales.speed / motor.resistance;
        Self {
            length,
            begin,
            scales: *scales,
            back_emf,
            resistance: motor.resistance,
            current,
        }
    }

    /// Cuts a record into windows that start where they are wanted, as far as there is such a place.
    #[must_use]
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
                .find(|d| self.begin.is_good(run, &self.scales, last + d))
                .or_else(|| {
                    (0..per_window / 2)
                        .take_while(within)
                        .find(|d| run.traces.is_clear(last + d))
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
        let load = LoadLevel::at(run_index, run, (first + last) / 2);
        if first == 0 && starts_at_rest(run, &self.scales) {
            return Window {
                run: run_index,
                first,
                last,
                anchor,
                accelerations: [0.0; 2],
                deviations: [EXACT; STARTS],
                load,
            };
        }
        let traces = &run.traces;
        let (disc, gear) = (&traces.disc, &traces.gear);
        let stuck = traces.motion[first] == Motion::Stuck;
        anchor[index::THETA] = disc.angle[first];
        anchor[index::OMEGA] = if stuck { 0.0 } else { disc.velocity[first] };
        anchor[index::THETA3] = gear.angle[first];
        anchor[index::OMEGA3] = gear.velocity[first];
        let voltage = run.voltage[first.saturating_sub(1)];
        anchor[index::CURRENT] = if run.has(channel::CURRENT) {
            run.readings[channel::CURRENT][first]
        } else {
            (voltage - self.back_emf * gear.velocity[first]) / self.resistance
        };
        let Scales { speed, twist, .. } = self.scales;
        // An angle that was read is told again by the readings of the window; one that was summed up is not.
        let angle = |known: bool, deviation: f64, share: f64| {
            if known {
                share * twist + 10.0 * deviation
            } else {
                deviation.max(0.01 * twist)
            }
        };
        let velocity = |stuck: bool, deviation: f64| {
            if stuck {
                AT_REST
            } else {
                0.15 * speed + 10.0 * deviation
            }
        };
        let seen = run.has(channel::THETA) || !run.has(channel::OMEGA);
        let (mut disc1_angle, mut disc1_velocity, mut disc1_acceleration) = (EXACT, EXACT, 0.0);
        if let Some(disc1) = &traces.disc1 {
            let stuck = disc1.motion[first] == Motion::Stuck;
            let disc1 = &disc1.disc;
            anchor[index::THETA1] = disc1.angle[first];
            anchor[index::OMEGA1] = if stuck { 0.0 } else { disc1.velocity[first] };
            disc1_acceleration = disc1.acceleration[first];
            let seen = run.has(channel::THETA1) || !run.has(channel::OMEGA1);
            disc1_angle = angle(seen, disc1.angle_deviation[first], 0.3);
            disc1_velocity = velocity(stuck, disc1.velocity_deviation);
        }
        Window {
            run: run_index,
            first,
            last,
            anchor,
            accelerations: [disc.acceleration[first], disc1_acceleration],
            deviations: [
                angle(seen, disc.angle_deviation[first], 0.3),
                velocity(stuck, disc.velocity_deviation),
                angle(run.has(channel::THETA3), gear.angle_deviation[first], 0.1),
                0.05 * speed + 10.0 * gear.velocity_deviation,
                self.current,
                0.1 * twist,
                0.003 * twist,
                disc1_angle,
                disc1_velocity,
            ],
            load,
        }
    }
}

/// Whether a run starts at rest with angles zero, as records that begin with the rig do; a stretch after a hole has turned on.
fn starts_at_rest(run: &Run, scales: &Scales) -> bool {
    let at_zero = |channel: usize| {
        run.readings[channel]
            .first()
            .is_none_or(|angle| angle.abs() < 0.02 * scales.twist)
    };
    begins_at_rest(run, scales.speed, run.traces.disc.velocity_deviation)
        && at_zero(channel::THETA)
        && at_zero(channel::THETA3)
        && at_zero(channel::THETA1)
}
