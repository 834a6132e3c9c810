//! `stickslip export`: what was found as a joint's parameters of simulators of robots.
//!
//! [`law`] is the friction over the speed, [`line`] the damping and dry friction that come closest to it over a range, [`joint`] what
//! a simulator needs beside them and what it cannot have, [`xml`] the file.

pub mod error;
pub mod joint;
pub mod law;
pub mod line;
pub mod xml;

use std::fs;
use std::path::PathBuf;

use clap::Args;

use crate::files::atomic;
use crate::outcome::Outcome;
use error::ExportError;
use joint::{Given, Joint};
use line::Speeds;
use xml::{Target, above, number, text};

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// Model file of a drive, pendulum or joint (.toml), such as a diagnosis' model.amended.toml.
    model: PathBuf,
    /// What reads the file.
    #[arg(long, value_enum)]
    to: Target,
    /// Name of the joint, and of its default class in MuJoCo.
    #[arg(long)]
    name: String,
    /// Range of speeds in which the parameters must hold, in both directions [rad/s or m/s].
    #[arg(long, value_name = "LOW:HIGH", allow_hyphen_values = true)]
    speed: Speeds,
    /// Whole moment of inertia about the axis [kg m²], the motor's times the ratio's square in it; of a joint and a pendulum, whose
    /// numbers are over it.
    #[arg(long, value_name = "INERTIA", allow_negative_numbers = true)]
    inertia: Option<f64>,
    /// Moment of inertia of the motor's rotor [kg m²]; times the ratio's square it is the armature.
    #[arg(
        long,
        value_name = "INERTIA",
        requires = "ratio",
        allow_negative_numbers = true
    )]
    rotor_inertia: Option<f64>,
    /// Turns of the motor over turns of the joint; of a drive along a line, angle of the motor over its way [rad/m].
    #[arg(long, requires = "rotor_inertia", allow_negative_numbers = true)]
    ratio: Option<f64>,
    /// File to write; without it the text goes to the screen.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes a joint's parameters.
///
/// # Errors
/// [`ExportError`]; there is no file then.
pub fn command(arguments: &ExportArguments) -> anyhow::Result<Outcome> {
    let (joint, text) = exported(arguments)?;
    let Some(out) = &arguments.out else {
        print!("{text}");
        return Ok(Outcome::Done);
    };
    atomic::write_file(out, text.as_bytes()).map_err(ExportError::from)?;
    let line = joint.line;
    println!(
        "{}: damping {} {}, {} {} {}",
        out.display(),
        number(line.damping),
        joint.damping_unit(),
        arguments.to.friction(),
        number(line.friction),
        joint.force_unit()
    );
    println!(
        "  largest error from {} to {} {}: {} {}",
        joint.speeds.low,
        joint.speeds.high,
        joint.speed_unit(),
        number(above(line.error)),
        joint.force_unit()
    );
    if !joint.left.is_empty() {
        eprintln!(
            "note: these parameters cannot tell {}; the file's comment says why",
            joint.left.join(", ")
        );
    }
    Ok(Outcome::Done)
}

fn exported(arguments: &ExportArguments) -> Result<(Joint, String), ExportError> {
    let ExportArguments { name, to, .. } = arguments;
    let fits = |c: char| c.is_alphanumeric() || "_-.".contains(c);
    if name.is_empty() || !name.chars().all(fits) {
        let name = name.clone();
        return Err(ExportError::Name { name });
    }
    let file = arguments.model.display().to_string();
    let model = fs::read_to_string(&arguments.model).map_err(|source| ExportError::Read {
        file: file.clone(),
        source,
    })?;
    let given = Given {
        speeds: arguments.speed,
        inertia: arguments.inertia,
        motor: arguments
            .rotor_inertia
            .zip(arguments.ratio)
            .map(|(rotor, ratio)| [rotor, ratio]),
        needs_armature: *to == Target::Mujoco,
    };
    let joint = Joint::of(&model, &file, &given)?;
    let text = text(*to, &joint, name, &file)?;
    Ok((joint, text))
}
