//! `stress-tests`: what is done to the built library before it may run in other people's processes.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use clap::{Parser, Subcommand};
use stress_tests::component::{Component, FULL_RIG, REDUCED_RIG};
use stress_tests::library::{Library, beside_program};
use stress_tests::standard::Version;
use stress_tests::{campaign, endurance};

#[derive(Parser)]
#[command(
    about = "Random and hostile calls, long runs and many instances against the built library"
)]
struct Arguments {
    /// The library; without it the one beside this program.
    #[arg(long, global = true)]
    library: Option<PathBuf>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Random sequences of calls, compared with the standard's tables and the native model.
    Calls {
        /// Version whose functions are called; two of eight instances are of the other one.
        #[arg(long)]
        fmi: Version,
        /// Least number of calls.
        #[arg(long, default_value_t = 200_000)]
        calls: u64,
        /// Seed of the first sequence; each further one has the next seed.
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Many instances stepped from many threads, compared with single runs.
    Threads {
        /// Number of instances.
        #[arg(long, default_value_t = 1000)]
        instances: usize,
        /// Number of threads.
        #[arg(long, default_value_t = 64)]
        threads: usize,
    },
    /// Instances made, run and freed; memory must stay flat.
    Instances {
        /// How many.
        #[arg(long, default_value_t = 100_000)]
        count: usize,
    },
    /// Communication steps of 1 ms in one run; memory, time base and limit cycle must not drift.
    Marathon {
        /// How many; the full run is 1000000000.
        #[arg(long, default_value_t = 20_000_000)]
        steps: u64,
    },
    /// Two components and both versions in one process.
    SideBySide,
    /// build-fmu, map, experiment and diagnose, killed at random times.
    Kills {
        /// How often, all together.
        #[arg(long, default_value_t = 200)]
        kills: usize,
        /// Seed of the times.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// The project's source tree, for a model, a case and a document.
        #[arg(long, default_value = ".")]
        source_tree: PathBuf,
        /// Leave out diagnose, which takes by far the longest.
        #[arg(long)]
        without_diagnose: bool,
    },
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("stress-tests: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<bool> {
    let path = match &arguments.library {
        Some(path) => path.clone(),
        None => beside_program()?,
    };
    let library = Library::load(&path)?;
    let start = Instant::now();
    match &arguments.command {
        Command::Calls { fmi, calls, seed } => {
            let components = [Component::new(REDUCED_RIG)?, Component::new(FULL_RIG)?];
            match campaign::run(&library, &components, *fmi, *seed, *calls, |_| ()) {
                Ok(tally) => println!(
                    "{} calls in {} sequences, {} of them rightly refused: as the standard and the native model say; \
                     longest call {:.1} s, all {:.0} s",
                    tally.calls,
                    tally.sequences,
                    tally.refused,
                    tally.longest.as_secs_f64(),
                    start.elapsed().as_secs_f64()
                ),
                Err(failure) => {
                    println!("{failure}");
                    return Ok(false);
                }
            }
            Ok(true)
        }
        Command::Threads { instances, threads } => {
            report(endurance::threads(&library, *instances, *threads), start)
        }
        Command::Instances { count } => report(endurance::instances(&library, *count), start),
        Command::Marathon { steps } => {
            let outcome = endurance::marathon(&library, *steps, |line| println!("{line}"));
            report(outcome, start)
        }
        Command::Kills {
            kills,
            seed,
            source_tree,
            without_diagnose,
        } => report(
            stress_tests::kills::kills(*kills, *seed, source_tree, !*without_diagnose),
            start,
        ),
        Command::SideBySide => report(endurance::side_by_side(&path), start),
    }
}

/// Prints what was found, or what went otherwise than it should.
fn report(outcome: Result<String>, start: Instant) -> Result<bool> {
    match outcome {
        Ok(line) => println!("{line} ({:.0} s)", start.elapsed().as_secs_f64()),
        Err(error) => {
            println!("{error:#}");
            return Ok(false);
        }
    }
    Ok(true)
}
