//! What drives a run: the inputs over time.

use std::f64::consts::PI;

use stickslip::plant::RigInputs;
use thiserror::Error;

use crate::component::{self, Component, ComponentError, Kind, Role};
use crate::files::record::{Record, RecordError};

/// Why the inputs do not fit the component.
#[derive(Debug, Error)]
pub enum DriveError {
    /// A column names nothing in the component.
    #[error("{file}: {source}")]
    Column {
        /// The record.
        file: String,
        /// What is wrong, with the nearest name.
        source: ComponentError,
    },
    /// A column names a parameter.
    #[error(
        "{file}: column `{name}` is a parameter, which no record can vary; give it one value with --set or in the model file"
    )]
    Parameter {
        /// The record.
        file: String,
        /// The column.
        name: String,
    },
    /// An input has no column.
    #[error("{0}; every input of the component needs one")]
    MissingColumn(RecordError),
    /// The parameters for the voltage are not all there.
    #[error("--speed-rpm needs a rig with the parameter {name}: {source}")]
    NoVoltage {
        /// The parameter.
        name: &'static str,
        /// Why it cannot be had.
        source: ComponentError,
    },
    /// A parameter for the voltage has no value.
    #[error("--speed-rpm needs the parameter {name}, of which the FMU does not tell the value")]
    NoValue {
        /// The parameter.
        name: &'static str,
    },
    /// The second force does not fit the rig.
    #[error("{0}")]
    SecondForce(&'static str),
}

/// Inputs over time, each value held until the next sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    description: String,
    /// Positions of the inputs among the component's variables.
    positions: Vec<usize>,
    times: Vec<f64>,
    /// One row per time, one value per position.
    rows: Vec<Vec<f64>>,
}

impl Drive {
    /// Inputs from a record. Columns that name outputs or internal quantities are left aside, so that a measured record can
    /// drive a run as it is.
    ///
    /// # Errors
    /// [`DriveError`] where a column names nothing in the component or a parameter, or an input has no column.
    pub fn from_record(component: &dyn Component, record: &Record) -> Result<Self, DriveError> {
        for name in record.names() {
            let position =
                component::position(component, name).map_err(|source| DriveError::Column {
                    file: record.source().to_owned(),
                    source,
                })?;
            if component.variables()[position].role == Role::Parameter {
                return Err(DriveError::Parameter {
                    file: record.source().to_owned(),
                    name: name.to_owned(),
                });
            }
        }
        let inputs = inputs(component);
        let columns = inputs
            .iter()
            .map(|(_, name)| record.require(name))
            .collect::<Result<Vec<_>, _>>()
            .map_err(DriveError::MissingColumn)?;
        let rows = (0..record.len())
            .map(|row| columns.iter().map(|column| column[row]).collect())
            .collect();
        Ok(Self {
            description: record.source().to_owned(),
            positions: inputs.iter().map(|(position, _)| *position).collect(),
            times: record.time().to_vec(),
            rows,
        })
    }

    /// Held inputs from time 0 on: the forces [N] and the voltage u = R (C_m η ω + T_fm sign ω)/K_T + K_E η ω that turns the
    /// undisturbed rig at `speed_rpm` at the gearbox output. `setting` gives the value of a parameter that was set.
    ///
    /// # Errors
    /// [`DriveError`] where the component lacks a parameter of the voltage, or has one pin and two forces or the other way.
    pub fn from_speed(
        component: &dyn Component,
        setting: impl Fn(&str) -> Option<f64>,
        speed_rpm: f64,
        normal_force: f64,
        normal_force_1: Option<f64>,
    ) -> Result<Self, DriveError> {
        let parameter = |name: &'static str| {
            let position = component::position(component, name)
                .map_err(|source| DriveError::NoVoltage { name, source })?;
            setting(name)
                .or(component.variables()[position].start)
                .ok_or(DriveError::NoValue { name })
        };
        let speed = speed_rpm * PI / 30.0;
        let direction = if speed == 0.0 { 0.0 } else { speed.signum() };
        let motor_speed = parameter("gearbox.ratio")? * speed;
        let drag = parameter("motor.viscous_damping")? * motor_speed
            + parameter("motor.coulomb_torque")? * direction;
        let voltage = parameter("motor.resistance")? * drag / parameter("motor.torque_constant")?
            + parameter("motor.back_emf_constant")? * motor_speed;
        let inputs = inputs(component);
        let two_pins = inputs.iter().any(|(_, name)| name == "N1");
        if two_pins != normal_force_1.is_some() {
            return Err(DriveError::SecondForce(if two_pins {
                "this is the full rig: --normal-force-1 is needed too"
            } else {
                "--normal-force-1: this rig has no disc D1"
            }));
        }
        let row = inputs
            .iter()
            .map(|(_, name)| match name.as_str() {
                "u" => voltage,
                "N2" => normal_force,
                "N1" => normal_force_1.unwrap_or(0.0),
                _ => 0.0,
            })
            .collect();
        let second = normal_force_1
            .map(|force| format!(", N1 = {force} N"))
            .unwrap_or_default();
        Ok(Self {
            description: format!(
                "{speed_rpm} rpm, N2 = {normal_force} N{second} (u = {voltage:.4} V)"
            ),
            positions: inputs.iter().map(|(position, _)| *position).collect(),
            times: vec![0.0],
            rows: vec![row],
        })
    }

    /// A few words for titles.
    #[must_use]
    pub fn describe(&self) -> &str {
        &self.description
    }

    /// First time [s].
    #[must_use]
    pub fn start(&self) -> f64 {
        self.times.first().copied().unwrap_or(0.0)
    }

    /// Time from the first to the last sample [s], where there are several.
    #[must_use]
    pub fn duration(&self) -> Option<f64> {
        (self.times.len() > 1).then(|| self.times[self.times.len() - 1] - self.times[0])
    }

    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        self.times.len()
    }

    /// Time of a sample [s].
    pub(super) fn time(&self, sample: usize) -> f64 {
        self.times[sample]
    }

    /// A sample as the inputs of a rig, held.
    pub(super) fn rig_inputs(&self, component: &dyn Component, sample: usize) -> RigInputs<f64> {
        let named = |name: &str| {
            self.values(sample)
                .into_iter()
                .find(|(position, _)| component.variables()[*position].name == name)
                .map_or(0.0, |(_, value)| value)
        };
        RigInputs::held(named("u"), named("N2"), named("N1"))
    }

    /// Positions and values of a sample.
    pub(super) fn values(&self, sample: usize) -> Vec<(usize, f64)> {
        self.positions
            .iter()
            .copied()
            .zip(self.rows[sample].iter().copied())
            .collect()
    }
}

fn inputs(component: &dyn Component) -> Vec<(usize, String)> {
    component
        .variables()
        .iter()
        .enumerate()
        .filter(|(_, variable)| variable.role == Role::Input && variable.kind == Kind::Real)
        .map(|(position, variable)| (position, variable.name.clone()))
        .collect()
}
