//! The tables: on the console, as CSV, and as the Markdown page `docs/benchmarks.md`.

use std::fmt::Write as _;

use crate::measurement::{Run, distinct, time_at_error};
use crate::systems::System;

/// Errors at which times are compared [rad].
pub const TARGETS: [f64; 8] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10];

/// Everything one benchmark found.
pub struct Findings {
    /// Systems that were run.
    pub systems: Vec<System>,
    /// Their reference θ2(60 s) and how far its two sources are apart [rad].
    pub references: Vec<Reference>,
    /// All runs.
    pub runs: Vec<Run>,
    /// Lines on machine and versions.
    pub setting: Vec<String>,
}

/// The converged solution against which errors are measured.
#[derive(Clone, Debug)]
pub struct Reference {
    /// θ2 at 60 s [rad].
    pub theta: f64,
    /// Where it comes from and how well its sources agree.
    pub provenance: String,
}

impl Findings {
    /// Runs of one solver on one system.
    #[must_use]
    pub fn of<'a>(&'a self, system: &str, solver: &str) -> Vec<&'a Run> {
        self.runs
            .iter()
            .filter(|r| r.system == system && r.solver == solver)
            .collect()
    }

    /// Solvers in order of appearance.
    #[must_use]
    pub fn solvers(&self) -> Vec<String> {
        distinct(self.runs.iter().map(|run| &run.solver))
    }

    /// Time of `other` over time of `solver` at equal error; `None` where one does not reach it.
    #[must_use]
    pub fn ratio(&self, system: &str, other: &str, solver: &str, target: f64) -> Option<f64> {
        let slow = time_at_error(&self.of(system, other), target)?.0;
        let fast = time_at_error(&self.of(system, solver), target)?.0;
        Some(slow / fast)
    }
}

/// All runs as CSV.
#[must_use]
pub fn csv(findings: &Findings) -> String {
    let mut text = String::from(
        "system,solver,configuration,tolerance,seconds,theta,error,switches,steps,driver,compiling\n",
    );
    for r in &findings.runs {
        let _ = writeln!(
            text,
            "{},{},\"{}\",{:e},{:e},{:?},{:e},{},{},{:e},{:e}",
            r.system,
            r.solver,
            r.configuration,
            r.tolerance,
            r.seconds,
            r.theta,
            r.error,
            r.switches,
            r.steps,
            r.apart.driver,
            r.apart.compiling
        );
    }
    text
}

/// Every run as a table for the console.
#[must_use]
pub fn run_table(findings: &Findings) -> String {
    let mut text = String::new();
    for (system, reference) in findings.systems.iter().zip(&findings.references) {
        let _ = writeln!(text, "\n({}) {}", system.key, system.title);
        let _ = writeln!(
            text,
            "    θ2(60 s) = {:.12} rad: {}",
            reference.theta, reference.provenance
        );
        let _ = writeln!(
            text,
            "    {:<12} {:<28} {:>9} {:>11} {:>10} {:>8} {:>8}",
            "solver", "configuration", "tolerance", "time [ms]", "error", "switches", "steps"
        );
        for r in findings.runs.iter().filter(|r| r.system == system.key) {
            let _ = writeln!(
                text,
                "    {:<12} {:<28} {:>9.1e} {:>11.3} {:>10.1e} {:>8} {:>8}",
                r.solver,
                r.configuration,
                r.tolerance,
                r.seconds * 1e3,
                r.error,
                r.switches,
                r.steps
            );
        }
    }
    text
}

fn milliseconds(time: Option<(f64, String)>) -> String {
    time.map_or_else(
        || "–".into(),
        |(seconds, _)| format!("{:.3}", seconds * 1e3),
    )
}

fn times(ratio: Option<f64>) -> String {
    ratio.map_or_else(
        || "–".into(),
        |r| {
            if r < 100.0 {
                format!("{r:.1}")
            } else {
                format!("{r:.0}")
            }
        },
    )
}

/// Times at equal error and the ratios to `ours`, as Markdown tables.
#[must_use]
pub fn equal_error_tables(findings: &Findings, ours: &str) -> String {
    let mut text = String::new();
    let solvers = findings.solvers();
    let header = |text: &mut String, first: &str| {
        let _ = write!(text, "| {first} |");
        for target in TARGETS {
            let _ = write!(text, " {target:.0e} |");
        }
        let _ = writeln!(text, "\n|---|{}", "---:|".repeat(TARGETS.len()));
    };
    for (system, reference) in findings.systems.iter().zip(&findings.references) {
        let _ = writeln!(text, "\n### ({}) {}\n", system.key, system.title);
        let _ = writeln!(
            text,
            "Reference θ2(60 s) = {:.11} rad: {}.\n",
            reference.theta, reference.provenance
        );
        header(&mut text, "time [ms] at an error [rad] of");
        for solver in &solvers {
            let runs = findings.of(system.key, solver);
            if runs.is_empty() {
                continue;
            }
            let _ = write!(text, "| {solver} |");
            for target in TARGETS {
                let _ = write!(text, " {} |", milliseconds(time_at_error(&runs, target)));
            }
            text.push('\n');
        }
        if findings.of(system.key, ours).is_empty() {
            continue;
        }
        text.push('\n');
        header(&mut text, &format!("time over that of {ours} at"));
        for solver in solvers.iter().filter(|s| *s != ours) {
            if findings.of(system.key, solver).is_empty() {
                continue;
            }
            let _ = write!(text, "| {solver} |");
            for target in TARGETS {
                let _ = write!(
                    text,
                    " {} |",
                    times(findings.ratio(system.key, solver, ours, target))
                );
            }
            text.push('\n');
        }
    }
    text
}

/// The page `docs/benchmarks.md`.
#[must_use]
pub fn page(findings: &Findings, ours: &str) -> String {
    let mut text = String::from(
        "# Benchmarks\n\nMade by `cargo run --release -p benchmarks -- bench`; every number and the plot come from one run of it.\n\n\
         ![Work against precision](work-precision.svg)\n\n\
         Each run: 60 s from rest, output every 10 ms, the smallest processor time of several repetitions, taken inside the\n\
         solver's own process. The error is that of θ2 at 60 s. A solver's time at an error is that of its fastest set-up, interpolated in\n\
         both logarithms along a sweep over tolerances in which every error is first raised to the largest that a tighter\n\
         tolerance made, so that no lucky hit counts.\n\n",
    );
    for line in &findings.setting {
        let _ = writeln!(text, "- {line}");
    }
    text.push_str(&equal_error_tables(findings, ours));
    text.push('\n');
    text.push_str("\nAll runs: [work-precision.csv](work-precision.csv).\n");
    text
}
