//! Section 3.4: three blocks in a row, Figs 3.7 and 3.8.

use stickslip::friction::Law;
use stickslip::integrator::Options;

use super::laws::{Levels, SHORTEST_STICK, SLIDING};
use crate::experiment::{ExperimentError, Findings, Row, Table, Verdict};
use crate::oscillator::{Drive, Motion, Oscillator};
use crate::plot::{Axis, Chart, Figure, Style};

const DAMPING_RATIO: f64 = 0.075;
const SPRING_LENGTH: f64 = 0.3;
const STRIBECK_VELOCITY: f64 = 0.025;
/// F₃ of case 1.
const CONSTANT_FORCE: f64 = 1.2;
/// A, B and ω_e of case 2.
const HARMONIC_FORCE: (f64, f64, f64) = (0.6, 1.1, 1.0);
const END: f64 = 100.0;
const STEP: f64 = 0.02;

/// Eqs 3-11 and 3-12 with M₁₂ = M₁₃ = M₂₃ = q = 1 (Table 3.3), from rest with unstressed springs.
fn motion(law: Law<f64>, force: Drive) -> Result<Motion, ExperimentError> {
    let mut train = Oscillator::new(3, law)?;
    let coupling = [[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]];
    train.stiffness = coupling;
    train.damping = coupling.map(|row| row.map(|entry| 2.0 * DAMPING_RATIO * entry));
    train.constant_force = [-SPRING_LENGTH, 0.0, SPRING_LENGTH];
    train.force = force;
    let initial = [0.0, SPRING_LENGTH, 2.0 * SPRING_LENGTH, 0.0, 0.0, 0.0, 0.0];
    Ok(Motion::of(&train, initial, END, STEP, Options::default())?)
}

fn motions(force: Drive, levels: Levels) -> Result<Vec<(&'static str, Motion)>, ExperimentError> {
    levels
        .published()
        .into_iter()
        .map(|(name, law)| Ok((name, motion(law, force)?)))
        .collect()
}

fn store(findings: &mut Findings, name: &str, title: &str, motions: &[(&str, Motion)]) {
    let mut position = Chart::new(Axis::new("τ [1]"), Axis::new("position X₁ [1]"));
    let mut figure_rows = Vec::new();
    let mut columns = vec![("tau".to_owned(), motions[0].1.time.clone())];
    for (index, (law, motion)) in motions.iter().enumerate() {
        let style = Style::series(index);
        position = position.line(*law, &motion.time, &motion.position, style);
        figure_rows.push(
            Chart::new(Axis::new("τ [1]"), Axis::new("velocity X₁′ [1]"))
                .title(*law)
                .line("", &motion.time, &motion.velocity, style.solid()),
        );
        columns.push((format!("{law}: X1"), motion.position.clone()));
        columns.push((format!("{law}: X1'"), motion.velocity.clone()));
    }
    let mut figure = Figure::new(title).panel(220.0, position);
    for chart in figure_rows {
        figure = figure.panel(180.0, chart);
    }
    findings.tables.push(Table {
        name: "locomotive".to_owned(),
        columns,
    });
    findings.picture(name, title, figure);
}

/// Phases of sticking after the start.
fn later_sticks(motion: &Motion, from: f64) -> usize {
    motion
        .sticking(SHORTEST_STICK)
        .iter()
        .filter(|span| span.from > from)
        .count()
}

/// Largest velocity over a stretch of time.
fn peak(motion: &Motion, from: f64, to: f64) -> f64 {
    motion
        .time
        .iter()
        .zip(&motion.velocity)
        .filter(|(time, _)| **time >= from && **time < to)
        .map(|(_, velocity)| *velocity)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Fig. 3.7.
pub fn constant_force() -> Result<Findings, ExperimentError> {
    let levels = Levels::printed(STRIBECK_VELOCITY);
    let motions = motions(Drive::constant(CONSTANT_FORCE), levels)?;
    let mut findings = Findings::default();
    for (name, motion) in &motions {
        let count = later_sticks(motion, 0.0);
        let stands = motion
            .sticking(SHORTEST_STICK)
            .last()
            .is_some_and(|span| span.to >= END);
        findings.rows.push(Row::statement(
            name,
            "no stick-slip",
            format!(
                "{count} phases of sticking after the start{}; velocity at τ = {END}: {:.3}",
                if stands { ", at rest at the end" } else { "" },
                motion.velocity.last().copied().unwrap_or(f64::NAN)
            ),
            Verdict::holds(count <= 1, "it sticks and slips"),
        ));
    }
    if let Some(row) = findings.rows.first_mut() {
        row.remark = "Initial state not given: at rest, springs unstressed. The mean force exceeds F_d, so that the loose train accelerates until it is stopped by nothing.".to_owned();
    }
    store(
        &mut findings,
        "fig-3.7",
        "Locomotive, constant force (Fig. 3.7)",
        &motions,
    );
    Ok(findings)
}

/// Fig. 3.8.
pub fn harmonic_force() -> Result<Findings, ExperimentError> {
    let (amplitude, mean, rate) = HARMONIC_FORCE;
    let levels = Levels::printed(STRIBECK_VELOCITY);
    let motions = motions(Drive::sine(mean, amplitude, rate), levels)?;
    let mut findings = Findings::default();
    for (name, motion) in &motions {
        let sticks = motion.sticking(SHORTEST_STICK);
        let later = later_sticks(motion, 0.0);
        let last = sticks.last().map_or(0.0, |span| span.to);
        let verdict = if later == 0 {
            Verdict::Open("no sticking after the start".to_owned())
        } else if last < 0.5 * END {
            Verdict::ReproducedWith(format!("sticking until τ = {last:.1} only"))
        } else {
            Verdict::Reproduced
        };
        findings.rows.push(
            Row::statement(
                name,
                "sticks and slips",
                format!("{later} phases of sticking after the start, the last until τ = {last:.1}"),
                verdict,
            )
            .remark(format!(
                "The mean force {mean} exceeds F_d = {SLIDING}: any loose train must run away in the end. How long Fig. 3.8 runs and from what state is not printed."
            )),
        );
    }
    let growth = |motion: &Motion| (peak(motion, 20.0, 40.0), peak(motion, 80.0, 100.0));
    let (early, late) = growth(&motions[0].1);
    findings.rows.push(Row::statement(
        "Coulomb: amplitude of the velocity",
        "increases with time",
        format!("peak {early:.3} in τ 20…40, {late:.3} in τ 80…100"),
        Verdict::holds(late > 1.05 * early, "it does not grow"),
    ));
    let (one, other) = (growth(&motions[1].1), growth(&motions[2].1));
    findings.rows.push(Row::statement(
        "stiction and Stribeck",
        "similar responses",
        format!("peaks {:.3} and {:.3} in τ 80…100", one.1, other.1),
        Verdict::holds((one.1 / other.1 - 1.0).abs() < 0.2, "more than 20 % apart"),
    ));
    store(
        &mut findings,
        "fig-3.8",
        "Locomotive, harmonic force (Fig. 3.8)",
        &motions,
    );
    Ok(findings)
}
