//! The pictures of the report.

use std::f64::consts::{PI, TAU};

use inference::record::{CHANNELS, RawRecord, channel};
use inference::window::PIECE;
use stickslip::friction::acceleration_angle;

use crate::analysis::spectrum::Spectrum;
use crate::diagnose::finding::{Finding, LearnedTerm};
use crate::diagnose::residual_torque::ResidualTorque;
use crate::diagnose::show::{Comparison, Shown};
use crate::plot::{Axis, Bar, Bars, Chart, Figure, Marker, Panel, Style};

/// Bins of a residual torque over a coordinate.
const BINS: usize = 24;
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

    fn highest_frequency(&self) -> f64 {
        SHOWN_FREQUENCIES / (TAU * self.time)
    }
}

fn before() -> Style {
    Style::series(1)
}

fn after() -> Style {
    Style::series(0)
}

fn scatter() -> Style {
    Style {
        colour: "#e8b9a2",
        ..Style::series(1)
    }
    .wide(0.0)
}

/// Residual torques of both models over every coordinate.
pub fn residuals(
    before_all: &[ResidualTorque],
    after_all: &[ResidualTorque],
    scaling: &Scaling,
) -> Figure {
    let sliding = |all: &[ResidualTorque]| -> Vec<ResidualTorque> {
        all.iter().filter(|r| r.place.sliding).copied().collect()
    };
    let (old, new) = (sliding(before_all), sliding(after_all));
    let disc = |label: &str, title: &str, of: fn(&ResidualTorque) -> f64| -> Box<dyn Panel> {
        Box::new(over(label, title, &old, &new, of, |r| r.disc))
    };
    Figure::new("")
        .row(
            250.0,
            vec![
                disc("time [s]", "over time", |r| r.place.time),
                disc("disc velocity θ̇₂ [rad/s]", "over velocity", |r| {
                    r.place.speed
                }),
            ],
        )
        .row(
            250.0,
            vec![
                disc("α [rad]", "over the phase-plane angle", |r| r.place.alpha),
                disc(
                    "disc angle θ₂ modulo 2π [rad]",
                    "over the disc's angle",
                    |r| r.place.disc_angle.rem_euclid(TAU),
                ),
            ],
        )
        .row(
            250.0,
            vec![
                disc("normal force N₂ [N]", "over the normal force", |r| {
                    r.place.normal_force
                }),
                Box::new(over(
                    "motor angle η θ₃ modulo 2π [rad]",
                    "torque on the gearbox output over the motor's angle",
                    before_all,
                    after_all,
                    |r| (scaling.ratio * r.place.gear_angle).rem_euclid(TAU),
                    |r| r.motor,
                )),
            ],
        )
        .row(
            250.0,
            vec![
                Box::new(
                    Chart::new(
                        Axis::new("order of the disc's angle"),
                        Axis::new("amplitude [N m]"),
                    )
                    .title("orders")
                    .line("before", &orders(), &order_amplitudes(&old), before())
                    .line("after", &orders(), &order_amplitudes(&new), after()),
                ),
                Box::new(frequencies(before_all, after_all, scaling)),
            ],
        )
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

/// The held-out record's velocity: measured, restarted windows and free run.
pub fn time_series(comparison: &Comparison, scaling: &Scaling) -> Figure {
    let run = &comparison.judging.records[comparison.free_stretch];
    let last = run.time.last().copied().unwrap_or(0.0);
    let end = last.min(run.time[0] + SHOWN_PERIODS * TAU * scaling.time);
    let axis = || Axis::new("time [s]");
    let velocity = || Axis::new("θ̇₂ [rad/s]");
    let measured = measured_velocity(run);
    let mut windows = Chart::new(axis().range(run.time[0], end), velocity())
        .title("restarted windows, first seconds")
        .line("measured", measured.0, measured.1, Style::measured());
    let mut free = Chart::new(axis(), velocity())
        .title("free run from the record's start")
        .line("measured", measured.0, measured.1, Style::measured());
    for (label, shown, style) in [
        ("before", &comparison.before, before()),
        ("after", &comparison.after, after()),
    ] {
        let (time, values) = joined(comparison, shown);
        windows = windows.line(label, &time, &values, style);
        if !shown.free_run[1].is_empty() {
            free = free.line(label, &run.time, &shown.free_run[1], style);
        }
    }
    Figure::new("").panel(270.0, windows).panel(270.0, free)
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
    for (label, shown, style) in [
        ("before", &comparison.before, before()),
        ("after", &comparison.after, after()),
    ] {
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
