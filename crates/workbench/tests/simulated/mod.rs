//! Records for tests, made by the model itself with the rig's sensors: any length and sampling interval.
#![allow(dead_code, reason = "each test that includes this uses a part of it")]

use std::f64::consts::TAU;
use std::path::Path;

use inference::record::RawRecord;
use workbench::component::Native;
use workbench::diagnose::restart::course;
use workbench::diagnose::sensors::Sensors;
use workbench::files::record::Record;

/// The model file of the small case.
pub fn model() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/unbalance/model.toml");
    std::fs::read_to_string(path).unwrap()
}

/// Voltage [V] and normal force [N] at a time [s].
pub type Inputs = fn(f64) -> (f64, f64);

/// Two speeds under two normal forces.
pub fn steps(time: f64) -> (f64, f64) {
    let (slow, light) = (time < 4.0, (3.0..7.0).contains(&time));
    (
        if slow { 1.5 } else { 2.8 },
        if light { 12.0 } else { 30.0 },
    )
}

/// Another course, to judge on.
pub fn other_steps(time: f64) -> (f64, f64) {
    (
        if time < 5.0 { 2.2 } else { 1.6 },
        if time < 3.0 { 30.0 } else { 20.0 },
    )
}

/// A record of `model` from rest over `seconds`, sampled every `interval` [s], as CSV.
pub fn record(model: &str, inputs: Inputs, seconds: f64, interval: f64, seed: u64) -> String {
    let samples = (seconds / interval).round() as usize + 1;
    let time: Vec<f64> = (0..samples).map(|j| j as f64 * interval).collect();
    // Inputs change on a grid of 0.1 s, whatever the sampling.
    let held = |t: f64| inputs(((t + 1e-9) * 10.0).floor() / 10.0);
    let (voltage, normal_force): (Vec<f64>, Vec<f64>) = time.iter().map(|&t| held(t)).unzip();
    let mut planned = Record::new("inputs", time).unwrap();
    planned.add_column("u", voltage).unwrap();
    planned.add_column("N2", normal_force).unwrap();
    sensed(model, &planned, seed)
}

/// What the rig's sensors show of `model` under planned inputs, as CSV.
pub fn sensed(model: &str, planned: &Record, seed: u64) -> String {
    let instruments = Sensors::dissertation().completed(&inference::record::Instruments::default());
    let load_cell_noise = Sensors::dissertation().load_cell_noise.unwrap();
    let samples = planned.len();
    let run = RawRecord {
        name: "simulated".to_owned(),
        time: planned.time().to_vec(),
        voltage: planned.require("u").unwrap().to_vec(),
        normal_force: planned.require("N2").unwrap().to_vec(),
        ..RawRecord::default()
    };
    let mut native = Native::from_text(model, "the hidden truth").unwrap();
    let rest = [0.0; stickslip::plant::STATES];
    let (motion, _) = course(&mut native, &run, 0, samples - 1, &rest).unwrap();
    let mut noise = Noise(seed);
    let step_down = |angle: f64, step: f64| (angle / step).floor() * step;
    let mut text = "time,u,N2,theta,theta_dot,theta3,theta3_dot\n".to_owned();
    for row in 0..samples {
        let force = run.normal_force[row];
        let load_cell = if force == 0.0 {
            0.0
        } else {
            force + load_cell_noise * noise.next()
        };
        text.push_str(&format!(
            "{:.4},{:.5},{load_cell:.3},{:.6},{:.4},{:.6},{:.5}\n",
            run.time[row],
            run.voltage[row],
            step_down(motion[0][row], instruments.step[0]),
            motion[1][row] + instruments.noise[1] * noise.next(),
            step_down(motion[2][row], instruments.step[2]),
            motion[3][row] + instruments.noise[3] * noise.next(),
        ));
    }
    text
}

/// Normal numbers of mean 0 and deviation 1 (Box and Muller) from a linear congruential generator (Knuth).
pub struct Noise(pub u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// The next number.
    pub fn next(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (TAU * self.uniform()).cos()
    }
}
