//! Peers in Python: a script in one of the environments that `setup.sh` makes, asked by JSON, answering in lines.

use std::io::Write as _;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use serde_json::{Value, json};

use crate::files;
use crate::systems::{END_TIME, OUTPUT_STEP, System};

/// The part of a request that every script understands: parameters, length of the run, time between outputs.
#[must_use]
pub fn request(system: &System, repeat: u32) -> Value {
    let parameters: serde_json::Map<_, _> = system
        .parameters()
        .into_iter()
        .map(|(name, value)| (name.to_owned(), json!(value)))
        .collect();
    json!({
        "parameters": parameters,
        "end": END_TIME,
        "output_step": OUTPUT_STEP,
        "repeat": repeat,
    })
}

/// Runs `python/SCRIPT` in the environment of this name; returns the lines of its answer, without its comments.
///
/// # Errors
/// When the environment is missing or the script fails on the system with this key.
pub fn ask(environment: &str, script: &str, key: &str, request: &Value) -> Result<Vec<String>> {
    let interpreter = files::build_folder()?.join(environment).join("bin/python");
    if !interpreter.exists() {
        bail!(
            "{} is missing: make it with tools/benchmarks/setup.sh, or leave the peer out with --solvers",
            interpreter.display()
        );
    }
    let mut child = Command::new(&interpreter)
        .arg(files::crate_folder().join("python").join(script))
        .env("NUMBA_CACHE_DIR", files::build_folder()?.join("numba"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("starting {}", interpreter.display()))?;
    child
        .stdin
        .take()
        .context("the Python process has no standard input")?
        .write_all(request.to_string().as_bytes())?;
    let output = child.wait_with_output()?;
    if !output.status.success() {
        bail!("{script} failed on system {key} ({})", output.status);
    }
    Ok(String::from_utf8(output.stdout)?
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(str::to_owned)
        .collect())
}
