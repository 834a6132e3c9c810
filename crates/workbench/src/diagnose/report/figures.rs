//! The pictures of the report.

use std::f64::consts::{PI, TAU};

use inference::record::{CHANNELS, RawRecord, channel};
use inference::window::PIECE;
use stickslip::friction::acceleration_angle;

use crate::analysis::spectrum::Spectrum;
use crate::diagnose::finding::{Finding, LearnedTerm};
use crate::diagnose::residual_torque::ResidualTorque;
use crate::diagnose::show::{Comparison, Shown};
use crate::plot::{Axis, Bar, Bars, Chart, Figure, Marker, Style};

/// Candidates shown in the ranking.
const SHOWN_CANDIDATES: usize = 12;
/// Length of the stretch shown in the time series of windows, in natural periods of the disc on its shaft.
const SHOWN_PERIODS: f64 = 8.0;
/// Highest frequency shown, in natural frequencies.
const SHOWN_FREQUENCIES: f64 = 7.0;
/// Speed below which the disc counts as sticking, as a share of the record's.
const SLOW: f64 = 0.01;

/// What the pictures are scaled by, SI units.
#[derive(Debug, Clone, Copy)]
pub struct Scaling {
    /// A radian of the natural oscillation [s].
    pub time: f64,
    /// Ratio of the gearbox.
    pub ratio: f64,
    /// Speed [rad/s] and acceleration [rad/s²] that are the scales of the phase-plane angle: the same for all models and for
    /// the measured motion, as in the search for structure.
    pub angle: (f64, f64),
}

impl Scaling {
    /// That of a comparison of models of a rig with this gearbox.
    pub fn of(comparison: &Comparison, ratio: f64) -> Self {
        let (units, scales) = (&comparison.judging.units, &comparison.judging.data.scales);
        Self {
            time: units.time,
            ratio,
            angle: (
                0.5 * scales.speed / units.time,
                scales.acceleration / units.time.powi(2),
            ),
        }
    }

    /// Length of the pieces of residual torques [s].
    pub fn piece(&self) -> f64 {
        PIECE * self.time
    }

    pub(super) fn highest_frequency(&self) -> f64 {
        SHOWN_FREQUENCIES / (TAU * self.time)
    }
}

pub(super) fn before() -> Style {
    Style::series(1)
}

pub(super) fn after() -> Style {
    Style::series(0)
}

/// What each candidate gains.
pub fn ranking(finding: &Finding) -> Figure {
    let bars: Vec<Bar> = finding
        .ranking
        .iter()
        .take(SHOWN_CANDIDATES)
        .map(|ranked| Bar {
            name: ranked.name.replace('_', " "),
            value: ranked.gain,
            interval: Some((ranked.interval95[0], ranked.interval95[1])),
            stressed: ranked
                .name
                .split(" + ")
                .all(|name| finding.effects.iter().any(|effect| effect.name == name)),
        })
        .collect();
    let bars = Bars::new(
        Axis::new("gain in ln likelihood on windows not fitted to"),
        bars,
    );
    let height = bars.natural_height();
    Figure::new("").panel(height, bars)
}

/// A learned function with its intervals.
pub fn learned(term: &LearnedTerm) -> Figure {
    let (low, high): (Vec<f64>, Vec<f64>) = term.interval95.iter().map(|[l, h]| (*l, *h)).unzip();
    let x = format!(
        "{} [{}]",
        term.coordinate.replace('_', " "),
        term.coordinate_unit
    );
    let chart = Chart::new(Axis::new(x), Axis::new(format!("term [{}]", term.unit)))
        .band("95 %", &term.knots, &low, &high, after())
        .line("learned", &term.knots, &term.values, after())
        .horizontal("", 0.0, Style::reference());
    Figure::new("").panel(260.0, chart)
}

/// The held-out record's velocity: measured, and in windows that are restarted.
pub(super) fn windows(comparison: &Comparison, scaling: &Scaling) -> Chart {
    let run = &comparison.judging.records[comparison.free_stretch];
    let last = run.time.last().copied().unwrap_or(0.0);
    let end = last.min(run.time[0] + SHOWN_PERIODS * TAU * scaling.time);
    let axis = Axis::new("time [s]").range(run.time[0], end);
    let measured = measured_velocity(run);
    let mut chart = Chart::new(axis, Axis::new("θ̇₂ [rad/s]"))
        .title("held-out record, restarted windows, first seconds")
        .line("measured", measured.0, measured.1, Style::measured());
    for (label, shown, style) in both(comparison) {
        let (time, values) = joined(comparison, shown);
        chart = chart.line(label, &time, &values, style);
    }
    chart
}

/// The held-out record's velocity: measured, and in one run.
pub fn free_run(comparison: &Comparison) -> Figure {
    let run = &comparison.judging.records[comparison.free_stretch];
    let measured = measured_velocity(run);
    let mut chart = Chart::new(Axis::new("time [s]"), Axis::new("θ̇₂ [rad/s]"))
        .title("free run from the record's start")
        .line("measured", measured.0, measured.1, Style::measured());
    for (label, shown, style) in both(comparison) {
        if !shown.free_run[1].is_empty() {
            chart = chart.line(label, &run.time, &shown.free_run[1], style);
        }
    }
    Figure::new("").panel(270.0, chart)
}

fn both(comparison: &Comparison) -> [(&'static str, &Shown, Style); 2] {
    [
        ("before", &comparison.before, before()),
        ("after", &comparison.after, after()),
    ]
}

/// Times and the disc's velocity as measured; nothing where it was not.
fn measured_velocity(run: &RawRecord) -> (&[f64], &[f64]) {
    let velocity = &run.readings[channel::OMEGA];
    (&run.time[..velocity.len()], velocity)
}

/// Velocities of all windows of the free run's stretch, with breaks between the windows.
fn joined(comparison: &Comparison, shown: &Shown) -> (Vec<f64>, Vec<f64>) {
    let (mut time, mut values) = (Vec::new(), Vec::new());
    for (window, course) in comparison.judging.data.windows.iter().zip(&shown.windows) {
        let Some(course) = course else { continue };
        if window.run != comparison.free_stretch {
            continue;
        }
        time.extend(&comparison.judging.records[window.run].time[window.first..=window.last]);
        values.extend(&course.values[1]);
        time.push(f64::NAN);
        values.push(f64::NAN);
    }
    (time, values)
}

/// Phase portrait and friction characteristics on the held-out record; `measured` holds the amended model's residual
/// torques there.
pub fn portraits(
    comparison: &Comparison,
    measured: &[ResidualTorque],
    scaling: &Scaling,
) -> Figure {
    let run = &comparison.judging.records[comparison.free_stretch];
    let settled = run.time.len() / 2;
    let twist = |channels: &[Vec<f64>; CHANNELS]| -> Vec<f64> {
        channels[2]
            .iter()
            .zip(&channels[0])
            .skip(settled)
            .map(|(output, disc)| output - disc)
            .collect()
    };
    let mut portrait = Chart::new(Axis::new("θ₃ − θ₂ [rad]"), Axis::new("θ̇₂ [rad/s]"))
        .title("phase portrait, second half of the free run");
    let shown = twist(&run.readings);
    if let Some(speed) = run.readings[1].get(settled..).filter(|_| !shown.is_empty()) {
        portrait = portrait.line("measured", &shown, speed, Style::measured());
    }
    let mut velocity = Chart::new(Axis::new("θ̇₂ [rad/s]"), Axis::new("T_f [N m]"))
        .title("friction torque over velocity");
    let mut angle = Chart::new(
        Axis::new("α [rad]").range(-PI, PI),
        Axis::new("T_f sign θ̇₂ [N m]"),
    )
    .title("friction torque over the phase-plane angle");
    let found = measured_friction(measured);
    let grey = Style::measured().wide(0.8);
    velocity = velocity.points("measured", &found.speed, &found.friction, Marker::Dot, grey);
    angle = angle.points("measured", &found.alpha, &found.along, Marker::Dot, grey);
    for (label, shown, style) in both(comparison) {
        if !shown.free_run[1].is_empty() {
            portrait = portrait.line(
                label,
                &twist(&shown.free_run),
                &shown.free_run[1][settled..],
                style,
            );
        }
        let characteristic = characteristic(comparison, shown, scaling);
        let dots = style.wide(0.0);
        velocity = velocity.points(
            label,
            &characteristic.speed,
            &characteristic.friction,
            Marker::Dot,
            dots,
        );
        angle = angle.points(
            label,
            &characteristic.alpha,
            &characteristic.along,
            Marker::Dot,
            dots,
        );
    }
    Figure::new("")
        .panel(340.0, portrait)
        .row(320.0, vec![Box::new(velocity), Box::new(angle)])
}

struct Characteristic {
    speed: Vec<f64>,
    friction: Vec<f64>,
    alpha: Vec<f64>,
    along: Vec<f64>,
}

/// Friction torque that the records show where the disc slides: the model's less the torque that it lacks.
fn measured_friction(residuals: &[ResidualTorque]) -> Characteristic {
    let sliding = || residuals.iter().filter(|r| r.place.sliding);
    let along = |r: &ResidualTorque| r.place.friction - r.place.speed.signum() * r.disc;
    Characteristic {
        speed: sliding().map(|r| r.place.speed).collect(),
        friction: sliding()
            .map(|r| r.place.speed.signum() * along(r))
            .collect(),
        alpha: sliding().map(|r| r.place.alpha).collect(),
        along: sliding().map(along).collect(),
    }
}

/// Friction torque wherever the disc slides in the restarted windows.
fn characteristic(comparison: &Comparison, shown: &Shown, scaling: &Scaling) -> Characteristic {
    let mut found = Characteristic {
        speed: vec![],
        friction: vec![],
        alpha: vec![],
        along: vec![],
    };
    for (window, course) in comparison.judging.data.windows.iter().zip(&shown.windows) {
        let Some(course) = course else { continue };
        let speed = &course.values[1];
        let time = &comparison.judging.records[window.run].time[window.first..];
        for j in (1..speed.len().saturating_sub(1)).step_by(2) {
            if speed[j].abs() < SLOW * scaling.angle.0 {
                continue;
            }
            let acceleration = (speed[j + 1] - speed[j - 1]) / (time[j + 1] - time[j - 1]);
            let sign = speed[j].signum();
            found.speed.push(speed[j]);
            found.friction.push(course.friction[j]);
            found.alpha.push(acceleration_angle(
                sign * speed[j],
                sign * acceleration,
                scaling.angle.0,
                scaling.angle.1,
            ));
            found.along.push(sign * course.friction[j]);
        }
    }
    found
}

/// Spectra of the disc's velocity.
pub fn spectra(comparison: &Comparison, scaling: &Scaling) -> Figure {
    let run: &RawRecord = &comparison.judging.records[comparison.free_stretch];
    let mut chart = Chart::new(
        Axis::new("frequency [Hz]").range(0.0, scaling.highest_frequency()),
        Axis::new("amplitude of θ̇₂ [rad/s]"),
    );
    let samples = run.time.len();
    let interval = (run.time[samples - 1] - run.time[0]) / (samples - 1) as f64;
    let series = [
        ("measured", &run.readings[1], Style::measured()),
        ("before", &comparison.before.free_run[1], before()),
        ("after", &comparison.after.free_run[1], after()),
    ];
    for (label, values, style) in series {
        if let Some(spectrum) = Spectrum::new(values, interval) {
            chart = chart.line(label, &spectrum.frequency, &spectrum.amplitude, style);
        }
    }
    Figure::new("").panel(280.0, chart)
}
