//! Section 5.3: sweeps of the full rig, Figs 5.5 to 5.8.

use std::f64::consts::TAU;

use stickslip::friction::{Law, Stribeck};
use stickslip::plant::Rig;

use crate::experiment::virtual_rig::{
    Operation, Run, SAMPLE_STEP, full_rig, peak_frequency, range, virtual_full_rig,
};
use crate::experiment::{ExperimentError, Findings, Row, Table, Verdict};
use crate::plot::{Axis, Chart, Figure, Space, Style};

/// (ω_ref [rpm], N1 [N], whether D1 sticks) of Figs 5.5 and 5.7; the first three are the speed sweep.
const CASES: [(f64, f64, bool); 5] = [
    (20.0, 15.0, false),
    (30.0, 15.0, true),
    (40.0, 15.0, false),
    (40.0, 30.0, false),
    (40.0, 40.0, true),
];
/// Sliding coefficients tried for the pin on D1, whose law is not published; the static one is 5/3 of it, as on D2.
const COEFFICIENTS: [f64; 6] = [0.03, 0.05, 0.08, 0.12, 0.17, 0.23];
/// Stribeck velocities tried [rad/s].
const STRIBECK_VELOCITIES: [f64; 4] = [0.6, 1.2, 2.4, 4.8];
const SHOWN: f64 = 15.0;

fn run(rig: &Rig<f64>, speed_rpm: f64, force: f64) -> Result<Run, ExperimentError> {
    Run::of(
        rig,
        &Operation {
            normal_force_1: force,
            ..Operation::steady(speed_rpm, 0.0)
        },
    )
}

fn with_law(rig: &Rig<f64>, mu_c: f64, omega_s: f64) -> Rig<f64> {
    let mut rig = *rig;
    if let Some(disc1) = &mut rig.disc1 {
        disc1.law = Law::Stribeck(Stribeck {
            mu_c,
            mu_s: mu_c / 0.6,
            omega_s,
        });
    }
    rig
}

/// Lowest natural frequency of two undamped discs behind a standing motor [Hz]; NaN for the reduced rig.
fn lowest_frequency(rig: &Rig<f64>) -> f64 {
    let Some(disc1) = &rig.disc1 else {
        return f64::NAN;
    };
    let (near, far) = (rig.shaft.stiffness, disc1.shaft.stiffness);
    let (j1, j2) = (disc1.disc.inertia, rig.disc.inertia);
    let (a, b) = (far / j1, (near + far) / j2);
    let square = 0.5 * (a + b) - (0.25 * (a - b).powi(2) + far * far / (j1 * j2)).sqrt();
    square.sqrt() / TAU
}

/// How many of the cases come out as printed.
fn matched(runs: &[Run]) -> usize {
    CASES
        .iter()
        .zip(runs)
        .filter(|((_, _, published), run)| (run.sticking_1 > 0.0) == *published)
        .count()
}

fn cases(rig: &Rig<f64>) -> Result<Vec<Run>, ExperimentError> {
    CASES
        .iter()
        .map(|(speed, force, _)| run(rig, *speed, *force))
        .collect()
}

/// What laws of Stribeck alone, without the virtual rig's flaws, make of the five cases.
fn without_flaws() -> Result<String, ExperimentError> {
    let rig = full_rig()?;
    let mut stopped = Vec::new();
    let (mut most, mut sticking) = (0, 0);
    for mu_c in COEFFICIENTS {
        for omega_s in STRIBECK_VELOCITIES {
            match cases(&with_law(&rig, mu_c, omega_s)) {
                Ok(runs) => {
                    most = most.max(matched(&runs));
                    sticking += usize::from(runs[1].sticking_1 > 0.0 && runs[0].sticking_1 == 0.0);
                }
                Err(ExperimentError::Integration(error)) => {
                    stopped.push(format!("μ_c = {mu_c}, ω_s = {omega_s}: {error}"));
                }
                Err(error) => return Err(error),
            }
        }
    }
    let mut words = format!(
        "Without unbalance and drag the best of {} laws of Stribeck (μ_s/μ_c = 5/3, μ_c {} … {}, ω_s {} … {} rad/s) meets {most} of 5 facts, and {sticking} of them stick at 30 but not at 20 rpm",
        COEFFICIENTS.len() * STRIBECK_VELOCITIES.len(),
        COEFFICIENTS[0],
        COEFFICIENTS[COEFFICIENTS.len() - 1],
        STRIBECK_VELOCITIES[0],
        STRIBECK_VELOCITIES[STRIBECK_VELOCITIES.len() - 1],
    );
    if !stopped.is_empty() {
        words.push_str(&format!(
            "; {} are left out because a run stopped: {}",
            stopped.len(),
            stopped.join("; ")
        ));
    }
    Ok(words)
}

/// Figs 5.5 to 5.8.
pub fn sweeps() -> Result<Findings, ExperimentError> {
    let rig = virtual_full_rig()?;
    let runs = cases(&rig)?;
    let mut findings = Findings::default();
    let mut figure = Figure::new("Full rig, virtual (Figs 5.5, 5.7)");
    for ((speed, force, published), run) in CASES.iter().zip(&runs) {
        let (low, high) = range(&run.omega1);
        let sticks = run.sticking_1 > 0.0;
        findings.rows.push(Row::statement(
            &format!("{speed} rpm, N₁ = {force} N"),
            if *published {
                "D1 sticks"
            } else {
                "D1 does not stick"
            },
            format!(
                "{}, {:.3} Hz, {low:.2} … {high:.2} rad/s",
                if sticks { "sticks" } else { "does not stick" },
                peak_frequency(&run.omega1, SAMPLE_STEP)
            ),
            if sticks == *published {
                Verdict::ReproducedWith(
                    "the full virtual rig, which is calibrated to it".to_owned(),
                )
            } else {
                Verdict::Open("the full virtual rig does not do it".to_owned())
            },
        ));
        let shown = (SHOWN / SAMPLE_STEP) as usize;
        figure = figure.panel(
            190.0,
            Chart::new(Axis::new("time [s]"), Axis::new("velocity [rad/s]"))
                .title(format!("{speed} rpm, N₁ = {force} N"))
                .line(
                    "θ̇₁",
                    &run.time[..shown],
                    &run.omega1[..shown],
                    Style::model(),
                )
                .line(
                    "θ̇₃",
                    &run.time[..shown],
                    &run.omega3[..shown],
                    Style::series(1),
                ),
        );
    }
    if let Some(row) = findings.rows.first_mut() {
        row.remark = format!(
            "The law of the pin on D1 is not published. {}. Once per revolution is 0.333, 0.5, 0.667 Hz at 20, 30, 40 rpm, and the rig's lowest natural frequency {:.3} Hz: an unbalance drives it most at 30 rpm. Settings: sec-5.3-virtual-rig",
            without_flaws()?,
            lowest_frequency(&rig)
        );
    }
    let mut columns = vec![("time [s]".to_owned(), runs[0].time.clone())];
    for ((speed, force, _), run) in CASES.iter().zip(&runs) {
        let label = format!("{speed} rpm {force} N");
        columns.push((format!("{label}: omega1 [rad/s]"), run.omega1.clone()));
        columns.push((format!("{label}: omega3 [rad/s]"), run.omega3.clone()));
    }
    findings.tables.push(Table {
        name: "sweeps".to_owned(),
        columns,
    });
    findings.picture("fig-5.5", "Full rig", figure);
    for (name, title, axis, chosen) in [
        (
            "fig-5.6",
            "Phase portraits at N₁ = 15 N (Fig. 5.6)",
            "ω_ref [rpm]",
            [0, 1, 2],
        ),
        (
            "fig-5.8",
            "Phase portraits at 40 rpm (Fig. 5.8)",
            "N₁ [N]",
            [2, 3, 4],
        ),
    ] {
        let mut space = Space::new(
            Axis::new(axis),
            Axis::new("θ₃ − θ₁ [rad]"),
            Axis::new("θ̇₁ [rad/s]"),
        );
        let mut named = Vec::new();
        for index in chosen {
            let run = &runs[index];
            let value = if name == "fig-5.6" {
                CASES[index].0
            } else {
                CASES[index].1
            };
            let (words, style) = if CASES[index].2 {
                ("published: sticks", Style::model())
            } else {
                ("published: does not stick", Style::series(1).solid())
            };
            let points = (0..(SHOWN / SAMPLE_STEP) as usize)
                .map(|sample| {
                    [
                        value,
                        run.theta3[sample] - run.theta1[sample],
                        run.omega1[sample],
                    ]
                })
                .collect();
            // One entry of the legend for each kind.
            let first = !named.contains(&words);
            named.push(words);
            space = space.curve(if first { words } else { "" }, points, style.wide(1.0));
        }
        findings.picture(name, title, Figure::new(title).panel(520.0, space));
    }
    Ok(findings)
}
