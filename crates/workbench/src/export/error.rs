//! Why a joint's parameters were not exported.

use std::io;

use stickslip::body::FileError;
use thiserror::Error;

use crate::files::atomic::WriteError;

/// Why a joint's parameters were not exported; there is no file then.
#[derive(Debug, Error)]
pub enum ExportError {
    /// The model cannot be read.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// File.
        file: String,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The model file is wrong.
    #[error(transparent)]
    File(#[from] FileError),
    /// A model without a motion of its own.
    #[error(
        "{file}: [plant] kind = \"{kind}\" must be \"drive\", \"pendulum\" or \"joint\" to be exported as a joint; {why}"
    )]
    Kind {
        /// File.
        file: String,
        /// What stands there.
        kind: &'static str,
        /// Why such a plant has no joint's parameters.
        why: &'static str,
    },
    /// A number on the command line is out of range.
    #[error("{option} is {value}; it must be a finite number above 0 [{unit}]")]
    Number {
        /// Option.
        option: &'static str,
        /// What was given.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A name that does not fit into both formats.
    #[error(
        "--name is {name:?}; it must be one word of letters, digits, _, - and ., such as shoulder_pitch"
    )]
    Name {
        /// What was given.
        name: String,
    },
    /// The moment of inertia is missing.
    #[error(
        "{file}: all numbers of a {kind} are over its moment of inertia; give that about the axis as --inertia [kg.m2], with the motor's times the ratio's square in it"
    )]
    NoInertia {
        /// File.
        file: String,
        /// Kind of the plant.
        kind: &'static str,
    },
    /// The model has an inertia of its own.
    #[error("{file}: [drive] inertia = {inertia} is the model's own; leave --inertia out")]
    Inertia {
        /// File.
        file: String,
        /// The model's.
        inertia: f64,
    },
    /// The armature is missing.
    #[error(
        "{file}: the model has the whole inertia and not the motor's part of it, which is MuJoCo's armature; give --rotor-inertia [kg.m2] and --ratio [{unit}]"
    )]
    NoMotor {
        /// File.
        file: String,
        /// Unit of the ratio.
        unit: &'static str,
    },
    /// A pendulum has no motor.
    #[error("{file}: a pendulum has no motor; leave --rotor-inertia and --ratio out")]
    Motor {
        /// File.
        file: String,
    },
    /// The motor's part is more than the whole.
    #[error(
        "--rotor-inertia {rotor} times the square of --ratio {ratio} is {armature} {unit}; it must not be above the whole inertia, {inertia} {unit}"
    )]
    Armature {
        /// Inertia of the rotor.
        rotor: f64,
        /// Ratio of the gearbox.
        ratio: f64,
        /// Their product.
        armature: f64,
        /// The whole inertia.
        inertia: f64,
        /// Unit of both.
        unit: &'static str,
    },
    /// The law has no number at a velocity of the range.
    #[error(
        "{file}: the effects' force at {velocity} {unit} is no finite number; give a range --speed without that velocity"
    )]
    NotFinite {
        /// File.
        file: String,
        /// The velocity.
        velocity: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// The XML could not be written.
    #[error("the XML could not be written: {0}")]
    Xml(#[from] io::Error),
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
