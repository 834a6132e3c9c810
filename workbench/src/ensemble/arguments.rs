//! The arguments of `stickslip ensemble`.

use std::fs;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Context, ensure};
use clap::Args;
use stickslip::controller::is_controller;

use super::settings::{Conditions, Settings};
use super::uncertain::Uncertain;
use crate::map::Span;

/// Runs with parameters drawn from their uncertainties.
#[derive(Debug, Args)]
pub struct EnsembleArguments {
    /// Model (.toml).
    pub model: PathBuf,
    /// Speed at the gearbox output [rpm] that the voltage would give the undisturbed nominal rig: from:to:count or one value.
    #[arg(long, allow_hyphen_values = true)]
    pub speed_rpm: Span,
    /// Normal force N2 on disc D2 [N]: from:to:count or one value.
    #[arg(long, allow_hyphen_values = true)]
    pub normal_force: Span,
    /// Normal force N1 on disc D1 [N], for the full rig.
    #[arg(long, allow_negative_numbers = true)]
    pub normal_force_1: Option<f64>,
    /// Number of rigs that are drawn; each runs at every speed and normal force.
    #[arg(long)]
    pub runs: usize,
    /// Number of the random draw: the same seed gives the same rigs.
    #[arg(long)]
    pub seed: u64,
    /// A parameter to draw, such as contact.mu_s; may be repeated. Without it all whose relative_uncertainty the model states.
    #[arg(long, value_name = "NAME")]
    pub draw: Vec<String>,
    /// Relative standard deviation of a parameter, in place of what the model states; 0 holds it. May be repeated.
    #[arg(long, value_name = "NAME=RELATIVE")]
    pub uncertain: Vec<Uncertain>,
    /// Length of each run [s]; its last third is judged.
    #[arg(long, default_value_t = 60.0, allow_negative_numbers = true)]
    pub duration: f64,
    /// Local tolerance of the integrator.
    #[arg(long, default_value = "1e-9", allow_negative_numbers = true)]
    pub tolerance: f64,
    /// Threads; all cores if not given.
    #[arg(long)]
    pub threads: Option<NonZeroUsize>,
    /// Directory for the result.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

impl FromStr for Uncertain {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong =
            || format!("`{text}` is not NAME=RELATIVE with a number, such as contact.mu_s=0.05");
        let (name, relative) = text.split_once('=').ok_or_else(wrong)?;
        Ok(Self {
            name: name.trim().to_owned(),
            relative: relative.trim().parse().map_err(|_| wrong())?,
        })
    }
}

impl EnsembleArguments {
    /// The runs that were asked for.
    pub(super) fn settings(&self) -> anyhow::Result<Settings> {
        let path = &self.model;
        ensure!(
            path.extension().is_none_or(|extension| extension != "fmu"),
            "{} is an FMU; an ensemble is made from its model file, which is in it as resources/model.toml",
            path.display()
        );
        let text = fs::read_to_string(path)
            .with_context(|| format!("{}: cannot be read", path.display()))?;
        ensure!(
            !is_controller(&text),
            "{} is a controller; an ensemble is made of a rig",
            path.display()
        );
        let conditions = Conditions {
            speed_rpm: self.speed_rpm,
            normal_force: self.normal_force,
            normal_force_1: self.normal_force_1,
            duration: self.duration,
            tolerance: self.tolerance,
        };
        Ok(Settings::new(
            &text,
            &path.display().to_string(),
            &conditions,
            (self.runs, self.seed),
            (&self.draw, &self.uncertain),
        )?)
    }
}
