//! Reference results: does the FMU give them?

use std::path::Path;

use super::finding::{Finding, Rule};
use crate::component::Fmu;
use crate::reference::trial::Trial;

/// Repeats an experiment: what is wrong, or a line on how well the results were met; an error where it could not be tried.
pub(super) fn repeat(path: &Path, trial: &Trial) -> Result<(Vec<Finding>, Option<String>), String> {
    if let Some(reason) = &trial.unread {
        return Err(reason.clone());
    }
    let mut fmu = Fmu::open(path).map_err(|error| error.to_string())?;
    let wrong =
        |message: String| Finding::new(Rule::ReferenceResults, format!("{trial}: {message}"));
    let found = match trial.run(&mut fmu) {
        Ok(found) => found,
        Err(reason) => return Ok((vec![wrong(reason)], None)),
    };
    if found.time.is_empty() {
        return Ok((
            vec![wrong("no row of the results lies within it".to_owned())],
            None,
        ));
    }
    let deviations = trial.deviations(&found);
    let excesses: Vec<Finding> = deviations
        .iter()
        .filter(|deviation| deviation.is_excess())
        .map(|deviation| {
            wrong(format!(
                "{} at {} s is {}, in the results {}; {:.1e} may lie between them",
                deviation.name,
                deviation.time,
                deviation.found,
                deviation.expected,
                deviation.allowed
            ))
        })
        .collect();
    if !excesses.is_empty() {
        return Ok((excesses, None));
    }
    let largest = deviations
        .iter()
        .map(|deviation| deviation.size() / deviation.allowed)
        .fold(0.0, f64::max);
    let how = if largest == 0.0 {
        "to the last bit".to_owned()
    } else {
        format!("to {largest:.0e} of what is allowed")
    };
    let note = format!("{trial}: results met at {} times {how}", found.time.len());
    Ok((Vec::new(), Some(note)))
}
