//! FMUs of amended models: they are there, run, and predict what the finding says they do.

use std::fs;
use std::path::Path;

use build_fmu::component::{self, Component};

/// Positions [rad] that an FMU gives at `times` [s] from this start, its inputs held at these values from each time on.
pub fn positions(
    fmu: &Path,
    start: [f64; 2],
    times: &[f64],
    inputs: &[(&str, Vec<f64>)],
) -> Vec<f64> {
    let mut component = component::open(fmu).unwrap();
    let place =
        |component: &dyn Component, name: &str| component::position(component, name).unwrap();
    let states = ["position", "velocity"].map(|name| place(&*component, name));
    let held: Vec<_> = inputs
        .iter()
        .map(|(name, values)| (place(&*component, name), values))
        .collect();
    let set = |component: &mut dyn Component, at: usize| {
        let values: Vec<_> = held
            .iter()
            .map(|(place, values)| (*place, values[at]))
            .collect();
        component.set(&values).unwrap();
    };
    let starts: Vec<_> = states.into_iter().zip(start).collect();
    component.set(&starts).unwrap();
    set(&mut *component, 0);
    component
        .initialise(times[0], times[times.len() - 1])
        .unwrap();
    let mut positions = Vec::new();
    for at in 0..times.len() {
        let mut value = [0.0];
        component.get(&states[..1], &mut value).unwrap();
        positions.push(value[0]);
        if at + 1 < times.len() {
            set(&mut *component, at);
            component.step(times[at], times[at + 1]).unwrap();
        }
    }
    positions
}

/// The columns of a record.
pub fn columns(file: &Path) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(file).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    (0..rows[0].len())
        .map(|column| rows.iter().map(|row| row[column]).collect())
        .collect()
}

/// Root mean square of the difference.
pub fn rmse(measured: &[f64], model: &[f64]) -> f64 {
    let squares = measured.iter().zip(model).map(|(y, m)| (y - m).powi(2));
    (squares.sum::<f64>() / measured.len() as f64).sqrt()
}

/// Root mean square of the difference between a record and the free run of an FMU from the start near `start` that fits it best.
pub fn best_rmse(fmu: &Path, start: [f64; 2], times: &[f64], measured: &[f64]) -> f64 {
    let run = |start| positions(fmu, start, times, &[]);
    let mut start = start;
    for _ in 0..2 {
        let course = run(start);
        let nudge = 1e-5;
        let slopes = [
            run([start[0] + nudge, start[1]]),
            run([start[0], start[1] + nudge]),
        ];
        let sum = |of: &dyn Fn(usize) -> f64| (0..times.len()).map(of).sum::<f64>();
        let slope = |at: usize, by: usize| (slopes[by][at] - course[at]) / nudge;
        let product = |a: usize, b: usize| sum(&|at| slope(at, a) * slope(at, b));
        let pull = |by: usize| sum(&|at| slope(at, by) * (measured[at] - course[at]));
        let (aa, ab, bb) = (product(0, 0), product(0, 1), product(1, 1));
        let determinant = aa * bb - ab * ab;
        start[0] += (bb * pull(0) - ab * pull(1)) / determinant;
        start[1] += (aa * pull(1) - ab * pull(0)) / determinant;
    }
    rmse(measured, &run(start))
}
