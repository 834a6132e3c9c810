//! The arguments of `stickslip ensemble`.

use std::str::FromStr;

use clap::Args;

use super::settings::{Conditions, Settings};
use super::uncertain::Uncertain;
use crate::files::table::TableFormat;
use crate::map::RunArguments;

/// Runs with parameters drawn from their uncertainties.
#[derive(Debug, Args)]
pub struct EnsembleArguments {
    #[command(flatten)]
    pub(super) common: RunArguments,
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
    /// As what the tables are written.
    #[arg(long, value_enum, value_name = "FORMAT", default_value = "csv")]
    pub tables: TableFormat,
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
        let common = &self.common;
        let text = common.text("an ensemble")?;
        let conditions = Conditions {
            speed_rpm: common.speed_rpm,
            normal_force: common.normal_force,
            normal_force_1: self.normal_force_1,
            duration: common.duration,
            tolerance: common.tolerance,
        };
        let mut settings = Settings::new(
            &text,
            &common.model.display().to_string(),
            &conditions,
            (self.runs, self.seed),
            (&self.draw, &self.uncertain),
        )?;
        settings.tables = self.tables;
        Ok(settings)
    }
}
