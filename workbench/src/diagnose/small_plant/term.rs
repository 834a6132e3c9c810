//! Terms of a small plant's equation: what all bases and effects have.

use super::unit::{Dimension, Kind, Path};

/// One moment of a record.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sample {
    /// Time since the record's start [s].
    pub time: f64,
    /// Position [m or rad].
    pub position: f64,
    /// Velocity [m/s or rad/s].
    pub velocity: f64,
    /// Acceleration [m/s² or rad/s²].
    pub acceleration: f64,
    /// Direction of motion: −1 or 1; at a standstill that of the motion before.
    pub direction: f64,
    /// Normal load over its mean on the records learned from; 1 where no load is measured.
    pub load: f64,
    /// Force that somebody's own model predicts [N or N m]; 0 where there is none.
    pub predicted: f64,
    /// By how much an FMU's missing force falls as each of its uncertain parameters grows [N or N m over the parameter's unit].
    pub slopes: [f64; MOST_PARAMETERS],
    /// The same times the parameters' values at which the force was found, summed [N or N m].
    pub nominal: f64,
}

/// Most uncertain parameters of an FMU.
pub const MOST_PARAMETERS: usize = 8;

/// Where a number may lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// Anywhere.
    Free,
    /// Above zero.
    Positive,
    /// Between two numbers.
    Within(f64, f64),
}

/// A parameter of a term.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Key in the model file.
    pub key: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Where it may lie.
    pub range: Range,
    /// What it is.
    pub description: &'static str,
}

/// How a term enters the equation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Added; no part of the friction.
    Added,
    /// Added, and part of the friction that others multiply.
    Friction,
    /// Replaces the base's friction law.
    Law,
    /// Shifts the motion in time against the force.
    Shift,
    /// Changes what is read of the position.
    Reading,
}

/// Force [N, N m; of a pendulum rad/s²] against the motion: parameters, moment, friction of the others at that moment.
pub type Force = fn(&[f64], &Sample, f64) -> f64;

/// A base or an effect.
#[derive(Debug)]
pub struct Entry {
    /// Name, and section in the model file.
    pub name: &'static str,
    /// What it is, in half a sentence.
    pub description: &'static str,
    /// What it looks like in records.
    pub signature: &'static str,
    /// Names that it is most easily confused with.
    pub confusable: &'static [&'static str],
    /// Kinds of plants that can have it.
    pub kinds: &'static [Kind],
    /// Path that it needs, if any.
    pub path: Option<Path>,
    /// Whether it needs a measured load.
    pub needs_load: bool,
    /// How it enters.
    pub role: Role,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// Its force as an equation over position, velocity, acceleration, direction, time, friction of the others, load and predicted
    /// force; `None` where it is no force or none that an equation can give.
    pub equation: Option<&'static str>,
    /// Its force.
    pub force: Force,
    /// Values from which a fit starts, in units of each parameter's usual size.
    pub starts: &'static [&'static [f64]],
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Entry {
    /// Whether such a plant can have it.
    #[must_use]
    pub fn fits(&self, kind: Kind, path: Path, has_load: bool) -> bool {
        self.kinds.contains(&kind)
            && self.path.is_none_or(|needed| needed == path)
            && (has_load || !self.needs_load)
    }
}

/// Shorthand for a parameter.
#[must_use]
pub const fn parameter(
    key: &'static str,
    dimension: Dimension,
    range: Range,
    description: &'static str,
) -> Parameter {
    Parameter {
        key,
        dimension,
        range,
        description,
    }
}
