//! The program `build-fmu`. Exit codes: 0 done, 1 a check said no, 2 usage or input.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(build_fmu::cli::main(std::env::args_os()))
}
