//! What an experiment finds: rows beside the published numbers, tables and pictures.

use serde::Serialize;
use stickslip::integrator::IntegrationError;
use stickslip::parameter::ParameterError;
use stickslip::plant::ModelFileError;
use thiserror::Error;

use crate::files::atomic::WriteError;
use crate::oscillator::OscillatorError;
use crate::plot::{Figure, PlotError};

/// Why an experiment came to no end.
#[derive(Debug, Error)]
pub enum ExperimentError {
    /// A run could not go on.
    #[error("the simulation stopped: {0}")]
    Integration(#[from] IntegrationError),
    /// A parameter that the experiment sets is refused.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The built-in model file is refused.
    #[error(transparent)]
    Model(#[from] Box<ModelFileError>),
    /// An oscillator that cannot be.
    #[error(transparent)]
    Oscillator(#[from] OscillatorError),
    /// A picture was not written.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A file was not written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// What was to be measured is not there, for example a limit cycle where the run stands still.
    #[error("nothing to measure: {0}")]
    Nothing(String),
}

impl From<ModelFileError> for ExperimentError {
    fn from(error: ModelFileError) -> Self {
        Self::Model(Box::new(error))
    }
}

/// How a published statement fares.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub enum Verdict {
    /// As printed.
    Reproduced,
    /// Under a condition that the dissertation does not state.
    ReproducedWith(String),
    /// Exact computation contradicts it.
    NotReproducible(String),
    /// Unexplained so far.
    Open(String),
    /// Nothing is printed; the number is ours alone.
    Added,
}

impl Verdict {
    /// [`Verdict::Reproduced`] if `holds`, else [`Verdict::Open`] with what stands against it.
    #[must_use]
    pub fn holds(holds: bool, otherwise: &str) -> Self {
        if holds {
            Self::Reproduced
        } else {
            Self::Open(otherwise.to_owned())
        }
    }

    /// In words.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::Reproduced => "reproduced".to_owned(),
            Self::ReproducedWith(condition) => format!("reproduced with {condition}"),
            Self::NotReproducible(reason) => format!("not reproducible: {reason}"),
            Self::Open(reason) if reason.is_empty() => "open".to_owned(),
            Self::Open(reason) => format!("open: {reason}"),
            Self::Added => "added here".to_owned(),
        }
    }
}

/// One published statement beside ours.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Row {
    /// What is compared, with unit.
    pub quantity: String,
    /// As printed.
    pub published: String,
    /// As computed.
    pub ours: String,
    /// Difference, relative where that makes sense.
    pub deviation: String,
    /// How the statement fares.
    pub verdict: Verdict,
    /// Why it deviates, or how it was obtained.
    pub remark: String,
}

impl Row {
    /// A number beside a number; reproduced if it lies within `bar` (relative), else open.
    #[must_use]
    pub fn number(quantity: &str, published: f64, ours: f64, bar: f64) -> Self {
        let deviation = ours / published - 1.0;
        Self {
            quantity: quantity.to_owned(),
            published: short(published),
            ours: short(ours),
            deviation: format!("{:+.2} %", 100.0 * deviation),
            verdict: Verdict::holds(deviation.abs() <= bar, ""),
            remark: String::new(),
        }
    }

    /// A statement in words beside what was found.
    #[must_use]
    pub fn statement(
        quantity: &str,
        published: &str,
        ours: impl Into<String>,
        verdict: Verdict,
    ) -> Self {
        Self {
            quantity: quantity.to_owned(),
            published: published.to_owned(),
            ours: ours.into(),
            deviation: "–".to_owned(),
            verdict,
            remark: String::new(),
        }
    }

    /// A number of ours for which nothing is printed.
    #[must_use]
    pub fn added(quantity: &str, ours: impl Into<String>) -> Self {
        Self::statement(quantity, "–", ours, Verdict::Added)
    }

    /// The same row with a remark.
    #[must_use]
    pub fn remark(self, remark: impl Into<String>) -> Self {
        Self {
            remark: remark.into(),
            ..self
        }
    }

    /// The same row with another verdict.
    #[must_use]
    pub fn verdict(self, verdict: Verdict) -> Self {
        Self { verdict, ..self }
    }
}

/// A number with four significant digits.
#[must_use]
pub fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let decimals = (3 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Columns of equal length for a CSV file.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Name of the file, without extension.
    pub name: String,
    /// Name (with unit) and values of each column.
    pub columns: Vec<(String, Vec<f64>)>,
}

impl Table {
    /// A table of the given columns.
    #[must_use]
    pub fn new(name: impl Into<String>, columns: Vec<(&str, Vec<f64>)>) -> Self {
        Self {
            name: name.into(),
            columns: columns
                .into_iter()
                .map(|(name, values)| (name.to_owned(), values))
                .collect(),
        }
    }

    /// As CSV; a column that is shorter than the longest ends in empty cells.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let names: Vec<&str> = self
            .columns
            .iter()
            .map(|column| column.0.as_str())
            .collect();
        let rows = self
            .columns
            .iter()
            .map(|column| column.1.len())
            .max()
            .unwrap_or(0);
        let mut text = names.join(",") + "\n";
        for row in 0..rows {
            let cells: Vec<String> = self
                .columns
                .iter()
                .map(|column| column.1.get(row).map_or(String::new(), f64::to_string))
                .collect();
            text.push_str(&cells.join(","));
            text.push('\n');
        }
        text
    }
}

/// A picture.
pub struct Picture {
    /// Name of the files, without extension.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// The picture itself.
    pub figure: Figure,
    /// Whether the reproduction document shows it.
    pub shown: bool,
}

/// All that an experiment finds.
#[derive(Default)]
pub struct Findings {
    /// Published statements beside ours.
    pub rows: Vec<Row>,
    /// Data.
    pub tables: Vec<Table>,
    /// Pictures.
    pub pictures: Vec<Picture>,
}

impl Findings {
    /// Adds a picture that the reproduction document does not show.
    pub fn picture(&mut self, name: &str, caption: &str, figure: Figure) {
        self.pictures.push(Picture {
            name: name.to_owned(),
            caption: caption.to_owned(),
            figure,
            shown: false,
        });
    }

    /// Adds a picture that the reproduction document shows.
    pub fn shown_picture(&mut self, name: &str, caption: &str, figure: Figure) {
        self.picture(name, caption, figure);
        if let Some(picture) = self.pictures.last_mut() {
            picture.shown = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_keeps_four_digits() {
        for (value, text) in [
            (10.2571, "10.26"),
            (0.75331, "0.7533"),
            (1470.2, "1470"),
            (0.5, "0.5"),
            (-0.000_123_46, "-0.0001235"),
            (0.0, "0"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn a_number_outside_its_bar_is_open() {
        assert_eq!(
            Row::number("f", 0.756, 0.758, 0.005).verdict,
            Verdict::Reproduced
        );
        assert_eq!(Row::number("f", 0.756, 0.761, 0.005).verdict.text(), "open");
    }
}
