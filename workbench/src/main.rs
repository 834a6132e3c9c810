//! The command `stickslip`. Exit codes: 0 done, 1 a check said no, 2 usage or input, 130 interrupted.

use std::process::ExitCode;

use clap::Parser;
use workbench::cli::{self, Cli, Outcome};

fn main() -> ExitCode {
    match cli::run(&Cli::parse()) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::CheckFailed) => ExitCode::from(1),
        Ok(Outcome::Interrupted) => ExitCode::from(130),
        Err(error) => {
            eprintln!("stickslip: {}", told_once(&error));
            ExitCode::from(2)
        }
    }
}

/// The error with its causes; a cause that is already in the words before it is not said again.
fn told_once(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if text.is_empty() {
            text = cause;
        } else if !text.contains(&cause) {
            text.push_str(": ");
            text.push_str(&cause);
        }
    }
    text
}
