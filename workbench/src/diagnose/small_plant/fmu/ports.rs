//! How an FMU meets the records: sections `[port]`, `[inputs]` and `[start]` of its model file.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// Which FMU it is, and its variables' parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Ports {
    /// The FMU's file, where the model file names it.
    pub fmu: Option<PathBuf>,
    /// Where a missing force acts.
    pub port: Port,
    /// Inputs that a column drives, by name.
    pub inputs: BTreeMap<String, Input>,
    /// Variables that take the first measured position or velocity, by name.
    pub start: BTreeMap<String, Coordinate>,
}

/// An input for a force with the outputs that are its coordinates.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Port {
    /// Input for a force or torque.
    pub input: String,
    /// Output: position where it acts.
    pub position: Option<String>,
    /// Output: velocity where it acts.
    pub velocity: Option<String>,
    /// Inertia that the input moves at once [kg or kg m²], as `diagnose` found it; negative where a positive input pushes backward.
    pub inertia: Option<f64>,
    /// The longest step over which an added effect's force is constant [s].
    pub coupling_step: Option<f64>,
}

/// An input that a column drives.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Name of the column.
    pub column: String,
    /// Unit of the column.
    pub unit: String,
    /// What one of `unit` is in the input's unit, where those differ.
    pub factor: Option<f64>,
    /// What the input does between two samples.
    pub between: Between,
}

/// What an input does between two samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Between {
    /// It keeps the earlier value, as that of a digital controller does.
    Held,
    /// It goes straight from one to the next, as a measured quantity does.
    Linear,
}

/// A measured coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Coordinate {
    /// Position or angle.
    Position,
    /// Velocity.
    Velocity,
}

impl Ports {
    /// The sections as text.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        if let Some(fmu) = &self.fmu {
            let _ = writeln!(text, "fmu = {:?}", fmu.display().to_string());
        }
        let _ = writeln!(text, "\n[port]\ninput = {:?}", self.port.input);
        let coordinates = [
            ("position", &self.port.position),
            ("velocity", &self.port.velocity),
        ];
        for (key, output) in coordinates {
            if let Some(output) = output {
                let _ = writeln!(text, "{key} = {output:?}");
            }
        }
        let numbers = [
            ("inertia", self.port.inertia),
            ("coupling_step", self.port.coupling_step),
        ];
        for (key, number) in numbers {
            if let Some(number) = number {
                let _ = writeln!(text, "{key} = {number:?}");
            }
        }
        text.push_str("\n[inputs]\n");
        for (name, input) in &self.inputs {
            let factor = input
                .factor
                .map_or(String::new(), |factor| format!(", factor = {factor:?}"));
            let between = match input.between {
                Between::Held => "held",
                Between::Linear => "linear",
            };
            let _ = writeln!(
                text,
                "{} = {{ column = {:?}, unit = {:?}{factor}, between = \"{between}\" }}",
                key(name),
                input.column,
                input.unit
            );
        }
        if !self.start.is_empty() {
            text.push_str("\n[start]\n");
        }
        for (name, coordinate) in &self.start {
            let word = match coordinate {
                Coordinate::Position => "position",
                Coordinate::Velocity => "velocity",
            };
            let _ = writeln!(text, "{} = \"{word}\"", key(name));
        }
        text
    }
}

/// A name as a key of TOML, in quotes where it needs them.
#[must_use]
pub fn key(name: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(is_bare) {
        name.to_owned()
    } else {
        format!("{name:?}")
    }
}
