//! `benchmarks bench`: every solver on every system.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};

#[cfg(feature = "diffsol")]
use crate::diffsol_rig;
use crate::effort::Effort;
use crate::files::write_atomically;
use crate::measurement::Run;
use crate::report::{Findings, Reference, csv, equal_error_tables, page, run_table};
use crate::systems::{self, System};
use crate::{cvode, heyoka, ours, plot, scipy};

/// Largest difference [rad] between independent converged solutions that still makes a reference.
const REFERENCE_AGREEMENT: f64 = 1e-9;

/// A solver that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Solver {
    /// Our own integrator.
    Stickslip,
    /// heyoka's Taylor integrators, compiled by LLVM at run time.
    Heyoka,
    /// SUNDIALS CVODE, compiled C.
    Cvode,
    /// The Rust crate diffsol.
    #[cfg(feature = "diffsol")]
    Diffsol,
    /// scipy's LSODA and Radau with functions compiled by numba.
    Scipy,
}

/// Options of `benchmarks bench`.
#[derive(Args, Debug)]
pub struct Options {
    /// Whole decades of tolerance and few repetitions.
    #[arg(long)]
    quick: bool,
    /// Solvers to run (default: all).
    #[arg(long, value_enum, value_delimiter = ',')]
    solvers: Vec<Solver>,
    /// Systems to run: a, b, c (default: all).
    #[arg(long, value_delimiter = ',', value_parser = ["a", "b", "c"])]
    systems: Vec<String>,
    /// Folder for benchmarks.md, work-precision.svg and work-precision.csv.
    #[arg(long, default_value = "docs")]
    out: PathBuf,
    /// End with exit code 1 when a speed bar is missed.
    #[arg(long)]
    check: bool,
}

/// Runs the benchmark; `false` when a bar was to be checked and is missed.
///
/// # Errors
/// When a solver is missing or fails, when converged solutions disagree, or a file cannot be written.
pub fn run(options: &Options) -> Result<bool> {
    let effort = if options.quick {
        Effort::Quick
    } else {
        Effort::Thorough
    };
    let wanted = |solver: &&Solver| options.solvers.is_empty() || options.solvers.contains(solver);
    let solvers: Vec<&Solver> = Solver::value_variants().iter().filter(wanted).collect();
    let systems: Vec<System> = systems::all()
        .into_iter()
        .filter(|s| options.systems.is_empty() || options.systems.iter().any(|key| key == s.key))
        .collect();
    let mut runs: Vec<Run> = Vec::new();
    let cvode = solvers.contains(&&Solver::Cvode);
    let program = cvode.then(cvode::build).transpose()?.unwrap_or_default();
    let bar = progress(solvers.len() * systems.len());
    for system in &systems {
        for solver in &solvers {
            bar.set_message(format!("system {}: {solver:?}", system.key));
            runs.extend(match solver {
                Solver::Stickslip => ours::sweep(system, effort)?,
                Solver::Heyoka => heyoka::sweep(system, effort)?,
                Solver::Cvode => cvode::sweep(&program, system, effort)?,
                #[cfg(feature = "diffsol")]
                Solver::Diffsol => diffsol_rig::sweep(system, effort)?,
                Solver::Scipy => scipy::sweep(system, effort)?,
            });
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    let references = systems
        .iter()
        .map(|s| reference(s, &runs))
        .collect::<Result<Vec<_>>>()?;
    for (system, reference) in systems.iter().zip(&references) {
        for run in runs.iter_mut().filter(|r| r.system == system.key) {
            run.error = (run.theta - reference.theta).abs();
        }
    }
    let setting = setting(&runs);
    let findings = Findings {
        systems,
        references,
        runs,
        setting,
    };
    println!("{}", run_table(&findings));
    println!("{}", equal_error_tables(&findings, ours::NAME));
    for (file, text) in [
        ("work-precision.csv", csv(&findings)),
        ("work-precision.svg", plot::svg(&findings)),
        ("benchmarks.md", page(&findings, ours::NAME)),
    ] {
        write_atomically(&options.out.join(file), &text)?;
    }
    let met = bars_met(&findings);
    Ok(met || !options.check)
}

/// The run of a solver's most precise configuration at its smallest tolerance.
fn tightest<'a>(
    runs: &'a [Run],
    system: &System,
    solver: &str,
    configuration: Option<&str>,
) -> Option<&'a Run> {
    runs.iter()
        .filter(|r| r.system == system.key && r.solver == solver)
        .filter(|r| configuration.is_none_or(|name| r.configuration == name))
        .min_by(|a, b| a.tolerance.total_cmp(&b.tolerance))
}

/// The mean of the converged solutions that took part, once they agree.
fn reference(system: &System, runs: &[Run]) -> Result<Reference> {
    let mut sources: Vec<(String, f64)> = Vec::new();
    for (solver, configuration) in [
        (cvode::NAME, Some(cvode::MOST_PRECISE)),
        (ours::NAME, Some(ours::MOST_PRECISE)),
        (heyoka::NAME, Some(heyoka::MOST_PRECISE)),
    ] {
        if let Some(run) = tightest(runs, system, solver, configuration) {
            sources.push((format!("{solver} at {:.0e}", run.tolerance), run.theta));
        }
    }
    let first = sources
        .first()
        .with_context(|| {
            format!(
                "system {}: a reference needs CVODE, {} or {} among --solvers",
                system.key,
                ours::NAME,
                heyoka::NAME
            )
        })?
        .clone();
    let theta = sources.iter().map(|s| s.1).sum::<f64>() / sources.len() as f64;
    let published = system
        .published_theta
        .map(|theta| ("published".to_owned(), theta));
    let mut provenance = format!("{} gives {:.11}", first.0, first.1);
    for (name, other) in sources.iter().skip(1).chain(&published) {
        let difference = other - first.1;
        anyhow::ensure!(
            difference.abs() <= REFERENCE_AGREEMENT,
            "system {}: {name} ends at θ2 = {other:.12} rad, {} at {:.12}: {difference:.1e} apart, more than {REFERENCE_AGREEMENT:e}",
            system.key,
            first.0,
            first.1
        );
        provenance.push_str(&format!(", {name} {other:.11} ({difference:+.1e})"));
    }
    Ok(Reference { theta, provenance })
}

fn progress(sweeps: usize) -> ProgressBar {
    let bar = ProgressBar::new(sweeps as u64);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} {elapsed} {msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(250));
    bar
}

/// Prints each system's ratios at 1e-6 rad: to heyoka, and to CVODE against its bar.
fn bars_met(findings: &Findings) -> bool {
    let mut met = true;
    for system in &findings.systems {
        if let Some(ratio) = findings.ratio(system.key, heyoka::NAME, ours::NAME, 1e-6) {
            println!(
                "({}) heyoka / {} at 1e-6 rad: {ratio:.2}",
                system.key,
                ours::NAME
            );
        }
        let Some(ratio) = findings.ratio(system.key, cvode::NAME, ours::NAME, 1e-6) else {
            continue;
        };
        let verdict = if ratio >= system.bar { "met" } else { "MISSED" };
        println!(
            "({}) CVODE / {} at 1e-6 rad: {ratio:.1} (bar {}: {verdict})",
            system.key,
            ours::NAME,
            system.bar
        );
        met &= ratio >= system.bar;
    }
    met
}

/// Lines on the machine for the page.
fn setting(runs: &[Run]) -> Vec<String> {
    let processor = std::fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            text.lines().find_map(|l| {
                l.strip_prefix("model name")?
                    .split(':')
                    .nth(1)
                    .map(|s| s.trim().to_owned())
            })
        })
        .unwrap_or_else(|| "unknown".into());
    let python = include_str!("../python/requirements.txt")
        .lines()
        .collect::<Vec<_>>()
        .join(", ");
    vec![
        format!("Processor: {processor}; one thread; processor time, not wall time, so that other load hardly counts."),
        heyoka::apart(runs),
        "CVODE: the distribution's SUNDIALS (6.4.1 in Debian 12), C compiled with -O3 -march=native, BDF and Adams with \
         Newton, dense solver and analytic Jacobian, root finding, output by CV_NORMAL."
            .into(),
        "diffsol 0.18.0 with nalgebra: BDF, TR-BDF2, ESDIRK34, Tsit45, root finding, analytic Jacobian products.".into(),
        format!("scipy: solve_ivp with terminal events, functions compiled by numba ({python})."),
    ]
}
