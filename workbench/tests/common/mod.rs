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

/// The library of an FMU around an FMU, which lies beside the test binaries.
#[allow(dead_code, reason = "not every test packs one")]
pub fn wrapper_library() -> String {
    let library = std::env::current_exe().unwrap().with_file_name(format!(
        "{}stickslip_wrapper{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    ));
    library.to_str().unwrap().to_owned()
}
