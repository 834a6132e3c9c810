//! Replicas of the records: what the instruments would have read, were the fitted model the plant.
//!
//! What a right model leaves of such records nobody has to explain: noise, an error of each level of the load, friction that
//! fluctuates and throws windows from one branch of a law to the other.

use crate::fit::Fit;
use crate::marginal::Disturbance;
use crate::problem::Problem;
use crate::random::Random;
use crate::record::{CHANNELS, Run, channel};
use crate::structure::{Structure, structures};
use crate::trace::{Traces, traces};
use stickslip::integrator::{IntegrationError, Options, Simulation};
use stickslip::plant::{Rig, RigInputs, RigState, index};

/// Steps in which the fitted model settles on a replica.
pub(crate) const STEPS: usize = 4;
/// State components that the channels read.
const READ: [usize; CHANNELS] = [
    index::THETA,
    index::OMEGA,
    index::THETA3,
    index::OMEGA3,
    index::CURRENT,
    index::THETA1,
    index::OMEGA1,
];

/// The structure that `fit` leaves of replica number `seed`, strongest first; `None` where the model cannot run through the
/// records.
#[must_use]
pub fn left_of_replica(problem: &Problem, fit: &Fit, seed: u64) -> Option<Vec<Structure>> {
    let (refitted, data) = fit.settled(problem, replica(problem, fit, seed)?, STEPS);
    Some(structures(&data.divided(), &refitted))
}

/// Replica number `seed` of the records, from the first window of each on; `None` where the model cannot run through them.
#[must_use]
pub fn replica(problem: &Problem, fit: &Fit, seed: u64) -> Option<Vec<Run>> {
    let rig = fit.hypothesis.rig_at().ok()?;
    let mut played = Played {
        problem,
        rig: &rig,
        disturbance: &fit.disturbance,
        random: Random::new(seed),
    };
    let data = &problem.long;
    let mut runs = Vec::with_capacity(data.runs.len());
    for (number, run) in data.runs.iter().enumerate() {
        let first = data.windows.iter().position(|window| window.run == number);
        if let Some(first) = first {
            let start = &fit.starts[first].state;
            runs.push(played.run(run, data.windows[first].first, start).ok()?);
        }
    }
    Some(runs)
}

/// A model that is run through a record's inputs and read by its instruments.
struct Played<'a> {
    problem: &'a Problem,
    rig: &'a Rig<f64>,
    disturbance: &'a Disturbance,
    random: Random,
}

impl Played<'_> {
    /// The replica of `run` from sample `first` on, where it is in `start`.
    fn run(
        &mut self,
        run: &Run,
        first: usize,
        start: &RigState<f64>,
    ) -> Result<Run, IntegrationError> {
        let time = &run.time[first..];
        let voltage = &run.voltage[first..];
        let forces = [&run.normal_force, &run.normal_force_1]
            .map(|force| force.get(first..).unwrap_or_default());
        let [pressed, pressed_1] = [0, 1]
            .map(|disc| self.pressed(forces[disc], run.load_deviations[disc], run.interval()));
        let inputs = |sample: usize| {
            let on_1 = pressed_1.get(sample).copied().unwrap_or_default();
            RigInputs::held(voltage[sample], pressed[sample], on_1)
        };
        let mut simulation =
            Simulation::new(*self.rig, Options::default(), time[0], *start, inputs(0))?;
        let delay = self.rig.effects.sensor_delay.map_or(0.0, |d| d.delay);
        let mut motion = vec![[0.0; CHANNELS]; time.len()];
        // The channels of D2 show what was `delay` earlier, all others are read at the sample.
        let mut next_delayed = 0;
        for sample in 0..time.len() {
            while next_delayed < time.len() && time[next_delayed] - delay <= time[sample] {
                let when = (time[next_delayed] - delay).max(time[0]);
                simulation.advance_to(when)?;
                for c in [channel::THETA, channel::OMEGA] {
                    motion[next_delayed][c] = simulation.component_at(READ[c], when);
                }
                next_delayed += 1;
            }
            simulation.advance_to(time[sample])?;
            for c in (channel::THETA3..CHANNELS).filter(|c| run.has(*c)) {
                motion[sample][c] = simulation.component_at(READ[c], time[sample]);
            }
            simulation.set_inputs(time[sample], inputs(sample))?;
        }
        let readings = std::array::from_fn(|c| {
            if run.has(c) {
                motion.iter().map(|at| self.reading(c, at[c])).collect()
            } else {
                Vec::new()
            }
        });
        let mut replica = Run {
            name: run.name.clone(),
            time: time.to_vec(),
            voltage: voltage.to_vec(),
            normal_force: forces[0].to_vec(),
            normal_force_1: forces[1].to_vec(),
            load_deviations: run.load_deviations,
            readings,
            traces: Traces::default(),
        };
        replica.traces = traces(&replica, &self.problem.rig, &self.problem.instruments);
        Ok(replica)
    }

    /// What presses where the load cell, freed from noise of this `deviation`, tells `force`: each level errs by what the noise
    /// leaves of its mean. Friction is in proportion to it, but for a load exponent, so that it fluctuates where friction does.
    fn pressed(&mut self, force: &[f64], deviation: f64, interval: f64) -> Vec<f64> {
        let mut pressed = Vec::with_capacity(force.len());
        for level in force.chunk_by(|a, b| a == b) {
            let is_level = level.len() > 1 && level[0] > 0.0;
            let error = if is_level {
                deviation / (level.len() as f64).sqrt() * self.random.normal()
            } else {
                0.0
            };
            pressed.extend(level.iter().map(|force| force + error));
        }
        let remembered = (-interval / self.disturbance.correlation_time).exp();
        let mut fluctuation = self.random.normal();
        for force in &mut pressed {
            fluctuation = remembered * fluctuation
                + (1.0 - remembered * remembered).sqrt() * self.random.normal();
            *force *= 1.0 + self.disturbance.relative * fluctuation;
        }
        pressed
    }

    /// What the instrument of a channel reads of a value, in the middle of its step.
    fn reading(&mut self, channel: usize, value: f64) -> f64 {
        let (step, noise) = (
            self.problem.instruments.step[channel],
            self.problem.instruments.noise[channel],
        );
        let read = value + noise * self.random.normal();
        if step > 0.0 {
            ((read / step).floor() + 0.5) * step
        } else {
            read
        }
    }
}

/// Probability that a gain in log evidence like those of `replicas` reaches `gain`: half of them exceed their median, and beyond
/// it, as half of a χ², they fall off exponentially; no less than the share of them that do reach it. `None`
/// where no replica has a gain.
#[must_use]
pub fn exceeded(gain: f64, mut replicas: Vec<f64>) -> Option<f64> {
    replicas.retain(|own| own.is_finite());
    replicas.sort_by(f64::total_cmp);
    let upper = &replicas[replicas.len() / 2..];
    let median = *upper.first()?;
    let beyond: f64 = upper.iter().map(|gain| gain - median).sum();
    let mean = beyond / upper.len().saturating_sub(1) as f64;
    let reaching = replicas.iter().filter(|own| **own >= gain).count();
    let share = reaching as f64 / replicas.len() as f64;
    Some((0.5 * (-(gain - median).max(0.0) / mean).exp()).max(share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_is_judged_by_how_far_replicas_scatter() {
        let calm = || vec![-12.0, -11.0, -10.0, -9.0, -8.0];
        let heavy = || vec![-12.0, -11.0, -10.0, 5.0, 15.0];
        assert!(exceeded(10.0, calm()).unwrap() < 1e-5);
        assert!(exceeded(20.0, heavy()).unwrap() > 0.05);
        assert!((exceeded(-7.5, calm()).unwrap() - 0.5 * (-2.5_f64 / 1.5).exp()).abs() < 1e-12);
    }

    #[test]
    fn what_a_replica_leaves_too_is_no_surprise() {
        let outlier = vec![-12.0, -11.9, -11.8, -11.7, -11.6, -11.5, -11.4, -11.3, 30.0];
        assert!(exceeded(29.0, outlier).unwrap() >= 1.0 / 9.0);
        assert_eq!(exceeded(5.0, vec![20.0]), Some(1.0));
        assert_eq!(exceeded(5.0, vec![f64::NAN]), None);
    }
}
