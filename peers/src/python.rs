//! scipy's LSODA and Radau: `python/rig_scipy.py` in the environment that `setup.sh` makes.

use std::io::Write as _;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use serde_json::json;

use crate::effort::Effort;
use crate::files;
use crate::measurement::Run;
use crate::systems::{END_TIME, OUTPUT_STEP, System};

/// Tightest tolerance per method: Radau, of order five, takes minutes below its own.
const METHODS: [(&str, &str, f64); 3] = [
    ("LSODA", "plain", 1e-12),
    ("LSODA", "absolute", 1e-12),
    ("Radau", "plain", 1e-9),
];

/// Sweeps tolerances with LSODA and Radau. Each is its own solver in the tables.
///
/// # Errors
/// When the environment is missing or the program fails.
pub fn sweep(system: &System, effort: Effort) -> Result<Vec<Run>> {
    let interpreter = files::build_folder()?.join("python/bin/python");
    if !interpreter.exists() {
        bail!(
            "{} is missing: make it with peers/setup.sh, or leave scipy out with --solvers",
            interpreter.display()
        );
    }
    let jobs: Vec<_> = METHODS
        .iter()
        .flat_map(|&(method, weights, tightest)| {
            let step = if effort == Effort::Quick { 2 } else { 1 };
            let decades = (4..=12)
                .step_by(step)
                .map(|k| 10f64.powi(-k))
                .filter(move |t| *t >= tightest * 0.999);
            decades.map(move |tolerance| json!([method, weights, tolerance]))
        })
        .collect();
    let parameters: serde_json::Map<_, _> = system
        .parameters()
        .into_iter()
        .map(|(name, value)| (name.to_owned(), json!(value)))
        .collect();
    let request = json!({
        "parameters": parameters,
        "end": END_TIME,
        "output_step": OUTPUT_STEP,
        "repeat": if effort == Effort::Quick { 1 } else { 2 },
        "runs": jobs,
    });
    let mut child = Command::new(&interpreter)
        .arg(files::crate_folder().join("python/rig_scipy.py"))
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
        bail!(
            "rig_scipy.py failed on system {} ({})",
            system.key,
            output.status
        );
    }
    String::from_utf8(output.stdout)?
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| parse(system, line))
        .collect()
}

fn parse(system: &System, line: &str) -> Result<Run> {
    let fields: Vec<&str> = line.split(',').collect();
    let [method, weights, tolerance, seconds, theta, switches] = fields[..] else {
        bail!("rig_scipy.py wrote `{line}`, which is not a row of its table");
    };
    Ok(Run {
        system: system.key.into(),
        solver: format!("scipy {method}"),
        configuration: format!("{weights} weights"),
        tolerance: tolerance.parse()?,
        seconds: seconds.parse()?,
        theta: theta.parse()?,
        error: f64::NAN,
        switches: switches.parse()?,
        steps: 0,
    })
}
