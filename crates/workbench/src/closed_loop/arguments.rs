//! The arguments of `stickslip closed-loop`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use anyhow::ensure;
use clap::Args;

use super::run::Case;
use crate::map::Span;

/// A rig with controllers: kinds of motion over speed and normal force, or over the communication step.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    stickslip closed-loop modelDescription/reduced-rig.toml --controller modelDescription/soft-torque.toml \
    --speed-rpm 5:60:12 --normal-force 0:70:15 --out out/closed-loop\n  \
    stickslip closed-loop modelDescription/reduced-rig.toml --controller modelDescription/soft-torque.toml \
    --speed-rpm 55 --normal-force 50 --communication-step 0.0001,0.001,0.01,0.05 --out out/steps")]
pub struct ClosedLoopArguments {
    /// The rig (.toml or .fmu).
    pub rig: PathBuf,
    /// A controller (.toml or .fmu), connected where names agree; may be repeated. The rig at constant voltage is
    /// always there to compare with.
    #[arg(long, required = true)]
    pub controller: Vec<PathBuf>,
    /// Wanted speed at the gearbox output [rpm]: from:to:count or one value.
    #[arg(long, allow_hyphen_values = true)]
    pub speed_rpm: Span,
    /// Normal force N2 on disc D2 [N]: from:to:count or one value.
    #[arg(long, allow_hyphen_values = true)]
    pub normal_force: Span,
    /// Normal force N1 on disc D1 [N], for the full rig.
    #[arg(long, allow_negative_numbers = true)]
    pub normal_force_1: Option<f64>,
    /// Time between exchanges of rig and controller [s]; several, with commas, give a table over them.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "0.002",
        allow_hyphen_values = true
    )]
    pub communication_step: Vec<f64>,
    /// Length of each run [s]; its last third is judged.
    #[arg(long, default_value_t = 60.0, allow_negative_numbers = true)]
    pub duration: f64,
    /// Threads; all cores if not given.
    #[arg(long)]
    pub threads: Option<NonZeroUsize>,
    /// Directory for the result.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

impl ClosedLoopArguments {
    /// Refuses numbers that make no sense together.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        ensure!(
            self.duration.is_finite() && self.duration > 0.0,
            "--duration {}: a positive number of seconds is needed",
            self.duration
        );
        for step in &self.communication_step {
            ensure!(
                *step > 0.0 && *step <= 0.1 * self.duration,
                "--communication-step {step}: a positive number of seconds up to a tenth of --duration is needed"
            );
        }
        let several = self.communication_step.len() > 1;
        ensure!(
            !(several && (self.speed_rpm.varies() || self.normal_force.varies())),
            "several communication steps are compared at one speed and one normal force"
        );
        for force in self.normal_force.values() {
            ensure!(
                force >= 0.0,
                "--normal-force {force}: 0 N or more is needed"
            );
        }
        if let Some(force) = self.normal_force_1 {
            ensure!(
                force.is_finite() && force >= 0.0,
                "--normal-force-1 {force}: 0 N or more is needed"
            );
        }
        Ok(())
    }

    /// The rig without and with each controller.
    pub(super) fn cases(&self) -> Vec<Case> {
        let controllers = self.controller.iter();
        std::iter::once(Case::ConstantVoltage)
            .chain(controllers.map(|path| Case::Controller(path.clone())))
            .collect()
    }
}
