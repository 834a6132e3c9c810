//! The command lines of the programs `stickslip` and `build-fmu`.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the program `stickslip` with these arguments, its own name first; returns the exit code. Wrong usage ends the process.
#[pyfunction]
pub fn stickslip(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| workbench::cli::main(arguments))
}

/// The same for `build-fmu`.
#[pyfunction]
pub fn build_fmu(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| ::build_fmu::cli::main(arguments))
}
