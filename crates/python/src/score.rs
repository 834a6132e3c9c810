//! Diagnoses of cases whose answers are known.

use std::path::PathBuf;

use pyo3::prelude::*;
use workbench::diagnose::score::{Scoring, Step, score as score_cases};

use crate::job::{Job, value};

/// Scores the cases of a directory into `out`; comes to the text of `score.md`, the cases that could not be diagnosed and
/// whether every bar is reached.
#[pyfunction]
pub fn score(
    cases: PathBuf,
    out: PathBuf,
    leave_one_out: bool,
    jobs: usize,
    library: Option<PathBuf>,
) -> PyResult<Job> {
    Job::start(move |watch| {
        let scoring = Scoring {
            cases: &cases,
            out: &out,
            leave_one_out,
            catalogue: None,
            jobs,
            library: library.as_deref(),
        };
        let scored = score_cases(&scoring, &|step| match step {
            Step::Begun { cases } => watch.set_total(cases),
            Step::Case(what) | Step::Within(what) => watch.tell(what),
            Step::Done => watch.add_done(),
        })?;
        Ok(value(move |py| {
            let all = (scored.markdown, scored.failed, scored.is_passed);
            Ok(all.into_pyobject(py)?.into_any().unbind())
        }))
    })
}
