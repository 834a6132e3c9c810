//! Draws every kind of panel; with the environment variable `GALLERY` set to a directory the pictures stay there.

use std::f64::consts::TAU;
use std::path::PathBuf;

use workbench::plot::{Axis, Bar, Bars, Chart, Figure, HeatMap, Marker, Space, Style, boundary};

fn curves() -> Figure {
    let time: Vec<f64> = (0..2000).map(|index| f64::from(index) * 0.01).collect();
    let wave = |shift: f64| {
        time.iter()
            .map(|t| 6.0 + 6.0 * (TAU * 0.753 * t + shift).sin())
            .collect::<Vec<_>>()
    };
    let velocity = Chart::new(Axis::new("time [s]"), Axis::new("velocity [rad/s]"))
        .title("θ̇₂ and θ̇₃")
        .line("measured", &time, &wave(0.2), Style::measured())
        .line("model θ̇₂", &time, &wave(0.0), Style::model())
        .line("model θ̇₃", &time, &wave(1.2), Style::series(1))
        .band(
            "95 % interval",
            &time,
            &wave(0.0),
            &wave(0.4),
            Style::series(2),
        );
    let histogram = Chart::new(Axis::new("velocity [rad/s]"), Axis::new("samples"))
        .histogram("model", &wave(0.0), 24, Style::series(2))
        .vertical("ω_ref", 5.76, Style::reference());
    let steps = [1e-2, 1e-4, 1e-6, 1e-8];
    let diagram = Chart::new(
        Axis::new("error [rad]").logarithmic(),
        Axis::new("wall time [s]").logarithmic(),
    )
    .line("ours", &steps, &[1e-4, 2e-4, 3e-4, 5e-4], Style::series(0))
    .points(
        "CVODE",
        &steps,
        &[5e-3, 1e-2, 2.5e-2, 7e-2],
        Marker::Ring,
        Style::series(1),
    )
    .intervals("spread", &[(1e-3, 2e-3, 1e-3, 4e-3)], Style::series(3))
    .published("published", &[1e-5], &[1e-2]);
    Figure::new("Curves")
        .panel(300.0, velocity)
        .row(280.0, vec![Box::new(histogram), Box::new(diagram)])
}

fn bars() -> Figure {
    let bar = |name: &str, value: f64, stressed| Bar {
        name: name.to_owned(),
        value,
        interval: Some((value - 0.05, value + 0.08)),
        stressed,
    };
    let bars = Bars::new(
        Axis::new("share of the window loss explained"),
        vec![
            bar("normal_force_wobble", 0.71, true),
            bar("bearing_friction", 0.22, false),
            bar("unbalance", 0.03, false),
        ],
    )
    .title("Candidates")
    .limit("null of the maximum, 95 %", 0.12);
    let height = bars.natural_height();
    Figure::new("Bars").panel(height, bars)
}

fn heat_map() -> Figure {
    let speeds: Vec<f64> = (5..=60).map(f64::from).collect();
    let forces: Vec<f64> = (0..=70).map(f64::from).collect();
    let value = |column: usize, row: usize| (forces[row] / 70.0) * (1.0 - speeds[column] / 90.0);
    let values: Vec<Vec<f64>> = (0..forces.len())
        .map(|row| (0..speeds.len()).map(|column| value(column, row)).collect())
        .collect();
    let edge = boundary(&speeds, &forces, 0.3, value);
    let axes = || {
        (
            (Axis::new("speed [rpm]"), speeds.clone()),
            (Axis::new("normal force [N]"), forces.clone()),
        )
    };
    let ((x, y), (x2, y2)) = (axes(), axes());
    let classes: Vec<Vec<f64>> = values
        .iter()
        .map(|row| row.iter().map(|value| (value * 5.0).floor()).collect())
        .collect();
    let names = [
        "no_motion",
        "sticking",
        "stick_slip",
        "oscillation",
        "steady",
    ];
    Figure::new("Map").row(
        420.0,
        vec![
            Box::new(
                HeatMap::continuous(x, y, values, "stick fraction").boundary("stick-slip", edge),
            ),
            Box::new(HeatMap::classes(x2, y2, classes, &names)),
        ],
    )
}

fn space() -> Figure {
    let mut stack = Space::new(
        Axis::new("N₂ [N]"),
        Axis::new("θ₃ − θ₂ [rad]"),
        Axis::new("θ̇₂ [rad/s]"),
    )
    .title("Phase portraits");
    for force in 0..6 {
        let (force, size) = (f64::from(force) * 10.0, 1.0 + f64::from(force));
        let loop_points = (0..=100).map(|index| TAU * f64::from(index) / 100.0);
        let points = loop_points
            .map(|angle| [force, 2.0 * angle.cos(), 5.0 + size * angle.sin()])
            .collect();
        stack = stack.curve("", points, Style::model());
    }
    let velocity: Vec<f64> = (-20..=20).map(|index| f64::from(index) * 0.5).collect();
    let acceleration: Vec<f64> = (-20..=20).map(|index| f64::from(index) * 3.0).collect();
    let torque: Vec<Vec<f64>> = acceleration
        .iter()
        .map(|a| {
            velocity
                .iter()
                .map(|v| 0.5 * (v / 1.5).tanh() + 0.1 * (a / 30.0).sin())
                .collect()
        })
        .collect();
    let surface = Space::new(
        Axis::new("θ̇₂ [rad/s]"),
        Axis::new("θ̈₂ [rad/s²]"),
        Axis::new("T_f [N m]"),
    )
    .surface(&velocity, &acceleration, &torque);
    Figure::new("Space").row(480.0, vec![Box::new(stack), Box::new(surface)])
}

#[test]
fn every_kind_of_panel_becomes_svg_and_png() {
    let place = tempfile::tempdir().unwrap();
    let directory =
        std::env::var_os("GALLERY").map_or_else(|| place.path().to_owned(), PathBuf::from);
    for (name, figure) in [
        ("curves", curves()),
        ("bars", bars()),
        ("map", heat_map()),
        ("space", space()),
    ] {
        figure.write(&directory.join(name)).unwrap();
        let svg = std::fs::read_to_string(directory.join(format!("{name}.svg"))).unwrap();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
        let png = std::fs::read(directory.join(format!("{name}.png"))).unwrap();
        assert_eq!(&png[1..4], b"PNG", "{name}");
    }
}
