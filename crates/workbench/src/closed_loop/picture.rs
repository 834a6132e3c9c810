//! The pictures of closed loops.

use super::run::Case;
use super::steps::Row;
use crate::analysis::motion::Motion;
use crate::map::Point;
use crate::plot::{Axis, Chart, Figure, HeatMap, Marker, Panel, Style, boundary};

/// Communication steps of which the motion is shown, at most.
const MOTIONS: usize = 4;
/// Part of the start of a run that is shown [s].
const SHOWN: f64 = 12.0;

/// Kinds of motion and amplitudes over speed and normal force, a column for each case.
pub(super) fn maps(
    cases: &[Case],
    speeds: &[f64],
    forces: &[f64],
    maps: &[&[Vec<Point>]],
) -> Figure {
    let names: Vec<String> = Motion::ALL
        .iter()
        .map(|motion| motion.name().replace('_', " "))
        .collect();
    let mut kinds: Vec<Box<dyn Panel>> = Vec::new();
    let mut amplitudes: Vec<Box<dyn Panel>> = Vec::new();
    for (case, map) in cases.iter().zip(maps) {
        let axes = || {
            let speed = (Axis::new("speed [rpm]"), speeds.to_vec());
            (speed, (Axis::new("normal force N₂ [N]"), forces.to_vec()))
        };
        let grid = |value: &dyn Fn(&Point) -> f64| -> Vec<Vec<f64>> {
            map.iter()
                .map(|points| points.iter().map(value).collect())
                .collect()
        };
        let sticks = |column: usize, row: usize| match map[row][column].motion {
            Some(motion) => f64::from(motion == Motion::StickSlip),
            None => f64::NAN,
        };
        let edge = boundary(speeds, forces, 0.5, sticks);
        let kind = |point: &Point| {
            point
                .motion
                .map_or(f64::NAN, |motion| motion.index() as f64)
        };
        let title = case.name().replace('_', " ");
        let (x, y) = axes();
        kinds.push(Box::new(
            HeatMap::classes(x, y, grid(&kind), &names)
                .title(title)
                .boundary("boundary of stick-slip", edge),
        ));
        let (x, y) = axes();
        amplitudes.push(Box::new(
            HeatMap::continuous(
                x,
                y,
                grid(&Point::half_amplitude),
                "half amplitude of θ̇₂ [rad/s]",
            )
            .range(0.0, 8.0),
        ));
    }
    Figure::new("Disc D2 at constant voltage and under control")
        .wide(560.0 * cases.len() as f64)
        .row(400.0, kinds)
        .row(400.0, amplitudes)
}

/// Range of the velocities and distance from the shortest step over the communication step, and some motions.
pub(super) fn steps(cases: &[Case], rows: &[Row]) -> Figure {
    let axis = || Axis::new("communication step [ms]").logarithmic();
    let mut figure =
        Figure::new("What the communication step does to the closed loop").wide(1120.0);
    for case in cases.iter().filter(|case| **case != Case::ConstantVoltage) {
        let own: Vec<&Row> = rows.iter().filter(|row| row.case == *case).collect();
        let over = |value: &dyn Fn(&Row) -> f64| -> Vec<f64> {
            own.iter().map(|row| value(row)).collect()
        };
        let x = over(&|row| 1e3 * row.step);
        let title = case.name().replace('_', " ");
        let ranges = Chart::new(axis(), Axis::new("velocity [rad/s]"))
            .title(format!("{title}: lowest and highest velocity, last third"))
            .line(
                "disc D2",
                &x,
                &over(&|row| row.disc.maximum),
                Style::series(0),
            )
            .line("", &x, &over(&|row| row.disc.minimum), Style::series(0))
            .line(
                "gearbox output",
                &x,
                &over(&|row| row.gearbox.maximum),
                Style::series(1),
            )
            .line("", &x, &over(&|row| row.gearbox.minimum), Style::series(1));
        let distance = Chart::new(axis(), Axis::new("difference [rad/s]").logarithmic())
            .title("difference of θ̇₂ from the shortest step, root mean square")
            .points(
                "",
                &x[1..],
                &over(&|row| row.difference)[1..],
                Marker::Dot,
                Style::series(0),
            );
        figure = figure.row(280.0, vec![Box::new(ranges), Box::new(distance)]);
        let mut motions = Chart::new(Axis::new("time [s]"), Axis::new("θ̇₂ [rad/s]"));
        let stride = own.len().div_ceil(MOTIONS);
        for (index, row) in own.iter().step_by(stride).enumerate() {
            let end = row.samples.time.partition_point(|time| *time <= SHOWN);
            motions = motions.line(
                format!("{} ms", 1e3 * row.step),
                &row.samples.time[..end],
                &row.samples.disc[..end],
                Style::series(index),
            );
        }
        figure = figure.panel(240.0, motions);
    }
    figure
}
