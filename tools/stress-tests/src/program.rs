//! A program of the project, run as a user runs it, with what it cost.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result, bail};

/// The program `name` beside the running one, or one folder up for a test.
///
/// # Errors
/// It is in neither place.
pub fn find(name: &str) -> Result<PathBuf> {
    beside(&format!("{name}{}", std::env::consts::EXE_SUFFIX))
}

/// A file beside the running program, or one folder up for a test.
pub(crate) fn beside(file: &str) -> Result<PathBuf> {
    let program = std::env::current_exe().context("cannot tell where this program is")?;
    for folder in program.ancestors().skip(1).take(2) {
        let path = folder.join(file);
        if path.is_file() {
            return Ok(path);
        }
    }
    bail!(
        "{file} is not beside {}; build it with `cargo build -p stickslip -p build-fmu -p workbench` in the same profile",
        program.display()
    )
}

/// The command of a line of a program's name and its arguments, in which `{name}` stands for a path.
///
/// # Errors
/// There is no such program.
pub fn command(line: &str, paths: &[(&str, &Path)]) -> Result<Command> {
    let mut words = line.split(' ');
    let mut command = Command::new(find(words.next().unwrap_or_default())?);
    command.args(words.map(|word| {
        paths.iter().fold(word.to_owned(), |word, (name, path)| {
            word.replace(&format!("{{{name}}}"), &path.to_string_lossy())
        })
    }));
    Ok(command)
}

/// Files by their names below a directory, without how long a diagnosis took.
pub type Files = BTreeMap<PathBuf, Vec<u8>>;

/// All files below a directory, or none where there is no such directory; `hidden` ones, which a killed writer leaves beside
/// its target, if asked for.
///
/// # Errors
/// A file cannot be read.
pub fn files(directory: &Path, hidden: bool) -> Result<Files> {
    let mut found = Files::new();
    let mut waiting = vec![directory.to_owned()];
    while let Some(folder) = waiting.pop() {
        let Ok(entries) = fs::read_dir(&folder) else {
            continue;
        };
        for entry in entries {
            let entry = entry?;
            let path = entry.path();
            if !hidden && entry.file_name().to_string_lossy().starts_with('.') {
                continue;
            }
            if path.is_dir() {
                waiting.push(path);
            } else {
                let content = without_duration(&path, fs::read(&path)?);
                found.insert(path.strip_prefix(directory)?.to_owned(), content);
            }
        }
    }
    Ok(found)
}

/// The content of a file of results, but for how long a diagnosis took: `seconds` of a `finding.json`, the last sentence of
/// a `report.html`.
fn without_duration(path: &Path, content: Vec<u8>) -> Vec<u8> {
    let name = path.file_name().unwrap_or_default();
    if name == "finding.json" {
        let text = String::from_utf8_lossy(&content);
        let lines = text
            .lines()
            .filter(|line| !line.trim_start().starts_with("\"seconds\":"));
        return lines.collect::<Vec<_>>().join("\n").into_bytes();
    }
    if name == "report.html" {
        let text = String::from_utf8_lossy(&content);
        if let Some((before, after)) = text.split_once("Found in ")
            && let Some((_, after)) = after.split_once(" s.")
        {
            return [before, after].concat().into_bytes();
        }
    }
    content
}

/// How a program ended and what it took.
#[derive(Debug)]
pub struct Ended {
    /// Its exit status.
    pub status: ExitStatus,
    /// What it said on standard error.
    pub said: String,
    /// Processor time [s], as far as the last look before its end.
    pub seconds: f64,
    /// Largest resident memory [MiB], as far as the last look before its end.
    pub mebibytes: f64,
}

/// Runs a program to its end, looking at what it takes every few milliseconds.
///
/// # Errors
/// It cannot be started.
pub fn run(command: &mut Command) -> Result<Ended> {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start {command:?}"))?;
    let mut pipe = child.stderr.take().context("no standard error")?;
    let reader = thread::spawn(move || {
        let mut said = String::new();
        let _ = pipe.read_to_string(&mut said);
        said
    });
    let (mut seconds, mut mebibytes) = (0.0_f64, 0.0_f64);
    let status = loop {
        if let Some((time, memory)) = usage(&child) {
            (seconds, mebibytes) = (seconds.max(time), mebibytes.max(memory));
        }
        if let Some(status) = child.try_wait()? {
            break status;
        }
        thread::sleep(Duration::from_millis(2));
    };
    Ok(Ended {
        status,
        said: reader.join().unwrap_or_default(),
        seconds,
        mebibytes,
    })
}

/// Processor time [s] and largest resident memory [MiB] of a running process; Linux only.
fn usage(child: &Child) -> Option<(f64, f64)> {
    /// Ticks of the processor times in `/proc`, the same on all platforms of Linux that Rust runs on.
    const TICKS: f64 = 100.0;
    let folder = Path::new("/proc").join(child.id().to_string());
    let stat = fs::read_to_string(folder.join("stat")).ok()?;
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(11);
    let user: f64 = fields.next()?.parse().ok()?;
    let system: f64 = fields.next()?.parse().ok()?;
    let status = fs::read_to_string(folder.join("status")).ok()?;
    let peak = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let peak: f64 = peak.trim().strip_suffix(" kB")?.trim().parse().ok()?;
    Some(((user + system) / TICKS, peak / 1024.0))
}
