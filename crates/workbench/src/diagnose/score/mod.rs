//! `stickslip score`: diagnoses cases whose answers are known, and says how often and how well it was right.
//!
//! The engine is given model and records alone; the answers are read for judging what it found.

pub mod answer;
pub mod judge;
pub mod reliability;
pub mod table;
pub mod wilson;

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use anyhow::Context;
use build_fmu::library::{self, Library};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use self::answer::Answer;
use self::judge::{Judgement, judge};
use self::reliability::{Bin, bins};
use self::table::{Line, confusion, lines, to_markdown};
use super::amend;
use super::finding::{FILE, Finding};
use super::material::CaseArguments;
use super::naming;
use super::session::compared;
use super::small_plant::command::{self as small_plant, Stage};
use super::supposed;
use crate::files::atomic;
use crate::outcome::Outcome;

/// Arguments of `score`.
#[derive(Debug, Args)]
pub struct ScoreArguments {
    /// Directory with ANSWERS.json and one directory per case.
    cases: PathBuf,
    /// Directory for findings, score.json and score.md; findings that are there already are not made again.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Diagnose each case once more with the right effects taken out of the catalogue.
    #[arg(long)]
    leave_one_out: bool,
    /// Directory with effects of your own that are tried in every case, as in `diagnose`. The answer of a case whose kind is
    /// `outside_` and the name of one of them is that effect.
    #[arg(long, value_name = "DIR")]
    catalogue: Option<PathBuf>,
    /// Cases diagnosed at a time. Each uses all cores, so more than one makes the times per case longer.
    #[arg(long, default_value_t = 1)]
    jobs: usize,
    /// The library to pack into the FMUs; without it the one beside this program.
    #[arg(long, value_name = "FILE")]
    library: Option<PathBuf>,
}

/// One diagnosis to make: the case, the answer, the effects taken out.
struct Task {
    case: String,
    answer: Answer,
    without: Vec<String>,
    out: PathBuf,
}

#[derive(Serialize)]
struct Score {
    table: Vec<Line>,
    /// Whether probabilities are what they say.
    reliability: Vec<Bin>,
    /// Cases that could not be diagnosed, with the reason.
    failed: Vec<String>,
}

/// Runs the subcommand; the check fails where a bar is missed or a case cannot be diagnosed.
///
/// # Errors
/// There are no answers, or results cannot be written.
pub fn command(arguments: &ScoreArguments) -> anyhow::Result<Outcome> {
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} {msg} {eta}") {
        bar.set_style(style);
    }
    let scored = score(
        &Scoring {
            cases: &arguments.cases,
            out: &arguments.out,
            leave_one_out: arguments.leave_one_out,
            catalogue: arguments.catalogue.as_deref(),
            jobs: arguments.jobs,
            library: arguments.library.as_deref(),
        },
        &|step| match step {
            Step::Begun { cases } => bar.set_length(cases as u64),
            Step::Case(name) => bar.set_message(name.to_owned()),
            Step::Within(_) => {}
            Step::Done => bar.inc(1),
        },
    )?;
    bar.finish_and_clear();
    print!("{}", scored.markdown);
    Ok(Outcome::of(scored.is_passed))
}

/// What is to be scored and how.
#[derive(Debug, Clone, Copy)]
pub struct Scoring<'a> {
    /// Directory with `ANSWERS.json` and one directory per case.
    pub cases: &'a Path,
    /// Directory for findings, `score.json` and `score.md`; findings that are there already are not made again.
    pub out: &'a Path,
    /// Whether each case is diagnosed once more with the right effects taken out of the catalogue.
    pub leave_one_out: bool,
    /// Directory with effects that are tried in every case beside those of the catalogue.
    pub catalogue: Option<&'a Path>,
    /// Cases diagnosed at a time.
    pub jobs: usize,
    /// The library to pack into the FMUs; without it the one beside the program.
    pub library: Option<&'a Path>,
}

/// What is going on; told from any thread that diagnoses.
#[derive(Debug, Clone, Copy)]
pub enum Step<'a> {
    /// So many diagnoses are to be made.
    Begun {
        /// How many.
        cases: usize,
    },
    /// A case is begun.
    Case(&'a str),
    /// What is being done within a case.
    Within(&'a str),
    /// A case is done.
    Done,
}

/// How well the findings fit the answers.
#[derive(Debug, Clone)]
pub struct Scored {
    /// A line for each group of cases.
    pub table: Vec<Line>,
    /// Cases that could not be diagnosed, with the reason.
    pub failed: Vec<String>,
    /// The whole as `score.md` has it.
    pub markdown: String,
    /// Whether every bar is reached and every case was diagnosed.
    pub is_passed: bool,
}

/// Diagnoses the cases and judges the findings; `tell` may unwind out of it, and findings that are finished are kept.
///
/// # Errors
/// There are no answers, or results cannot be written.
pub fn score(scoring: &Scoring<'_>, tell: &(dyn Fn(Step<'_>) + Sync)) -> anyhow::Result<Scored> {
    let supposed = match scoring.catalogue {
        Some(directory) => supposed::names(&supposed::files(directory)?)?,
        None => Vec::new(),
    };
    let mut answers = Answer::read_all(scoring.cases)?;
    for answer in answers.values_mut() {
        answer.suppose(&supposed);
    }
    let library = library::find(scoring.library)?;
    let mut tasks = Vec::new();
    for (case, answer) in &answers {
        tasks.push(task(case, answer, Vec::new(), scoring.out.join(case)));
        let names: Vec<String> = answer.names().into_iter().map(str::to_owned).collect();
        if scoring.leave_one_out && names.len() == 1 {
            tasks.push(task(
                case,
                answer,
                names,
                scoring.out.join("leave-one-out").join(case),
            ));
        }
    }
    tell(Step::Begun { cases: tasks.len() });
    let results = run_all(&tasks, scoring, &library, tell);
    let (mut judged, mut without, mut failed) = (Vec::new(), Vec::new(), Vec::new());
    for (task, result) in tasks.iter().zip(results) {
        match result {
            Some(Ok(judgement)) if task.without.is_empty() => judged.push(judgement),
            Some(Ok(judgement)) => without.push(judgement),
            Some(Err(error)) => failed.push(format!("{}: {error:#}", task.case)),
            None => failed.push(format!("{}: not run", task.case)),
        }
    }
    let table = lines(&judged, &without);
    let markdown = markdown(&table, &judged, &without, &failed);
    let mut json = serde_json::to_string_pretty(&Score {
        table: table.clone(),
        reliability: bins(&judged),
        failed: failed.clone(),
    })?;
    json.push('\n');
    atomic::write_file(&scoring.out.join("score.json"), json.as_bytes())?;
    atomic::write_file(&scoring.out.join("score.md"), markdown.as_bytes())?;
    let is_missed = table.iter().any(|line| line.reached == Some(false));
    Ok(Scored {
        is_passed: !is_missed && failed.is_empty(),
        table,
        failed,
        markdown,
    })
}

fn task(case: &str, answer: &Answer, without: Vec<String>, out: PathBuf) -> Task {
    Task {
        case: case.to_owned(),
        answer: answer.clone(),
        without,
        out,
    }
}

fn run_all(
    tasks: &[Task],
    scoring: &Scoring<'_>,
    library: &Library,
    tell: &(dyn Fn(Step<'_>) + Sync),
) -> Vec<Option<anyhow::Result<Judgement>>> {
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<Option<anyhow::Result<Judgement>>>> =
        Mutex::new(tasks.iter().map(|_| None).collect());
    std::thread::scope(|scope| {
        let work = || {
            scope.spawn(|| {
                loop {
                    let at = next.fetch_add(1, Ordering::Relaxed);
                    let Some(task) = tasks.get(at) else { return };
                    tell(Step::Case(&task.case));
                    let result = diagnosed(task, scoring, library, tell)
                        .map(|finding| judge(&task.answer, &finding));
                    results
                        .lock()
                        .unwrap_or_else(std::sync::PoisonError::into_inner)[at] = Some(result);
                    tell(Step::Done);
                }
            })
        };
        let threads: Vec<_> = (0..scoring.jobs.max(1)).map(|_| work()).collect();
        for thread in threads {
            // Joined by hand, so that what a thread unwinds with arrives as it is.
            if let Err(reason) = thread.join() {
                std::panic::resume_unwind(reason);
            }
        }
    });
    results
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// The finding of an earlier run, or a new one.
fn diagnosed(
    task: &Task,
    scoring: &Scoring<'_>,
    library: &Library,
    tell: &(dyn Fn(Step<'_>) + Sync),
) -> anyhow::Result<Finding> {
    if task.out.join(FILE).is_file() {
        let finding = Finding::read(&task.out)?;
        if finding.without == task.without {
            return Ok(finding);
        }
    }
    let begun = Instant::now();
    let arguments = CaseArguments {
        case: Some(scoring.cases.join(&task.case)),
        catalogue: scoring.catalogue.map(Path::to_owned),
        without: task.without.clone(),
        ..CaseArguments::default()
    };
    let material = arguments.material()?;
    if material.is_of_small_plant() {
        small_plant::run(&material, Stage::All, &task.out, None, &mut |what| {
            tell(Step::Within(what));
        })?;
        return Ok(Finding::read(&task.out)?);
    }
    let case = material.load()?;
    let (mut finding, _) = naming::name(&case, &mut |what| tell(Step::Within(what)))?;
    // Where the right effect is taken out only the verdict counts.
    if task.without.is_empty() {
        let text = amend::text(&case, &finding, &amend::amended_model(&case, &finding)?)?;
        finding.gap = Some(
            compared(&case, &finding, &text, library)
                .context("held-out record")?
                .gap,
        );
    }
    finding.seconds = begun.elapsed().as_secs_f64();
    finding.write(&task.out)?;
    Ok(finding)
}

fn markdown(
    table: &[Line],
    judged: &[Judgement],
    without: &[Judgement],
    failed: &[String],
) -> String {
    let mut text = format!(
        "# Score\n\n{}\n## Probabilities\n\n{}\n## What was said\n\n{}",
        to_markdown(table),
        reliability::to_markdown(&bins(judged)),
        confusion(judged)
    );
    if !without.is_empty() {
        text.push_str(&format!(
            "\n## With the right effect taken out of the catalogue\n\n{}",
            confusion(without)
        ));
    }
    if !failed.is_empty() {
        text.push_str(&format!(
            "\n## Not diagnosed\n\n- {}\n",
            failed.join("\n- ")
        ));
    }
    text
}
