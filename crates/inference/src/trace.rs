//! Angle, velocity and acceleration of disc and gearbox output from whatever was measured of them.

use crate::record::{Instruments, Run, channel};
use std::f64::consts::TAU;
use stickslip::plant::Rig;

/// Half of the stretch through which a line is laid to smooth a reading, in periods of the shaft.
const HALF_LINE: f64 = 0.023;
/// Half of the stretch over which it is asked whether a disc moves, in periods of the shaft.
const HALF_LOOK: f64 = 0.046;
/// Standard deviations that a reading may differ from rest by chance.
const SURELY: f64 = 4.0;
/// Share of the records' highest speed below which a motion counts as slow.
const SLOW: f64 = 0.05;

/// One body's motion over the samples of a record.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// Angle.
    pub angle: Vec<f64>,
    /// Angular velocity.
    pub velocity: Vec<f64>,
    /// Angular acceleration.
    pub acceleration: Vec<f64>,
    /// Standard deviation of the angle.
    pub angle_deviation: Vec<f64>,
    /// Standard deviation of the velocity.
    pub velocity_deviation: f64,
}

impl Trace {
    /// The same where only changes of the angle are known: about `told`, as well as that is known.
    fn about(self, told: &Self) -> Self {
        let distance = told.distance(&self);
        self.shifted(distance, told)
    }

    /// The same with an angle larger by `distance`, which is known as well as `told`'s.
    fn shifted(mut self, distance: f64, told: &Self) -> Self {
        for angle in &mut self.angle {
            *angle += distance;
        }
        for (own, deviation) in self.angle_deviation.iter_mut().zip(&told.angle_deviation) {
            *own = own.hypot(*deviation);
        }
        self
    }

    /// By how much its angle is ahead of `other`'s on average.
    fn distance(&self, other: &Self) -> f64 {
        let pairs = self.angle.iter().zip(&other.angle);
        pairs.map(|(own, other)| own - other).sum::<f64>() / self.angle.len().max(1) as f64
    }
}

/// How the disc moves about a sample, as far as the readings tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// It does not move.
    Stuck,
    /// It moves all the time.
    Sliding,
    /// The readings do not tell.
    Unclear,
}

/// Disc D1 of the full rig.
#[derive(Clone, Debug, Default)]
pub struct Disc1Traces {
    /// The disc.
    pub disc: Trace,
    /// How it moves at each sample.
    pub motion: Vec<Motion>,
}

/// Both ends of the shaft, and disc D1.
#[derive(Clone, Debug, Default)]
pub struct Traces {
    /// The disc.
    pub disc: Trace,
    /// The gearbox output.
    pub gear: Trace,
    /// How the disc moves at each sample.
    pub motion: Vec<Motion>,
    /// Speed that the motion hardly exceeds.
    pub speed: f64,
    /// Disc D1, in the full rig.
    pub disc1: Option<Disc1Traces>,
}

impl Traces {
    /// Whether the readings tell how every disc moves about a sample.
    #[must_use]
    pub fn is_clear(&self, at: usize) -> bool {
        let disc1 = self.disc1.as_ref().map(|disc1| disc1.motion[at]);
        self.motion[at] != Motion::Unclear && disc1 != Some(Motion::Unclear)
    }
}

/// Where the readings of a disc are, and what presses on it.
struct Sensed<'a> {
    angle: usize,
    velocity: usize,
    normal_force: &'a [f64],
}

pub(crate) fn traces(run: &Run, rig: &Rig<f64>, instruments: &Instruments) -> Traces {
    let mut gear = body(run, channel::THETA3, channel::OMEGA3, instruments)
        .unwrap_or_else(|| driven(run, rig));
    let measured = body(run, channel::THETA, channel::OMEGA, instruments);
    let is_measured = measured.is_some();
    let mut disc = measured.unwrap_or_else(|| twisted(run, &gear, rig));
    let speed = speed(&gear).max(if is_measured { speed(&disc) } else { 0.0 });
    let is_at_rest = begins_at_rest(run, speed, disc.velocity_deviation);
    if is_measured && !is_at_rest {
        let told = twisted(run, &gear, rig);
        if !run.has(channel::THETA) {
            disc = disc.about(&told);
        } else if !run.has(channel::THETA3) {
            gear = gear.shifted(disc.distance(&told), &told);
        }
    }
    let motions = |disc: &Trace, is_measured: bool, sensed: &Sensed<'_>| -> Vec<Motion> {
        if !is_measured {
            return vec![Motion::Unclear; run.len()];
        }
        let seen: Vec<Motion> = (0..run.len())
            .map(|at| motion(run, disc, at, sensed, instruments, speed))
            .collect();
        lasting(&seen, half(HALF_LOOK, run))
    };
    let sensed = Sensed {
        angle: channel::THETA,
        velocity: channel::OMEGA,
        normal_force: &run.normal_force,
    };
    let motion = motions(&disc, is_measured, &sensed);
    let disc1 = rig.disc1.as_ref().map(|disc1| {
        let sensed = Sensed {
            angle: channel::THETA1,
            velocity: channel::OMEGA1,
            normal_force: &run.normal_force_1,
        };
        let measured = body(run, sensed.angle, sensed.velocity, instruments);
        let is_measured = measured.is_some();
        let period = (disc1.disc.inertia / disc1.shaft.stiffness).sqrt();
        let carried = carried(&disc, speed, period);
        let disc = match measured {
            None => carried,
            Some(disc1) if is_at_rest || run.has(sensed.angle) => disc1,
            Some(disc1) => disc1.about(&carried),
        };
        let motion = motions(&disc, is_measured, &sensed);
        Disc1Traces { disc, motion }
    });
    Traces {
        disc,
        gear,
        motion,
        speed,
        disc1,
    }
}

/// Whether a run begins with the rig at rest, as far as velocities tell of which the highest is `speed` and the disc's is known to
/// `deviation`. A stretch after a hole has begun before.
pub(crate) fn begins_at_rest(run: &Run, speed: f64, deviation: f64) -> bool {
    let is_slow = |channel: usize| {
        let first = run.readings[channel].first();
        first.is_none_or(|velocity| velocity.abs() < 0.03 * speed + 6.0 * deviation)
    };
    let is_first = run
        .time
        .first()
        .is_some_and(|time| time.abs() < run.interval());
    is_first
        && [channel::OMEGA, channel::OMEGA3, channel::OMEGA1]
            .into_iter()
            .all(is_slow)
}

/// Disc D1 where nothing of it was measured: it turns with D2, but for what it swings on its shaft in `period`, a radian of
/// its oscillation.
fn carried(disc: &Trace, speed: f64, period: f64) -> Trace {
    Trace {
        angle_deviation: vec![speed * period; disc.angle.len()],
        velocity_deviation: 0.5 * speed,
        ..disc.clone()
    }
}

fn half(share: f64, run: &Run) -> usize {
    ((share * TAU / run.interval()).round() as usize).max(2)
}

/// The speed that 95 % of the samples stay below.
fn speed(trace: &Trace) -> f64 {
    let mut speeds: Vec<f64> = trace.velocity.iter().map(|v| v.abs()).collect();
    speeds.sort_by(f64::total_cmp);
    speeds
        .get((0.95 * speeds.len() as f64) as usize)
        .copied()
        .unwrap_or(0.0)
}

fn body(run: &Run, angle: usize, velocity: usize, instruments: &Instruments) -> Option<Trace> {
    let deviations = instruments.deviations();
    let n = run.len();
    match (run.has(angle), run.has(velocity)) {
        (false, false) => None,
        (true, true) => {
            let half = half(HALF_LINE, run);
            let mut trace = Trace {
                angle_deviation: vec![deviations[angle]; n],
                velocity_deviation: deviations[velocity] / ((2 * half + 1) as f64).sqrt(),
                ..Trace::default()
            };
            for at in 0..n {
                let [v, a, _] = polynomial(run, velocity, at, half, 1);
                trace.velocity.push(v);
                trace.acceleration.push(a);
                let (low, high) = around(at, half, n);
                let sum: f64 = (low..=high)
                    .map(|j| {
                        let t = run.time[j] - run.time[at];
                        run.readings[angle][j] - v * t - 0.5 * a * t * t
                    })
                    .sum();
                trace.angle.push(sum / (high - low + 1) as f64);
            }
            Some(trace)
        }
        (true, false) => {
            let half = half(HALF_LOOK, run);
            let span = half as f64 * run.interval();
            let mut trace = Trace {
                angle_deviation: vec![deviations[angle]; n],
                velocity_deviation: deviations[angle] / span,
                ..Trace::default()
            };
            for at in 0..n {
                let [x, v, a] = polynomial(run, angle, at, half, 2);
                trace.angle.push(x);
                trace.velocity.push(v);
                trace.acceleration.push(2.0 * a);
            }
            Some(trace)
        }
        (false, true) => {
            let half = half(HALF_LINE, run);
            let noise = deviations[velocity];
            let mut trace = Trace {
                velocity_deviation: noise / ((2 * half + 1) as f64).sqrt(),
                ..Trace::default()
            };
            let mut travelled = 0.0;
            for at in 0..n {
                let [v, a, _] = polynomial(run, velocity, at, half, 1);
                trace.velocity.push(v);
                trace.acceleration.push(a);
                if at > 0 {
                    let series = &run.readings[velocity];
                    travelled +=
                        0.5 * (series[at] + series[at - 1]) * (run.time[at] - run.time[at - 1]);
                }
                trace.angle.push(travelled);
                let since = run.time[at] - run.time[0];
                trace
                    .angle_deviation
                    .push(noise * (since * run.interval()).sqrt());
            }
            Some(trace)
        }
    }
}

/// The gearbox output where nothing of it was measured: at the speed that the voltage gives.
fn driven(run: &Run, rig: &Rig<f64>) -> Trace {
    let back_emf = rig.gearbox.ratio * rig.motor.back_emf_constant;
    let velocity: Vec<f64> = run.voltage.iter().map(|u| u / back_emf).collect();
    let mut angle = vec![0.0; run.len()];
    for at in 1..run.len() {
        angle[at] = angle[at - 1] + velocity[at - 1] * (run.time[at] - run.time[at - 1]);
    }
    let typical = velocity.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    Trace {
        angle,
        acceleration: vec![0.0; run.len()],
        angle_deviation: vec![typical; run.len()],
        velocity_deviation: 0.3 * typical,
        velocity,
    }
}

/// The disc where nothing of it was measured: the shaft is twisted by what the motor gives and does not need itself.
fn twisted(run: &Run, gear: &Trace, rig: &Rig<f64>) -> Trace {
    let (motor, ratio) = (&rig.motor, rig.gearbox.ratio);
    let half = half(HALF_LOOK, run);
    let n = run.len();
    let twist: Vec<f64> = (0..n)
        .map(|at| {
            let speed = gear.velocity[at];
            let before = run.voltage[at.saturating_sub(1)];
            let (low, high) = around(at, half, n);
            let current = if run.has(channel::CURRENT) {
                run.readings[channel::CURRENT][low..=high]
                    .iter()
                    .sum::<f64>()
                    / (high - low + 1) as f64
            } else {
                (before - motor.back_emf_constant * ratio * speed) / motor.resistance
            };
            let friction = if speed.abs() > gear.velocity_deviation {
                motor.coulomb_torque * speed.signum()
            } else {
                0.0
            };
            let drive =
                motor.torque_constant * current - motor.viscous_damping * ratio * speed - friction;
            let inertia = ratio * ratio * motor.inertia;
            (inertia * gear.acceleration[at] - ratio * drive) / rig.shaft.stiffness
        })
        .collect();
    let mut trace = Trace {
        angle_deviation: vec![0.0; n],
        ..Trace::default()
    };
    for at in 0..n {
        let (low, high) = around(at, half, n);
        let count = (high - low + 1) as f64;
        let mean = twist[low..=high].iter().sum::<f64>() / count;
        let (mut st, mut stt) = (0.0, 0.0);
        for j in low..=high {
            let t = run.time[j] - run.time[at];
            st += t * twist[j];
            stt += t * t;
        }
        let rate = if stt > 0.0 { st / stt } else { 0.0 };
        trace.angle.push(gear.angle[at] + mean);
        trace.velocity.push(gear.velocity[at] + rate);
        trace.acceleration.push(0.0);
    }
    let typical = twist.iter().map(|x| x.abs()).sum::<f64>() / n.max(1) as f64;
    trace.angle_deviation = vec![0.3 * typical; n];
    trace.velocity_deviation = 0.5 * typical;
    trace
}

fn around(at: usize, half: usize, n: usize) -> (usize, usize) {
    (at.saturating_sub(half), (at + half).min(n - 1))
}

/// Coefficients of the polynomial of first or second degree through the readings around a sample, about that sample.
fn polynomial(run: &Run, channel: usize, at: usize, half: usize, degree: usize) -> [f64; 3] {
    let (low, high) = around(at, half, run.len());
    let degree = degree.min(high - low);
    let mut moments = nalgebra::Matrix3::<f64>::zeros();
    let mut right = nalgebra::Vector3::<f64>::zeros();
    for j in low..=high {
        let t = (run.time[j] - run.time[at]) / (half as f64 * run.interval());
        let powers = [1.0, t, t * t];
        for a in 0..=degree {
            right[a] += powers[a] * run.readings[channel][j];
            for b in 0..=degree {
                moments[(a, b)] += powers[a] * powers[b];
            }
        }
    }
    for a in degree + 1..3 {
        moments[(a, a)] = 1.0;
    }
    let unit = half as f64 * run.interval();
    let solved = moments.cholesky().map_or(right, |c| c.solve(&right));
    [solved[0], solved[1] / unit, solved[2] / (unit * unit)]
}

/// The same motions, where a disc that rests does so before and after, too: one that turns back seems to rest as well.
fn lasting(seen: &[Motion], half: usize) -> Vec<Motion> {
    (0..seen.len())
        .map(|at| {
            let (low, high) = around(at, half, seen.len());
            match seen[at] {
                Motion::Stuck if seen[low] != Motion::Stuck || seen[high] != Motion::Stuck => {
                    Motion::Unclear
                }
                own => own,
            }
        })
        .collect()
}

fn motion(
    run: &Run,
    disc: &Trace,
    at: usize,
    sensed: &Sensed<'_>,
    instruments: &Instruments,
    speed: f64,
) -> Motion {
    let half = half(HALF_LOOK, run);
    let (low, high) = around(at, half, run.len());
    let count = (high - low + 1) as f64;
    let span_of_time = run.time[high] - run.time[low];
    let mut still = true;
    // Speed that a disc may have which seems to rest.
    let mut hidden = f64::INFINITY;
    if run.has(sensed.angle) {
        let angles = &run.readings[sensed.angle][low..=high];
        let span = angles.iter().fold(f64::MIN, |a, b| a.max(*b))
            - angles.iter().fold(f64::MAX, |a, b| a.min(*b));
        let most =
            1.01 * instruments.step[sensed.angle] + 1.5 * SURELY * instruments.noise[sensed.angle];
        still &= span <= most;
        hidden = hidden.min(most / span_of_time);
    }
    if run.has(sensed.velocity) {
        let velocities = &run.readings[sensed.velocity][low..=high];
        let mean = velocities.iter().sum::<f64>() / count;
        let most = SURELY * instruments.deviations()[sensed.velocity] / count.sqrt();
        still &= mean.abs() <= most;
        hidden = hidden.min(most);
    }
    // Nothing holds a disc whose pins are lifted but bearings that stick, which take it up within a sample: where it seems
    // to rest it may as well be turning back.
    let is_held = sensed
        .normal_force
        .get(at)
        .is_some_and(|force| *force > 0.0);
    if still {
        return if is_held && hidden < 2.0 * SLOW * speed {
            Motion::Stuck
        } else {
            Motion::Unclear
        };
    }
    let slowest = disc.velocity[low..=high]
        .iter()
        .fold(f64::MAX, |a, v| a.min(v.abs()));
    if slowest > SLOW * speed && slowest > SURELY * disc.velocity_deviation {
        Motion::Sliding
    } else {
        Motion::Unclear
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_that_only_turns_back_does_not_rest() {
        use Motion::{Sliding, Stuck, Unclear};
        let turning = [Sliding, Unclear, Stuck, Stuck, Stuck, Unclear, Sliding];
        assert!(!lasting(&turning, 2).contains(&Stuck));
        let resting = [Stuck, Stuck, Stuck, Stuck, Stuck, Unclear, Sliding];
        assert_eq!(lasting(&resting, 2)[..3], [Stuck; 3]);
    }
}
