//! Terms of a small plant's equation: what all bases and effects have.

use operations::Operation;
use stickslip::body::coordinate::FRICTION;
use stickslip::body::{Kind, Parameter, Path};

use super::equation::{Moments, uses};
use super::motion::Scales;
use super::start;
use super::unit::Usual as _;
use crate::numbers::Number;

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
    /// Load: of a contact the normal load over its mean on the records learned from; of a joint the moment of the arm's weight over the
    /// moment of inertia [rad/s²]; else a force or torque [N or N m]. 0 where none is measured.
    pub load: f64,
    /// Force that somebody's own model predicts [N or N m]; 0 where there is none.
    pub predicted: f64,
    /// Voltage at the motor's terminals [V].
    pub voltage: f64,
    /// 1 where the motor's terminals are connected, 0 where they are open.
    pub connected: f64,
    /// What drives the plant: the force of a drive, the voltage of a joint, an FMU's first input.
    pub driving: f64,
    /// Torque of the motor over the moment of inertia, friction apart [rad/s²]; of a joint.
    pub motor: f64,
    /// Which of an FMU's ports it is of.
    pub port: usize,
}

/// Most uncertain parameters of an FMU.
pub const MOST_PARAMETERS: usize = 12;
/// Most of its inputs whose columns may be off by a constant.
pub const MOST_OFFSETS: usize = 4;

/// Where a term acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// At every port.
    Everywhere,
    /// At one port.
    Port(usize),
}

impl Place {
    /// Whether a term there acts at an FMU's port.
    #[must_use]
    pub fn is_at(self, port: usize) -> bool {
        matches!(self, Self::Everywhere) || self == Self::Port(port)
    }
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

/// Force [N, N m; of a pendulum or joint rad/s²] against the motion: parameters, moment, friction of the others at that moment.
pub type Force = fn(&[f64], &Sample, f64) -> f64;

/// Operations of equations whose values have room on the stack: of most, and of every one of the catalogue. To clear more room than an
/// equation needs takes longer than a short one.
const BRIEF: usize = 8;
const SHORT: usize = 24;

/// Where a term's force comes from.
#[derive(Debug, Clone, Copy)]
pub enum Formula {
    /// An equation.
    Equation {
        /// As written.
        text: &'static str,
        /// As evaluated.
        operations: &'static [Operation],
    },
    /// Code.
    Code {
        /// The force.
        force: Force,
        /// Values from which a fit starts, in units of each parameter's usual size; none of a base.
        starts: &'static [&'static [f64]],
        /// Places of parameters in which it is linear, all of them together.
        linear: &'static [usize],
    },
    /// What repeats so often per turn, as cosine and sine.
    Repeats(f64),
    /// A series that stands in the record of an FMU; at a moment alone it is nothing.
    Pursued(Pursued),
}

/// What stands in the record of an FMU.
#[derive(Debug, Clone, Copy)]
pub enum Pursued {
    /// The force that its uncertain parameters make.
    Parameters,
    /// That of an uncertain parameter, of this number among them, that changes by a share of its value in a minute.
    Drift(usize),
    /// That of a column that is off by a constant, of this number among those that may be.
    Offset(usize),
}

impl Formula {
    /// Values from which a fit starts, in units of each parameter's usual size; none of an equation, which tells them itself.
    fn multiples(&self) -> &'static [&'static [f64]] {
        match self {
            Self::Equation { .. } => &[],
            Self::Code { starts, .. } => starts,
            Self::Repeats(_) => &[&[0.1, 0.1]],
            Self::Pursued(Pursued::Parameters) => &[],
            Self::Pursued(_) => &[&[0.1]],
        }
    }
}

/// A base or an effect.
#[derive(Debug, Clone, Copy)]
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
    /// Whether it needs a load, which is measured but for a joint's, the arm's weight.
    pub needs_load: bool,
    /// How it enters.
    pub role: Role,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// Its force.
    pub formula: Formula,
    /// Whether a file of the user's describes it.
    pub own: bool,
    /// Where it acts.
    pub place: Place,
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
            && (has_load || !self.needs_load || kind == Kind::Joint)
    }

    /// Its force at a moment.
    #[must_use]
    pub fn force(&self, values: &[f64], sample: &Sample, friction: f64) -> f64 {
        let mut moments = Moments::new(std::array::from_ref(sample));
        moments.set_friction([friction]);
        let [force] = self.forces(values, &moments);
        force
    }

    /// Its force at each of some moments.
    #[must_use]
    pub fn forces<const N: usize>(&self, values: &[f64], moments: &Moments<N>) -> [f64; N] {
        let samples = moments.samples;
        match self.formula {
            Formula::Equation { operations, .. } => {
                let at = &moments.coordinates;
                let count = operations.len();
                let find = |room: &mut [[f64; N]]| operations::values(operations, values, at, room);
                if count <= BRIEF {
                    find(&mut [[0.0; N]; BRIEF])
                } else if count <= SHORT {
                    find(&mut [[0.0; N]; SHORT])
                } else {
                    find(&mut vec![[0.0; N]; count])
                }
            }
            Formula::Code { force, .. } => {
                let friction = moments.friction();
                std::array::from_fn(|at| force(values, &samples[at], friction[at]))
            }
            Formula::Repeats(often) => samples.each_ref().map(|sample| {
                let (sine, cosine) = (often * sample.position).sin_cos();
                values[0] * cosine + values[1] * sine
            }),
            Formula::Pursued(_) => [0.0; N],
        }
    }

    /// Its equation, if it is described by one.
    #[must_use]
    pub fn equation(&self) -> Option<&'static str> {
        match self.formula {
            Formula::Equation { text, .. } => Some(text),
            _ => None,
        }
    }

    /// Whether its equation uses this coordinate; false of what no equation describes.
    #[must_use]
    pub fn uses(&self, coordinate: usize) -> bool {
        matches!(self.formula, Formula::Equation { operations, .. } if uses(operations, coordinate))
    }

    /// Places of parameters in which it is linear, all of them together.
    #[must_use]
    pub fn linear(&self) -> Vec<usize> {
        match self.formula {
            Formula::Equation { operations, .. } => {
                operations::linear(operations, self.parameters.len())
            }
            Formula::Code { linear, .. } => linear.to_vec(),
            Formula::Repeats(_) | Formula::Pursued(_) => (0..self.parameters.len()).collect(),
        }
    }

    /// Whether it may depend on the friction of others. No base does.
    #[must_use]
    pub fn multiplies_friction(&self) -> bool {
        match self.formula {
            Formula::Equation { .. } => self.uses(FRICTION),
            Formula::Code { starts, .. } => self.role == Role::Added && !starts.is_empty(),
            _ => false,
        }
    }

    /// What each of its numbers does; nothing of a law, which takes another's place.
    #[must_use]
    pub fn numbers(&self, kind: Kind, path: Path, scales: &Scales) -> Vec<Number> {
        match self.formula {
            Formula::Equation { .. } => {
                start::recognised(self, kind, path, scales).unwrap_or_default()
            }
            Formula::Code { .. } if self.role == Role::Law => Vec::new(),
            _ => {
                let sizes = self.parameters.iter().map(|own| Number::Amplitude {
                    origin: 0.0,
                    scale: own.dimension.scale(scales),
                });
                sizes.collect()
            }
        }
    }

    /// Values from which a fit starts, each a set of all its numbers, on such a plant and records of these sizes. Empty where nothing
    /// of the effect shows there.
    #[must_use]
    pub fn starts(&self, kind: Kind, path: Path, scales: &Scales) -> Vec<Vec<f64>> {
        if let Formula::Equation { .. } = self.formula {
            return start::values(self, kind, path, scales).unwrap_or_default();
        }
        let sizes: Vec<f64> = self
            .parameters
            .iter()
            .map(|own| own.dimension.scale(scales))
            .collect();
        let starts = self.formula.multiples().iter();
        let sized = |multiples: &&[f64]| -> Vec<f64> {
            let pairs = multiples.iter().zip(&sizes);
            pairs.map(|(multiple, size)| multiple * size).collect()
        };
        starts.map(sized).collect()
    }
}
