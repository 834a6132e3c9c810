//! The picture of an ensemble: heat maps over speed and normal force, bands over one of them, histograms at one place.

use super::bands::{Bands, MEASURES};
use super::settings::Settings;
use crate::analysis::motion::Motion;
use crate::map::{Point, Quantity};
use crate::plot::{Axis, Chart, Figure, HeatMap, Panel, Style, boundary};

/// Places of the measures that are drawn.
const MINIMUM: usize = 0;
const MAXIMUM: usize = 1;
const HALF_AMPLITUDE: usize = 2;
const FREQUENCY: usize = 3;
const STICK_FRACTION: usize = 4;
/// Bins of a histogram.
const BINS: usize = 40;

/// The picture that suits the number of quantities that vary.
pub(super) fn picture(settings: &Settings, rows: &[Vec<Point>], bands: &[Bands]) -> Figure {
    match (settings.speeds.len(), settings.forces.len()) {
        (1, 1) => at_one_place(settings, rows, bands),
        (1, _) => over_one(settings, &Quantity::NormalForce, &settings.forces, bands),
        (_, 1) => over_one(settings, &Quantity::SpeedRpm, &settings.speeds, bands),
        _ => over_two(settings, bands),
    }
}

fn over_two(settings: &Settings, bands: &[Bands]) -> Figure {
    let (speeds, forces) = (&settings.speeds, &settings.forces);
    let grid = |value: &dyn Fn(&Bands) -> f64| -> Vec<Vec<f64>> {
        let rows = bands.chunks(speeds.len());
        rows.map(|row| row.iter().map(value).collect()).collect()
    };
    let probability = |bands: &Bands| bands.share(Motion::StickSlip).value();
    let half = boundary(speeds, forces, 0.5, |column, row| {
        probability(&bands[row * speeds.len() + column])
    });
    let panel = |title: &str, label: &str, value: &dyn Fn(&Bands) -> f64| {
        let x = Axis::new(settings.label(&Quantity::SpeedRpm));
        let y = Axis::new(settings.label(&Quantity::NormalForce));
        HeatMap::continuous((x, speeds.clone()), (y, forces.clone()), grid(value), label)
            .title(title)
            .boundary("stick-slip in half of the rigs", half.clone())
    };
    let median = |measure: usize| move |bands: &Bands| bands.band(measure)[1];
    let width = |bands: &Bands| {
        let [low, _, high] = bands.band(HALF_AMPLITUDE);
        high - low
    };
    let stick_slip = panel("probability of stick-slip", "probability", &probability);
    Figure::new(settings.title())
        .wide(1120.0)
        .row(
            400.0,
            vec![
                Box::new(stick_slip.range(0.0, 1.0)),
                Box::new(panel(
                    "half amplitude of the velocity, median",
                    "half amplitude [rad/s]",
                    &median(HALF_AMPLITUDE),
                )),
            ],
        )
        .row(
            400.0,
            vec![
                Box::new(panel(
                    "half amplitude, 95 % less 5 % quantile",
                    "width of the band [rad/s]",
                    &width,
                )),
                Box::new(panel(
                    "frequency, median",
                    "frequency [Hz]",
                    &median(FREQUENCY),
                )),
            ],
        )
}

fn over_one(settings: &Settings, quantity: &Quantity, x: &[f64], bands: &[Bands]) -> Figure {
    let axis = || Axis::new(settings.label(quantity));
    let of = |value: &dyn Fn(&Bands) -> f64| bands.iter().map(value).collect::<Vec<f64>>();
    let shares = |bands: &Bands| bands.share(Motion::StickSlip);
    let probability = Chart::new(
        axis(),
        Axis::new("probability of stick-slip").range(-0.03, 1.03),
    )
    .band(
        "95 % interval",
        x,
        &of(&|bands| shares(bands).interval95()[0]),
        &of(&|bands| shares(bands).interval95()[1]),
        Style::series(0),
    )
    .line("", x, &of(&|bands| shares(bands).value()), Style::series(0));
    let banded = |chart: Chart, label: &str, measure: usize, style: Style| {
        let at = |level: usize| of(&|bands: &Bands| bands.band(measure)[level]);
        chart
            .band("", x, &at(0), &at(2), style)
            .line(label, x, &at(1), style)
    };
    let velocity = Chart::new(axis(), Axis::new("θ̇₂ [rad/s]"))
        .title("median and 5 … 95 % band of the last third of each run");
    let velocity = banded(velocity, "highest", MAXIMUM, Style::series(1));
    let velocity = banded(velocity, "lowest", MINIMUM, Style::series(2));
    let single = |label: &str, measure: usize| {
        banded(
            Chart::new(axis(), Axis::new(label)),
            "",
            measure,
            Style::series(0),
        )
    };
    Figure::new(settings.title())
        .panel(260.0, probability)
        .panel(320.0, velocity)
        .row(
            230.0,
            vec![
                Box::new(single("frequency [Hz]", FREQUENCY)),
                Box::new(single("stick fraction", STICK_FRACTION)),
            ],
        )
}

fn at_one_place(settings: &Settings, rows: &[Vec<Point>], bands: &[Bands]) -> Figure {
    let points: Vec<&Point> = rows.iter().flatten().collect();
    let histogram = |label: &str, measure: usize| -> Box<dyn Panel> {
        let (_, of) = MEASURES[measure];
        let values: Vec<f64> = points.iter().map(|point| of(point)).collect();
        let mut chart = Chart::new(Axis::new(label), Axis::new("rigs")).histogram(
            "",
            &values,
            BINS,
            Style::series(0),
        );
        for level in bands.iter().flat_map(|bands| bands.band(measure)) {
            if level.is_finite() {
                chart = chart.vertical("", level, Style::reference());
            }
        }
        Box::new(chart)
    };
    let probability = bands
        .first()
        .map_or(f64::NAN, |bands| bands.share(Motion::StickSlip).value());
    Figure::new(format!(
        "{}: stick-slip in {:.1} %",
        settings.title(),
        100.0 * probability
    ))
    .row(
        280.0,
        vec![
            histogram("half amplitude of θ̇₂ [rad/s]", HALF_AMPLITUDE),
            histogram("highest θ̇₂ [rad/s]", MAXIMUM),
        ],
    )
    .row(
        280.0,
        vec![
            histogram("frequency [Hz]", FREQUENCY),
            histogram("stick fraction", STICK_FRACTION),
        ],
    )
}
