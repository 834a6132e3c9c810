//! `stickslip diagnose`, and its stages `locate`, `name`, `amend` and `show` alone on each other's files.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use build_fmu::library::{self, Library};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use stickslip::plant::ModelFile;

use super::amend;
use super::case::{Case, CaseArguments, check_effect};
use super::console::screen;
use super::finding::{Finding, VerdictName};
use super::forced::fit_effects;
use super::marginal::Disturbance;
use super::naming::{self, forced_finding, located_finding};
use super::report::{self, Report};
use super::residual_torque::residual_torques;
use super::show::{Comparison, compare};
use crate::cli::Outcome;
use crate::files::atomic;

/// Arguments of `diagnose` and of its stages.
#[derive(Debug, Args)]
pub struct DiagnoseArguments {
    #[command(flatten)]
    case: CaseArguments,
    /// Directory for the results; files of an earlier run are replaced.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// The library to pack into the FMUs; without it the one beside this program.
    #[arg(long, value_name = "FILE")]
    library: Option<PathBuf>,
}

/// Arguments of `amend`.
#[derive(Debug, Args)]
pub struct AmendArguments {
    #[command(flatten)]
    common: DiagnoseArguments,
    /// Add this effect instead of what the finding names; may be given several times.
    #[arg(long, value_name = "NAME")]
    effect: Vec<String>,
}

/// All stages in turn.
///
/// # Errors
/// Whatever is wrong with the input; the exit code is then 2.
pub fn diagnose(arguments: &DiagnoseArguments) -> anyhow::Result<Outcome> {
    let begun = Instant::now();
    let progress = Progress::new();
    let case = load(arguments)?;
    let library = library::find(arguments.library.as_deref())?;
    let (mut finding, experiment) = naming::name(&case, &mut |what| progress.say(what))?;
    if let Some(inputs) = experiment {
        inputs.write(&arguments.out.join(naming::EXPERIMENT_FILE))?;
    }
    finding.seconds = begun.elapsed().as_secs_f64();
    finding.write(&arguments.out)?;
    let text = amended(&case, &finding, &arguments.out, &library, &progress)?;
    let outcome = shown(
        &case,
        &mut finding,
        &text,
        &arguments.out,
        &library,
        &progress,
        begun,
    )?;
    progress.done();
    print_answer(&case, &finding, &arguments.out);
    Ok(outcome)
}

/// Where the model and the records disagree; no candidate is tried.
///
/// # Errors
/// As for [`diagnose`].
pub fn locate(arguments: &DiagnoseArguments) -> anyhow::Result<Outcome> {
    let begun = Instant::now();
    let progress = Progress::new();
    let case = load(arguments)?;
    let mut finding = located_finding(&case, &mut |what| progress.say(what))?;
    finding.seconds = begun.elapsed().as_secs_f64();
    finding.write(&arguments.out)?;
    progress.done();
    print!("{}", screen(&case.name, &finding));
    Ok(open_or_done(finding.verdict == VerdictName::NothingMissing))
}

/// Which effect is missing.
///
/// # Errors
/// As for [`diagnose`].
pub fn name(arguments: &DiagnoseArguments) -> anyhow::Result<Outcome> {
    let begun = Instant::now();
    let progress = Progress::new();
    let case = load(arguments)?;
    let (mut finding, experiment) = naming::name(&case, &mut |what| progress.say(what))?;
    if let Some(inputs) = experiment {
        inputs.write(&arguments.out.join(naming::EXPERIMENT_FILE))?;
    }
    finding.seconds = begun.elapsed().as_secs_f64();
    finding.write(&arguments.out)?;
    progress.done();
    print!("{}", screen(&case.name, &finding));
    Ok(open_or_done(finding.verdict != VerdictName::NotInCatalogue))
}

/// The amended model and its FMUs, from the finding there is or with effects that are given.
///
/// # Errors
/// As for [`diagnose`]; also where there is neither a finding nor an effect.
pub fn amend_command(arguments: &AmendArguments) -> anyhow::Result<Outcome> {
    let common = &arguments.common;
    for name in &arguments.effect {
        check_effect(name).with_context(|| format!("--effect {name}"))?;
    }
    let begun = Instant::now();
    let progress = Progress::new();
    let case = load(common)?;
    let library = library::find(common.library.as_deref())?;
    let finding = if arguments.effect.is_empty() {
        Finding::read(&common.out)?
    } else {
        let fit = fit_effects(
            &case.training(),
            &case.model,
            &arguments.effect,
            &mut |what| progress.say(what),
        )?;
        let mut finding = forced_finding(
            &case,
            &arguments.effect,
            &fit,
            Finding::read(&common.out).ok(),
        )?;
        finding.seconds = begun.elapsed().as_secs_f64();
        finding.write(&common.out)?;
        finding
    };
    amended(&case, &finding, &common.out, &library, &progress)?;
    progress.done();
    print!("{}", screen(&case.name, &finding));
    println!("\n  written  {}", common.out.join(amend::FILE).display());
    Ok(Outcome::Done)
}

/// Before and after on the held-out record, and the report, from the finding and the amended model there are.
///
/// # Errors
/// As for [`diagnose`]; also where there is no finding or no amended model.
pub fn show(arguments: &DiagnoseArguments) -> anyhow::Result<Outcome> {
    let begun = Instant::now();
    let progress = Progress::new();
    let case = load(arguments)?;
    let library = library::find(arguments.library.as_deref())?;
    let mut finding = Finding::read(&arguments.out)?;
    let path = arguments.out.join(amend::FILE);
    let text = std::fs::read_to_string(&path).with_context(|| {
        format!(
            "{}: run `stickslip amend` into this directory first",
            path.display()
        )
    })?;
    let outcome = shown(
        &case,
        &mut finding,
        &text,
        &arguments.out,
        &library,
        &progress,
        begun,
    )?;
    progress.done();
    print_answer(&case, &finding, &arguments.out);
    Ok(outcome)
}

fn load(arguments: &DiagnoseArguments) -> anyhow::Result<Case> {
    let case = arguments.case.load()?;
    for note in &case.notes {
        eprintln!("note: {note}");
    }
    Ok(case)
}

fn amended(
    case: &Case,
    finding: &Finding,
    out: &Path,
    library: &Library,
    progress: &Progress,
) -> anyhow::Result<String> {
    progress.say("building the amended FMUs");
    let model = amend::amended_model(case, finding)?;
    let text = amend::text(case, finding, &model)?;
    amend::write(out, &text, library)?;
    Ok(text)
}

/// The comparison of both models on the case's held-out record, from their texts.
///
/// # Errors
/// The amended model is wrong, or nothing can be run or built.
pub fn compared(
    case: &Case,
    finding: &Finding,
    text: &str,
    library: &Library,
) -> anyhow::Result<Comparison> {
    let model = ModelFile::parse(text, amend::FILE)?;
    let disturbance = Disturbance {
        relative: finding.friction_fluctuation,
        ..Disturbance::NONE
    };
    let work = tempfile::tempdir()?;
    Ok(compare(
        case,
        &model,
        text,
        &disturbance,
        library,
        work.path(),
    )?)
}

fn shown(
    case: &Case,
    finding: &mut Finding,
    text: &str,
    out: &Path,
    library: &Library,
    progress: &Progress,
    begun: Instant,
) -> anyhow::Result<Outcome> {
    progress.say("held-out record, through the FMUs");
    let comparison = compared(case, finding, text, library)?;
    finding.gap = Some(comparison.gap.clone());
    finding.seconds = finding.seconds.max(begun.elapsed().as_secs_f64());
    finding.write(out)?;
    progress.say("report");
    let training = case.training();
    let amended = ModelFile::parse(text, amend::FILE)?;
    let page = Report {
        case,
        finding,
        comparison: &comparison,
        residuals_before: &residual_torques(&training, &case.model.rig),
        residuals_after: &residual_torques(&training, &amended.rig),
    }
    .to_html();
    atomic::write_file(&out.join(report::FILE), page.as_bytes())?;
    Ok(open_or_done(finding.is_settled()))
}

fn open_or_done(settled: bool) -> Outcome {
    if settled {
        Outcome::Done
    } else {
        Outcome::CheckFailed
    }
}

fn print_answer(case: &Case, finding: &Finding, out: &Path) {
    print!("{}", screen(&case.name, finding));
    println!(
        "\n  written to {}: finding.json, {}, ReducedRig.fmi2.fmu, ReducedRig.fmi3.fmu, {} ({:.1} s)",
        out.display(),
        amend::FILE,
        report::FILE,
        finding.seconds
    );
}

/// A line that says what is being done.
struct Progress {
    bar: ProgressBar,
}

impl Progress {
    fn new() -> Self {
        let bar = ProgressBar::new_spinner();
        bar.set_style(ProgressStyle::default_spinner());
        bar.enable_steady_tick(std::time::Duration::from_millis(200));
        Self { bar }
    }

    fn say(&self, what: &str) {
        self.bar.set_message(what.to_owned());
    }

    fn done(&self) {
        self.bar.finish_and_clear();
    }
}
