//! The shipped program, as a user runs it.

use std::process::Command;

/// Runs `stickslip` with these arguments: its exit code, and all that it printed.
pub fn stickslip(arguments: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(arguments)
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    (output.status.code().unwrap(), text)
}
