//! The work-precision plot as SVG: one panel per system, both axes logarithmic.

use std::fmt::Write as _;

use crate::measurement::time_at_error;
use crate::report::Findings;

const PANEL: f64 = 360.0;
const HEIGHT: f64 = 320.0;
const MARGIN: f64 = 62.0;
const TOP: f64 = 56.0;
const ERROR_DECADES: (f64, f64) = (-12.0, -1.0);
const COLOURS: [&str; 6] = [
    "#c0392b", "#2471a3", "#1e8449", "#b9770e", "#7d3c98", "#566573",
];

/// Maps decades of error and time [s] to a panel's coordinates.
struct Axes {
    left: f64,
    time_decades: (f64, f64),
}

impl Axes {
    fn x(&self, error: f64) -> f64 {
        let (low, high) = ERROR_DECADES;
        self.left + (error.log10().clamp(low, high) - low) / (high - low) * (PANEL - MARGIN - 12.0)
    }

    fn y(&self, seconds: f64) -> f64 {
        let (low, high) = self.time_decades;
        TOP + HEIGHT - (seconds.log10() - low) / (high - low) * HEIGHT
    }
}

fn time_decades(findings: &Findings) -> (f64, f64) {
    let logs = || findings.runs.iter().map(|r| r.seconds.log10());
    let (low, high) = (
        logs().fold(f64::INFINITY, f64::min),
        logs().fold(f64::NEG_INFINITY, f64::max),
    );
    (low.floor(), high.ceil().max(low.floor() + 1.0))
}

fn grid(svg: &mut String, axes: &Axes, labels: bool) {
    let (right, bottom) = (axes.x(10f64.powf(ERROR_DECADES.1)), TOP + HEIGHT);
    let mut decade = ERROR_DECADES.0;
    while decade <= ERROR_DECADES.1 {
        let x = axes.x(10f64.powf(decade));
        let _ = writeln!(
            svg,
            r##"<path d="M{x:.1} {TOP}V{bottom}" stroke="#e5e7e9"/>"##
        );
        if decade.rem_euclid(2.0) == 0.0 {
            let _ = writeln!(
                svg,
                r#"<text x="{x:.1}" y="{:.1}" text-anchor="middle">1e{decade}</text>"#,
                bottom + 16.0
            );
        }
        decade += 1.0;
    }
    decade = axes.time_decades.0;
    while decade <= axes.time_decades.1 {
        let y = axes.y(10f64.powf(decade));
        let _ = writeln!(
            svg,
            r##"<path d="M{:.1} {y:.1}H{right:.1}" stroke="#e5e7e9"/>"##,
            axes.left
        );
        if labels {
            let milliseconds = 10f64.powf(decade + 3.0);
            let _ = writeln!(
                svg,
                r#"<text x="{:.1}" y="{:.1}" text-anchor="end">{milliseconds}</text>"#,
                axes.left - 6.0,
                y + 4.0
            );
        }
        decade += 1.0;
    }
    let _ = writeln!(
        svg,
        r##"<rect x="{:.1}" y="{TOP}" width="{:.1}" height="{HEIGHT}" fill="none" stroke="#808b96"/>"##,
        axes.left,
        right - axes.left
    );
}

/// Draws dots for all runs and, per solver, the line of its fastest set-up at equal error.
fn panel(svg: &mut String, findings: &Findings, axes: &Axes, system: &str) {
    for (solver, colour) in findings.solvers().iter().zip(COLOURS.iter().cycle()) {
        let runs = findings.of(system, solver);
        for r in runs.iter().filter(|r| r.error.is_finite()) {
            let _ = writeln!(
                svg,
                r#"<circle cx="{:.1}" cy="{:.1}" r="2" fill="{colour}" fill-opacity="0.35"/>"#,
                axes.x(r.error),
                axes.y(r.seconds)
            );
        }
        let mut path = String::new();
        for quarter in -44..=-8 {
            let error = 10f64.powf(f64::from(quarter) / 4.0);
            if let Some((seconds, _)) = time_at_error(&runs, error) {
                let command = if path.is_empty() { 'M' } else { 'L' };
                let _ = write!(path, "{command}{:.1} {:.1}", axes.x(error), axes.y(seconds));
            }
        }
        if !path.is_empty() {
            let _ = writeln!(
                svg,
                r#"<path d="{path}" fill="none" stroke="{colour}" stroke-width="2"/>"#
            );
        }
    }
}

/// The whole picture.
#[must_use]
pub fn svg(findings: &Findings) -> String {
    let panels = findings.systems.len() as f64;
    let (width, height) = (MARGIN + PANEL * panels, TOP + HEIGHT + 70.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let time_decades = time_decades(findings);
    let mut left = MARGIN;
    for system in &findings.systems {
        let axes = Axes { left, time_decades };
        grid(&mut svg, &axes, true);
        panel(&mut svg, findings, &axes, system.key);
        let _ = writeln!(
            svg,
            r#"<text x="{left:.1}" y="{:.1}">({}) {}</text>"#,
            TOP - 10.0,
            system.key,
            short(system.title)
        );
        let _ = writeln!(
            svg,
            r#"<text x="{:.1}" y="{:.1}" text-anchor="middle">error of θ2 at 60 s [rad]</text>"#,
            left + (PANEL - MARGIN) / 2.0,
            TOP + HEIGHT + 34.0
        );
        left += PANEL;
    }
    let _ = writeln!(
        svg,
        r#"<text transform="translate(14 {:.1}) rotate(-90)" text-anchor="middle">processor time of the run [ms]</text>"#,
        TOP + HEIGHT / 2.0
    );
    let mut x = MARGIN;
    for (solver, colour) in findings.solvers().iter().zip(COLOURS.iter().cycle()) {
        let _ = writeln!(
            svg,
            r#"<path d="M{x:.1} 18h22" stroke="{colour}" stroke-width="3"/>"#
        );
        let _ = writeln!(svg, r#"<text x="{:.1}" y="22">{solver}</text>"#, x + 28.0);
        x += 50.0 + 8.0 * solver.chars().count() as f64;
    }
    svg.push_str("</svg>\n");
    svg
}

/// The part of a title before its numbers, which fits above a panel.
fn short(title: &str) -> String {
    title.split(", ").take(2).collect::<Vec<_>>().join(", ")
}
