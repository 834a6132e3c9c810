//! heyoka's adaptive Taylor integrators: `python/rig_heyoka.py` in the environment that `setup.sh` makes.

use anyhow::{Result, bail};
use serde_json::json;

use crate::effort::Effort;
use crate::interpreter;
use crate::measurement::{Apart, Run};
use crate::systems::System;

/// Name in tables.
pub const NAME: &str = "heyoka";

/// The set-up whose arithmetic the compiler does not reorder.
pub const MOST_PRECISE: &str = "non-compact";

/// Set-ups that the script knows and that are tried.
const SET_UPS: [&str; 4] = [
    MOST_PRECISE,
    "compact",
    "non-compact, fast math",
    "non-compact, fast math, SLP",
];

/// Sweeps tolerances with every set-up.
///
/// # Errors
/// When the environment is missing or the program fails.
pub fn sweep(system: &System, effort: Effort) -> Result<Vec<Run>> {
    // A run takes two milliseconds, as ours: as many repetitions.
    let mut request = interpreter::request(system, 10 * effort.repetitions());
    request["set_ups"] = json!(SET_UPS);
    request["tolerances"] = json!(effort.tolerances(1e-4, 1e-14));
    interpreter::ask("heyoka", "rig_heyoka.py", system.key, &request)?
        .iter()
        .map(|line| parse(system, line))
        .collect()
}

fn parse(system: &System, line: &str) -> Result<Run> {
    let fields: Vec<&str> = line.split(';').collect();
    let [
        set_up,
        tolerance,
        seconds,
        driver,
        compiling,
        theta,
        switches,
        steps,
    ] = fields[..]
    else {
        bail!("rig_heyoka.py wrote `{line}`, which is not a row of its table");
    };
    let apart = Apart {
        driver: driver.parse()?,
        compiling: compiling.parse()?,
    };
    Ok(Run {
        system: system.key.into(),
        solver: NAME.into(),
        configuration: set_up.into(),
        tolerance: tolerance.parse()?,
        seconds: seconds.parse::<f64>()? - apart.driver,
        theta: theta.parse()?,
        error: f64::NAN,
        switches: switches.parse()?,
        steps: steps.parse()?,
        apart,
    })
}

/// What the page says of the times that are not counted, from the runs.
#[must_use]
pub fn apart(runs: &[Run]) -> String {
    let range = |of: fn(&Run) -> f64| {
        runs.iter()
            .filter(|run| run.solver == NAME)
            .map(of)
            .fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
                (low.min(value), high.max(value))
            })
    };
    let (driver, compiling) = (
        range(|run| run.apart.driver),
        range(|run| run.apart.compiling),
    );
    format!(
        "heyoka: one adaptive Taylor integrator a mode, numbers compiled in, made once; exact terminal events; outputs by propagate_grid; \
         non-compact, compact, with fast math and with SLP vectorisation ({}). Not counted: compiling, up to {:.2} s of processor time \
         for the modes of one run, and the Python loop around the modes, which in (b) solves the algebraic loop at each switch, {:.2} to {:.2} ms a run, measured by playing the run's calls \
         without integration.",
        include_str!("../python/heyoka-requirements.txt")
            .lines()
            .collect::<Vec<_>>()
            .join(", "),
        compiling.1,
        driver.0 * 1e3,
        driver.1 * 1e3
    )
}
