//! `stickslip._native`: what the Python package `stickslip` calls of the workbench.
//!
//! The package's own modules (`python/stickslip`) hold what a user sees: tables, documentation, figures, progress bars. Here
//! numbers go in and out as buffers, and long work is a [`job::Job`] that a thread does while Python runs on.

mod arrays;
mod case;
mod ensemble;
mod errors;
mod job;
mod map;
mod programs;
mod rig;
mod score;
mod simulate;

use std::ffi::OsString;
use std::path::PathBuf;

use pyo3::prelude::*;
use workbench::diagnose::small_plant::fmu::worker;

/// Tells where the package keeps the libraries that go into FMUs.
#[pyfunction]
fn look_for_libraries_in(folder: PathBuf) {
    build_fmu::library::look_in(folder);
}

/// The text of `[columns]` in a model file's text, and what is left.
#[pyfunction]
fn split_columns(text: &str) -> (String, String) {
    workbench::diagnose::rig_columns::RigColumns::split(text)
}

/// The module as Python loads it.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add(
        "REDUCED_RIG",
        include_str!("../../../modelDescription/reduced-rig.toml"),
    )?;
    module.add(
        "FULL_RIG",
        include_str!("../../../modelDescription/full-rig.toml"),
    )?;
    let executable = module.py().import("sys")?.getattr("executable")?;
    if let Ok(executable) = executable.extract::<OsString>() {
        worker::set_program(vec![executable, "-m".into(), "stickslip".into()]);
    }
    errors::add_to(module)?;
    module.add_class::<arrays::Table>()?;
    module.add_class::<case::Case>()?;
    module.add_class::<job::Job>()?;
    module.add_class::<rig::Rig>()?;
    module.add_function(wrap_pyfunction!(look_for_libraries_in, module)?)?;
    module.add_function(wrap_pyfunction!(split_columns, module)?)?;
    module.add_function(wrap_pyfunction!(ensemble::ensemble, module)?)?;
    module.add_function(wrap_pyfunction!(map::map, module)?)?;
    module.add_function(wrap_pyfunction!(programs::stickslip, module)?)?;
    module.add_function(wrap_pyfunction!(programs::build_fmu, module)?)?;
    module.add_function(wrap_pyfunction!(score::score, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::simulate, module)?)?;
    Ok(())
}
