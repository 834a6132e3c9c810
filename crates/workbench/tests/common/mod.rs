//! The shipped program, as a user runs it.

use std::fs::{self, File};
use std::io::Write as _;
use std::path::Path;
use std::process::Command;

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

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

/// The library `stickslip`, or `stickslip_wrapper` of an FMU around an FMU, which lies beside the test binaries.
#[allow(dead_code, reason = "not every test packs one")]
pub fn library(name: &str) -> String {
    let library = std::env::current_exe().unwrap().with_file_name(format!(
        "{}{name}{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    ));
    library.to_str().unwrap().to_owned()
}

/// The library that rustc makes of a file below the repository's root.
#[allow(dead_code, reason = "not every test compiles one")]
pub fn compiled(source: &str) -> Vec<u8> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(source);
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("plant.library");
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let done = Command::new(compiler)
        .args(["--edition", "2024", "--crate-type", "cdylib", "-O"])
        .arg(&source)
        .arg("-o")
        .arg(&file)
        .status();
    assert!(
        done.as_ref().is_ok_and(std::process::ExitStatus::success),
        "{done:?}: the tests compile {} with rustc; put it into the PATH, or name it in RUSTC",
        source.display()
    );
    fs::read(file).unwrap()
}

/// Packs files by their names.
#[allow(dead_code, reason = "not every test packs one")]
pub fn pack(path: &Path, files: &[(&str, &[u8])]) {
    let mut archive = ZipWriter::new(File::create(path).unwrap());
    for (name, content) in files {
        let options = SimpleFileOptions::default();
        archive.start_file(*name, options).unwrap();
        archive.write_all(content).unwrap();
    }
    archive.finish().unwrap();
}
