//! `stickslip score`: diagnoses cases whose answers are known, and says how often and how well it was right.
//!
//! The engine is given model and records alone; the answers are read for judging what it found.

pub mod answer;
pub mod judge;
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
use self::table::{Line, confusion, lines, to_markdown};
use super::amend;
use super::case::CaseArguments;
use super::command::compared;
use super::finding::{FILE, Finding};
use super::naming;
use crate::cli::Outcome;
use crate::files::atomic;

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
    /// Cases that could not be diagnosed, with the reason.
    failed: Vec<String>,
}

/// Runs the subcommand; the check fails where a bar is missed or a case cannot be diagnosed.
///
/// # Errors
/// There are no answers, or results cannot be written.
pub fn command(arguments: &ScoreArguments) -> anyhow::Result<Outcome> {
    let answers = Answer::read_all(&arguments.cases)?;
    let library = library::find(arguments.library.as_deref())?;
    let mut tasks = Vec::new();
    for (case, answer) in &answers {
        tasks.push(task(case, answer, Vec::new(), arguments.out.join(case)));
        let names: Vec<String> = answer.names().into_iter().map(str::to_owned).collect();
        if arguments.leave_one_out && names.len() == 1 {
            tasks.push(task(
                case,
                answer,
                names,
                arguments.out.join("leave-one-out").join(case),
            ));
        }
    }
    let results = run_all(&tasks, arguments, &library);
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
        failed: failed.clone(),
    })?;
    json.push('\n');
    atomic::write_file(&arguments.out.join("score.json"), json.as_bytes())?;
    atomic::write_file(&arguments.out.join("score.md"), markdown.as_bytes())?;
    print!("{markdown}");
    let missed = table.iter().any(|line| line.reached == Some(false));
    Ok(if missed || !failed.is_empty() {
        Outcome::CheckFailed
    } else {
        Outcome::Done
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
    arguments: &ScoreArguments,
    library: &Library,
) -> Vec<Option<anyhow::Result<Judgement>>> {
    let bar = ProgressBar::new(tasks.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} {msg} {eta}") {
        bar.set_style(style);
    }
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<Option<anyhow::Result<Judgement>>>> =
        Mutex::new(tasks.iter().map(|_| None).collect());
    std::thread::scope(|scope| {
        for _ in 0..arguments.jobs.max(1) {
            scope.spawn(|| {
                loop {
                    let at = next.fetch_add(1, Ordering::Relaxed);
                    let Some(task) = tasks.get(at) else { return };
                    bar.set_message(task.case.clone());
                    let result = diagnosed(task, &arguments.cases, library)
                        .map(|finding| judge(&task.answer, &finding));
                    results
                        .lock()
                        .unwrap_or_else(std::sync::PoisonError::into_inner)[at] = Some(result);
                    bar.inc(1);
                }
            });
        }
    });
    bar.finish_and_clear();
    results
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// The finding of an earlier run, or a new one.
fn diagnosed(task: &Task, cases: &Path, library: &Library) -> anyhow::Result<Finding> {
    if task.out.join(FILE).is_file() {
        let finding = Finding::read(&task.out)?;
        if finding.without == task.without {
            return Ok(finding);
        }
    }
    let begun = Instant::now();
    let arguments = CaseArguments {
        case: Some(cases.join(&task.case)),
        without: task.without.clone(),
        ..CaseArguments::default()
    };
    let case = arguments.load()?;
    let (mut finding, _) = naming::name(&case, &mut |_| {})?;
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
        "# Score\n\n{}\n## What was said\n\n{}",
        to_markdown(table),
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
