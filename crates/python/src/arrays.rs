//! Tables between Python and the workbench: columns of numbers as buffers.

use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use workbench::files::record::Record;

use crate::errors::input_error;

/// Columns over time.
#[pyclass(frozen)]
pub struct Table {
    /// The same as the workbench has it.
    pub record: Record,
}

#[pymethods]
impl Table {
    /// A table that messages call `name`, of buffers of 64-bit floats.
    #[new]
    fn new(
        py: Python<'_>,
        name: &str,
        time: PyBuffer<f64>,
        columns: Vec<(String, PyBuffer<f64>)>,
    ) -> PyResult<Self> {
        let refused = |error| input_error(&error);
        let mut record = Record::new(name, time.to_vec(py)?).map_err(refused)?;
        for (column, values) in columns {
            record
                .add_column(column, values.to_vec(py)?)
                .map_err(refused)?;
        }
        Ok(Self { record })
    }
}

/// Numbers as the bytes of 64-bit floats in the machine's order.
pub fn bytes<'py>(py: Python<'py>, numbers: &[f64]) -> Bound<'py, PyByteArray> {
    let bytes: Vec<u8> = numbers
        .iter()
        .flat_map(|number| number.to_ne_bytes())
        .collect();
    PyByteArray::new(py, &bytes)
}

/// The columns of a record as names and bytes, time first.
pub fn columns<'py>(py: Python<'py>, record: &Record) -> Vec<(String, Bound<'py, PyByteArray>)> {
    let named = record
        .names()
        .filter_map(|name| Some((name.to_owned(), bytes(py, record.column(name)?))));
    std::iter::once(("time".to_owned(), bytes(py, record.time())))
        .chain(named)
        .collect()
}
