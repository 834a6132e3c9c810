//! An experiment of an FMU with its data, ready to be repeated.

use std::fmt;

use super::read::Stated;
use super::repeat::{self, Deviation, Experiment};
use super::table::Table;
use crate::component::Fmu;

/// An experiment of the FMU, with its data.
#[derive(Debug)]
pub struct Trial {
    /// File of the experiment inside the FMU.
    file: String,
    name: String,
    start: Option<f64>,
    stop: Option<f64>,
    step: Option<f64>,
    tolerance: Option<f64>,
    pub(crate) parameters: Vec<(String, f64)>,
    pub(crate) stimuli: Table,
    pub(crate) references: Table,
    /// What of it is in a format that is not read.
    pub(crate) unread: Option<String>,
}

impl fmt::Display for Trial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "experiment {} of {}", self.name, self.file)
    }
}

impl Trial {
    /// An experiment without its data; what it does not state is that of the `default` experiment, by its attributes.
    pub(crate) fn new(file: &str, stated: &Stated, default: impl Fn(&str) -> Option<f64>) -> Self {
        Self {
            file: file.to_owned(),
            name: stated.name.clone(),
            start: stated.start.or_else(|| default("startTime")),
            stop: stated.stop.or_else(|| default("stopTime")),
            step: stated.step.or_else(|| default("stepSize")),
            tolerance: stated.tolerance.or_else(|| default("tolerance")),
            parameters: Vec::new(),
            stimuli: Table::default(),
            references: Table::default(),
            unread: None,
        }
    }

    /// The run; times that nobody states are those of the references.
    #[must_use]
    pub fn experiment(&self) -> Experiment {
        let times = &self.references.time;
        let first = times.first().copied().unwrap_or(0.0);
        let last = times.last().copied().unwrap_or(first);
        let start = self.start.unwrap_or(first);
        let stop = self.stop.unwrap_or(last);
        let steps = times.len().saturating_sub(1).max(1);
        Experiment {
            name: self.name.clone(),
            start,
            stop,
            step: self.step.unwrap_or((last - first) / steps as f64),
            tolerance: self.tolerance,
            parameters: self.parameters.clone(),
            stimuli: self.stimuli.clone(),
        }
    }

    /// The results that should come out.
    #[must_use]
    pub fn references(&self) -> &Table {
        &self.references
    }

    /// How far results came from what they should be.
    #[must_use]
    pub fn deviations(&self, found: &Table) -> Vec<Deviation> {
        repeat::compare(found, &self.references, self.tolerance)
    }

    /// Runs the FMU through the experiment.
    ///
    /// # Errors
    /// The reason, where it cannot be run at all.
    pub fn run(&self, fmu: &mut Fmu) -> Result<Table, String> {
        if let Some(reason) = &self.unread {
            return Err(reason.clone());
        }
        fmu.set_tolerance(self.tolerance);
        let shown: Vec<&str> = self
            .references
            .columns
            .iter()
            .map(|column| column.name.as_str())
            .collect();
        let fixed = !fmu.takes_any_step();
        let rows = repeat::times(&self.references);
        repeat::run(fmu, &self.experiment(), &shown, &rows, fixed)
            .map_err(|error| error.to_string())
    }
}
