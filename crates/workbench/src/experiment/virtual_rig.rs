//! The rig as it stands in for the lost records: runs at an operating point, sampled and seen through sensors.

use std::f64::consts::{PI, TAU};

use stickslip::friction::{Law, TwoGaussianMu, TwoGaussianTorque};
use stickslip::integrator::{HybridSystem, Options, Simulation};
use stickslip::plant::{NormalForceWobble, Rig, RigInputs, STATES, index};
use stickslip::series::{evaluate, evaluate_derivative};

use super::ExperimentError;
use crate::analysis::spectrum::Spectrum;
use inference::random::Random;

const REDUCED_RIG: &str = include_str!("../../../../modelDescription/reduced-rig.toml");
const FULL_RIG: &str = include_str!("../../../../modelDescription/full-rig.toml");
/// Model file of the rig that stands in for the reduced one of the lost records.
pub(super) const VIRTUAL_RIG: &str = include_str!("../../targets/experiment-rig.toml");
/// The published facts to which it is calibrated.
pub(super) const VIRTUAL_FACTS: &str = include_str!("../../targets/experiment.toml");
/// Model file of the rig that stands in for the full one of the lost records.
pub(super) const VIRTUAL_FULL_RIG: &str = include_str!("../../targets/experiment-full-rig.toml");
/// The published facts to which it is calibrated.
pub(super) const VIRTUAL_FULL_FACTS: &str = include_str!("../../targets/experiment-full.toml");

/// Sampling time of the rig's data acquisition [s] (Section 4.2).
pub const SAMPLE_STEP: f64 = 0.01;
/// Encoder resolution [rad]: 1000 ticks per revolution (Section 4.2).
pub const ENCODER_STEP: f64 = TAU / 1000.0;
/// Standard deviation of the tachometers' noise [rad/s]; not given, chosen.
const TACHOMETER_NOISE: f64 = 0.03;

/// Eq. 6-2 with calibrated numbers: meets the published cycles with a single-valued loop.
pub const CALIBRATED_MU: TwoGaussianMu<f64> = TwoGaussianMu {
    a1: 0.27115,
    b1: -3.07246,
    c1: 1.28946,
    a2: 0.18567,
    b2: 0.47960,
    c2: 2.62303,
    omega_centre: 7.15956,
    acceleration_semi_axis: 58.2873,
};

/// Eq. 6-1 with calibrated numbers: the torque at 50 N, whatever the normal force. Of the sets that meet every bar the one
/// nearest to the torque of [`CALIBRATED_MU`] at 50 N, since both laws were fitted to one record.
pub const CALIBRATED_TORQUE: TwoGaussianTorque<f64> = TwoGaussianTorque {
    a1: 1.17981,
    b1: -2.927,
    c1: 2.36411,
    a2: 0.894694,
    b2: 2.2018,
    c2: 3.22014,
    omega_centre: 6.70694,
    acceleration_semi_axis: 74.6222,
};

/// rpm in rad/s.
pub fn radians_per_second(rpm: f64) -> f64 {
    rpm * PI / 30.0
}

/// The reduced rig with its published numbers.
pub fn reduced_rig() -> Result<Rig<f64>, ExperimentError> {
    Ok(Rig::from_toml(REDUCED_RIG, "reduced-rig.toml")?)
}

/// The full rig with its published numbers.
pub fn full_rig() -> Result<Rig<f64>, ExperimentError> {
    Ok(Rig::from_toml(FULL_RIG, "full-rig.toml")?)
}

/// The reduced rig under the calibrated second law.
pub fn two_gaussian_rig() -> Result<Rig<f64>, ExperimentError> {
    let mut rig = reduced_rig()?;
    rig.law = Law::TwoGaussianMu(CALIBRATED_MU);
    Ok(rig)
}

/// The reduced rig under the calibrated first law.
pub fn first_law_rig() -> Result<Rig<f64>, ExperimentError> {
    let mut rig = reduced_rig()?;
    rig.law = Law::TwoGaussianTorque(CALIBRATED_TORQUE);
    Ok(rig)
}

/// The same under the second law with a normal force that varies with the disc's angle.
pub fn wobbling_rig(amplitude: f64) -> Result<Rig<f64>, ExperimentError> {
    let mut rig = two_gaussian_rig()?;
    rig.effects.normal_force_wobble = Some(NormalForceWobble {
        amplitude,
        phase: 0.0,
    });
    Ok(rig)
}

/// The rig that stands in for the reduced one of the lost records.
pub fn virtual_rig() -> Result<Rig<f64>, ExperimentError> {
    Ok(Rig::from_toml(VIRTUAL_RIG, "experiment-rig.toml")?)
}

/// The rig that stands in for the full one of the lost records.
pub fn virtual_full_rig() -> Result<Rig<f64>, ExperimentError> {
    Ok(Rig::from_toml(
        VIRTUAL_FULL_RIG,
        "experiment-full-rig.toml",
    )?)
}

/// The normal force of `rig` at the disc angle `theta` [rad], relative to its mean.
#[must_use]
pub fn relative_force(rig: &Rig<f64>, theta: f64) -> f64 {
    rig.effects.normal_force_wobble.map_or(1.0, |wobble| {
        1.0 + wobble.amplitude * (theta - wobble.phase).cos()
    })
}

/// An operating point and what of the run is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Operation {
    /// ω_ref [rpm].
    pub speed_rpm: f64,
    /// N2 [N].
    pub normal_force: f64,
    /// N1 [N]; only the full rig has it.
    pub normal_force_1: f64,
    /// Time from rest that is left out [s].
    pub settle: f64,
    /// Time that is kept [s].
    pub duration: f64,
    /// Sampling step [s].
    pub step: f64,
}

impl Operation {
    /// The reduced rig's steady state: 60 s after 60 s, every 10 ms.
    pub fn steady(speed_rpm: f64, normal_force: f64) -> Self {
        Self {
            speed_rpm,
            normal_force,
            normal_force_1: 0.0,
            settle: 60.0,
            duration: 60.0,
            step: SAMPLE_STEP,
        }
    }
}

/// A sampled run; times count from the end of settling.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Run {
    /// Time [s].
    pub time: Vec<f64>,
    /// θ2 [rad].
    pub theta: Vec<f64>,
    /// ω2 [rad/s].
    pub omega: Vec<f64>,
    /// dω2/dt [rad/s²].
    pub acceleration: Vec<f64>,
    /// θ3 [rad].
    pub theta3: Vec<f64>,
    /// ω3 [rad/s].
    pub omega3: Vec<f64>,
    /// Armature current [A].
    pub current: Vec<f64>,
    /// θ1 [rad].
    pub theta1: Vec<f64>,
    /// ω1 [rad/s].
    pub omega1: Vec<f64>,
    /// Friction torque on D2 [N m].
    pub friction: Vec<f64>,
    /// Time during which D2's contact stuck [s].
    pub sticking: f64,
    /// Time during which D1's contact stuck [s].
    pub sticking_1: f64,
    /// Smallest margin of the algebraic loop.
    pub loop_margin: f64,
}

impl Run {
    /// Runs `rig` from rest at an operating point.
    pub fn of(rig: &Rig<f64>, operation: &Operation) -> Result<Self, ExperimentError> {
        let speed = radians_per_second(operation.speed_rpm);
        let inputs = RigInputs::held(
            rig.voltage_for_speed(speed),
            operation.normal_force,
            operation.normal_force_1,
        );
        let options = Options {
            tolerance: 1e-9,
            ..Options::default()
        };
        let mut simulation = Simulation::new(*rig, options, 0.0, [0.0; STATES], inputs)?;
        simulation.advance_to(operation.settle)?;
        let mut run = Self {
            loop_margin: f64::INFINITY,
            ..Self::default()
        };
        let end = operation.settle + operation.duration;
        let samples = (operation.duration / operation.step).round() as usize;
        loop {
            let from = simulation.segment_start();
            let to = simulation.segment_end().min(end);
            let inside = to - from.max(operation.settle);
            if simulation.mode().disc.is_stuck() {
                run.sticking += inside;
            } else {
                run.loop_margin = run.loop_margin.min(simulation.jet().loop_margin());
            }
            if simulation.mode().disc1.is_stuck() {
                run.sticking_1 += inside;
            }
            while run.time.len() <= samples {
                let time = operation.settle + run.time.len() as f64 * operation.step;
                if time > simulation.segment_end() {
                    break;
                }
                run.sample(&simulation, time, time - from, operation);
            }
            if simulation.segment_end() >= end {
                return Ok(run);
            }
            simulation.next_segment()?;
        }
    }

    fn sample(
        &mut self,
        simulation: &Simulation<f64, Rig<f64>>,
        time: f64,
        local: f64,
        operation: &Operation,
    ) {
        let state = simulation.state_at(time);
        let jet = simulation.jet();
        let velocity = &simulation.system().states(jet)[index::OMEGA];
        let order = jet.friction_torque().len() - 1;
        self.time.push(self.time.len() as f64 * operation.step);
        self.theta.push(state[index::THETA]);
        self.omega.push(state[index::OMEGA]);
        self.acceleration
            .push(evaluate_derivative(&velocity[..=order], local));
        self.theta3.push(state[index::THETA3]);
        self.omega3.push(state[index::OMEGA3]);
        self.current.push(state[index::CURRENT]);
        self.theta1.push(state[index::THETA1]);
        self.omega1.push(state[index::OMEGA1]);
        self.friction.push(evaluate(jet.friction_torque(), local));
    }

    /// Share of the time kept during which D2 sticks.
    pub fn stick_fraction(&self) -> f64 {
        self.sticking / self.time.last().copied().unwrap_or(f64::NAN)
    }

    /// Lowest and highest velocity of D2 [rad/s].
    pub fn range(&self) -> (f64, f64) {
        range(&self.omega)
    }

    /// Half of the range of D2's velocity [rad/s].
    pub fn half_amplitude(&self) -> f64 {
        let (low, high) = self.range();
        0.5 * (high - low)
    }
}

/// Lowest and highest of a series.
pub fn range(series: &[f64]) -> (f64, f64) {
    series
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(*value), high.max(*value))
        })
}

/// An angle as an encoder of 1000 ticks gives it [rad].
pub fn encoder(angle: &[f64]) -> Vec<f64> {
    angle
        .iter()
        .map(|angle| (angle / ENCODER_STEP).floor() * ENCODER_STEP)
        .collect()
}

/// A velocity as a noisy tachometer gives it [rad/s].
pub fn tachometer(velocity: &[f64], seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    velocity
        .iter()
        .map(|velocity| velocity + TACHOMETER_NOISE * random.normal())
        .collect()
}

/// Frequency of the strongest peak of a velocity's spectrum above 0.2 Hz [Hz]; NaN where nothing oscillates.
pub fn peak_frequency(velocity: &[f64], step: f64) -> f64 {
    Spectrum::new(velocity, step)
        .and_then(|spectrum| spectrum.peak(0.2))
        .map_or(f64::NAN, |peak| peak.frequency)
}
