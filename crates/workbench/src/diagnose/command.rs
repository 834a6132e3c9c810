//! `stickslip diagnose`, and its stages `locate`, `name`, `amend` and `show` alone on each other's files.

use std::path::PathBuf;

use anyhow::Context;
use build_fmu::library;
use clap::Args;

use super::amend;
use super::case::CaseError;
use super::finding::{Finding, VerdictName};
use super::made::typed;
use super::material::{CaseArguments, Material};
use super::progress::Progress;
use super::session::Session;
use super::small_plant::command::{self as small_plant, Stage};
use crate::outcome::Outcome;

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

/// What the case is made of, with the command for the report.
fn material(case: &CaseArguments) -> Result<Material, CaseError> {
    Ok(Material {
        command: Some(typed()),
        ..case.material()?
    })
}

/// All stages in turn.
///
/// # Errors
/// Whatever is wrong with the input; the exit code is then 2.
pub fn diagnose(arguments: &DiagnoseArguments) -> anyhow::Result<Outcome> {
    let material = material(&arguments.case)?;
    if material.is_of_small_plant() {
        return small(&material, Stage::All, arguments);
    }
    let library = library::find(arguments.library.as_deref())?;
    let session = Session::begin(&material, &arguments.out)?;
    let (finding, _) = session.all_stages(&library)?;
    session.answer_with_files(&finding);
    Ok(Outcome::of(finding.is_settled()))
}

/// Where the model and the records disagree; no candidate is tried.
///
/// # Errors
/// As for [`diagnose`].
pub fn locate(arguments: &DiagnoseArguments) -> anyhow::Result<Outcome> {
    let material = material(&arguments.case)?;
    if material.is_of_small_plant() {
        return small(&material, Stage::Locate, arguments);
    }
    let session = Session::begin(&material, &arguments.out)?;
    let finding = session.locate()?;
    session.answer(&finding);
    Ok(Outcome::Done)
}

/// Which effect is missing.
///
/// # Errors
/// As for [`diagnose`].
pub fn name(arguments: &DiagnoseArguments) -> anyhow::Result<Outcome> {
    let material = material(&arguments.case)?;
    if material.is_of_small_plant() {
        return small(&material, Stage::Name, arguments);
    }
    let session = Session::begin(&material, &arguments.out)?;
    let finding = session.name()?;
    session.answer(&finding);
    Ok(Outcome::of(finding.verdict != VerdictName::NotInCatalogue))
}

/// The amended model and its FMUs, from the finding there is or with effects that are given.
///
/// # Errors
/// As for [`diagnose`]; also where there is neither a finding nor an effect.
pub fn amend_command(arguments: &AmendArguments) -> anyhow::Result<Outcome> {
    let common = &arguments.common;
    let material = material(&common.case)?;
    if material.is_of_small_plant() {
        return small(&material, Stage::Amend(&arguments.effect), common);
    }
    let library = library::find(common.library.as_deref())?;
    let session = Session::begin(&material, &common.out)?;
    let finding = if arguments.effect.is_empty() {
        Finding::read(&common.out)?
    } else {
        session.forced(&arguments.effect, Finding::read(&common.out).ok())?
    };
    session.amend(&finding, &library)?;
    session.answer(&finding);
    println!("\n  written to {}", common.out.join(amend::FILE).display());
    println!("  next: stickslip show, for before and after on the held-out record");
    Ok(Outcome::Done)
}

/// Before and after on the held-out record, and the report, from the finding and the amended model there are.
///
/// # Errors
/// As for [`diagnose`]; also where there is no finding or no amended model.
pub fn show(arguments: &DiagnoseArguments) -> anyhow::Result<Outcome> {
    let material = material(&arguments.case)?;
    if material.is_of_small_plant() {
        return small(&material, Stage::Show, arguments);
    }
    let library = library::find(arguments.library.as_deref())?;
    let session = Session::begin(&material, &arguments.out)?;
    let mut finding = Finding::read(&arguments.out)?;
    let path = arguments.out.join(amend::FILE);
    let text = std::fs::read_to_string(&path).with_context(|| {
        format!(
            "{}: run `stickslip amend` into this directory first",
            path.display()
        )
    })?;
    session.show(&mut finding, &text, &library)?;
    session.answer_with_files(&finding);
    Ok(Outcome::of(finding.is_settled()))
}

/// A stage, or all, on a small plant.
fn small(
    material: &Material,
    stage: Stage<'_>,
    common: &DiagnoseArguments,
) -> anyhow::Result<Outcome> {
    let progress = Progress::new();
    let library = common.library.as_deref();
    let (outcome, text) = small_plant::run(material, stage, &common.out, library, &mut |what| {
        progress.say(what)
    })?;
    progress.done();
    print!("{text}");
    Ok(outcome)
}
