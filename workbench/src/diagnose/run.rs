//! A measured record, ready for comparison with a model.

use super::load_cell::denoise;
use super::sensors::Sensors;

/// Motion channels in the order θ2, ω2, θ3, ω3.
pub const CHANNELS: usize = 4;

/// One record.
#[derive(Clone, Debug)]
pub struct Run {
    /// File name.
    pub name: String,
    /// Sample times [s].
    pub time: Vec<f64>,
    /// Motor voltage [V], held from each sample to the next.
    pub voltage: Vec<f64>,
    /// Normal force [N], freed from noise.
    pub normal_force: Vec<f64>,
    /// Readings of θ2, ω2, θ3, ω3; encoder readings moved to the middle of their step.
    pub readings: [Vec<f64>; CHANNELS],
}

impl Run {
    /// A record from its columns.
    pub fn new(
        name: String,
        time: Vec<f64>,
        voltage: Vec<f64>,
        load_cell: &[f64],
        motion: [&[f64]; CHANNELS],
        sensors: &Sensors,
    ) -> Self {
        let half_steps = [
            0.5 * sensors.disc_encoder_step,
            0.0,
            0.5 * sensors.gear_encoder_step,
            0.0,
        ];
        let mut readings: [Vec<f64>; CHANNELS] = Default::default();
        for (c, channel) in motion.iter().enumerate() {
            readings[c] = channel.iter().map(|x| x + half_steps[c]).collect();
        }
        let normal_force = denoise(load_cell, sensors.load_cell_noise);
        Self {
            name,
            time,
            voltage,
            normal_force,
            readings,
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Mean sampling interval [s].
    pub fn interval(&self) -> f64 {
        match (self.time.first(), self.time.last()) {
            (Some(first), Some(last)) if self.len() > 1 => (last - first) / (self.len() - 1) as f64,
            _ => 0.0,
        }
    }
}
