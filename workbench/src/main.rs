//! The command `stickslip`. Exit codes: 0 done, 1 a check said no, 2 usage or input, 130 interrupted.

use std::process::ExitCode;

use build_fmu::explain::explain;
use clap::Parser;
use workbench::cli::{self, Cli, Outcome};

fn main() -> ExitCode {
    // A reader such as `head` that has seen enough is no error.
    sigpipe::reset();
    match cli::run(&Cli::parse()) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::CheckFailed) => ExitCode::from(1),
        Ok(Outcome::Interrupted) => ExitCode::from(130),
        Err(error) => {
            eprintln!("stickslip: {}", explain(error.as_ref()));
            ExitCode::from(2)
        }
    }
}
