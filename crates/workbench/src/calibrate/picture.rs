//! The ensemble in a picture: where in its range each parameter can lie.

use super::search::Calibration;
use super::target::Target;
use crate::plot::{Axis, Chart, Figure, Panel, Style};

/// Bins of each histogram.
const BINS: usize = 12;
/// Panels side by side.
const ACROSS: usize = 3;

/// A histogram of each parameter over the sets that meet every bar, on the range that was searched, with the best set.
#[must_use]
pub fn ensemble(target: &Target, found: &Calibration) -> Figure {
    let mut figure = Figure::new(format!(
        "{} parameter sets meet every bar",
        found.ensemble.len()
    ));
    let panels: Vec<Box<dyn Panel>> = target
        .parameter
        .iter()
        .enumerate()
        .map(|(index, sought)| {
            let values: Vec<f64> = found.ensemble.iter().map(|set| set.values[index]).collect();
            let chart = Chart::new(
                Axis::new(sought.name.as_str()).range(sought.minimum, sought.maximum),
                Axis::new("sets"),
            )
            .histogram("", &values, BINS, Style::series(2).solid())
            .vertical("best", found.best.values[index], Style::model());
            Box::new(chart) as Box<dyn Panel>
        })
        .collect();
    let mut panels = panels.into_iter().peekable();
    while panels.peek().is_some() {
        figure = figure.row(190.0, panels.by_ref().take(ACROSS).collect());
    }
    figure
}
