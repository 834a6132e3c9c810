//! A measured record, ready for comparison with a model.

use inference::record::RawRecord;

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
    /// A record of the engine of any rig, whose instruments round down by these steps.
    pub fn of(record: &RawRecord, steps: &[f64]) -> Self {
        Self {
            name: record.name.clone(),
            time: record.time.clone(),
            voltage: record.voltage.clone(),
            normal_force: record.normal_force.clone(),
            readings: std::array::from_fn(|c| {
                record.readings[c]
                    .iter()
                    .map(|x| x + 0.5 * steps[c])
                    .collect()
            }),
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
