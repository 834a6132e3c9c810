//! SUNDIALS CVODE: `cvode/rig_cvode.c`, compiled here and run as a child process.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::effort::Effort;
use crate::files;
use crate::measurement::{Apart, Run};
use crate::systems::{END_TIME, OUTPUT_STEP, System};

/// Name in tables.
pub const NAME: &str = "CVODE";

/// The configuration that converges furthest: BDF stops at order five, and weights that grow with the
/// angles loosen the tolerance along the run.
pub const MOST_PRECISE: &str = "Adams, absolute weights";

/// Compiles the program with the machine's own instruction set.
///
/// # Errors
/// When there is no C compiler or no SUNDIALS; the message says how to get them.
pub fn build() -> Result<PathBuf> {
    let program = files::build_folder()?.join("rig_cvode");
    let status = Command::new("cc")
        .args(["-O3", "-march=native", "-o"])
        .arg(&program)
        .arg(files::crate_folder().join("cvode/rig_cvode.c"))
        .args([
            "-lsundials_cvode",
            "-lsundials_nvecserial",
            "-lsundials_sunmatrixdense",
        ])
        .args(["-lsundials_sunlinsoldense", "-lm"])
        .status()
        .context(
            "starting the C compiler `cc`: install it and SUNDIALS with tools/benchmarks/setup.sh",
        )?;
    if !status.success() {
        bail!(
            "cvode/rig_cvode.c does not compile ({status}): install SUNDIALS 6 with tools/benchmarks/setup.sh"
        );
    }
    Ok(program)
}

/// Sweeps tolerances with BDF and Adams, each with two kinds of error weights, on one system.
///
/// # Errors
/// When the program fails or its table cannot be read.
pub fn sweep(program: &PathBuf, system: &System, effort: Effort) -> Result<Vec<Run>> {
    let mut command = Command::new(program);
    for (name, value) in system.parameters() {
        command.arg(format!("{name}={value:?}"));
    }
    command
        .arg(format!("end={END_TIME}"))
        .arg(format!("output_step={OUTPUT_STEP}"));
    command.arg(format!("repeat={}", effort.repetitions()));
    for method in ["bdf", "adams"] {
        for weights in ["plain", "absolute"] {
            for tolerance in effort.tolerances(1e-4, 5e-14) {
                command.arg(format!(
                    "run={method}:{weights}:{tolerance:e}:{tolerance:e}"
                ));
            }
        }
    }
    let output = command
        .stderr(Stdio::piped())
        .output()
        .with_context(|| format!("running {}", program.display()))?;
    if !output.status.success() {
        bail!(
            "rig_cvode failed on system {}: {}",
            system.key,
            String::from_utf8_lossy(&output.stderr)
        );
    }
    for line in String::from_utf8_lossy(&output.stderr)
        .lines()
        .filter(|l| l.starts_with("rig_cvode"))
    {
        eprintln!("system {}: {line}", system.key);
    }
    String::from_utf8(output.stdout)?
        .lines()
        .skip(1)
        .map(|line| parse(system, line))
        .collect()
}

fn parse(system: &System, line: &str) -> Result<Run> {
    let fields: Vec<&str> = line.split(',').collect();
    let [
        method,
        weights,
        tolerance,
        _,
        seconds,
        theta,
        _,
        _,
        _,
        _,
        _,
        _,
        switches,
        steps,
        ..,
    ] = fields[..]
    else {
        bail!("rig_cvode wrote `{line}`, which is not a row of its table");
    };
    Ok(Run {
        system: system.key.into(),
        solver: NAME.into(),
        configuration: format!(
            "{}, {weights} weights",
            if method == "bdf" { "BDF" } else { "Adams" }
        ),
        tolerance: tolerance.parse()?,
        seconds: seconds.parse()?,
        theta: theta.parse()?,
        error: f64::NAN,
        switches: switches.parse()?,
        steps: steps.parse()?,
        apart: Apart::default(),
    })
}
