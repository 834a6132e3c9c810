//! The target file: what is known about the motions, and which parameters are sought.

use std::path::Path;

use serde::{Deserialize, Serialize};
use stickslip::parameter::ParameterError;
use stickslip::plant::Rig;
use thiserror::Error;

use super::check::check;
use super::cycle::{Disc, Operating};
use super::transition::Transition;

/// Why a target file is refused.
#[derive(Debug, Error)]
pub enum TargetError {
    /// The file cannot be read.
    #[error("cannot read {file}: {source}")]
    Read {
        /// The file.
        file: String,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// The text is not a target file.
    #[error("{file}: {message}")]
    Syntax {
        /// The file.
        file: String,
        /// What is wrong where.
        message: String,
    },
    /// A value that makes no sense.
    #[error("{file}: {place}: {message}")]
    Value {
        /// The file.
        file: String,
        /// Which entry.
        place: String,
        /// What is wrong and what would be right.
        message: String,
    },
    /// A parameter that the model does not have or does not allow.
    #[error("{file}: [[parameter]] {name}: {source}{hint}")]
    Parameter {
        /// The file.
        file: String,
        /// The parameter's name, as the file gives it.
        name: String,
        /// What is wrong.
        source: ParameterError,
        /// What would be right, beginning with its own punctuation; empty where the source says it.
        hint: String,
    },
}

/// A number to be met within a relative bar.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a table such as { value = 0.756, bar = 0.005 }"
)]
pub struct Goal {
    /// Value.
    pub value: f64,
    /// Relative distance within which it counts as met.
    pub bar: f64,
    /// Weight in the local search.
    #[serde(default = "one")]
    pub weight: f64,
}

fn one() -> f64 {
    1.0
}

/// What is known at one operating point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// ω_ref [rpm].
    pub speed_rpm: f64,
    /// N2 [N].
    #[serde(default)]
    pub normal_force: f64,
    /// N1 [N]; only the full rig has it.
    #[serde(default)]
    pub normal_force_1: f64,
    /// The disc that the facts are about.
    #[serde(default)]
    pub disc: Disc,
    /// Frequency of the velocity [Hz].
    pub frequency_hz: Option<Goal>,
    /// Half of the velocity's range [rad/s].
    pub half_amplitude: Option<Goal>,
    /// Lowest velocity [rad/s].
    pub minimum_velocity: Option<Goal>,
    /// Highest velocity [rad/s].
    pub maximum_velocity: Option<Goal>,
    /// Whether the disc sticks.
    pub sticking: Option<bool>,
    /// Where the facts come from.
    pub source: Option<String>,
}

impl Point {
    /// The operating point.
    #[must_use]
    pub fn operating(&self) -> Operating {
        Operating {
            speed_rpm: self.speed_rpm,
            normal_force: self.normal_force,
            normal_force_1: self.normal_force_1,
            disc: self.disc,
        }
    }

    /// The operating point in words.
    #[must_use]
    pub fn label(&self) -> String {
        let disc1 = if self.normal_force_1 == 0.0 {
            String::new()
        } else {
            format!(", N1 {} N", self.normal_force_1)
        };
        format!("{} rpm, {} N{disc1}", self.speed_rpm, self.normal_force)
    }
}

/// A parameter that is sought, with the range in which.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sought {
    /// Dotted name, such as `contact.a1`.
    pub name: String,
    /// Lowest value.
    pub minimum: f64,
    /// Highest value.
    pub maximum: f64,
}

/// How the search is done.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Search {
    /// Number of the random sequence.
    pub seed: u64,
    /// Independent global searches.
    pub starts: usize,
    /// Members of each search.
    pub population: usize,
    /// Most generations of each search.
    pub generations: usize,
    /// Smallest margin of the algebraic loop that is accepted on any cycle.
    pub smallest_loop_margin: f64,
}

/// A target file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// How the search is done.
    pub search: Search,
    /// What is sought.
    pub parameter: Vec<Sought>,
    /// What is known at single operating points.
    pub point: Vec<Point>,
    /// Where stick-slip begins or ends.
    #[serde(default)]
    pub transition: Vec<Transition>,
}

impl Target {
    /// Reads a target file for `rig`.
    ///
    /// # Errors
    /// [`TargetError`], naming the file and the entry.
    pub fn read(path: &Path, rig: &Rig<f64>) -> Result<Self, TargetError> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|source| TargetError::Read {
            file: file.clone(),
            source,
        })?;
        Self::parse(&text, &file, rig)
    }

    /// Reads the text of a target file; `file` names it in messages.
    ///
    /// # Errors
    /// As for [`Target::read`].
    pub fn parse(text: &str, file: &str, rig: &Rig<f64>) -> Result<Self, TargetError> {
        if text.trim().is_empty() {
            return Err(TargetError::Syntax {
                file: file.to_owned(),
                message: "is empty; [search], [[parameter]] and [[point]] are needed".to_owned(),
            });
        }
        let target: Self = toml::from_str(text).map_err(|error| TargetError::Syntax {
            file: file.to_owned(),
            message: error.to_string().trim_end().to_owned(),
        })?;
        check(&target, file, rig)?;
        Ok(target)
    }
}
