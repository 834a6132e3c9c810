//! The picture of a map: heat maps over two parameters, a bifurcation diagram over one.

use stickslip::integrator::Simulation;
use stickslip::plant::{STATES, index};

use super::point::Point;
use super::settings::{Settings, Varied};
use crate::analysis::motion::Motion;
use crate::plot::{Axis, Chart, Figure, HeatMap, Marker, Piece, Space, Style, View, boundary};

/// Phase portraits in a stack, at most.
const PORTRAITS: usize = 21;
/// Part of the end of a run that a portrait shows [s], with the time between its points [s].
const PORTRAIT: (f64, f64) = (6.0, 0.005);

/// The picture that suits the number of parameters.
pub(super) fn picture(settings: &Settings, rows: &[Vec<Point>]) -> anyhow::Result<Figure> {
    match settings.column_axis() {
        Some(across) => Ok(over_two(settings, across, rows)),
        None => over_one(settings, rows),
    }
}

fn over_two(settings: &Settings, across: &Varied, rows: &[Vec<Point>]) -> Figure {
    let upward = settings.row_axis();
    let grid = |value: &dyn Fn(&Point) -> f64| -> Vec<Vec<f64>> {
        rows.iter()
            .map(|points| points.iter().map(value).collect())
            .collect()
    };
    let sticks = |column: usize, row: usize| match rows[row][column].motion {
        Some(motion) => f64::from(motion == Motion::StickSlip),
        None => f64::NAN,
    };
    let edge: Vec<Piece> = boundary(&across.values, &upward.values, 0.5, sticks);
    let axes = || {
        let axis = |varied: &Varied| (Axis::new(varied.label.clone()), varied.values.clone());
        (axis(across), axis(upward))
    };
    let continuous = |title: &str, label: &str, value: &dyn Fn(&Point) -> f64| {
        let (x, y) = axes();
        HeatMap::continuous(x, y, grid(value), label)
            .title(title)
            .boundary("boundary of stick-slip", edge.clone())
    };
    let (x, y) = axes();
    let names: Vec<String> = Motion::ALL
        .iter()
        .map(|motion| motion.name().replace('_', " "))
        .collect();
    let kinds = grid(&|point| {
        point
            .motion
            .map_or(f64::NAN, |motion| motion.index() as f64)
    });
    let kinds = HeatMap::classes(x, y, kinds, &names)
        .title("kind of motion of disc D2")
        .boundary("boundary of stick-slip", edge.clone());
    Figure::new(settings.title())
        .wide(1120.0)
        .row(
            400.0,
            vec![
                Box::new(kinds),
                Box::new(continuous(
                    "half amplitude of the velocity",
                    "half amplitude [rad/s]",
                    &Point::half_amplitude,
                )),
            ],
        )
        .row(
            400.0,
            vec![
                Box::new(continuous(
                    "share of the time stuck",
                    "stick fraction",
                    &|point| point.stick_fraction,
                )),
                Box::new(continuous("frequency", "frequency [Hz]", &|point| {
                    point.frequency
                })),
            ],
        )
}

fn over_one(settings: &Settings, rows: &[Vec<Point>]) -> anyhow::Result<Figure> {
    let axis = settings.row_axis();
    let points: Vec<&Point> = rows.iter().flatten().collect();
    let x = || Axis::new(axis.label.clone());
    let of = |value: &dyn Fn(&Point) -> f64| {
        points
            .iter()
            .map(|point| value(point))
            .collect::<Vec<f64>>()
    };
    let sticking = |wanted: bool| {
        let (mut parameter, mut velocity) = (Vec::new(), Vec::new());
        for (point, value) in points.iter().zip(&axis.values) {
            let rests = matches!(
                point.motion,
                Some(Motion::StickSlip | Motion::Sticking | Motion::NoMotion)
            );
            if rests == wanted {
                let ends = [point.minimum, point.maximum];
                parameter.extend(std::iter::repeat_n(
                    *value,
                    point.extrema.len() + ends.len(),
                ));
                velocity.extend(point.extrema.iter().chain(&ends));
            }
        }
        (parameter, velocity)
    };
    let ((stuck_x, stuck_y), (free_x, free_y)) = (sticking(true), sticking(false));
    let diagram = Chart::new(x(), Axis::new("extrema of θ̇₂ [rad/s]"))
        .title("bifurcation diagram, last third of each run")
        .points(
            "with sticking",
            &stuck_x,
            &stuck_y,
            Marker::Dot,
            Style::series(0).wide(-0.6),
        )
        .points(
            "without",
            &free_x,
            &free_y,
            Marker::Ring,
            Style::series(1).wide(-0.2),
        );
    let fraction = Chart::new(x(), Axis::new("stick fraction").range(-0.03, 1.03)).line(
        "",
        &axis.values,
        &of(&|point| point.stick_fraction),
        Style::series(0),
    );
    let frequency = Chart::new(x(), Axis::new("frequency [Hz]")).line(
        "",
        &axis.values,
        &of(&|point| point.frequency),
        Style::series(0),
    );
    Ok(Figure::new(settings.title())
        .panel(320.0, diagram)
        .row(230.0, vec![Box::new(fraction), Box::new(frequency)])
        .panel(480.0, portraits(settings)?))
}

/// Phase portraits stacked along the parameter.
fn portraits(settings: &Settings) -> anyhow::Result<Space> {
    let axis = settings.row_axis();
    let mut space = Space::new(
        Axis::new(axis.label.clone()),
        Axis::new("θ₃ − θ₂ [rad]"),
        Axis::new("θ̇₂ [rad/s]"),
    )
    .title("phase portraits along the parameter")
    .view(View {
        proportions: [1.7, 0.8, 0.7],
        ..View::default()
    });
    let stride = axis.values.len().div_ceil(PORTRAITS);
    for row in (0..axis.values.len()).step_by(stride) {
        // A run that fails has a place in the table, not in the stack.
        let Ok((rig, inputs)) = settings.conditions(row, 0) else {
            continue;
        };
        let Ok(mut run) = Simulation::new(rig, settings.options(), 0.0, [0.0; STATES], inputs)
        else {
            continue;
        };
        let (length, step) = PORTRAIT;
        let steps = (length.min(settings.duration) / step) as usize;
        let mut curve = Vec::with_capacity(steps + 1);
        for index in 0..=steps {
            let time = settings.duration - (steps - index) as f64 * step;
            if run.advance_to(time).is_err() {
                break;
            }
            let twist =
                run.component_at(index::THETA3, time) - run.component_at(index::THETA, time);
            curve.push([
                axis.values[row],
                twist,
                run.component_at(index::OMEGA, time),
            ]);
        }
        space = space.curve(
            "",
            curve,
            Style::series(if (row / stride).is_multiple_of(2) {
                0
            } else {
                2
            })
            .solid()
            .wide(1.1),
        );
    }
    Ok(space)
}
