//! The workbench's errors as Python's exceptions, with the same words.

use std::error::Error;

use build_fmu::explain::explain;
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    stickslip,
    InputError,
    PyValueError,
    "What the command line answers with exit code 2: something about the input is wrong, and the message says what is right."
);
create_exception!(
    stickslip,
    DefectError,
    PyRuntimeError,
    "The program itself is wrong: please report the message with what led to it."
);

/// Adds the exceptions to the module.
pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("InputError", module.py().get_type::<InputError>())?;
    module.add("DefectError", module.py().get_type::<DefectError>())
}

/// An error as the command line says it.
pub fn input_error(error: &(dyn Error + 'static)) -> PyErr {
    InputError::new_err(in_python(&explain(error)))
}

/// The same of an error of any kind.
pub fn any_error(error: &anyhow::Error) -> PyErr {
    input_error(error.as_ref())
}

/// Options of the command line as the arguments of functions that they are here: `--normal-force-1` is `normal_force_1`.
fn in_python(message: &str) -> String {
    let mut words = message.split("--");
    let mut text = words.next().unwrap_or_default().to_owned();
    for part in words {
        let end = part
            .find(|c: char| !(c.is_ascii_alphanumeric() || c == '-'))
            .unwrap_or(part.len());
        let (option, rest) = part.split_at(end);
        if option.starts_with(|c: char| c.is_ascii_alphabetic()) {
            text.push_str(&option.replace('-', "_"));
        } else {
            text.push_str("--");
            text.push_str(option);
        }
        text.push_str(rest);
    }
    text
}
