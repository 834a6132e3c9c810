//! Records of a rig, as a simulation with noise makes them.
#![allow(dead_code, reason = "no test uses all of it")]

use inference::record::{Instruments, RawRecord, channel};
use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES, index};

/// Time between samples [s].
const INTERVAL: f64 = 0.02;
/// Length of a record [s].
const LENGTH: f64 = 12.0;

/// Irregular numbers of mean 0 and deviation 1: sums of twelve uniform ones.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// The instruments.
pub fn instruments() -> Instruments {
    Instruments {
        noise: [0.002, 0.05, 0.001, 0.02, 0.0, 0.002, 0.05],
        ..Instruments::default()
    }
}

/// Speeds [rad/s] and normal forces on the two discs [N] that are held for a quarter of a record each.
pub type Steps = [(f64, f64, f64); 4];

/// Both discs slide, and both stick for a while.
const USUAL: Steps = [
    (3.0, 0.0, 0.0),
    (6.0, 20.0, 30.0),
    (4.0, 40.0, 10.0),
    (8.0, 10.0, 40.0),
];

/// A record of `truth` from rest.
pub fn record(truth: &Rig<f64>, seed: u64) -> RawRecord {
    record_of(truth, seed, USUAL)
}

/// A record of `truth` from rest under these inputs.
pub fn record_of(truth: &Rig<f64>, seed: u64, steps: Steps) -> RawRecord {
    let held = |time: f64| {
        let (speed, force, force_1) = steps[((time / LENGTH * 4.0) as usize).min(3)];
        (truth.voltage_for_speed(speed), force, force_1)
    };
    let mut noise = Noise(seed);
    let mut record = RawRecord {
        name: format!("run-{seed}"),
        ..RawRecord::default()
    };
    let inputs = |time: f64| {
        let (voltage, force, force_1) = held(time);
        RigInputs::held(voltage, force, force_1)
    };
    let mut run =
        Simulation::new(*truth, Options::default(), 0.0, [0.0; STATES], inputs(0.0)).unwrap();
    let channels = [
        (channel::THETA, index::THETA),
        (channel::OMEGA, index::OMEGA),
        (channel::THETA3, index::THETA3),
        (channel::OMEGA3, index::OMEGA3),
        (channel::THETA1, index::THETA1),
        (channel::OMEGA1, index::OMEGA1),
    ];
    let seen = if truth.disc1.is_some() { 6 } else { 4 };
    for sample in 0..(LENGTH / INTERVAL) as usize {
        let time = sample as f64 * INTERVAL;
        run.advance_to(time).unwrap();
        run.set_inputs(time, inputs(time)).unwrap();
        let state = run.state_at(time);
        let (voltage, force, force_1) = held(time);
        record.time.push(time);
        record.voltage.push(voltage);
        record.normal_force.push(force);
        if truth.disc1.is_some() {
            record.normal_force_1.push(force_1);
        }
        for (channel, component) in channels.into_iter().take(seen) {
            let error = instruments().noise[channel] * noise.next();
            record.readings[channel].push(state[component] + error);
        }
    }
    record
}

/// Models with many derivatives need more than the usual stack of a thread.
pub fn prepare_threads() {
    let _ = rayon::ThreadPoolBuilder::new()
        .stack_size(64 << 20)
        .build_global();
}
