//! A run of an FMU in a process of its own: one that crashes or hangs takes nothing down, and several run at once.

use std::ffi::OsString;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::OnceLock;
use std::thread;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::pursuit::{Pursued, Pursuit, PursuitError, pursue};
use crate::component::Fmu;

/// Name of the hidden subcommand.
pub const COMMAND: &str = "fmu-worker";
/// Files of a run in its directory.
const JOB: &str = "job.json";
const ANSWER: &str = "answer.json";
const REACHED: &str = "reached";
const STDERR: &str = "stderr";
/// Time without any progress after which an FMU counts as hanging.
const SILENCE: Duration = Duration::from_secs(60);
/// How often a run is looked at, and how often it says how far it is.
const LOOK: Duration = Duration::from_millis(2);
const SAY: Duration = Duration::from_millis(200);
/// End of what an FMU wrote before it crashed that a message shows [bytes].
const SHOWN: usize = 300;

/// Command line that runs this program, where that is not the process' own executable.
static PROGRAM: OnceLock<Vec<OsString>> = OnceLock::new();

/// Says how this program is run from a process that is another's, such as an interpreter.
pub fn set_program(command: Vec<OsString>) {
    let _ = PROGRAM.set(command);
}

/// Why a run gave nothing.
#[derive(Debug, Error)]
pub enum WorkerError {
    /// The FMU or its run failed.
    #[error("{fmu}: {what}")]
    Failed {
        /// The FMU.
        fmu: String,
        /// What went wrong.
        what: String,
    },
    /// The process ended without an answer.
    #[error("{fmu}: crashed ({status}) after t = {time} s of {record}{output}")]
    Crashed {
        /// The FMU.
        fmu: String,
        /// How the process ended.
        status: ExitStatus,
        /// Time that it had reached [s].
        time: f64,
        /// The record.
        record: String,
        /// The end of what it wrote, with a colon before it; may be empty.
        output: String,
    },
    /// Nothing happened for long.
    #[error("{fmu}: hangs after t = {time} s of {record}: no step came to its end for {} s", SILENCE.as_secs())]
    Hangs {
        /// The FMU.
        fmu: String,
        /// Time that it had reached [s].
        time: f64,
        /// The record.
        record: String,
    },
    /// The process could not be begun, or its files not be written.
    #[error("the run of an FMU could not begin: {0}")]
    Begin(#[from] std::io::Error),
}

#[derive(Serialize, Deserialize)]
struct Job {
    fmu: PathBuf,
    pursued: Pursued,
}

#[derive(Serialize, Deserialize)]
enum Answer {
    Done(Vec<Pursuit>),
    Failed(String),
}

/// Runs the FMU after a record that messages call `record`.
///
/// # Errors
/// [`WorkerError`].
pub fn run(fmu: &Path, pursued: Pursued, record: &str) -> Result<Vec<Pursuit>, WorkerError> {
    let name = fmu.display().to_string();
    let directory = tempfile::tempdir()?;
    let begin = pursued.begin;
    let job = Job {
        fmu: fmu.to_owned(),
        pursued,
    };
    fs::write(directory.path().join(JOB), text(&job)?)?;
    let child = Running(begun(directory.path())?);
    let status = child.ended(directory.path());
    let reached = || reached(directory.path()).unwrap_or(begin);
    let Some(status) = status? else {
        return Err(WorkerError::Hangs {
            fmu: name,
            time: reached(),
            record: record.to_owned(),
        });
    };
    let answer = fs::read_to_string(directory.path().join(ANSWER)).ok();
    match answer.and_then(|text| serde_json::from_str(&text).ok()) {
        Some(Answer::Done(pursuit)) => Ok(pursuit),
        Some(Answer::Failed(what)) => Err(WorkerError::Failed {
            what: format!(
                "{}, in {record}",
                what.trim_start_matches(&format!("{name}: "))
            ),
            fmu: name,
        }),
        None => Err(WorkerError::Crashed {
            fmu: name,
            status,
            time: reached(),
            record: record.to_owned(),
            output: last_words(directory.path()),
        }),
    }
}

/// The process of a run: does what `directory` has as its job.
///
/// # Errors
/// The job cannot be read or the answer not be written.
pub fn work(directory: &Path) -> std::io::Result<()> {
    let job: Job = serde_json::from_str(&fs::read_to_string(directory.join(JOB))?)?;
    let mut said = Instant::now();
    let mut tell = |time: f64| {
        if said.elapsed() > SAY {
            said = Instant::now();
            // Who waits sees a run that says nothing as one that hangs, which is what it then is.
            let _ = fs::write(directory.join(REACHED), time.to_string());
        }
    };
    let pursuit = Fmu::open(&job.fmu)
        .map_err(PursuitError::from)
        .and_then(|mut component| pursue(&mut component, &job.pursued, &mut tell));
    let answer = match pursuit {
        Ok(pursuit) => Answer::Done(pursuit),
        Err(error) => Answer::Failed(error.to_string()),
    };
    let mut file = fs::File::create(directory.join(ANSWER))?;
    file.write_all(text(&answer)?.as_bytes())
}

fn text<T: Serialize>(value: &T) -> std::io::Result<String> {
    serde_json::to_string(value).map_err(std::io::Error::from)
}

fn begun(directory: &Path) -> std::io::Result<Child> {
    let own = match PROGRAM.get() {
        Some(command) => command.clone(),
        None => vec![std::env::current_exe()?.into_os_string()],
    };
    let mut words = own.into_iter();
    let mut command = Command::new(words.next().unwrap_or_default());
    command
        .args(words)
        .arg(COMMAND)
        .arg(directory)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(fs::File::create(directory.join(STDERR))?);
    command.spawn()
}

/// A process that does not outlive who waits for it.
struct Running(Child);

impl Running {
    /// How it ended; `None` where it made no progress for long.
    fn ended(mut self, directory: &Path) -> std::io::Result<Option<ExitStatus>> {
        let mut heard = (Instant::now(), None);
        loop {
            if let Some(status) = self.0.try_wait()? {
                return Ok(Some(status));
            }
            let now = reached(directory);
            if now != heard.1 {
                heard = (Instant::now(), now);
            }
            if heard.0.elapsed() > SILENCE {
                return Ok(None);
            }
            thread::sleep(LOOK);
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn reached(directory: &Path) -> Option<f64> {
    let text = fs::read_to_string(directory.join(REACHED)).ok()?;
    text.trim().parse().ok()
}

/// The end of what the process wrote.
fn last_words(directory: &Path) -> String {
    let written = fs::read(directory.join(STDERR)).unwrap_or_default();
    let from = written.len().saturating_sub(SHOWN);
    let end = String::from_utf8_lossy(&written[from..]);
    let end = end.trim();
    if end.is_empty() {
        String::new()
    } else {
        format!(": {end}")
    }
}
