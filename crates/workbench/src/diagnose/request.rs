//! A diagnosis that a program asks for, such as the Python package or the studio: nothing is printed, no interrupt is caught.

use std::path::Path;

use build_fmu::library;

use super::console::screen;
use super::finding::Finding;
use super::material::Material;
use super::progress::Finished;
use super::session::{Session, check_out};
use super::show::Comparison;
use super::small_plant::command::{self as small_plant, Stage};
use crate::outcome::Outcome;

/// What is asked of which case.
pub struct Request<'a> {
    /// The case.
    pub material: &'a Material,
    /// Directory for the results.
    pub out: &'a Path,
    /// The library to pack into the FMUs; without it the one beside this program.
    pub library: Option<&'a Path>,
    /// Hears of every step, and may unwind out of it.
    pub tell: Box<dyn Fn(&str)>,
    /// What is in `out` by then.
    pub finished: Finished,
}

/// Which stages are asked for.
#[derive(Debug, Clone, Copy)]
pub enum Stages<'a> {
    /// All in turn.
    All,
    /// Those that follow a finding there is: `amend` and `show`.
    AfterFinding,
    /// The model with these effects and no others, fitted whether they gain or not, then `amend` and `show`. Ranking and places come
    /// from the finding in `earlier`, where there is one.
    With {
        /// Their names.
        effects: &'a [String],
        /// Directory of a finding.
        earlier: &'a Path,
    },
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

impl Request<'_> {
    /// Runs the stages.
    ///
    /// # Errors
    /// Whatever is wrong with the input, as the command line says it.
    pub fn run(self, stages: Stages<'_>) -> anyhow::Result<Diagnosed> {
        check_out(self.out)?;
        if self.material.is_of_small_plant() {
            return self.run_small(stages);
        }
        let library = library::find(self.library)?;
        let session = Session::told(self.material, self.out, self.tell, self.finished)?;
        let finding = match stages {
            Stages::All => session.name()?,
            Stages::AfterFinding => Finding::read(self.out)?,
            Stages::With { effects, earlier } => {
                session.forced(effects, Finding::read(earlier).ok())?
            }
        };
        let (finding, comparison) = session.finish(finding, &library)?;
        Ok(Diagnosed {
            outcome: Outcome::of(finding.is_settled()),
            screen: screen(&session.case.name, &finding),
            shown: Some(comparison),
        })
    }

    fn run_small(self, stages: Stages<'_>) -> anyhow::Result<Diagnosed> {
        let run = |stage| {
            let mut tell = |what: &str| (self.tell)(what);
            small_plant::run(self.material, stage, self.out, self.library, &mut tell)
        };
        let (outcome, screen) = match stages {
            Stages::All => run(Stage::All)?,
            Stages::AfterFinding => {
                run(Stage::Amend(&[]))?;
                run(Stage::Show)?
            }
            Stages::With { effects, .. } => {
                run(Stage::Amend(effects))?;
                run(Stage::Show)?
            }
        };
        Ok(Diagnosed {
            outcome,
            screen,
            shown: None,
        })
    }
}
