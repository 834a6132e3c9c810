//! Cases: a model with records to learn from and to judge on, and their diagnosis.

use std::path::{Path, PathBuf};

use anyhow::ensure;
use inference::record::CHANNELS;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use workbench::diagnose::material::{CaseArguments, Material};
use workbench::diagnose::progress::{Finished, farewell};
use workbench::diagnose::record_check::COLUMNS;
use workbench::diagnose::record_part::Part;
use workbench::diagnose::request::{Diagnosed, Request, Stages};
use workbench::diagnose::show::Comparison;
use workbench::diagnose::small_plant::case as of_small_plant;
use workbench::outcome::Outcome;

use crate::arrays::{Table, bytes};
use crate::errors::any_error;
use crate::job::{Job, Value, value};

/// A record: a table, or a file, whole or in part.
#[derive(FromPyObject)]
pub enum GivenRecord {
    /// A table in memory.
    #[pyo3(transparent)]
    Table(Py<Table>),
    /// `FILE` or `FILE@FROM:TO`.
    #[pyo3(transparent)]
    File(PathBuf),
}

impl GivenRecord {
    fn part(&self, py: Python<'_>) -> anyhow::Result<Part> {
        Ok(match self {
            Self::Table(table) => Part::of_table(table.bind(py).get().record.clone()),
            Self::File(path) => Part::parse(path)?,
        })
    }
}

/// What is diagnosed.
#[pyclass(frozen)]
pub struct Case {
    material: Material,
    finished: Finished,
}

#[pymethods]
impl Case {
    /// A case; `model`, `sensors` and each of `effects` are name and text of a file.
    #[new]
    #[pyo3(signature = (name, model, records, held_out, sensors, effects, without))]
    #[allow(clippy::too_many_arguments, reason = "the facade names them")]
    fn new(
        py: Python<'_>,
        name: String,
        model: (String, String),
        records: Vec<GivenRecord>,
        held_out: Option<GivenRecord>,
        sensors: Option<(String, String)>,
        effects: Vec<(String, String)>,
        without: Vec<String>,
    ) -> PyResult<Self> {
        let (model_name, model_text) = model;
        let parts = || {
            ensure!(
                !records.is_empty(),
                "records: there is none; at least one is needed to learn from"
            );
            let parts: anyhow::Result<Vec<Part>> =
                records.iter().map(|record| record.part(py)).collect();
            let held_out = held_out.as_ref().map(|record| record.part(py));
            Ok((parts?, held_out.transpose()?))
        };
        let (records, held_out) = parts().map_err(|error| any_error(&error))?;
        let directory = Path::new(&model_name)
            .parent()
            .map(Path::to_owned)
            .unwrap_or_default();
        Ok(Self {
            finished: Finished::default(),
            material: Material {
                name,
                model_name,
                model_text,
                directory,
                fmu: None,
                records,
                held_out,
                sensors,
                effects,
                without,
                command: None,
            },
        })
    }

    /// The case in a directory, as the command line reads it.
    #[staticmethod]
    fn in_directory(directory: PathBuf, without: Vec<String>) -> PyResult<Self> {
        let arguments = CaseArguments {
            case: Some(directory),
            without,
            ..CaseArguments::default()
        };
        let material = arguments
            .material()
            .map_err(|error| any_error(&error.into()))?;
        Ok(Self {
            finished: Finished::default(),
            material,
        })
    }

    /// What messages and the report call it.
    #[getter]
    fn name(&self) -> &str {
        &self.material.name
    }

    /// Text of the model file.
    #[getter]
    fn model_text(&self) -> &str {
        &self.material.model_text
    }

    /// What messages call the model.
    #[getter]
    fn model_name(&self) -> &str {
        &self.material.model_name
    }

    /// Whether the model is that of a small plant.
    #[getter]
    fn is_of_small_plant(&self) -> bool {
        self.material.is_of_small_plant()
    }

    /// Reads and checks the records; comes to what has to be said about them.
    fn check(&self) -> PyResult<Job> {
        let material = self.material.clone();
        Job::start(move |_| {
            let notes = if material.is_of_small_plant() {
                of_small_plant::load(&material, &mut |_| {})?.notes
            } else {
                material.load()?.notes
            };
            Ok(value(move |py| {
                Ok(notes.into_pyobject(py)?.into_any().unbind())
            }))
        })
    }

    /// Names, amends and shows; the files go into `out`.
    fn diagnose(&self, out: PathBuf, library: Option<PathBuf>) -> PyResult<Job> {
        let material = self.material.clone();
        let finished = self.finished.clone();
        lock(&finished).clear();
        Job::start_owning(move |watch| {
            let tell = Box::new(move |what: &str| watch.tell(what));
            let request = Request {
                material: &material,
                out: &out,
                library: library.as_deref(),
                tell,
                finished,
            };
            let diagnosed = request.run(Stages::All)?;
            Ok(finding(diagnosed))
        })
    }

    /// What is left of a diagnosis that was interrupted: the names of what is finished, and a sentence about it.
    fn left(&self, out: PathBuf) -> (Vec<&'static str>, String) {
        let finished = lock(&self.finished).clone();
        let sentence = farewell(&finished, &out);
        (finished, sentence)
    }
}

fn lock(finished: &Finished) -> std::sync::MutexGuard<'_, Vec<&'static str>> {
    finished
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Whether the exit code would be 0, what the command line shows, and both models on the held-out record.
fn finding(diagnosed: Diagnosed) -> Value {
    value(move |py| {
        let is_settled = diagnosed.outcome == Outcome::Done;
        let shown = diagnosed
            .shown
            .map(|comparison| shown(py, &comparison))
            .transpose()?;
        let all = (is_settled, diagnosed.screen, shown);
        Ok(all.into_pyobject(py)?.into_any().unbind())
    })
}

/// The held-out record's stretches: time, what was measured, and each model restarted in windows, as bytes by name; where no
/// window reaches, a model has NaN.
fn shown<'py>(py: Python<'py>, comparison: &Comparison) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let judging = &comparison.judging;
    let names = &COLUMNS[COLUMNS.len() - 1 - CHANNELS..COLUMNS.len() - 1];
    let mut stretches = Vec::new();
    for (number, record) in judging.records.iter().enumerate() {
        let stretch = PyDict::new(py);
        stretch.set_item("time", bytes(py, &record.time))?;
        for (channel, name) in names.iter().enumerate() {
            let measured = &record.readings[channel];
            if measured.is_empty() {
                continue;
            }
            stretch.set_item(*name, bytes(py, measured))?;
            for (model, shown) in [("before", &comparison.before), ("after", &comparison.after)] {
                let mut values = vec![f64::NAN; record.time.len()];
                for (window, course) in judging.data.windows.iter().zip(&shown.windows) {
                    let Some(course) = course.as_ref().filter(|_| window.run == number) else {
                        continue;
                    };
                    let own = &course.values[channel];
                    for (place, value) in values[window.first..].iter_mut().zip(own) {
                        *place = *value;
                    }
                }
                stretch.set_item(format!("{name} {model}"), bytes(py, &values))?;
            }
        }
        stretches.push(stretch);
    }
    Ok(stretches)
}
