//! What the instruments do to the rig's motion.

use serde::Deserialize;
use std::f64::consts::TAU;
use thiserror::Error;

/// Steps and noise of the rig's instruments, SI units.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Sensors {
    /// Step of the disc's encoder [rad], rounded down.
    pub disc_encoder_step: f64,
    /// Step of the motor's encoder seen at the gearbox output [rad], rounded down.
    pub gear_encoder_step: f64,
    /// Standard deviation of the disc's velocity [rad/s].
    pub disc_velocity_noise: f64,
    /// Standard deviation of the gearbox output's velocity [rad/s].
    pub gear_velocity_noise: f64,
    /// Standard deviation of the load cell [N].
    pub load_cell_noise: f64,
}

/// What is wrong with a sensor file.
#[derive(Debug, Error)]
pub enum SensorError {
    /// Not TOML, or a key is missing, unknown or of the wrong type.
    #[error(
        "{file}: {message}; needed are disc_encoder_step, gear_encoder_step [rad], disc_velocity_noise, gear_velocity_noise [rad/s] and load_cell_noise [N]"
    )]
    Syntax {
        /// File name.
        file: String,
        /// What the parser says.
        message: String,
    },
    /// A value is not a positive number.
    #[error("{file}: {key} = {value} must be a finite number above 0")]
    Range {
        /// File name.
        file: String,
        /// Key.
        key: &'static str,
        /// Value.
        value: f64,
    },
}

impl Default for Sensors {
    /// The instruments of the dissertation, section 4.2: encoders of 1000 ticks per turn (the
    /// motor's behind the gearbox of 8:1), tachometers and a load cell.
    fn default() -> Self {
        Self {
            disc_encoder_step: TAU / 1000.0,
            gear_encoder_step: TAU / 8000.0,
            disc_velocity_noise: 0.05,
            gear_velocity_noise: 0.05 / 8.0,
            load_cell_noise: 0.2,
        }
    }
}

impl Sensors {
    /// Reads a sensor file's text; `file` names it in messages.
    pub fn parse(text: &str, file: &str) -> Result<Self, SensorError> {
        let sensors: Self = toml::from_str(text).map_err(|error| SensorError::Syntax {
            file: file.to_owned(),
            message: error.message().to_owned(),
        })?;
        for (key, value) in [
            ("disc_encoder_step", sensors.disc_encoder_step),
            ("gear_encoder_step", sensors.gear_encoder_step),
            ("disc_velocity_noise", sensors.disc_velocity_noise),
            ("gear_velocity_noise", sensors.gear_velocity_noise),
            ("load_cell_noise", sensors.load_cell_noise),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(SensorError::Range {
                    file: file.to_owned(),
                    key,
                    value,
                });
            }
        }
        Ok(sensors)
    }

    /// Standard deviations of the four motion channels θ2, ω2, θ3, ω3: a step rounded down errs by
    /// step/√12 about its middle.
    pub fn deviations(&self) -> [f64; 4] {
        [
            self.disc_encoder_step / 12f64.sqrt(),
            self.disc_velocity_noise,
            self.gear_encoder_step / 12f64.sqrt(),
            self.gear_velocity_noise,
        ]
    }
}
