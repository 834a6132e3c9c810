//! Residual torques over every coordinate, the one that tells most first.

use std::f64::consts::TAU;

use super::figures::{Scaling, after, before, windows};
use super::markup::capital;
use crate::analysis::spectrum::Spectrum;
use crate::diagnose::console::number;
use crate::diagnose::finding::Finding;
use crate::diagnose::residual_torque::ResidualTorque;
use crate::diagnose::show::Comparison;
use crate::plot::{Axis, Chart, Figure, Marker, Panel, Style};

/// Bins of a residual torque over a coordinate.
const BINS: usize = 24;
/// Height of a plot that decides, and of one beside others [px].
const LARGE: f64 = 330.0;
const SMALL: f64 = 250.0;

/// A coordinate of residual torques.
type Coordinate = fn(&ResidualTorque) -> f64;

/// The residual torque over one coordinate.
pub struct Residual {
    /// What findings call the coordinate; empty where they have none such.
    coordinate: &'static str,
    panel: Box<dyn Panel>,
}

/// What decides, with its caption: the residual torque over the coordinate in which a finding has most structure, and the held-out record
/// before and after. The others are left in `residuals`.
pub fn decisive(
    finding: &Finding,
    residuals: &mut Vec<Residual>,
    comparison: &Comparison,
    scaling: &Scaling,
) -> (Figure, String) {
    let mut significant = finding.structure.iter().filter(|place| place.significant);
    let at = significant.find_map(|place| {
        let is_it = |own: &Residual| own.coordinate == place.coordinate;
        residuals.iter().position(is_it)
    });
    let velocity =
        "the disc's velocity on the held-out record, each window restarted from its own start.";
    let Some(at) = at else {
        let figure = Figure::new("").panel(LARGE, windows(comparison, scaling));
        return (figure, capital(velocity));
    };
    let figure = Figure::new("")
        .row(LARGE, vec![residuals.remove(at).panel])
        .panel(LARGE, windows(comparison, scaling));
    let caption = format!(
        "Above: the torque that would have to be added for the model to follow the records it learned from, in pieces of {} s, over the \
         coordinate that tells most. Dots: single pieces before. Lines: means of bins before and after. Below: {velocity}",
        number(scaling.piece())
    );
    (figure, caption)
}

/// The residuals in pairs.
pub fn others(residuals: Vec<Residual>) -> Figure {
    let mut figure = Figure::new("");
    let mut panels = residuals.into_iter().map(|own| own.panel);
    while let Some(left) = panels.next() {
        let pair = std::iter::once(left).chain(panels.next());
        figure = figure.row(SMALL, pair.collect());
    }
    figure
}

/// Residual torques of both models over every coordinate.
pub fn residuals(
    before_all: &[ResidualTorque],
    after_all: &[ResidualTorque],
    scaling: &Scaling,
) -> Vec<Residual> {
    let sliding = |all: &[ResidualTorque]| -> Vec<ResidualTorque> {
        all.iter().filter(|r| r.place.sliding).copied().collect()
    };
    let (old, new) = (sliding(before_all), sliding(after_all));
    let mut all: Vec<Residual> = Vec::new();
    let mut add = |coordinate: &'static str, chart: Chart| {
        all.push(Residual {
            coordinate,
            panel: Box::new(chart),
        });
    };
    let on_disc: [(&'static str, &str, &str, Coordinate); 7] = [
        ("time", "time [s]", "over time", |r| r.place.time),
        (
            "speed",
            "disc velocity θ̇₂ [rad/s]",
            "over velocity",
            |r| r.place.speed,
        ),
        ("alpha", "α [rad]", "over the phase-plane angle", |r| {
            r.place.alpha
        }),
        (
            "disc_angle",
            "disc angle θ₂ modulo 2π [rad]",
            "over the disc's angle",
            |r| r.place.disc_angle.rem_euclid(TAU),
        ),
        (
            "normal_force",
            "normal force N₂ [N]",
            "over the normal force",
            |r| r.place.normal_force,
        ),
        (
            "acceleration",
            "disc acceleration [rad/s²]",
            "over the acceleration",
            |r| r.place.acceleration,
        ),
        (
            "twist",
            "twist of the shaft θ₂ − θ₃ [rad]",
            "over the twist",
            |r| r.place.twist,
        ),
    ];
    for (coordinate, label, title, of) in on_disc {
        add(coordinate, over(label, title, &old, &new, of, |r| r.disc));
    }
    add(
        "motor_angle",
        over(
            "motor angle η θ₃ modulo 2π [rad]",
            "torque on the gearbox output over the motor's angle",
            before_all,
            after_all,
            |r| (scaling.ratio * r.place.gear_angle).rem_euclid(TAU),
            |r| r.motor,
        ),
    );
    add(
        "motor_speed_and_current",
        over(
            "velocity of the gearbox output θ̇₃ [rad/s]",
            "torque on the gearbox output over its velocity",
            before_all,
            after_all,
            |r| r.place.gear_speed,
            |r| r.motor,
        ),
    );
    add("frequency", frequencies(before_all, after_all, scaling));
    add(
        "",
        Chart::new(
            Axis::new("order of the disc's angle"),
            Axis::new("amplitude [N m]"),
        )
        .title("orders")
        .line("before", &orders(), &order_amplitudes(&old), before())
        .line("after", &orders(), &order_amplitudes(&new), after()),
    );
    all
}

fn scatter() -> Style {
    Style {
        colour: "#e8b9a2",
        ..Style::series(1)
    }
    .wide(0.0)
}

/// Single values before, and means of bins before and after.
fn over(
    label: &str,
    title: &str,
    old: &[ResidualTorque],
    new: &[ResidualTorque],
    coordinate: impl Fn(&ResidualTorque) -> f64,
    torque: impl Fn(&ResidualTorque) -> f64,
) -> Chart {
    let series = |all: &[ResidualTorque]| -> (Vec<f64>, Vec<f64>) {
        (
            all.iter().map(&coordinate).collect(),
            all.iter().map(&torque).collect(),
        )
    };
    let (x, y) = series(old);
    let (new_x, new_y) = series(new);
    let (middle, mean) = binned(&x, &y);
    let (new_middle, new_mean) = binned(&new_x, &new_y);
    Chart::new(Axis::new(label), Axis::new("residual torque [N m]"))
        .title(title)
        .points("", &x, &y, Marker::Dot, scatter())
        .horizontal("", 0.0, Style::reference())
        .line("before", &middle, &mean, before().wide(2.0))
        .line("after", &new_middle, &new_mean, after().wide(2.0))
        // A bin between empty ones makes no line.
        .points("", &middle, &mean, Marker::Dot, before().wide(0.5))
        .points("", &new_middle, &new_mean, Marker::Dot, after().wide(0.5))
}

/// Middles and means of bins of equal width that hold at least three values; the line breaks over those that do not.
fn binned(x: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (low, high) = x.iter().fold((f64::MAX, f64::MIN), |(low, high), v| {
        (low.min(*v), high.max(*v))
    });
    if high <= low {
        return (Vec::new(), Vec::new());
    }
    let width = (high - low) / BINS as f64;
    let mut bins = vec![(0.0, 0_usize); BINS];
    for (x, y) in x.iter().zip(y) {
        let bin = &mut bins[(((x - low) / width) as usize).min(BINS - 1)];
        bin.0 += y;
        bin.1 += 1;
    }
    bins.iter()
        .enumerate()
        .map(|(j, (sum, count))| {
            let mean = if *count >= 3 {
                sum / *count as f64
            } else {
                f64::NAN
            };
            (low + (j as f64 + 0.5) * width, mean)
        })
        .unzip()
}

fn orders() -> Vec<f64> {
    (2..=40).map(|j| 0.1 * f64::from(j)).collect()
}

/// Amplitude of the disc torque's part at each order of the disc's angle.
fn order_amplitudes(all: &[ResidualTorque]) -> Vec<f64> {
    let mean = all.iter().map(|r| r.disc).sum::<f64>() / all.len().max(1) as f64;
    orders()
        .iter()
        .map(|order| {
            let (mut cosine, mut sine) = (0.0, 0.0);
            for r in all {
                let (s, c) = (order * r.place.disc_angle).sin_cos();
                cosine += (r.disc - mean) * c;
                sine += (r.disc - mean) * s;
            }
            2.0 * cosine.hypot(sine) / all.len().max(1) as f64
        })
        .collect()
}

fn frequencies(old: &[ResidualTorque], new: &[ResidualTorque], scaling: &Scaling) -> Chart {
    let spectrum = |all: &[ResidualTorque]| {
        let first_run: Vec<f64> = all
            .iter()
            .filter(|r| r.run == 0)
            .map(|r| if r.place.sliding { r.disc } else { 0.0 })
            .collect();
        Spectrum::new(&first_run, scaling.piece())
    };
    let mut chart = Chart::new(
        Axis::new("frequency [Hz]").range(0.0, scaling.highest_frequency()),
        Axis::new("amplitude [N m]"),
    )
    .title("frequencies, first record");
    for (label, all, style) in [("before", old, before()), ("after", new, after())] {
        if let Some(spectrum) = spectrum(all) {
            chart = chart.line(label, &spectrum.frequency, &spectrum.amplitude, style);
        }
    }
    chart
}
