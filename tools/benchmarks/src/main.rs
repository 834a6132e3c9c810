//! `benchmarks`: our integrator against other solvers, and the cost of the FMU's communication step.
//!
//! `benchmarks bench` runs every solver on the same systems in one process tree and writes the
//! work-precision tables and plot to `docs/`. `benchmarks dostep` drives the built library as an importer does;
//! `benchmarks derivatives` times sensitivities against plain runs.

mod bench;
mod cvode;
mod derivatives;
#[cfg(feature = "diffsol")]
mod diffsol_rig;
mod do_step;
mod effects;
mod effort;
mod files;
mod heyoka;
mod interpreter;
mod laws;
mod measurement;
mod ours;
mod plot;
mod report;
mod scipy;
mod systems;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run all solvers on all systems; print and write tables and plot.
    Bench(bench::Options),
    /// Time communication steps of the built library through the C ABI, both FMI versions.
    Dostep(do_step::Options),
    /// Time runs with eight derivatives against plain ones: every law, both rigs.
    Derivatives(derivatives::Options),
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Bench(options) => bench::run(&options),
        Command::Dostep(options) => do_step::run(&options),
        Command::Derivatives(options) => derivatives::run(&options),
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("benchmarks: {error:#}");
            ExitCode::from(2)
        }
    }
}
