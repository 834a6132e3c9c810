//! Programs killed at random times: every file that they leave is whole, old or new, and what can be continued goes on.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};

use crate::component::REDUCED_RIG;
use crate::program::{self, Files, files};
use crate::random::Random;

/// A program and what it works on.
struct Job {
    name: &'static str,
    /// The line of its command; `{out}` stands for the directory into which it writes.
    line: String,
    /// The line of a command that writes what this one has written halfway, if it replaces that later.
    halfway: Option<String>,
    /// Whether a run goes on where the one before was killed.
    resumes: bool,
    /// Share of all kills.
    share: f64,
}

/// Where the jobs work and what they read.
struct Ground {
    place: PathBuf,
    case: PathBuf,
    document: PathBuf,
}

/// Effects that the killed diagnosis chooses among: with all of them it would take minutes.
const CANDIDATES: [&str; 2] = ["unbalance", "normal_force_wobble"];

/// The document into which experiments are written.
const DOCUMENT: &str = "reproduction.md";

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
    fs::write(place.path().join("reduced-rig.toml"), REDUCED_RIG)?;
    fs::write(place.path().join("target.toml"), TARGET)?;
    let ground = Ground {
        place: place.path().to_owned(),
        case: source_tree.join("crates/workbench/tests/data/unbalance"),
        document: source_tree.join("docs").join(DOCUMENT),
    };
    let mut random = Random::new(seed);
    let mut lines = Vec::new();
    let mut jobs = jobs()?;
    jobs.retain(|job| with_diagnose || job.name != "diagnose");
    let shares: f64 = jobs.iter().map(|job| job.share).sum();
    for job in &jobs {
        let count = (job.share / shares * kills as f64).round() as usize;
        lines.push(killed(job, &ground, count.max(1), &mut random)?);
    }
    Ok(lines.join("; "))
}

fn jobs() -> Result<Vec<Job>> {
    let without: String = all_effects()?
        .iter()
        .filter(|name| !CANDIDATES.contains(&name.as_str()))
        .map(|name| format!(" --without {name}"))
        .collect();
    let job = |name, line: &str, resumes, share| Job {
        name,
        line: line.to_owned(),
        halfway: None,
        resumes,
        share,
    };
    let map = "stickslip map --speed-rpm 20:80:40 --normal-force 0:70:40 --out {out} {model}";
    let calibrate = "stickslip calibrate --model {model} --target {target} --out {out}";
    let experiment =
        "stickslip experiment run fig-3.5 --out {out} --document {out}/reproduction.md";
    let diagnose = format!("stickslip diagnose {{case}} --out {{out}}{without}");
    Ok(vec![
        job("build-fmu", "build-fmu {model} --out {out}", false, 0.3),
        job("map", map, true, 0.25),
        job("calibrate", calibrate, true, 0.1),
        job("experiment", experiment, false, 0.2),
        Job {
            // The finding is written when something is named, and again with before and after.
            halfway: Some(diagnose.replace(" diagnose ", " name ")),
            ..job("diagnose", &diagnose, false, 0.15)
        },
    ])
}

impl Ground {
    /// The command of a line that writes into `out`.
    fn command(&self, line: &str, out: &Path) -> Result<Command> {
        if line.contains(DOCUMENT) && !out.join(DOCUMENT).exists() {
            fs::create_dir_all(out)?;
            fs::copy(&self.document, out.join(DOCUMENT))?;
        }
        let paths = [
            ("out", out),
            ("model", &self.place.join("reduced-rig.toml")),
            ("target", &self.place.join("target.toml")),
            ("case", &self.case),
        ];
        let mut command = program::command(line, &paths)?;
        command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        Ok(command)
    }

    /// Runs the command of a line to its end.
    fn run(&self, line: &str, out: &Path) -> Result<()> {
        let status = self.command(line, out)?.status()?;
        ensure!(
            matches!(status.code(), Some(0 | 1)),
            "`{line}` fails: {status}"
        );
        Ok(())
    }
}

/// Names of all effects on rigs, which stand before those on small plants, from the program that knows them.
fn all_effects() -> Result<Vec<String>> {
    let output = program::command("stickslip effects", &[])?.output()?;
    let names = String::from_utf8(output.stdout)?
        .lines()
        .take_while(|line| !line.is_empty())
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

fn killed(job: &Job, ground: &Ground, count: usize, random: &mut Random) -> Result<String> {
    let place = |what: &str| ground.place.join(format!("{}-{what}", job.name));
    let whole = place("whole");
    let begin = Instant::now();
    ground.run(&job.line, &whole)?;
    let duration = begin.elapsed();
    let new = files(&whole, false)?;
    let mut between = Files::new();
    if let Some(line) = &job.halfway {
        let part = place("halfway");
        ground.run(line, &part)?;
        between = files(&part, false)?;
    }
    // The document of experiments is no result: rows are put into the one that is there.
    let old: Files = new
        .keys()
        .filter(|name| !is_document(name))
        .map(|name| (name.clone(), b"an older result".to_vec()))
        .collect();
    let out = place("killed");
    let mut midway = 0;
    for kill in 0..count {
        if !job.resumes {
            let _ = fs::remove_dir_all(&out);
            if kill % 2 == 1 {
                put(&old, &out)?;
            }
        }
        let mut child = ground.command(&job.line, &out)?.spawn()?;
        thread::sleep(Duration::from_secs_f64(
            1.05 * random.uniform() * duration.as_secs_f64(),
        ));
        if child.try_wait()?.is_none() {
            midway += 1;
        }
        let _ = child.kill();
        child.wait()?;
        let mut complete = true;
        for (name, found) in files(&out, false)? {
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
        if job.resumes && complete && files(&out, false)?.len() == new.len() {
            fs::remove_dir_all(&out)?;
        }
    }
    ground.run(&job.line, &out)?;
    for (name, content) in &new {
        ensure!(
            files(&out, false)?.get(name) == Some(content),
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
    name.ends_with(DOCUMENT)
}

fn put(files: &Files, directory: &Path) -> Result<()> {
    for (name, content) in files {
        let path = directory.join(name);
        fs::create_dir_all(path.parent().context("no folder")?)?;
        fs::write(path, content)?;
    }
    Ok(())
}
