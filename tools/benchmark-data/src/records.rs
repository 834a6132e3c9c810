//! The text of a record for any instruments, and which columns it has.

use crate::effects::Effects;
use crate::excitation::Excitation;
use crate::instruments::Instruments;
use crate::random::Stream;
use crate::simulator::Sample;
use clap::ValueEnum;
use std::fmt::Write;

/// What is measured beside time, voltage and normal force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Sensors {
    /// Angles and speeds of disc and gearbox output.
    #[default]
    All,
    /// Angles only.
    Encoders,
    /// Speeds only.
    Tachometers,
    /// Gearbox output's angle and the motor's current; nothing of the disc.
    NoDisc,
    /// Angles, speeds and the motor's current.
    Current,
}

impl Sensors {
    /// Whether column `name` is recorded.
    pub fn has(self, name: &str) -> bool {
        match name {
            "time" | "u" | "N2" | "N1" => true,
            "theta" | "theta1" => !matches!(self, Self::Tachometers | Self::NoDisc),
            "theta_dot" | "theta1_dot" => !matches!(self, Self::Encoders | Self::NoDisc),
            "theta3" => self != Self::Tachometers,
            "theta3_dot" => !matches!(self, Self::Encoders | Self::NoDisc),
            "i" => matches!(self, Self::NoDisc | Self::Current),
            _ => false,
        }
    }
}

/// Everything a record is made of.
pub struct Recording<'a> {
    /// The inputs.
    pub excitation: &'a Excitation,
    /// The states.
    pub samples: &'a [Sample],
    /// What is hidden on disc D2 and elsewhere.
    pub effects: &'a Effects,
    /// What is hidden on disc D1.
    pub disc1_effects: Option<&'a Effects>,
    /// The instruments.
    pub instruments: &'a Instruments,
    /// Which of them there are.
    pub sensors: Sensors,
    /// Sampling interval [s].
    pub interval: f64,
    /// Step to which the voltage is stated [V].
    pub voltage_step: f64,
}

/// Decimals that show a hundredth of `resolution`.
pub fn decimals(resolution: f64) -> usize {
    (-libm::floor(libm::log10(resolution) + 1e-9)).max(0.0) as usize
}

/// A column: name, decimals, values.
type Column = (&'static str, usize, Vec<f64>);

impl Recording<'_> {
    /// The record as CSV. Noise is drawn for every channel, recorded or not, so that the same seed
    /// gives the same readings whatever is left out.
    pub fn csv(&self, stream: &mut Stream) -> String {
        let columns = self.columns(stream);
        let mut text = String::with_capacity(16 * columns.len() * self.samples.len());
        let names: Vec<_> = columns.iter().map(|(name, ..)| *name).collect();
        let _ = writeln!(text, "{}", names.join(","));
        for row in 0..self.samples.len() {
            for (index, (_, decimals, values)) in columns.iter().enumerate() {
                if index > 0 {
                    text.push(',');
                }
                // A negative zero becomes a zero.
                let value = values[row] + 0.0;
                let _ = write!(text, "{value:.decimals$}");
            }
            text.push('\n');
        }
        text
    }

    fn columns(&self, stream: &mut Stream) -> Vec<Column> {
        let tools = self.instruments;
        let count = self.samples.len();
        let mut of = |read: &dyn Fn(usize, &mut Stream) -> f64| -> Vec<f64> {
            (0..count).map(|k| read(k, stream)).collect()
        };
        let (hidden, samples) = (self.effects, self.samples);
        let (force, disc1_force) = (&self.excitation.normal_force, &self.excitation.disc1_force);
        let fine = |noise: f64| decimals(noise / 30.0);
        let (disc_step, gear_step) = (tools.disc_encoder_step, tools.gear_encoder_step);
        let (disc_noise, gear_noise) = (tools.disc_speed, tools.gearbox_speed);
        let mut columns: Vec<Column> = vec![
            (
                "time",
                decimals(self.interval) + 1,
                of(&|k, _| k as f64 * self.interval),
            ),
            (
                "u",
                decimals(self.voltage_step),
                self.excitation.voltage.clone(),
            ),
            (
                "N2",
                fine(tools.normal_force),
                of(&|k, stream| tools.force(force[k], hidden.cell_bias, stream)),
            ),
            (
                "theta",
                fine(disc_step) + 1,
                of(&|k, stream| {
                    let angle = hidden.encoder_angle(samples[k].seen_disc_angle);
                    tools.angle(angle, disc_step, stream)
                }),
            ),
            (
                "theta_dot",
                fine(disc_noise),
                of(&|k, stream| {
                    let speed = hidden.tacho_gain * samples[k].seen_disc_speed;
                    speed + disc_noise * stream.normal()
                }),
            ),
            (
                "theta3",
                fine(gear_step) + 1,
                of(&|k, stream| tools.angle(samples[k].state.gearbox_angle, gear_step, stream)),
            ),
            (
                "theta3_dot",
                fine(gear_noise),
                of(&|k, stream| samples[k].state.gearbox_speed + gear_noise * stream.normal()),
            ),
            (
                "i",
                fine(tools.current),
                of(&|k, stream| samples[k].state.current + tools.current * stream.normal()),
            ),
        ];
        if let Some(disc1) = self.disc1_effects {
            let forces = of(&|k, stream| tools.force(disc1_force[k], disc1.cell_bias, stream));
            columns.insert(3, ("N1", fine(tools.normal_force), forces));
            columns.push((
                "theta1",
                fine(disc_step) + 1,
                of(&|k, stream| tools.angle(samples[k].state.disc1_angle, disc_step, stream)),
            ));
            columns.push((
                "theta1_dot",
                fine(disc_noise),
                of(&|k, stream| samples[k].state.disc1_speed + disc_noise * stream.normal()),
            ));
        }
        columns.retain(|(name, ..)| self.sensors.has(name));
        columns
    }
}
