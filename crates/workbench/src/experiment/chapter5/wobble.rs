//! The printed pattern at 10 N and the 0.92 Hz of 55 rpm: what a normal force that varies with the disc's angle explains.

use std::f64::consts::TAU;

use super::sweeps::{SPEED_SWEEP_FORCE, SPEEDS, sticks};
use crate::experiment::virtual_rig::{
    Operation, Run, SAMPLE_STEP, peak_frequency, radians_per_second, virtual_rig, wobbling_rig,
};
use crate::experiment::{ExperimentError, Findings, Row, Table, Verdict};
use crate::plot::{Axis, Chart, Figure, Marker, Style};

/// Relative variation of the normal force at which the motor's constants are varied.
const WOBBLE: f64 = 0.2;
/// Variations tried.
const AMPLITUDES: [f64; 9] = [0.0, 0.1, 0.13, 0.16, 0.2, 0.3, 0.4, 0.5, 0.7];
/// Peaks of the experiments at 55 rpm: (N₂ [N], frequency [Hz]).
const PUBLISHED_PEAKS: [(f64, f64); 2] = [(10.0, 0.92), (50.0, 0.81)];

/// What equal motor constants, which Table 4.6 violates, do to the loaded rig's speed and so to the locked vibration.
fn equal_constants() -> Result<Row, ExperimentError> {
    let mut rig = wobbling_rig(WOBBLE)?;
    rig.motor.torque_constant = rig.motor.back_emf_constant;
    let mut ours = Vec::new();
    for (force, _) in PUBLISHED_PEAKS {
        let run = Run::of(&rig, &Operation::steady(55.0, force))?;
        ours.push(format!(
            "{force} N: {:.3}",
            peak_frequency(&run.omega, SAMPLE_STEP)
        ));
    }
    Ok(Row::added(
        "the same peaks with K_T = K_E = 0.0602 [Hz]",
        ours.join(", "),
    )
    .remark(format!(
        "variation ±{:.0} %. Half the torque constant doubles the loss of speed under load",
        100.0 * WOBBLE
    )))
}

/// Whether the virtual rig sticks where it is published to, and nowhere else.
fn pattern_of_virtual_rig() -> Result<bool, ExperimentError> {
    let rig = virtual_rig()?;
    for (speed, published) in SPEEDS {
        let run = Run::of(&rig, &Operation::steady(speed, SPEED_SWEEP_FORCE))?;
        if sticks(&run) != published {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The scan over the variation's amplitude.
pub fn explanation() -> Result<Findings, ExperimentError> {
    let mut columns = vec![Vec::new(); SPEEDS.len()];
    let mut peaks = vec![Vec::new(); PUBLISHED_PEAKS.len()];
    let mut turns = vec![Vec::new(); PUBLISHED_PEAKS.len()];
    let mut matches = Vec::new();
    for amplitude in AMPLITUDES {
        let rig = wobbling_rig(amplitude)?;
        let mut matched = 0;
        for ((speed, published), column) in SPEEDS.iter().zip(&mut columns) {
            let run = Run::of(&rig, &Operation::steady(*speed, SPEED_SWEEP_FORCE))?;
            matched += usize::from(sticks(&run) == *published);
            column.push(run.stick_fraction());
        }
        matches.push(matched);
        for (index, (force, _)) in PUBLISHED_PEAKS.iter().enumerate() {
            let run = Run::of(&rig, &Operation::steady(55.0, *force))?;
            peaks[index].push(peak_frequency(&run.omega, SAMPLE_STEP));
            let turned = run.theta.last().copied().unwrap_or(f64::NAN) - run.theta[0];
            turns[index].push(turned / TAU / run.time.last().copied().unwrap_or(f64::NAN));
        }
    }
    let mut findings = Findings::default();
    let most = matches.iter().copied().max().unwrap_or(0);
    let with_most: Vec<String> = AMPLITUDES
        .iter()
        .zip(&matches)
        .filter(|(_, matched)| **matched == most)
        .map(|(amplitude, _)| format!("{amplitude}"))
        .collect();
    findings.rows.push(
        Row::statement(
            "sticks at 25, 35, 45, 55 rpm, N₂ = 10 N",
            "yes, no, yes, no",
            format!("{most} of 4 at relative amplitudes {}; {} of 4 without variation", with_most.join(", "), matches[0]),
            if most == 4 {
                Verdict::ReproducedWith("a normal force varying with the disc's angle".to_owned())
            } else if pattern_of_virtual_rig()? {
                Verdict::ReproducedWith(
                    "more than that: also a friction that varies twice per revolution and a drag, sec-5.1-virtual-rig".to_owned(),
                )
            } else {
                Verdict::Open("neither a varying normal force nor the virtual rig gives the whole pattern".to_owned())
            },
        )
        .remark("Once per revolution is 0.75 Hz at 45 rpm, next to the natural frequency of 0.765 Hz: the variation drives the disc in resonance there, as the author suspects."),
    );
    let once = radians_per_second(55.0) / TAU;
    for (index, (force, published)) in PUBLISHED_PEAKS.iter().enumerate() {
        let shown: Vec<String> = AMPLITUDES
            .iter()
            .zip(&peaks[index])
            .map(|(amplitude, frequency)| format!("{amplitude}: {frequency:.3}"))
            .collect();
        // Locked: the peak is once per turn of the loaded rig.
        let locked = (0..AMPLITUDES.len())
            .find(|at| (peaks[index][*at] / turns[index][*at] - 1.0).abs() < 0.005);
        let near = locked.is_some_and(|at| (peaks[index][at] / published - 1.0).abs() < 0.025);
        let verdict = match locked {
            Some(at) if near => Verdict::ReproducedWith(format!(
                "a variation of ±{:.0} %, which locks the vibration to once per revolution",
                100.0 * AMPLITUDES[at]
            )),
            _ => {
                let run = Run::of(&virtual_rig()?, &Operation::steady(55.0, *force))?;
                let peak = peak_frequency(&run.omega, SAMPLE_STEP);
                let lock = locked.map_or("no variation locks the vibration".to_owned(), |at| {
                    format!(
                        "a variation of ±{:.0} % locks the vibration to once per revolution, {:.3} Hz",
                        100.0 * AMPLITUDES[at],
                        turns[index][at]
                    )
                });
                if (peak / published - 1.0).abs() < 0.025 {
                    Verdict::ReproducedWith(format!(
                        "another law of the same form, sec-5.1-virtual-rig: {peak:.3} Hz; with this one {lock}"
                    ))
                } else {
                    Verdict::Open(lock)
                }
            }
        };
        findings.rows.push(
            Row::statement(&format!("peak at 55 rpm, {force} N [Hz]"), &format!("{published} (experiment)"), shown.join(", "), verdict)
                .remark(format!(
                    "relative amplitude: peak. Once per revolution is {once:.4} Hz at 55 rpm and {:.4} Hz at the mean speed to which the friction pulls the open-loop rig without variation",
                    turns[index][0]
                )),
        );
    }
    findings.rows.push(equal_constants()?);
    let mut stick_chart = Chart::new(
        Axis::new("relative amplitude of the normal force's variation [1]"),
        Axis::new("share of time stuck at 10 N [1]"),
    );
    for (index, ((speed, published), column)) in SPEEDS.iter().zip(&columns).enumerate() {
        let word = if *published {
            "published: sticks"
        } else {
            "published: does not"
        };
        stick_chart = stick_chart.line(
            format!("{speed} rpm ({word})"),
            &AMPLITUDES,
            column,
            Style::series(index),
        );
    }
    let mut peak_chart = Chart::new(
        Axis::new("relative amplitude of the normal force's variation [1]"),
        Axis::new("peak at 55 rpm [Hz]"),
    );
    for (index, ((force, published), column)) in PUBLISHED_PEAKS.iter().zip(&peaks).enumerate() {
        peak_chart = peak_chart
            .points(
                format!("{force} N"),
                &AMPLITUDES,
                column,
                if index == 0 {
                    Marker::Dot
                } else {
                    Marker::Ring
                },
                Style::series(index),
            )
            .horizontal(
                format!("published {published} Hz"),
                *published,
                Style::reference(),
            );
    }
    peak_chart = peak_chart.horizontal("once per revolution", once, Style::series(2));
    findings.picture(
        "sec-5.2-wobble",
        "What a varying normal force explains",
        Figure::new("Second law with a normal force that varies with the disc's angle")
            .panel(320.0, stick_chart)
            .panel(320.0, peak_chart),
    );
    let mut table = vec![("relative amplitude".to_owned(), AMPLITUDES.to_vec())];
    for ((speed, _), column) in SPEEDS.iter().zip(columns) {
        table.push((format!("stick fraction {speed} rpm 10 N"), column));
    }
    for ((force, _), column) in PUBLISHED_PEAKS.iter().zip(peaks) {
        table.push((format!("peak 55 rpm {force} N [Hz]"), column));
    }
    findings.tables.push(Table {
        name: "wobble".to_owned(),
        columns: table,
    });
    Ok(findings)
}
