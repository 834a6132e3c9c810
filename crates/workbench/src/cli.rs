//! The command line: one subcommand per module.

use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;

use build_fmu::explain::explain;
use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;

use crate::build::{self, BuildArguments};
use crate::calibrate::{self, command::CalibrateArguments};
use crate::closed_loop::{self, ClosedLoopArguments};
use crate::cross_check::{self, CrossCheckArguments};
use crate::diagnose::command::{self as diagnose, AmendArguments, DiagnoseArguments};
use crate::diagnose::effect_page::{self, EffectsArguments};
use crate::diagnose::score::{self, ScoreArguments};
use crate::diagnose::small_plant::fmu::template::{self, PortsArguments};
use crate::diagnose::small_plant::fmu::worker::{self, COMMAND as WORKER};
use crate::ensemble::{self, EnsembleArguments};
use crate::experiment::{self, command::ExperimentArguments};
use crate::export::{self, ExportArguments};
use crate::identify::{self, command::IdentifyArguments};
use crate::info::{self, InfoArguments};
use crate::map::{self, MapArguments};
use crate::outcome::Outcome;
use crate::simulate::{self, SimulateArguments};
use crate::studio::{self, StudioArguments};

/// Exit code for wrong usage or input.
const INPUT_ERROR: u8 = 2;

/// Friction-induced stick-slip of a motor-driven torsional rig: simulate it, map it, find what a model of it lacks.
#[derive(Debug, Parser)]
#[command(name = "stickslip", version, arg_required_else_help = true)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a model or an FMU.
    #[command(
        after_help = "Example: stickslip simulate rig.toml --speed-rpm 55 --normal-force 50 --out result
         stickslip simulate ReducedRig.fmi3.fmu --inputs run.csv --set contact.mu_s=0.25 --out result"
    )]
    Simulate(SimulateArguments),
    /// Map the kinds of motion over one or two parameters.
    #[command(
        after_help = "Example: stickslip map rig.toml --speed-rpm 20:80:61 --normal-force 0:80:81 --out map

Interrupted, it goes on with the same command."
    )]
    Map(MapArguments),
    /// Run a rig many times with parameters drawn from their uncertainties: probability of stick-slip, bands of its measures.
    #[command(
        after_help = "Example: stickslip ensemble rig.toml --speed-rpm 20:80:13 --normal-force 0:80:9 --runs 200 --seed 1 --out ensemble
         stickslip ensemble rig.toml --speed-rpm 55 --normal-force 50 --runs 10000 --seed 1 --uncertain contact.mu_s=0.1 --out ensemble

Interrupted, it goes on with the same command."
    )]
    Ensemble(EnsembleArguments),
    /// Run a rig with controllers over speed and normal force, or over the communication step.
    ClosedLoop(ClosedLoopArguments),
    /// Say what a model or an FMU is and has.
    #[command(after_help = "Example: stickslip info ReducedRig.fmi3.fmu")]
    Info(InfoArguments),
    /// Name the effect that a model lacks, add it, and show on a held-out record that the gap is closed.
    #[command(after_help = "Example: stickslip diagnose my-case --out result
         stickslip diagnose --model model.toml --records run-a.csv run-b.csv --held-out held-out.csv --out result

Reading on: result/report.html. Exit codes: 0 gap closed or nothing missing, 1 structure left, 2 bad input, 130 interrupted.")]
    Diagnose(DiagnoseArguments),
    /// First stage of `diagnose`: where model and records disagree.
    #[command(after_help = "Example: stickslip locate my-case --out result

Then: stickslip name my-case --out result")]
    Locate(DiagnoseArguments),
    /// Second stage of `diagnose`: which effect is missing.
    #[command(
        after_help = "Example: stickslip name my-case --out result --without stribeck

Then: stickslip amend my-case --out result"
    )]
    Name(DiagnoseArguments),
    /// Third stage of `diagnose`: the amended model and its FMUs, from the finding or from effects that are given.
    #[command(after_help = "Example: stickslip amend my-case --out result
         stickslip amend my-case --out result --effect unbalance --effect viscous_drag

Then: stickslip show my-case --out result")]
    Amend(AmendArguments),
    /// Last stage of `diagnose`: before and after on the held-out record, and the report.
    #[command(after_help = "Example: stickslip show my-case --out result")]
    Show(DiagnoseArguments),
    /// The diagnosis as a local page: records, sliders, residuals, the finding, and what to take along.
    #[command(after_help = "Example: stickslip studio my-case
         stickslip studio --out my-folder

The page is served to this machine alone, works offline, and goes on where it was after a reload or a new start. Ctrl-C ends it.")]
    Studio(StudioArguments),
    /// The effects that can be named, and what each one is.
    #[command(
        after_help = "Examples: stickslip effects unbalance\n          stickslip effects --out docs/effects"
    )]
    Effects(EffectsArguments),
    /// A first ports file for an FMU, by which `diagnose` takes it as a plant.
    #[command(after_help = "Example: stickslip ports plant.fmu --out ports.toml

Then: stickslip diagnose --model plant.fmu --ports ports.toml --records run-a.csv --held-out held-out.csv --out result")]
    Ports(PortsArguments),
    /// A run of an FMU in a process of its own; `diagnose` calls it.
    #[command(name = WORKER, hide = true, after_help = "Example: stickslip fmu-worker directory")]
    FmuWorker {
        /// Directory with the job, where the answer goes.
        directory: PathBuf,
    },
    /// Diagnose cases whose answers are known, and judge the findings.
    #[command(after_help = "Example: stickslip score cases --out score --leave-one-out")]
    Score(ScoreArguments),
    /// Pack a model into FMUs.
    #[command(after_help = "Example: stickslip build rig.toml --out fmus
         stickslip build rig.toml --platform linux64 --platform win64 --out fmus")]
    Build(BuildArguments),
    /// Write damping, dry friction and armature of a joint for MuJoCo or URDF, with what they cannot tell.
    #[command(
        after_help = "Example: stickslip export result/model.amended.toml --to mujoco --name shoulder --speed 0.05:6 \\
           --inertia 0.012 --rotor-inertia 3e-8 --ratio 288.4 --out shoulder.xml
         stickslip export drive.toml --to urdf --name slide --speed 0.01:0.4 --out slide.urdf.xml"
    )]
    Export(ExportArguments),
    /// FMUs with inputs, reference results and options of the FMI Cross-Check; any FMU against the results that it holds.
    #[command(
        after_help = "Example: stickslip cross-check rig.toml --speed-rpm 55 --normal-force 50 --out cross-check
         stickslip cross-check Foreign.fmu --out cross-check"
    )]
    CrossCheck(CrossCheckArguments),
    /// The dissertation's computations, with the published numbers beside ours.
    #[command(after_help = "Example: stickslip experiment list
         stickslip experiment run table-4.7
         stickslip experiment all --out experiments")]
    Experiment(ExperimentArguments),
    /// Stiffness, damping and frequencies from a user's own tests.
    #[command(after_help = "Example: stickslip identify static twists.csv
         stickslip identify decay swing.csv --column theta --smallest 0.01 --inertia 0.0149
         stickslip identify spectrum run.csv --column theta_dot --peaks 5")]
    Identify(IdentifyArguments),
    /// Find a law's unpublished parameters from published facts.
    #[command(
        after_help = "Example: stickslip calibrate --model crates/workbench/targets/eq-6-2-rig.toml \\
           --target crates/workbench/targets/eq-6-2.toml --out calibrated

Interrupted, it goes on with the same command."
    )]
    Calibrate(CalibrateArguments),
    /// Print the completions of these commands for a shell.
    #[command(
        after_help = "Example: stickslip completions bash > ~/.local/share/bash-completion/completions/stickslip
         stickslip completions zsh > ~/.zfunc/_stickslip
         stickslip completions fish > ~/.config/fish/completions/stickslip.fish"
    )]
    Completions {
        /// The shell.
        shell: Shell,
    },
}

/// The program: `arguments` are its name and those of the command line; returns the exit code. Usage that is wrong or asks for
/// help ends the process.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    // A reader such as `head` that has seen enough is no error.
    sigpipe::reset();
    match run(&Cli::parse_from(arguments)) {
        Ok(outcome) => outcome.code(),
        Err(error) => {
            eprintln!("stickslip: {}", explain(error.as_ref()));
            INPUT_ERROR
        }
    }
}

/// Runs the command that was given.
///
/// # Errors
/// Whatever is wrong with the usage or the input, in words for the user; the exit code is then 2.
pub fn run(cli: &Cli) -> anyhow::Result<Outcome> {
    match &cli.command {
        Command::Simulate(arguments) => simulate::command(arguments),
        Command::Map(arguments) => map::command(arguments),
        Command::Ensemble(arguments) => ensemble::command(arguments),
        Command::ClosedLoop(arguments) => closed_loop::command(arguments),
        Command::Info(arguments) => info::command(arguments),
        Command::Diagnose(arguments) => diagnose::diagnose(arguments),
        Command::Locate(arguments) => diagnose::locate(arguments),
        Command::Name(arguments) => diagnose::name(arguments),
        Command::Amend(arguments) => diagnose::amend_command(arguments),
        Command::Show(arguments) => diagnose::show(arguments),
        Command::Studio(arguments) => studio::command(arguments),
        Command::Effects(arguments) => effect_page::command(arguments),
        Command::Ports(arguments) => template::command(arguments),
        Command::FmuWorker { directory } => {
            worker::work(directory)?;
            Ok(Outcome::Done)
        }
        Command::Score(arguments) => score::command(arguments),
        Command::Build(arguments) => build::command(arguments),
        Command::Export(arguments) => export::command(arguments),
        Command::CrossCheck(arguments) => cross_check::command(arguments),
        Command::Experiment(arguments) => experiment::command::run(arguments),
        Command::Identify(arguments) => identify::command::run(arguments),
        Command::Calibrate(arguments) => calibrate::command::run(arguments),
        Command::Completions { shell } => {
            // Into memory first: what writes to a pipe that is closed would panic.
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Cli::command(), "stickslip", &mut script);
            std::io::stdout().write_all(&script)?;
            Ok(Outcome::Done)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The command lines of a help's examples, words split, continued lines joined.
    fn examples(help: &str) -> Vec<Vec<String>> {
        help.replace("\\\n", " ")
            .lines()
            .filter_map(|line| {
                let start = line.find("stickslip ")?;
                let before = line[..start].trim();
                if !(before.is_empty() || before == "Example:" || before == "Then:") {
                    return None;
                }
                let words = line[start..].split_whitespace().map(str::to_owned);
                Some(words.take_while(|word| word != ">").collect())
            })
            .collect()
    }

    #[test]
    fn every_command_has_examples_and_they_can_be_typed() {
        for command in Cli::command().get_subcommands() {
            let name = command.get_name();
            let help = command
                .get_after_help()
                .map(ToString::to_string)
                .unwrap_or_default();
            let examples = examples(&help);
            assert!(
                examples.iter().any(|words| words[1] == name),
                "{name} has no example"
            );
            for words in examples {
                if let Err(error) = Cli::try_parse_from(&words) {
                    panic!("{}: {error}", words.join(" "));
                }
            }
        }
    }

    #[test]
    fn completions_know_every_command() {
        for shell in [Shell::Bash, Shell::Zsh, Shell::Fish, Shell::PowerShell] {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "stickslip", &mut script);
            let script = String::from_utf8(script).unwrap();
            for command in Cli::command().get_subcommands() {
                assert!(
                    script.contains(command.get_name()),
                    "{shell}: {}",
                    command.get_name()
                );
            }
        }
    }
}
