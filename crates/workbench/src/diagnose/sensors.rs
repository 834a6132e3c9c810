//! What the instruments do to the rig's motion.

use inference::record::{CHANNELS, Instruments, RawRecord, channel};
use serde::Deserialize;
use std::f64::consts::TAU;
use thiserror::Error;

use super::record_check::{COLUMNS, INPUTS};

/// Keys of the channels in a sensor file; the two discs have sensors of one kind.
const KEYS: [&str; CHANNELS] = [
    "disc_encoder_step",
    "disc_velocity_noise",
    "gear_encoder_step",
    "gear_velocity_noise",
    "current_noise",
    "disc_encoder_step",
    "disc_velocity_noise",
];

/// Steps and noise of the rig's instruments, SI units; what was not stated is absent.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Sensors {
    /// Step of the encoder of every disc [rad], rounded down.
    pub disc_encoder_step: Option<f64>,
    /// Step of the motor's encoder seen at the gearbox output [rad], rounded down.
    pub gear_encoder_step: Option<f64>,
    /// Standard deviation of the velocity of every disc [rad/s].
    pub disc_velocity_noise: Option<f64>,
    /// Standard deviation of the gearbox output's velocity [rad/s].
    pub gear_velocity_noise: Option<f64>,
    /// Standard deviation of the armature current [A].
    pub current_noise: Option<f64>,
    /// Standard deviation of every load cell [N].
    pub load_cell_noise: Option<f64>,
}

/// What is wrong with a sensor file.
#[derive(Debug, Error)]
pub enum SensorError {
    /// Not TOML, or a key is unknown or of the wrong type.
    #[error(
        "{file}: {message}; it may have disc_encoder_step, gear_encoder_step [rad], disc_velocity_noise, gear_velocity_noise [rad/s], current_noise [A] and load_cell_noise [N]"
    )]
    Syntax {
        /// File name.
        file: String,
        /// What the parser says.
        message: String,
    },
    /// Keys of columns that were measured are missing.
    #[error("{file}: lacks {keys}; {record} has the columns that they tell of")]
    Missing {
        /// File name.
        file: String,
        /// The keys.
        keys: String,
        /// A record that needs them.
        record: String,
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

impl Sensors {
    /// The instruments of the dissertation, section 4.2: encoders of 1000 ticks per turn (the motor's behind the gearbox of
    /// 8:1), tachometers and a load cell.
    #[must_use]
    pub fn dissertation() -> Self {
        Self {
            disc_encoder_step: Some(TAU / 1000.0),
            gear_encoder_step: Some(TAU / 8000.0),
            disc_velocity_noise: Some(0.05),
            gear_velocity_noise: Some(0.05 / 8.0),
            current_noise: None,
            load_cell_noise: Some(0.2),
        }
    }

    /// Reads a sensor file's text; `file` names it in messages.
    ///
    /// # Errors
    /// [`SensorError`], naming the file, the key and what would be right.
    pub fn parse(text: &str, file: &str) -> Result<Self, SensorError> {
        let sensors: Self = toml::from_str(text).map_err(|error| SensorError::Syntax {
            file: file.to_owned(),
            message: error.message().to_owned(),
        })?;
        let load_cell = ("load_cell_noise", sensors.load_cell_noise);
        for (key, value) in KEYS.into_iter().zip(sensors.channels()).chain([load_cell]) {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(SensorError::Range {
                    file: file.to_owned(),
                    key,
                    value,
                });
            }
        }
        Ok(sensors)
    }

    /// What is stated of the channels: an encoder's step or another instrument's noise.
    #[must_use]
    pub fn channels(&self) -> [Option<f64>; CHANNELS] {
        [
            self.disc_encoder_step,
            self.disc_velocity_noise,
            self.gear_encoder_step,
            self.gear_velocity_noise,
            self.current_noise,
            self.disc_encoder_step,
            self.disc_velocity_noise,
        ]
    }

    /// Refuses a sensor file that says nothing of a channel that `record` has; the current is then left aside instead.
    ///
    /// # Errors
    /// [`SensorError::Missing`].
    pub fn check_for(
        &self,
        file: &str,
        record: &str,
        has: [bool; CHANNELS],
    ) -> Result<(), SensorError> {
        let mut missing: Vec<&str> = Vec::new();
        for c in (0..CHANNELS).filter(|c| *c != channel::CURRENT) {
            let is_missing = has[c] && self.channels()[c].is_none();
            if is_missing && !missing.contains(&KEYS[c]) {
                missing.push(KEYS[c]);
            }
        }
        if missing.is_empty() {
            return Ok(());
        }
        Err(SensorError::Missing {
            file: file.to_owned(),
            keys: missing.join(", "),
            record: record.to_owned(),
        })
    }

    /// Steps and noise as stated, and as the records tell them (`estimated`) where nothing is stated.
    #[must_use]
    pub fn completed(&self, estimated: &Instruments) -> Instruments {
        let mut instruments = *estimated;
        for (c, stated) in self.channels().into_iter().enumerate() {
            if let Some(stated) = stated {
                let is_step = [channel::THETA, channel::THETA3, channel::THETA1].contains(&c);
                instruments.step[c] = if is_step { stated } else { 0.0 };
                instruments.noise[c] = if is_step { 0.0 } else { stated };
            }
        }
        instruments
    }
}

/// Instruments in words.
#[must_use]
pub fn in_words(instruments: &Instruments) -> String {
    let units = ["rad", "rad/s", "rad", "rad/s", "A", "rad", "rad/s"];
    let names = &COLUMNS[INPUTS..];
    let told: Vec<String> = (0..CHANNELS)
        .filter_map(|c| {
            let (step, noise) = (instruments.step[c], instruments.noise[c]);
            if step > 0.0 {
                Some(format!("{} in steps of {step:.3e} {}", names[c], units[c]))
            } else if noise > 0.0 {
                Some(format!(
                    "{} with noise of {noise:.3e} {}",
                    names[c], units[c]
                ))
            } else {
                None
            }
        })
        .collect();
    told.join(", ")
}

/// Readings moved to the middle of the encoders' steps, SI units.
#[must_use]
pub fn in_the_middle(records: &[RawRecord], instruments: &Instruments) -> Vec<RawRecord> {
    records
        .iter()
        .map(|record| RawRecord {
            readings: std::array::from_fn(|c| {
                let half = 0.5 * instruments.step[c];
                record.readings[c].iter().map(|x| x + half).collect()
            }),
            ..record.clone()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_of_what_is_not_measured_may_be_left_out() {
        let text = "gear_encoder_step = 0.001\nload_cell_noise = 0.2\n";
        let sensors = Sensors::parse(text, "sensors.toml").unwrap();
        let encoder = [false, false, true, false, true, false, false];
        assert!(
            sensors
                .check_for("sensors.toml", "run-a.csv", encoder)
                .is_ok()
        );
        let message = sensors
            .check_for("sensors.toml", "run-a.csv", [true; CHANNELS])
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("disc_encoder_step, disc_velocity_noise"),
            "{message}"
        );
    }
}
