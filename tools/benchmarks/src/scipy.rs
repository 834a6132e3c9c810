//! scipy's LSODA and Radau: `python/rig_scipy.py` in the environment that `setup.sh` makes.

use anyhow::{Result, bail};
use serde_json::json;

use crate::effort::Effort;
use crate::interpreter;
use crate::measurement::{Apart, Run};
use crate::systems::System;

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
    let mut request = interpreter::request(system, if effort == Effort::Quick { 1 } else { 2 });
    request["runs"] = jobs.into();
    interpreter::ask("python", "rig_scipy.py", system.key, &request)?
        .iter()
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
        apart: Apart::default(),
    })
}
