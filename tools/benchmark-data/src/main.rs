//! `benchmark-data`: makes sealed cases and checks itself against the practice records.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    // A reader such as `head` that has seen enough is no error.
    sigpipe::reset();
    match cli::run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("benchmark-data: {error:#}");
            ExitCode::from(2)
        }
    }
}
