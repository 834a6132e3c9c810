//! The arguments of `stickslip simulate`.

use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Context, bail, ensure};
use clap::Args;

use crate::component::{self, Component, Role};
use crate::files::record::Record;

use super::drive::Drive;

/// One run of a model or an FMU.
#[derive(Debug, Args)]
pub struct SimulateArguments {
    /// Model (.toml, run natively) or FMU (.fmu, run through its binary).
    pub model: PathBuf,
    /// Inputs over time: a record whose header names `time` and FMU variables; values are held between samples.
    #[arg(long, value_name = "CSV", conflicts_with_all = ["speed_rpm", "normal_force", "normal_force_1"])]
    pub inputs: Option<PathBuf>,
    /// Speed at the gearbox output [rpm] that the voltage would give the undisturbed rig.
    #[arg(long, requires = "normal_force", allow_negative_numbers = true)]
    pub speed_rpm: Option<f64>,
    /// Normal force N2 on disc D2 [N].
    #[arg(long, requires = "speed_rpm", allow_negative_numbers = true)]
    pub normal_force: Option<f64>,
    /// Normal force N1 on disc D1 [N], for the full rig.
    #[arg(long, requires = "speed_rpm", allow_negative_numbers = true)]
    pub normal_force_1: Option<f64>,
    /// Length of the run [s]; without it that of the inputs, or 60.
    #[arg(long, allow_negative_numbers = true)]
    pub duration: Option<f64>,
    /// Time between the rows of the result [s].
    #[arg(long, default_value_t = 0.01, allow_negative_numbers = true)]
    pub step: f64,
    /// A parameter's value, such as disc.inertia=0.015; may be repeated.
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<Setting>,
    /// Directory for the result.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// A parameter and the value it is to have.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Dotted name.
    pub name: String,
    /// Value in the parameter's unit.
    pub value: f64,
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (name, value) = text
            .split_once('=')
            .ok_or("NAME=VALUE is needed, such as disc.inertia=0.015")?;
        match value.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Self {
                name: name.trim().to_owned(),
                value,
            }),
            _ => Err(format!("`{value}` is not a finite number")),
        }
    }
}

/// Gives a component's parameters their values.
///
/// # Errors
/// A name that is no parameter's or was given twice, or a value that the component refuses.
pub fn apply_settings(component: &mut dyn Component, settings: &[Setting]) -> anyhow::Result<()> {
    for (place, setting) in settings.iter().enumerate() {
        ensure!(
            settings[..place]
                .iter()
                .all(|other| other.name != setting.name),
            "--set {} was given twice; one value is needed",
            setting.name
        );
        let position = component::position(component, &setting.name)?;
        let role = component.variables()[position].role;
        ensure!(
            role == Role::Parameter,
            "--set {}: is not a parameter but {}",
            setting.name,
            role_name(role)
        );
        component
            .set(&[(position, setting.value)])
            .with_context(|| format!("--set {}={}", setting.name, setting.value))?;
    }
    Ok(())
}

fn role_name(role: Role) -> &'static str {
    match role {
        Role::Time => "the time",
        Role::Input => "an input; give it in --inputs",
        Role::Output => "an output",
        Role::Local => "an internal quantity",
        Role::Parameter => "a parameter",
        Role::Other => "something that cannot be set",
    }
}

impl SimulateArguments {
    /// The inputs that were asked for.
    pub(super) fn drive(&self, component: &dyn Component) -> anyhow::Result<Drive> {
        match (&self.inputs, self.speed_rpm, self.normal_force) {
            (Some(path), _, _) => Ok(Drive::from_record(component, &Record::read(path)?)?),
            (None, Some(speed), Some(force)) => {
                let forces = [
                    ("--normal-force", Some(force)),
                    ("--normal-force-1", self.normal_force_1),
                ];
                for (name, value) in forces
                    .into_iter()
                    .filter_map(|(name, value)| value.map(|value| (name, value)))
                {
                    ensure!(
                        value.is_finite() && value >= 0.0,
                        "{name} {value}: a force of 0 N or more is needed"
                    );
                }
                ensure!(
                    speed.is_finite(),
                    "--speed-rpm {speed}: a finite number is needed"
                );
                let settings = |name: &str| {
                    self.set
                        .iter()
                        .find(|setting| setting.name == name)
                        .map(|setting| setting.value)
                };
                Ok(Drive::from_speed(
                    component,
                    settings,
                    speed,
                    force,
                    self.normal_force_1,
                )?)
            }
            _ => bail!(
                "say what drives the rig: --inputs FILE.csv, or --speed-rpm with --normal-force"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read() {
        let setting: Setting = "disc.inertia=0.015".parse().unwrap();
        assert_eq!(
            setting,
            Setting {
                name: "disc.inertia".to_owned(),
                value: 0.015
            }
        );
        assert!("disc.inertia".parse::<Setting>().is_err());
        assert!("disc.inertia=NaN".parse::<Setting>().is_err());
    }
}
