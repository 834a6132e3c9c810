//! `stickslip experiment list | run ID | all`.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::Context;
use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};

use super::document::{is_generated, with_block};
use super::{Experiment, Findings, Verdict, all};
use crate::files::atomic::write_file;
use crate::outcome::Outcome;

/// Arguments of `experiment`.
#[derive(Debug, Args)]
pub struct ExperimentArguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List the experiments.
    List,
    /// Run one experiment.
    Run {
        /// Its id, as `list` gives it.
        id: String,
        #[command(flatten)]
        places: Places,
    },
    /// Run all experiments.
    All {
        #[command(flatten)]
        places: Places,
    },
}

#[derive(Debug, Args)]
struct Places {
    /// Directory for CSV files and pictures.
    #[arg(long, default_value = "experiments")]
    out: PathBuf,
    /// The document whose rows are replaced; its pictures go into `pictures` beside it.
    #[arg(long, default_value = "docs/reproduction.md")]
    document: PathBuf,
}

/// Runs the subcommand.
///
/// # Errors
/// An unknown id, a run that stops, a file that cannot be written.
pub fn run(arguments: &ExperimentArguments) -> anyhow::Result<Outcome> {
    let experiments = all();
    match &arguments.action {
        Action::List => {
            for experiment in &experiments {
                println!("{:<24} {}", experiment.id, experiment.title);
            }
            Ok(Outcome::Done)
        }
        Action::Run { id, places } => {
            let known = || {
                let ids: Vec<&str> = experiments.iter().map(|entry| entry.id).collect();
                format!(
                    "there is no experiment `{id}`; known are {}",
                    ids.join(", ")
                )
            };
            let chosen = experiments
                .iter()
                .find(|entry| entry.id == id)
                .with_context(known)?;
            run_all(std::slice::from_ref(chosen), places)
        }
        Action::All { places } => run_all(&experiments, places),
    }
}

fn run_all(chosen: &[Experiment], places: &Places) -> anyhow::Result<Outcome> {
    read_document(&places.document)?;
    let bar = ProgressBar::new(chosen.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{elapsed} {bar:30} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    let next = AtomicUsize::new(0);
    let failures = Mutex::new(Vec::new());
    let document = Mutex::new(());
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..workers.min(chosen.len()) {
            scope.spawn(|| {
                while let Some(experiment) = chosen.get(next.fetch_add(1, Ordering::Relaxed)) {
                    bar.set_message(experiment.id);
                    let result =
                        (experiment.run)()
                            .map_err(anyhow::Error::from)
                            .and_then(|findings| {
                                let _guard =
                                    document.lock().unwrap_or_else(|poison| poison.into_inner());
                                bar.suspend(|| print_rows(experiment, &findings));
                                store(experiment, &findings, places)
                            });
                    if let Err(error) = result {
                        failures
                            .lock()
                            .unwrap_or_else(|poison| poison.into_inner())
                            .push(format!("{}: {error:#}", experiment.id));
                    }
                    bar.inc(1);
                }
            });
        }
    });
    bar.finish_and_clear();
    let failures = failures
        .into_inner()
        .unwrap_or_else(|poison| poison.into_inner());
    if failures.is_empty() {
        Ok(Outcome::Done)
    } else {
        anyhow::bail!("{}", failures.join("\n"))
    }
}

fn print_rows(experiment: &Experiment, findings: &Findings) {
    println!("{} {}", experiment.id, experiment.title);
    for row in &findings.rows {
        let published = if row.verdict == Verdict::Added {
            String::new()
        } else {
            format!(" (published {})", row.published)
        };
        println!(
            "    {}: {}{published}: {}",
            row.quantity,
            row.ours,
            row.verdict.text()
        );
    }
}

/// Writes tables, pictures and the block of the document.
fn store(experiment: &Experiment, findings: &Findings, places: &Places) -> anyhow::Result<()> {
    let directory = places.out.join(experiment.id);
    for table in &findings.tables {
        write_file(
            &directory.join(format!("{}.csv", table.name)),
            table.to_csv().as_bytes(),
        )?;
    }
    for picture in &findings.pictures {
        picture.figure.write(&directory.join(&picture.name))?;
        if picture.shown {
            let beside = places.document.parent().unwrap_or(Path::new(""));
            let file = beside
                .join("pictures")
                .join(format!("{}.svg", picture.name));
            write_file(&file, picture.figure.to_svg().as_bytes())?;
        }
    }
    let rows = serde_json::to_string_pretty(&findings.rows)?;
    write_file(&directory.join("rows.json"), rows.as_bytes())?;
    let text = read_document(&places.document)?;
    let text = with_block(&text, &all(), experiment, findings);
    write_file(&places.document, text.as_bytes())?;
    Ok(())
}

/// The document as it stands; empty where there is none yet.
fn read_document(path: &Path) -> anyhow::Result<String> {
    match std::fs::read_to_string(path) {
        Ok(text) if text.is_empty() || is_generated(&text) => Ok(text),
        Ok(_) => anyhow::bail!(
            "{} is not a document of these experiments and would be lost; name another file with --document",
            path.display()
        ),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(String::new()),
        Err(error) => Err(error).with_context(|| format!("cannot read {}", path.display())),
    }
}
