//! Programs killed at random times: every file that they leave is whole, old or new, and what can be continued goes on.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};

use crate::component::REDUCED_RIG;
use crate::program::find;
use crate::random::Random;

/// Files by their name below a directory.
type Files = BTreeMap<PathBuf, Vec<u8>>;

/// Makes the command that writes into the directory it is given.
type MakesCommand = dyn Fn(&Path) -> Result<Command>;

/// A program and what it works on.
struct Job {
    name: &'static str,
    /// Makes the command that writes into a directory.
    command: Box<MakesCommand>,
    /// A command that writes what this one has written halfway, if it replaces that later.
    halfway: Option<Box<MakesCommand>>,
    /// Whether a run goes on where the one before was killed.
    resumes: bool,
    /// Share of all kills.
    share: f64,
}

/// Effects that the killed diagnosis chooses among: with all of them it would take minutes.
const CANDIDATES: [&str; 2] = ["unbalance", "normal_force_wobble"];

/// A calibration of a second or two.
const TARGET: &str = "[search]
seed = 3
starts = 1
population = 8
generations = 10
smallest_loop_margin = 0.0
[[parameter]]
name = \"contact.mu_c\"
minimum = 0.05
maximum = 0.15
[[parameter]]
name = \"contact.mu_s\"
minimum = 0.16
maximum = 0.3
[[point]]
speed_rpm = 55.0
normal_force = 50.0
frequency_hz = { value = 0.73, bar = 0.05 }
";

/// Kills programs `kills` times in all, with whole old files in place, none, or what the run before left. The last,
/// `diagnose`, takes by far the longest.
///
/// # Errors
/// A file is neither the old nor the new one, or a run that goes on ends otherwise than one that was never killed.
pub fn kills(kills: usize, seed: u64, source_tree: &Path, with_diagnose: bool) -> Result<String> {
    let place = tempfile::tempdir()?;
    let mut random = Random::new(seed);
    let mut lines = Vec::new();
    let mut jobs = jobs(place.path(), source_tree)?;
    jobs.retain(|job| with_diagnose || job.name != "diagnose");
    let shares: f64 = jobs.iter().map(|job| job.share).sum();
    for job in &jobs {
        let count = (job.share / shares * kills as f64).round() as usize;
        lines.push(killed(job, place.path(), count.max(1), &mut random)?);
    }
    Ok(lines.join("; "))
}

fn jobs(place: &Path, source_tree: &Path) -> Result<Vec<Job>> {
    let model = place.join("reduced-rig.toml");
    fs::write(&model, REDUCED_RIG)?;
    let case = source_tree.join("crates/workbench/tests/data/unbalance");
    let document = source_tree.join("docs/reproduction.md");
    let (stickslip, build_fmu) = (find("stickslip")?, find("build-fmu")?);
    let command = move |program: &Path, arguments: &[&str]| {
        let mut command = Command::new(program);
        command.args(arguments);
        command
    };
    let target = place.join("target.toml");
    fs::write(&target, TARGET)?;
    let without = all_effects(&stickslip)?
        .into_iter()
        .filter(|name| !CANDIDATES.contains(&name.as_str()))
        .flat_map(|name| ["--without".to_owned(), name]);
    let without: Vec<String> = without.collect();
    let (map_model, map_program) = (model.clone(), stickslip.clone());
    let (calibrate_model, calibrate_program) = (model.clone(), stickslip.clone());
    let (name_case, name_without) = (case.clone(), without.clone());
    let (experiment_program, diagnose_program) = (stickslip.clone(), stickslip.clone());
    let name_program = stickslip;
    Ok(vec![
        Job {
            name: "build-fmu",
            command: Box::new(move |out| {
                let mut made = command(&build_fmu, &[]);
                made.arg(&model).arg("--out").arg(out);
                Ok(made)
            }),
            halfway: None,
            resumes: false,
            share: 0.3,
        },
        Job {
            name: "map",
            command: Box::new(move |out| {
                let spans = [
                    "map",
                    "--speed-rpm",
                    "20:80:40",
                    "--normal-force",
                    "0:70:40",
                ];
                let mut made = command(&map_program, &spans);
                made.arg("--out").arg(out).arg(&map_model);
                Ok(made)
            }),
            halfway: None,
            resumes: true,
            share: 0.25,
        },
        Job {
            name: "calibrate",
            command: Box::new(move |out| {
                let mut made = command(&calibrate_program, &["calibrate", "--model"]);
                made.arg(&calibrate_model).arg("--target").arg(&target);
                made.arg("--out").arg(out);
                Ok(made)
            }),
            halfway: None,
            resumes: true,
            share: 0.1,
        },
        Job {
            name: "experiment",
            command: Box::new(move |out| {
                fs::create_dir_all(out)?;
                let copy = out.join("reproduction.md");
                if !copy.exists() {
                    fs::copy(&document, &copy)?;
                }
                let mut made = command(&experiment_program, &["experiment", "run", "fig-3.5"]);
                made.arg("--out").arg(out).arg("--document").arg(&copy);
                Ok(made)
            }),
            halfway: None,
            resumes: false,
            share: 0.2,
        },
        Job {
            name: "diagnose",
            command: Box::new(move |out| {
                let mut made = command(&diagnose_program, &["diagnose"]);
                made.arg(&case).arg("--out").arg(out).args(&without);
                Ok(made)
            }),
            // The finding is written when something is named, and again with before and after.
            halfway: Some(Box::new(move |out| {
                let mut made = command(&name_program, &["name"]);
                made.arg(&name_case)
                    .arg("--out")
                    .arg(out)
                    .args(&name_without);
                Ok(made)
            })),
            resumes: false,
            share: 0.15,
        },
    ])
}

/// Names of all effects, from the program that knows them.
fn all_effects(stickslip: &Path) -> Result<Vec<String>> {
    let output = Command::new(stickslip).arg("effects").output()?;
    let names = String::from_utf8(output.stdout)?
        .lines()
        .filter_map(|line| line.split_whitespace().next().map(str::to_owned))
        .collect::<Vec<_>>();
    ensure!(
        CANDIDATES
            .iter()
            .all(|name| names.iter().any(|found| found == name)),
        "`stickslip effects` does not list {CANDIDATES:?}"
    );
    Ok(names)
}

fn killed(job: &Job, place: &Path, count: usize, random: &mut Random) -> Result<String> {
    let whole = place.join(format!("{}-whole", job.name));
    let begin = Instant::now();
    let status = quiet((job.command)(&whole)?).status()?;
    ensure!(
        matches!(status.code(), Some(0 | 1)),
        "{} fails by itself: {status}",
        job.name
    );
    let duration = begin.elapsed();
    let new = files(&whole)?;
    let mut between = Files::new();
    if let Some(command) = &job.halfway {
        let part = place.join(format!("{}-halfway", job.name));
        quiet(command(&part)?).status()?;
        between = files(&part)?;
    }
    // The document of experiments is no result: rows are put into the one that is there.
    let old: Files = new
        .keys()
        .filter(|name| !is_document(name))
        .map(|name| (name.clone(), b"an older result".to_vec()))
        .collect();
    let out = place.join(format!("{}-killed", job.name));
    let mut midway = 0;
    for kill in 0..count {
        if !job.resumes {
            let _ = fs::remove_dir_all(&out);
            if kill % 2 == 1 {
                put(&old, &out)?;
            }
        }
        let mut child = quiet((job.command)(&out)?).spawn()?;
        thread::sleep(Duration::from_secs_f64(
            1.05 * random.uniform() * duration.as_secs_f64(),
        ));
        if child.try_wait()?.is_none() {
            midway += 1;
        }
        let _ = child.kill();
        child.wait()?;
        let mut complete = true;
        for (name, found) in files(&out)? {
            // A journal grows line by line; that its whole lines serve is seen when the run goes on.
            let journal = name
                .extension()
                .is_some_and(|extension| extension == "journal");
            if journal || is_document(&name) {
                complete &= !journal;
                continue;
            }
            let whole = [&new, &old, &between]
                .iter()
                .any(|files| files.get(&name) == Some(&found));
            if !whole {
                bail!(
                    "{}, kill {kill}: {} is neither old nor new ({} bytes)",
                    job.name,
                    name.display(),
                    found.len()
                );
            }
        }
        if job.resumes && complete && files(&out)?.len() == new.len() {
            fs::remove_dir_all(&out)?;
        }
    }
    let status = quiet((job.command)(&out)?).status()?;
    ensure!(
        matches!(status.code(), Some(0 | 1)),
        "{} fails after the kills: {status}",
        job.name
    );
    for (name, content) in &new {
        ensure!(
            files(&out)?.get(name) == Some(content),
            "{}: {} after kills is not that of an undisturbed run",
            job.name,
            name.display()
        );
    }
    Ok(format!(
        "{}: {count} kills, {midway} before its end of {:.1} s",
        job.name,
        duration.as_secs_f64()
    ))
}

fn is_document(name: &Path) -> bool {
    name.ends_with("reproduction.md")
}

fn quiet(mut command: Command) -> Command {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command
}

fn put(files: &Files, directory: &Path) -> Result<()> {
    for (name, content) in files {
        let path = directory.join(name);
        fs::create_dir_all(path.parent().context("no folder")?)?;
        fs::write(path, content)?;
    }
    Ok(())
}

/// All files below a directory but hidden ones: those are what a killed writer leaves beside its target.
fn files(directory: &Path) -> Result<Files> {
    let mut found = Files::new();
    let mut waiting = vec![directory.to_owned()];
    while let Some(folder) = waiting.pop() {
        let Ok(entries) = fs::read_dir(&folder) else {
            continue;
        };
        for entry in entries {
            let path = entry?.path();
            if path
                .file_name()
                .is_some_and(|name| name.to_string_lossy().starts_with('.'))
            {
                continue;
            }
            if path.is_dir() {
                waiting.push(path);
            } else {
                let content = crate::program::without_duration(&path, fs::read(&path)?);
                found.insert(path.strip_prefix(directory)?.to_owned(), content);
            }
        }
    }
    Ok(found)
}
