//! The text of a record for any instruments, and which columns it has.

use crate::effects::Effects;
use crate::excitation::Excitation;
use crate::instruments::{Instruments, encoder};
use crate::random::Stream;
use crate::simulator::Sample;
use libm::sin;
use std::fmt::Write;

/// What is measured beside time, voltage and normal force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
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
        let of = |value: &dyn Fn(usize) -> f64| (0..count).map(value).collect::<Vec<f64>>();
        let force = |forces: &[f64], bias: f64, stream: &mut Stream| {
            forces
                .iter()
                .map(|&force| {
                    let noise = tools.normal_force * stream.normal();
                    if force == 0.0 {
                        0.0
                    } else {
                        force + bias + noise
                    }
                })
                .collect::<Vec<f64>>()
        };
        let angle = |angles: Vec<f64>, step: f64, stream: &mut Stream| {
            angles
                .into_iter()
                .map(|angle| {
                    // An angle that is not quantised is noisy as much as a quantised one errs.
                    let noise = step / libm::sqrt(12.0) * stream.normal();
                    if tools.quantised {
                        encoder(angle, step)
                    } else {
                        angle + noise
                    }
                })
                .collect::<Vec<f64>>()
        };
        let speed = |speeds: Vec<f64>, noise: f64, stream: &mut Stream| {
            speeds
                .into_iter()
                .map(|speed| speed + noise * stream.normal())
                .collect::<Vec<f64>>()
        };
        let hidden = self.effects;
        let start = sin(hidden.eccentricity_ph);
        let seen = |k: usize| {
            let angle = self.samples[k].seen_disc_angle;
            angle + hidden.eccentricity * (sin(angle - hidden.eccentricity_ph) + start)
        };
        let samples = self.samples;
        let fine = |noise: f64| decimals(noise / 30.0);
        let (disc_step, gear_step) = (tools.disc_encoder_step, tools.gear_encoder_step);
        let mut columns: Vec<Column> = vec![
            (
                "time",
                decimals(self.interval) + 1,
                of(&|k| k as f64 * self.interval),
            ),
            (
                "u",
                decimals(self.voltage_step),
                self.excitation.voltage.clone(),
            ),
            (
                "N2",
                fine(tools.normal_force),
                force(&self.excitation.normal_force, hidden.cell_bias, stream),
            ),
            (
                "theta",
                fine(disc_step) + 1,
                angle(of(&seen), disc_step, stream),
            ),
            (
                "theta_dot",
                fine(tools.disc_speed),
                speed(
                    of(&|k| hidden.tacho_gain * samples[k].seen_disc_speed),
                    tools.disc_speed,
                    stream,
                ),
            ),
            (
                "theta3",
                fine(gear_step) + 1,
                angle(of(&|k| samples[k].state.gearbox_angle), gear_step, stream),
            ),
            (
                "theta3_dot",
                fine(tools.gearbox_speed),
                speed(
                    of(&|k| samples[k].state.gearbox_speed),
                    tools.gearbox_speed,
                    stream,
                ),
            ),
            (
                "i",
                fine(tools.current),
                speed(of(&|k| samples[k].state.current), tools.current, stream),
            ),
        ];
        if let Some(disc1) = self.disc1_effects {
            let disc1_force = force(&self.excitation.disc1_force, disc1.cell_bias, stream);
            columns.insert(3, ("N1", fine(tools.normal_force), disc1_force));
            columns.push((
                "theta1",
                fine(disc_step) + 1,
                angle(of(&|k| samples[k].state.disc1_angle), disc_step, stream),
            ));
            columns.push((
                "theta1_dot",
                fine(tools.disc_speed),
                speed(
                    of(&|k| samples[k].state.disc1_speed),
                    tools.disc_speed,
                    stream,
                ),
            ));
        }
        columns.retain(|(name, ..)| self.sensors.has(name));
        columns
    }
}
