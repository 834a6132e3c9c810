//! One run of a rig, driven by constant voltage or by a controller.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, bail};

use super::circuit::Circuit;
use crate::analysis::motion::{Evidence, evidence};
use crate::component::{self, Component, position};
use crate::map::Point;

/// What drives the rig.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Case {
    /// The voltage that would give the undisturbed rig the wanted speed.
    ConstantVoltage,
    /// The controller of this file.
    Controller(PathBuf),
}

impl Case {
    /// A word for tables and pictures.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::ConstantVoltage => "constant_voltage".to_owned(),
            Self::Controller(path) => path
                .file_stem()
                .map_or_else(|| "controller".into(), |stem| stem.to_string_lossy())
                .replace('-', "_"),
        }
    }
}

/// What a run is made under.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Wanted speed at the gearbox output [rpm].
    pub speed_rpm: f64,
    /// Normal force on disc D2 [N].
    pub normal_force: f64,
    /// Normal force on disc D1 [N], for the full rig.
    pub normal_force_1: Option<f64>,
    /// Time between exchanges [s].
    pub step: f64,
    /// Length [s].
    pub duration: f64,
}

/// What is seen of the rig at the communication points.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Samples {
    /// Time [s].
    pub time: Vec<f64>,
    /// Velocity of disc D2 [rad/s].
    pub disc: Vec<f64>,
    /// Velocity of the gearbox output [rad/s].
    pub gearbox: Vec<f64>,
    /// Voltage [V].
    pub voltage: Vec<f64>,
    /// Whether disc D2 sticks.
    pub stuck: Vec<bool>,
}

/// Runs the rig from rest.
///
/// # Errors
/// What is wrong with the models, or where they cannot go on; an interrupt by `stop`.
pub fn run(
    rig: &Path,
    case: &Case,
    conditions: &Conditions,
    stop: &AtomicBool,
) -> anyhow::Result<Samples> {
    let speed = conditions.speed_rpm * PI / 30.0;
    let rig = component::open(rig)?;
    match (position(&*rig, "N1"), conditions.normal_force_1) {
        (Ok(_), None) => bail!(
            "{} is a full rig: --normal-force-1 is needed too",
            rig.title()
        ),
        (Err(_), Some(_)) => bail!("--normal-force-1: {} has no disc D1", rig.title()),
        _ => {}
    }
    let mut circuit = match case {
        Case::ConstantVoltage => {
            let voltage = voltage_for_speed(&*rig, speed)?;
            let mut circuit = Circuit::new(rig, None)?;
            circuit.set("u", voltage)?;
            circuit
        }
        Case::Controller(path) => {
            let mut circuit = Circuit::new(rig, Some(component::open(path)?))?;
            circuit.set("omega_ref", speed)?;
            circuit
        }
    };
    circuit.set("N2", conditions.normal_force)?;
    if let Some(force) = conditions.normal_force_1 {
        circuit.set("N1", force)?;
    }
    let steps = (conditions.duration / conditions.step).round() as usize;
    circuit.initialise(steps as f64 * conditions.step)?;
    let names = ["theta_dot", "theta3_dot", "u", "stuck"];
    let places = names
        .iter()
        .map(|name| position(circuit.rig(), name))
        .collect::<Result<Vec<_>, _>>()?;
    let mut values = [0.0; 4];
    let mut samples = Samples::default();
    for number in 1..=steps {
        if stop.load(Ordering::Relaxed) {
            bail!("interrupted");
        }
        let time = number as f64 * conditions.step;
        circuit.step(time)?;
        circuit.rig().get(&places, &mut values)?;
        samples.time.push(time);
        samples.disc.push(values[0]);
        samples.gearbox.push(values[1]);
        samples.voltage.push(values[2]);
        samples.stuck.push(values[3] != 0.0);
    }
    Ok(samples)
}

/// Voltage [V] that turns the undisturbed rig at `speed` [rad/s]: u = R (C_m η ω + T_fm sign ω)/K_T + K_E η ω.
fn voltage_for_speed(rig: &dyn Component, speed: f64) -> anyhow::Result<f64> {
    let value = |name: &str| -> anyhow::Result<f64> {
        let variable = &rig.variables()[position(rig, name)?];
        variable
            .start
            .with_context(|| format!("{}: {name} has no start value", rig.title()))
    };
    let motor_speed = value("gearbox.ratio")? * speed;
    let direction = if speed == 0.0 { 0.0 } else { speed.signum() };
    let torque =
        value("motor.viscous_damping")? * motor_speed + value("motor.coulomb_torque")? * direction;
    Ok(
        value("motor.resistance")? * torque / value("motor.torque_constant")?
            + value("motor.back_emf_constant")? * motor_speed,
    )
}

impl Samples {
    /// What the samples tell of disc D2.
    #[must_use]
    pub fn evidence(&self) -> Evidence {
        evidence(&self.time, &self.disc, |index| self.stuck[index])
    }

    /// What is kept of the run in a map.
    #[must_use]
    pub fn point(&self) -> Point {
        let evidence = self.evidence();
        let changes = self.stuck.windows(2).filter(|pair| pair[0] != pair[1]);
        Point {
            motion: Some(evidence.judge()),
            minimum: evidence.late.minimum,
            maximum: evidence.late.maximum,
            frequency: f64::NAN,
            stick_fraction: evidence.stick_fraction,
            switches: changes.count() as u64,
            extrema: Vec::new(),
        }
    }
}
