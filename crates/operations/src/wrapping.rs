//! What an FMU around an FMU reads: the original, its port, and the effects that act there.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{Fault, Operation, check};

/// Name of the file among the resources of an FMU around an FMU; the original's files lie in a folder beside it.
pub const SETTINGS_FILE: &str = "wrapper.json";

/// What an equation at a port may depend on, in the order in which its operations count them: position [m or rad], velocity
/// [m/s or rad/s], acceleration [m/s² or rad/s²], direction of motion (−1 or 1), time [s], friction of the effects before it and
/// load [N or N m].
pub const COORDINATES: [&str; 7] = [
    "position",
    "velocity",
    "acceleration",
    "direction",
    "time",
    "friction",
    "load",
];

/// An FMU around an FMU.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Token of the whole.
    pub token: String,
    /// `modelIdentifier` of the original.
    pub original_identifier: String,
    /// Token of the original.
    pub original_token: String,
    /// Folder of the original beside this file.
    pub original_folder: String,
    /// Whether the original can save and restore its state.
    pub can_restore: bool,
    /// Whether the original takes steps of any length.
    pub can_vary_steps: bool,
    /// Variables of the original that start with other values, with these.
    pub starts: Vec<(u32, f64)>,
    /// Where the effects act.
    pub port: Port,
    /// The longest step over which the effects' force is constant [s].
    pub coupling_step: Own,
    /// Reads the force that the effects add [unit of the port's input].
    pub force: u32,
    /// The effects, friction first.
    pub effects: Vec<AddedEffect>,
}

/// An input for a force with its coordinates; each with its value reference and its unit in SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Port {
    /// The input.
    pub input: (u32, f64),
    /// Start value of the input, in its unit.
    pub start: f64,
    /// Output of the position.
    pub position: Option<(u32, f64)>,
    /// Output of the velocity.
    pub velocity: Option<(u32, f64)>,
    /// Variable of the load.
    #[serde(default)]
    pub load: Option<(u32, f64)>,
    /// Inertia that the input moves at once [kg or kg m²]; negative where a positive input pushes backward.
    pub inertia: f64,
}

/// A variable that the original does not have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Own {
    /// Name.
    pub name: String,
    /// Value reference.
    pub reference: u32,
    /// Start value.
    pub start: f64,
}

/// An effect at the port.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AddedEffect {
    /// Name.
    pub name: String,
    /// Its equation as people read it.
    pub equation: String,
    /// Force against the motion [N or N m].
    pub operations: Vec<Operation>,
    /// Whether it is part of the friction that others multiply.
    pub is_friction: bool,
    /// Its parameters, SI units.
    pub parameters: Vec<Own>,
}

/// Why settings cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SettingsError {
    /// A port without coordinates.
    #[error("the port has neither position nor velocity")]
    NoCoordinate,
    /// A number that must be finite and not zero.
    #[error("{0} must be finite and not zero")]
    Number(&'static str),
    /// The coupling step.
    #[error("the coupling step must be finite and above zero")]
    Step,
    /// An effect whose equation cannot run.
    #[error("the equation of {0} cannot run: {1}")]
    Equation(String, Fault),
}

impl Settings {
    /// Checks that everything can run.
    ///
    /// # Errors
    /// The first thing that cannot.
    pub fn check(&self) -> Result<(), SettingsError> {
        let port = &self.port;
        if port.position.is_none() && port.velocity.is_none() {
            return Err(SettingsError::NoCoordinate);
        }
        let is_good = |value: f64| value.is_finite() && value != 0.0;
        let units = [Some(port.input), port.position, port.velocity, port.load];
        if !units.iter().flatten().all(|(_, unit)| is_good(*unit)) {
            return Err(SettingsError::Number("a unit of the port"));
        }
        if !is_good(port.inertia) {
            return Err(SettingsError::Number("the port's inertia"));
        }
        if !(is_good(self.coupling_step.start) && self.coupling_step.start > 0.0) {
            return Err(SettingsError::Step);
        }
        for effect in &self.effects {
            check(
                &effect.operations,
                effect.parameters.len(),
                COORDINATES.len(),
            )
            .map_err(|fault| SettingsError::Equation(effect.name.clone(), fault))?;
        }
        Ok(())
    }
}
