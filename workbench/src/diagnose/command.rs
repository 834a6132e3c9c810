//! `stickslip diagnose`, and its stages `locate`, `name`, `amend` and `show` alone on each other's files.

use std::path::{Path, PathBuf};

use anyhow::Context;
use build_fmu::library::{self, Library};
use clap::Args;
use inference::marginal::Disturbance;
use stickslip::plant::ModelFile;

use super::amend;
use super::case::{Case, check_effect};
use super::console::screen;
use super::finding::{self, Finding, VerdictName};
use super::material::{CaseArguments, Material};
use super::naming::{self, forced_finding, located_finding};
use super::progress::{Finished, Interruptible, Progress};
use super::report::{self, Report};
use super::residual_torque::residual_torques;
use super::show::{Comparison, compare};
use super::small_plant::command::{self as small_plant, Stage};
use crate::cli::Outcome;
use crate::files::atomic;
use crate::files::record::Record;

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

/// What the stages of one command share.
struct Session {
    progress: Progress,
    interruptible: Interruptible,
    case: Case,
    out: PathBuf,
}

impl Session {
    /// Reads the case, for a person at a screen.
    fn begin(material: &Material, out: &Path) -> anyhow::Result<Self> {
        check_out(out)?;
        let case = material.load()?;
        for note in &case.notes {
            eprintln!("note: {note}");
        }
        Ok(Self {
            progress: Progress::new(),
            interruptible: Interruptible::new(out)?,
            case,
            out: out.to_owned(),
        })
    }

    /// Reads the case, for a program.
    fn told(
        material: &Material,
        out: &Path,
        tell: Box<dyn Fn(&str)>,
        finished: Finished,
    ) -> anyhow::Result<Self> {
        check_out(out)?;
        Ok(Self {
            case: material.load()?,
            progress: Progress::told(tell),
            interruptible: Interruptible::by_caller(finished),
            out: out.to_owned(),
        })
    }

    /// Amends and shows what was found.
    fn finish(&self, mut finding: Finding, library: &Library) -> anyhow::Result<Diagnosed> {
        let text = self.amend(&finding, library)?;
        let comparison = self.show(&mut finding, &text, library)?;
        Ok(self.diagnosed(&finding, comparison))
    }

    /// What a diagnosis came to.
    fn diagnosed(&self, finding: &Finding, comparison: Comparison) -> Diagnosed {
        Diagnosed {
            outcome: open_or_done(finding.is_settled()),
            screen: screen(&self.case.name, finding),
            shown: Some(comparison),
        }
    }

    /// Names, amends and shows.
    fn all_stages(&self, library: &Library) -> anyhow::Result<(Finding, Comparison)> {
        let mut finding = self.name()?;
        let text = self.amend(&finding, library)?;
        let comparison = self.show(&mut finding, &text, library)?;
        Ok((finding, comparison))
    }

    /// Writes a finding with the experiment it proposes, and takes away what later stages made of an earlier finding.
    fn found(&self, finding: &mut Finding, experiment: Option<Record>) -> anyhow::Result<()> {
        finding.seconds = self.progress.seconds();
        self.interruptible.write(finding::FILE, || {
            for name in [naming::EXPERIMENT_FILE, amend::FILE, report::FILE]
                .into_iter()
                .chain(amend::fmu_files(&self.case.model.rig))
            {
                remove(&self.out.join(name))?;
            }
            if let Some(inputs) = experiment {
                inputs.write(&self.out.join(naming::EXPERIMENT_FILE))?;
            }
            Ok(finding.write(&self.out)?)
        })
    }

    /// Which effect is missing.
    fn name(&self) -> anyhow::Result<Finding> {
        let (mut finding, experiment) =
            naming::name(&self.case, &mut |what| self.progress.say(what))?;
        self.found(&mut finding, experiment)?;
        Ok(finding)
    }

    /// The amended model and its FMUs.
    fn amend(&self, finding: &Finding, library: &Library) -> anyhow::Result<String> {
        self.progress.say("building the amended FMUs");
        let model = amend::amended_model(&self.case, finding)?;
        let text = amend::text(&self.case, finding, &model)?;
        self.interruptible
            .write("the amended model with its FMUs", || {
                Ok(amend::write(&self.out, &text, library)?)
            })?;
        Ok(text)
    }

    /// Before and after on the held-out record, and the report.
    fn show(
        &self,
        finding: &mut Finding,
        text: &str,
        library: &Library,
    ) -> anyhow::Result<Comparison> {
        let (case, progress) = (&self.case, &self.progress);
        progress.say("held-out record, through the FMUs");
        let comparison = compared(case, finding, text, library)?;
        finding.gap = Some(comparison.gap.clone());
        finding.seconds = finding.seconds.max(progress.seconds());
        progress.say("report");
        let problem = case.problem()?;
        let (training, units) = (&problem.long, &problem.units);
        let amended = ModelFile::parse(text, amend::FILE)?;
        let judging = &comparison.judging;
        let page = Report {
            case,
            finding,
            comparison: &comparison,
            residuals_before: &residual_torques(training, units, &case.model.rig)?,
            residuals_after: &residual_torques(training, units, &amended.rig)?,
            residuals_held_out: &residual_torques(&judging.data, &judging.units, &amended.rig)?,
        }
        .to_html();
        self.interruptible.write(report::FILE, || {
            finding.write(&self.out)?;
            Ok(atomic::write_file(
                &self.out.join(report::FILE),
                page.as_bytes(),
            )?)
        })?;
        Ok(comparison)
    }

    /// The answer on the screen.
    fn answer(&self, finding: &Finding) {
        self.progress.done();
        print!("{}", screen(&self.case.name, finding));
    }

    /// The answer, and where all results are.
    fn answer_with_files(&self, finding: &Finding) {
        self.answer(finding);
        println!(
            "\n  {} shows it; beside it: {}, {}, {} ({:.1} s)",
            self.out.join(report::FILE).display(),
            finding::FILE,
            amend::FILE,
            amend::fmu_files(&self.case.model.rig).join(", "),
            finding.seconds
        );
    }
}

fn remove(path: &Path) -> anyhow::Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error)
            .with_context(|| format!("{}: of an earlier run, cannot be removed", path.display())),
        _ => Ok(()),
    }
}

fn check_out(out: &Path) -> anyhow::Result<()> {
    if out.exists() && !out.is_dir() {
        anyhow::bail!(
            "--out {}: is a file; the findings need a directory",
            out.display()
        );
    }
    Ok(())
}

/// What a diagnosis comes to, beside the files that it wrote.
pub struct Diagnosed {
    /// The exit code of the command line.
    pub outcome: Outcome,
    /// What the command line shows.
    pub screen: String,
    /// Both models on the held-out record; absent for small plants.
    pub shown: Option<Comparison>,
}

/// All stages in turn for a program: `tell` hears of every step and may unwind out of it, and `finished` has what is in
/// `out` by then. Nothing is printed and no interrupt is caught.
///
/// # Errors
/// Whatever is wrong with the input.
pub fn diagnose_for(
    material: &Material,
    out: &Path,
    library: Option<&Path>,
    tell: Box<dyn Fn(&str)>,
    finished: Finished,
) -> anyhow::Result<Diagnosed> {
    check_out(out)?;
    if material.is_of_small_plant() {
        return small_for(material, &[Stage::All], out, library, &tell);
    }
    let library = library::find(library)?;
    let session = Session::told(material, out, tell, finished)?;
    let (finding, comparison) = session.all_stages(&library)?;
    Ok(session.diagnosed(&finding, comparison))
}

/// The stages that follow a finding there is, `amend` and `show`, for a program; otherwise as [`diagnose_for`].
///
/// # Errors
/// As for [`diagnose_for`]; also where there is no finding.
pub fn go_on_for(
    material: &Material,
    out: &Path,
    library: Option<&Path>,
    tell: Box<dyn Fn(&str)>,
    finished: Finished,
) -> anyhow::Result<Diagnosed> {
    if material.is_of_small_plant() {
        return small_for(
            material,
            &[Stage::Amend(&[]), Stage::Show],
            out,
            library,
            &tell,
        );
    }
    let library = library::find(library)?;
    let session = Session::told(material, out, tell, finished)?;
    let finding = Finding::read(out)?;
    session.finish(finding, &library)
}

/// What the model is with `effects` and no others, fitted whether they gain or not, for a program; otherwise as
/// [`diagnose_for`]. Ranking and places come from the finding in `earlier`, where there is one.
///
/// # Errors
/// As for [`diagnose_for`]; also where the catalogue has no such effect, or it cannot be added to the model.
pub fn amend_for(
    material: &Material,
    effects: &[String],
    earlier: &Path,
    out: &Path,
    library: Option<&Path>,
    tell: Box<dyn Fn(&str)>,
    finished: Finished,
) -> anyhow::Result<Diagnosed> {
    if material.is_of_small_plant() {
        return small_for(
            material,
            &[Stage::Amend(effects), Stage::Show],
            out,
            library,
            &tell,
        );
    }
    let library = library::find(library)?;
    let session = Session::told(material, out, tell, finished)?;
    for name in effects {
        check_effect(name, &session.case.catalogue)?;
    }
    let mut finding = forced_finding(
        &session.case,
        effects,
        Finding::read(earlier).ok(),
        &mut |what| session.progress.say(what),
    )?;
    session.found(&mut finding, None)?;
    session.finish(finding, &library)
}

/// Stages on a small plant for a program, one after the other.
fn small_for(
    material: &Material,
    stages: &[Stage<'_>],
    out: &Path,
    library: Option<&Path>,
    tell: &dyn Fn(&str),
) -> anyhow::Result<Diagnosed> {
    check_out(out)?;
    let mut last = (Outcome::Done, String::new());
    for stage in stages {
        last = small_plant::run(material, *stage, out, library, &mut |what| tell(what))?;
    }
    let (outcome, screen) = last;
    Ok(Diagnosed {
        outcome,
        screen,
        shown: None,
    })
}

/// All stages in turn.
///
/// # Errors
/// Whatever is wrong with the input; the exit code is then 2.
pub fn diagnose(arguments: &DiagnoseArguments) -> anyhow::Result<Outcome> {
    let material = arguments.case.material()?;
    if material.is_of_small_plant() {
        return small(&material, Stage::All, arguments);
    }
    let library = library::find(arguments.library.as_deref())?;
    let session = Session::begin(&material, &arguments.out)?;
    let (finding, _) = session.all_stages(&library)?;
    session.answer_with_files(&finding);
    Ok(open_or_done(finding.is_settled()))
}

/// Where the model and the records disagree; no candidate is tried.
///
/// # Errors
/// As for [`diagnose`].
pub fn locate(arguments: &DiagnoseArguments) -> anyhow::Result<Outcome> {
    let material = arguments.case.material()?;
    if material.is_of_small_plant() {
        return small(&material, Stage::Locate, arguments);
    }
    let session = Session::begin(&material, &arguments.out)?;
    let mut finding = located_finding(&session.case, &mut |what| session.progress.say(what))?;
    session.found(&mut finding, None)?;
    session.answer(&finding);
    Ok(Outcome::Done)
}

/// Which effect is missing.
///
/// # Errors
/// As for [`diagnose`].
pub fn name(arguments: &DiagnoseArguments) -> anyhow::Result<Outcome> {
    let material = arguments.case.material()?;
    if material.is_of_small_plant() {
        return small(&material, Stage::Name, arguments);
    }
    let session = Session::begin(&material, &arguments.out)?;
    let finding = session.name()?;
    session.answer(&finding);
    Ok(open_or_done(finding.verdict != VerdictName::NotInCatalogue))
}

/// The amended model and its FMUs, from the finding there is or with effects that are given.
///
/// # Errors
/// As for [`diagnose`]; also where there is neither a finding nor an effect.
pub fn amend_command(arguments: &AmendArguments) -> anyhow::Result<Outcome> {
    let common = &arguments.common;
    let material = common.case.material()?;
    if material.is_of_small_plant() {
        return small(&material, Stage::Amend(&arguments.effect), common);
    }
    let library = library::find(common.library.as_deref())?;
    let session = Session::begin(&material, &common.out)?;
    for name in &arguments.effect {
        check_effect(name, &session.case.catalogue).context("--effect")?;
    }
    let finding = if arguments.effect.is_empty() {
        Finding::read(&common.out)?
    } else {
        let earlier = Finding::read(&common.out).ok();
        let mut finding = forced_finding(&session.case, &arguments.effect, earlier, &mut |what| {
            session.progress.say(what)
        })?;
        session.found(&mut finding, None)?;
        finding
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
    let material = arguments.case.material()?;
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
    Ok(open_or_done(finding.is_settled()))
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

fn open_or_done(settled: bool) -> Outcome {
    if settled {
        Outcome::Done
    } else {
        Outcome::CheckFailed
    }
}
