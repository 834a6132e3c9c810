//! A measured record in the plant's units, and what its instruments do.

use crate::trace::{Traces, traces};
use crate::units::PlantUnits;
use stickslip::plant::Rig;

/// Motion channels in the order θ2, ω2, θ3, ω3, i, θ1, ω1; the last two are of the full rig.
pub const CHANNELS: usize = 7;
/// Positions of the channels.
pub mod channel {
    /// Angle of the disc.
    pub const THETA: usize = 0;
    /// Angular velocity of the disc.
    pub const OMEGA: usize = 1;
    /// Angle of the gearbox output.
    pub const THETA3: usize = 2;
    /// Angular velocity of the gearbox output.
    pub const OMEGA3: usize = 3;
    /// Armature current.
    pub const CURRENT: usize = 4;
    /// Angle of disc D1.
    pub const THETA1: usize = 5;
    /// Angular velocity of disc D1.
    pub const OMEGA1: usize = 6;
}

/// Steps and noise of the instruments, in the plant's units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instruments {
    /// Step to which a channel is rounded down; 0 where it is not.
    pub step: [f64; CHANNELS],
    /// Standard deviation of the noise of a channel.
    pub noise: [f64; CHANNELS],
}

impl Instruments {
    /// Standard deviations of the channels: a step rounded down errs by step/√12 about its middle.
    #[must_use]
    pub fn deviations(&self) -> [f64; CHANNELS] {
        std::array::from_fn(|c| (self.step[c] / 12f64.sqrt()).hypot(self.noise[c]))
    }
}

/// A record as read, SI units: readings are empty where a channel was not measured.
#[derive(Clone, Debug, Default)]
pub struct RawRecord {
    /// File name.
    pub name: String,
    /// Sample times [s].
    pub time: Vec<f64>,
    /// Motor voltage [V].
    pub voltage: Vec<f64>,
    /// Normal force on disc D2 freed from noise [N].
    pub normal_force: Vec<f64>,
    /// The same on disc D1; empty where there is none.
    pub normal_force_1: Vec<f64>,
    /// Standard deviations of the load cells' noise before, on D2 and D1 [N].
    pub load_deviations: [f64; 2],
    /// Readings of the channels.
    pub readings: [Vec<f64>; CHANNELS],
}

/// One record in the plant's units.
#[derive(Clone, Debug)]
pub struct Run {
    /// File name.
    pub name: String,
    /// Sample times.
    pub time: Vec<f64>,
    /// Motor voltage, held from each sample to the next.
    pub voltage: Vec<f64>,
    /// Normal force on disc D2.
    pub normal_force: Vec<f64>,
    /// Normal force on disc D1; empty where there is none.
    pub normal_force_1: Vec<f64>,
    /// Standard deviations of the noise that the two were freed from.
    pub load_deviations: [f64; 2],
    /// Readings, in the middle of their steps; empty where a channel was not measured.
    pub readings: [Vec<f64>; CHANNELS],
    /// Angle, velocity and acceleration of the bodies as the readings tell them.
    pub traces: Traces,
}

impl Run {
    /// A record in the units of its plant.
    #[must_use]
    pub fn new(
        raw: &RawRecord,
        units: &PlantUnits,
        rig: &Rig<f64>,
        instruments: &Instruments,
    ) -> Self {
        let channel_units = channel_units(units);
        let scaled =
            |series: &[f64], unit: f64| -> Vec<f64> { series.iter().map(|x| x / unit).collect() };
        let readings: [Vec<f64>; CHANNELS] = std::array::from_fn(|c| {
            raw.readings[c]
                .iter()
                .map(|x| x / channel_units[c] + 0.5 * instruments.step[c])
                .collect()
        });
        let mut run = Self {
            name: raw.name.clone(),
            time: scaled(&raw.time, units.time),
            voltage: scaled(&raw.voltage, units.voltage()),
            normal_force: scaled(&raw.normal_force, units.force),
            normal_force_1: scaled(&raw.normal_force_1, units.force),
            load_deviations: raw.load_deviations.map(|noise| noise / units.force),
            readings,
            traces: Traces::default(),
        };
        run.traces = traces(&run, rig, instruments);
        run
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there are no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Mean sampling interval.
    #[must_use]
    pub fn interval(&self) -> f64 {
        match (self.time.first(), self.time.last()) {
            (Some(first), Some(last)) if self.len() > 1 => (last - first) / (self.len() - 1) as f64,
            _ => 0.0,
        }
    }

    /// Whether a channel was measured.
    #[must_use]
    pub fn has(&self, channel: usize) -> bool {
        !self.readings[channel].is_empty()
    }
}

/// SI values of the units of the channels.
#[must_use]
pub fn channel_units(units: &PlantUnits) -> [f64; CHANNELS] {
    let speed = 1.0 / units.time;
    [1.0, speed, 1.0, speed, units.current, 1.0, speed]
}
