//! Section 4.4: free decays seen through the rig's encoders, Tables 4.4 and 4.5, Figs 4.9 and 4.10.

use std::f64::consts::TAU;

use super::static_tests::{INERTIAS, NATURAL_FREQUENCIES};
use crate::analysis::spectrum::Spectrum;
use crate::experiment::virtual_rig::{ENCODER_STEP, SAMPLE_STEP, encoder};
use crate::experiment::{ExperimentError, Findings, Row, Table, Verdict, short};
use crate::identify::decay::{self, damping_ratio};
use crate::plot::{Axis, Chart, Figure, Marker, Style};

/// One disc's decay as printed.
struct Printed {
    disc: usize,
    damped: f64,
    natural_hz: f64,
    /// What Table 4.5 calls ξ.
    ratio: f64,
    /// The decrement that the printed figure stands for.
    decrement: f64,
    damping: f64,
    spectrum_peak: f64,
    /// Initial twist of the virtual decay [rad].
    twist: f64,
}

const PRINTED: [Printed; 2] = [
    Printed {
        disc: 1,
        damped: 10.037,
        natural_hz: 1.5986,
        ratio: 0.02323,
        decrement: 0.2323,
        damping: 0.0214,
        spectrum_peak: 1.572,
        twist: 0.45,
    },
    Printed {
        disc: 2,
        damped: 4.8074,
        natural_hz: 0.7652,
        ratio: 0.0986,
        decrement: 0.0986,
        damping: 0.0022,
        spectrum_peak: 0.7743,
        twist: 1.5,
    },
];

/// A decay as the encoder sees it: the twist is the difference of a moving and a standing encoder.
fn virtual_decay(printed: &Printed) -> (Vec<f64>, Vec<f64>) {
    let natural = NATURAL_FREQUENCIES[printed.disc - 1];
    let ratio = damping_ratio(printed.decrement);
    let damped = natural * (1.0 - ratio * ratio).sqrt();
    // Until the swing is down to a few encoder steps.
    let end = (printed.twist / (3.0 * ENCODER_STEP)).ln() / (ratio * natural);
    let time: Vec<f64> = (0..=(end / SAMPLE_STEP) as usize)
        .map(|index| index as f64 * SAMPLE_STEP)
        .collect();
    let twist: Vec<f64> = time
        .iter()
        .map(|t| {
            let phase = damped * t;
            printed.twist
                * (-ratio * natural * t).exp()
                * (phase.cos() + ratio / (1.0 - ratio * ratio).sqrt() * phase.sin())
        })
        .collect();
    (time, encoder(&twist))
}

/// Tables 4.4 and 4.5.
pub fn decays() -> Result<Findings, ExperimentError> {
    let mut findings = Findings::default();
    let mut figure = Figure::new("Free decays through 1000-tick encoders (Figs 4.9, 4.10)");
    for printed in &PRINTED {
        let (time, twist) = virtual_decay(printed);
        let found = decay::evaluate(&time, &twist, 10.0 * ENCODER_STEP)
            .ok_or_else(|| ExperimentError::Nothing("no swings in the decay".to_owned()))?;
        let spectrum = Spectrum::new(&twist, SAMPLE_STEP).ok_or_else(|| {
            ExperimentError::Nothing("the decay is too short for a spectrum".to_owned())
        })?;
        let peak = spectrum.peak(0.2).ok_or_else(|| {
            ExperimentError::Nothing("the decay's spectrum has no peak".to_owned())
        })?;
        let disc = printed.disc;
        let inertia = INERTIAS[disc - 1];
        let natural = NATURAL_FREQUENCIES[disc - 1];
        findings.rows.push(
            Row::number(
                &format!("disc {disc}: ω_d [rad/s]"),
                printed.damped,
                found.damped_frequency.value,
                0.002,
            )
            .remark("a decay simulated from Table 4.4 and υ, recovered from its encoder record"),
        );
        findings.rows.push(Row::number(
            &format!("disc {disc}: f_n [Hz]"),
            printed.natural_hz,
            found.natural_frequency / TAU,
            0.002,
        ));
        let ratio = found.damping_ratio;
        findings
            .rows
            .push(ratio_row(printed, ratio, found.decrement.value, natural));
        findings.rows.push(
            Row::number(
                &format!("disc {disc}: d [N m s/rad]"),
                printed.damping,
                found.damping(inertia),
                0.03,
            )
            .remark("2 ξ J ω_n (Eq. 4-11) with the ratio of Eq. 4-9; printed with the unit N s/m"),
        );
        findings.rows.push(
            Row::number(
                &format!("disc {disc}: peak of the spectrum [Hz]"),
                printed.spectrum_peak,
                peak.frequency,
                0.02,
            )
            .remark(format!(
                "bins of {} Hz; the printed peaks lie {:+.2} % from the printed f_n",
                short(spectrum.frequency[1]),
                100.0 * (printed.spectrum_peak / printed.natural_hz - 1.0)
            )),
        );
        let (extreme_times, extreme_values): (Vec<f64>, Vec<f64>) =
            found.extremes.iter().copied().unzip();
        let decay_chart = Chart::new(Axis::new("time [s]"), Axis::new("twist [rad]"))
            .title(format!("disc {disc}"))
            .line("encoder", &time, &twist, Style::model())
            .points(
                "extremes",
                &extreme_times,
                &extreme_values,
                Marker::Ring,
                Style::series(1),
            );
        let spectrum_chart = Chart::new(
            Axis::new("frequency [Hz]").range(0.0, 3.0),
            Axis::new("amplitude [rad]"),
        )
        .line("", &spectrum.frequency, &spectrum.amplitude, Style::model())
        .vertical("published peak", printed.spectrum_peak, Style::reference());
        figure = figure.row(260.0, vec![Box::new(decay_chart), Box::new(spectrum_chart)]);
        findings.tables.push(Table::new(
            format!("decay-{disc}"),
            vec![("time [s]", time), ("twist [rad]", twist)],
        ));
    }
    findings.picture("fig-4.9", "Free decays", figure);
    Ok(findings)
}

/// What Table 4.5 prints as ξ against what its other columns and Table 4.4 need.
fn ratio_row(printed: &Printed, ratio: f64, decrement: f64, natural: f64) -> Row {
    let from_frequencies = (1.0 - (printed.damped / natural).powi(2)).sqrt();
    let inertia = INERTIAS[printed.disc - 1];
    let from_damping = printed.damping / (2.0 * inertia * natural);
    let row = Row::number(
        &format!("disc {}: ξ", printed.disc),
        printed.ratio,
        ratio,
        0.02,
    );
    let reason = if (printed.decrement / printed.ratio - 10.0).abs() < 1e-6 {
        "the column holds the decrement υ, here with a slipped decimal"
    } else {
        "the column holds the decrement υ"
    };
    row.verdict(Verdict::NotReproducible(reason.to_owned()))
        .remark(format!(
            "υ = {decrement:.4}; ξ = υ/√(4π² + υ²) = {ratio:.4}; from ω_d and ω_n {from_frequencies:.4}; from d {from_damping:.4}"
        ))
}
