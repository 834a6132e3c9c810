//! The command `stickslip`. Exit codes: 0 done, 1 a check said no, 2 usage or input, 130 interrupted.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(workbench::cli::main(std::env::args_os()))
}
