//! How an FMU meets the records: sections `[port]`, `[inputs]` and `[start]` of its model file.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::diagnose::small_plant::columns::Column;

/// Which FMU it is, and its variables' parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Ports {
    /// The FMU's file, where the model file names it.
    pub fmu: Option<PathBuf>,
    /// Where a missing force may act: one place, or several.
    pub ports: Vec<Port>,
    /// Uncertain parameters that may change with time.
    pub drifts: Vec<String>,
    /// Inputs that a column drives, by name.
    pub inputs: BTreeMap<String, Input>,
    /// Variables that take the first measured position or velocity, by name.
    pub start: BTreeMap<String, Coordinate>,
}

/// An input for a force with the outputs that are its coordinates.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Port {
    /// Name of the place, where there are several.
    pub name: Option<String>,
    /// Input for a force or torque, or parameter that may change between steps.
    pub input: String,
    /// Output: position where it acts.
    pub position: Option<String>,
    /// Output: velocity where it acts.
    pub velocity: Option<String>,
    /// Column of the measured position there; that of the first port stands in `[columns]`.
    pub measured_position: Option<Column>,
    /// Column of the measured velocity, likewise.
    pub measured_velocity: Option<Column>,
    /// Load there, on which friction may depend.
    pub load: Option<LoadVariable>,
    /// How often per turn teeth, poles or rollers repeat there.
    #[serde(default)]
    pub repeats: Vec<f64>,
    /// Cut-off below which forces are compared there, where it is not that of `[measurement]` [Hz].
    pub compare_low_pass: Option<f64>,
    /// Inertia that the input moves at once [kg or kg m²], as `diagnose` found it; negative where a positive input pushes backward.
    pub inertia: Option<f64>,
    /// The longest step over which an added effect's force is constant [s].
    pub coupling_step: Option<f64>,
}

/// A variable of the FMU that is a load.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadVariable {
    /// Its name.
    pub variable: String,
    /// What one of its unit is in N, along a turn in N m, where it is in another: of a normal force in N, the radius in m.
    pub factor: Option<f64>,
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
    /// Whether the column may be off by a constant.
    #[serde(default)]
    pub may_be_offset: bool,
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
        let head = match self.ports.len() {
            1 => "[port]",
            _ => "[[port]]",
        };
        for port in &self.ports {
            let _ = write!(text, "\n{head}\n{}", port.to_toml());
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
                "{} = {{ column = {:?}, unit = {:?}{factor}, between = \"{between}\"{} }}",
                key(name),
                input.column,
                input.unit,
                if input.may_be_offset {
                    ", may_be_offset = true"
                } else {
                    ""
                }
            );
        }
        if !self.drifts.is_empty() {
            let _ = writeln!(text, "\n[drifts]\nparameters = {:?}", self.drifts);
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

impl Port {
    /// What stands below the section's head.
    fn to_toml(&self) -> String {
        let mut text = String::new();
        let names = [
            ("name", self.name.as_ref()),
            ("input", Some(&self.input)),
            ("position", self.position.as_ref()),
            ("velocity", self.velocity.as_ref()),
        ];
        for (key, name) in names {
            if let Some(name) = name {
                let _ = writeln!(text, "{key} = {name:?}");
            }
        }
        let columns = [
            ("measured_position", &self.measured_position),
            ("measured_velocity", &self.measured_velocity),
        ];
        for (key, column) in columns {
            if let Some(column) = column {
                let _ = writeln!(text, "{key} = {}", column.to_toml());
            }
        }
        if let Some(load) = &self.load {
            let factor = load
                .factor
                .map_or(String::new(), |factor| format!(", factor = {factor:?}"));
            let _ = writeln!(text, "load = {{ variable = {:?}{factor} }}", load.variable);
        }
        if !self.repeats.is_empty() {
            let _ = writeln!(text, "repeats = {:?}", self.repeats);
        }
        let numbers = [
            ("compare_low_pass", self.compare_low_pass),
            ("inertia", self.inertia),
            ("coupling_step", self.coupling_step),
        ];
        for (key, number) in numbers {
            if let Some(number) = number {
                let _ = writeln!(text, "{key} = {number:?}");
            }
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
