//! The arguments of `stickslip map`.

use std::fs;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Context, ensure};
use clap::Args;
use stickslip::controller::is_controller;

use super::settings::{Quantity, Settings};
use super::span::Span;

/// What maps and ensembles are asked alike.
#[derive(Debug, Args)]
pub struct RunArguments {
    /// Model (.toml).
    pub model: PathBuf,
    /// Speed at the gearbox output [rpm] that the voltage would give the undisturbed rig with the model's numbers: from:to:count or one
    /// value.
    #[arg(long, allow_hyphen_values = true)]
    pub speed_rpm: Span,
    /// Normal force N2 on disc D2 [N]: from:to:count or one value.
    #[arg(long, allow_hyphen_values = true)]
    pub normal_force: Span,
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

impl RunArguments {
    /// The text of the model, of which `study`, such as "a map", is made.
    pub(crate) fn text(&self, study: &str) -> anyhow::Result<String> {
        let path = &self.model;
        ensure!(
            path.extension().is_none_or(|extension| extension != "fmu"),
            "{} is an FMU; {study} is made from its model file, which is in it as resources/model.toml",
            path.display()
        );
        let text = fs::read_to_string(path)
            .with_context(|| format!("{}: cannot be read", path.display()))?;
        ensure!(
            !is_controller(&text),
            "{} is a controller; {study} is made of a rig (with controllers: stickslip closed-loop)",
            path.display()
        );
        Ok(text)
    }
}

/// Kinds of motion over one or two parameters.
#[derive(Debug, Args)]
pub struct MapArguments {
    #[command(flatten)]
    pub(super) runs: RunArguments,
    /// Normal force N1 on disc D1 [N], for the full rig: from:to:count or one value.
    #[arg(long, allow_hyphen_values = true)]
    pub normal_force_1: Option<Span>,
    /// A parameter of the model, such as contact.mu_s=0.1:0.3:21; may be repeated.
    #[arg(long, value_name = "NAME=FROM:TO:COUNT")]
    pub vary: Vec<Variation>,
}

/// A parameter and the values it takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Variation {
    name: String,
    span: Span,
}

impl FromStr for Variation {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (name, span) = text
            .split_once('=')
            .ok_or("NAME=FROM:TO:COUNT is needed, such as contact.mu_s=0.1:0.3:21")?;
        Ok(Self {
            name: name.trim().to_owned(),
            span: span.parse()?,
        })
    }
}

impl MapArguments {
    /// The runs that were asked for.
    pub(super) fn settings(&self) -> anyhow::Result<Settings> {
        let runs = &self.runs;
        let text = runs.text("a map")?;
        let mut spans = vec![
            (Quantity::SpeedRpm, runs.speed_rpm),
            (Quantity::NormalForce, runs.normal_force),
        ];
        spans.extend(
            self.normal_force_1
                .map(|span| (Quantity::NormalForce1, span)),
        );
        for variation in &self.vary {
            spans.push((Quantity::Parameter(variation.name.clone()), variation.span));
        }
        Ok(Settings::new(
            &text,
            &runs.model.display().to_string(),
            &spans,
            runs.duration,
            runs.tolerance,
        )?)
    }
}
