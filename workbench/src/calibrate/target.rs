//! The target file: what is known about the motions, and which parameters are sought.

use std::path::Path;

use serde::{Deserialize, Serialize};
use stickslip::parameter::ParameterError;
use stickslip::plant::Rig;
use thiserror::Error;

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
    #[error("{file}: {source}")]
    Parameter {
        /// The file.
        file: String,
        /// What is wrong.
        source: ParameterError,
    },
}

/// A number to be met within a relative bar.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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
        let outer = if self.normal_force_1 == 0.0 {
            String::new()
        } else {
            format!(", N1 {} N", self.normal_force_1)
        };
        format!("{} rpm, {} N{outer}", self.speed_rpm, self.normal_force)
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

/// Most starts, members and generations of a search: above, it is a slip of the pen.
const MOST: usize = 100_000;

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
        let target: Self = toml::from_str(text).map_err(|error| TargetError::Syntax {
            file: file.to_owned(),
            message: error.to_string().trim_end().to_owned(),
        })?;
        let refuse = |place: String, message: &str| {
            Err(TargetError::Value {
                file: file.to_owned(),
                place,
                message: message.to_owned(),
            })
        };
        if target.parameter.is_empty() || target.point.is_empty() {
            return refuse(
                "[[parameter]], [[point]]".to_owned(),
                "at least one of each is needed",
            );
        }
        let search = &target.search;
        let sizes = [search.starts, search.population, search.generations];
        if search.population < 5 || search.starts == 0 || sizes.iter().any(|size| *size > MOST) {
            return refuse(
                "[search]".to_owned(),
                "population must be at least 5, starts at least 1, both and generations at most 100000",
            );
        }
        if !search.smallest_loop_margin.is_finite() {
            return refuse(
                "[search]".to_owned(),
                "smallest_loop_margin must be a finite number",
            );
        }
        for transition in &target.transition {
            if let Err(message) = transition.check() {
                return refuse(transition.label(), message);
            }
        }
        for sought in &target.parameter {
            if sought.minimum.is_nan() || sought.minimum >= sought.maximum {
                return refuse(sought.name.clone(), "minimum must be below maximum");
            }
            let mut trial = *rig;
            for bound in [sought.minimum, sought.maximum] {
                trial.set_parameter(&sought.name, bound).map_err(|source| {
                    TargetError::Parameter {
                        file: file.to_owned(),
                        source,
                    }
                })?;
            }
        }
        for point in &target.point {
            let goals = [
                point.frequency_hz,
                point.half_amplitude,
                point.minimum_velocity,
                point.maximum_velocity,
            ];
            let place = format!("point at {}", point.label());
            let outer = point.disc == Disc::D1 || point.normal_force_1 != 0.0;
            if outer && rig.outer.is_none() {
                return refuse(
                    place,
                    "disc D1 and normal_force_1 need a model with [disc1], [shaft1] and [contact1]",
                );
            }
            let right = |value: f64| value.is_finite() && value >= 0.0;
            if ![point.speed_rpm, point.normal_force, point.normal_force_1]
                .into_iter()
                .all(right)
            {
                return refuse(
                    place,
                    "speed and normal forces must be finite and at least 0",
                );
            }
            if !goals.iter().flatten().all(|goal| {
                let bar = right(goal.bar) && goal.bar > 0.0;
                bar && right(goal.weight) && goal.value.is_finite() && goal.value != 0.0
            }) {
                return refuse(
                    place,
                    "a goal needs a finite value other than 0, a bar above 0 and a weight of at least 0",
                );
            }
            if goals.iter().all(Option::is_none) && point.sticking.is_none() {
                return refuse(place, "nothing is stated about it");
            }
        }
        Ok(target)
    }
}
