//! The stages of a diagnosis on a rig's case: what each reads and writes.

use std::path::{Path, PathBuf};

use anyhow::Context;
use build_fmu::library::Library;
use inference::marginal::Disturbance;
use stickslip::plant::ModelFile;

use super::amend;
use super::case::{Case, check_effect};
use super::console::screen;
use super::finding::{self, Finding};
use super::made::Made;
use super::material::Material;
use super::naming::{self, forced_finding, located_finding};
use super::progress::{Finished, Interruptible, Progress};
use super::report::{self, Report};
use super::residual_torque::residual_torques;
use super::show::{Comparison, compare};
use crate::files::atomic;
use crate::files::record::Record;

/// What the stages of one command share.
pub(super) struct Session {
    progress: Progress,
    interruptible: Interruptible,
    pub case: Case,
    made: Made,
    out: PathBuf,
}

impl Session {
    /// Reads the case, for a person at a screen.
    pub fn begin(material: &Material, out: &Path) -> anyhow::Result<Self> {
        check_out(out)?;
        let case = material.load()?;
        for note in &case.notes {
            eprintln!("note: {note}");
        }
        Ok(Self {
            progress: Progress::new(),
            interruptible: Interruptible::new(out)?,
            case,
            made: Made::of(material, None)?,
            out: out.to_owned(),
        })
    }

    /// Reads the case, for a program.
    pub fn told(
        material: &Material,
        out: &Path,
        tell: Box<dyn Fn(&str)>,
        finished: Finished,
    ) -> anyhow::Result<Self> {
        check_out(out)?;
        Ok(Self {
            case: material.load()?,
            made: Made::of(material, None)?,
            progress: Progress::told(tell),
            interruptible: Interruptible::by_caller(finished),
            out: out.to_owned(),
        })
    }

    /// Names, amends and shows.
    pub fn all_stages(&self, library: &Library) -> anyhow::Result<(Finding, Comparison)> {
        let finding = self.name()?;
        self.finish(finding, library)
    }

    /// Amends and shows what was found.
    pub fn finish(
        &self,
        mut finding: Finding,
        library: &Library,
    ) -> anyhow::Result<(Finding, Comparison)> {
        let text = self.amend(&finding, library)?;
        let comparison = self.show(&mut finding, &text, library)?;
        Ok((finding, comparison))
    }

    /// Writes a finding with the experiment it proposes, and takes away what later stages made of an earlier finding.
    pub fn found(&self, finding: &mut Finding, experiment: Option<Record>) -> anyhow::Result<()> {
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

    /// The model with these effects and no others, fitted whether they gain or not; ranking and places are those of `earlier`.
    pub fn forced(&self, effects: &[String], earlier: Option<Finding>) -> anyhow::Result<Finding> {
        for name in effects {
            check_effect(name, &self.case.catalogue)?;
        }
        let mut tell = |what: &str| self.progress.say(what);
        let mut finding = forced_finding(&self.case, effects, earlier, &mut tell)?;
        self.found(&mut finding, None)?;
        Ok(finding)
    }

    /// Where the model and the records disagree.
    pub fn locate(&self) -> anyhow::Result<Finding> {
        let mut finding = located_finding(&self.case, &mut |what| self.progress.say(what))?;
        self.found(&mut finding, None)?;
        Ok(finding)
    }

    /// Which effect is missing.
    pub fn name(&self) -> anyhow::Result<Finding> {
        let (mut finding, experiment) =
            naming::name(&self.case, &mut |what| self.progress.say(what))?;
        self.found(&mut finding, experiment)?;
        Ok(finding)
    }

    /// The amended model and its FMUs.
    pub fn amend(&self, finding: &Finding, library: &Library) -> anyhow::Result<String> {
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
    pub fn show(
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
            made: &self.made,
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
    pub fn answer(&self, finding: &Finding) {
        self.progress.done();
        print!("{}", screen(&self.case.name, finding));
    }

    /// The answer, and where all results are.
    pub fn answer_with_files(&self, finding: &Finding) {
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

/// Refuses a place for results that is a file.
pub(super) fn check_out(out: &Path) -> anyhow::Result<()> {
    if out.exists() && !out.is_dir() {
        anyhow::bail!(
            "--out {}: is a file; the findings need a directory",
            out.display()
        );
    }
    Ok(())
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
