//! Section 6.2: the ellipse of the phase plane and friction over its angle, Figs 6.1, 6.2, 6.3, 6.8, 6.9.

use std::f64::consts::PI;

use stickslip::friction::{Law, TwoGaussianMu};

use crate::experiment::chapter5::recorded::{RecordedFriction, recorded_friction};
use crate::experiment::virtual_rig::virtual_rig;
use crate::experiment::{ExperimentError, Findings, Row, Table, Verdict, short};
use crate::identify::ellipse::Ellipse;
use crate::identify::two_gaussian_fit::TwoGaussians;
use crate::plot::{Axis, Chart, Figure, Marker, Panel, Style};

/// Radius of the pin [m], not given.
const RADIUS: f64 = 0.075;
/// Velocity below which a recovered sample counts as sticking [rad/s]: five standard deviations of a velocity that is
/// recovered from an encoder of 1000 ticks over 13 samples.
const MOVING: f64 = 0.2;
/// Velocity above which the recovered torque is used [rad/s]: below, the smoothing mixes it with the torque of sticking.
const SLIDING: f64 = 1.26;
const SHOWN: usize = 3000;

/// The law that drives the virtual rig.
fn driving_law() -> Result<TwoGaussianMu<f64>, ExperimentError> {
    match virtual_rig()?.law {
        Law::TwoGaussianMu(law) => Ok(law),
        other => Err(ExperimentError::Nothing(format!(
            "the virtual rig has the law {}, not the two Gaussians of Eq. 6-2",
            other.name()
        ))),
    }
}

/// Samples in which the disc is faster than `velocity` [rad/s].
fn faster(record: &RecordedFriction, velocity: f64) -> Vec<usize> {
    (0..record.friction.velocity.len())
        .filter(|index| record.friction.velocity[*index] > velocity)
        .collect()
}

fn pick(series: &[f64], chosen: &[usize]) -> Vec<f64> {
    chosen.iter().map(|index| series[*index]).collect()
}

fn fit_ellipse(record: &RecordedFriction) -> Result<Ellipse, ExperimentError> {
    let chosen = faster(record, MOVING);
    Ellipse::of_cycle(
        &pick(&record.friction.velocity, &chosen),
        &pick(&record.friction.acceleration, &chosen),
    )
    .ok_or_else(|| ExperimentError::Nothing("the phase plane shows no ellipse".to_owned()))
}

/// Fig. 6.1.
pub fn ellipse() -> Result<Findings, ExperimentError> {
    let record = recorded_friction(55.0, 50.0)?;
    let ellipse = fit_ellipse(&record)?;
    let law = driving_law()?;
    let mut findings = Findings::default();
    findings.rows.push(
        Row::added(
            "centre, velocity axis [rad/s], acceleration axis [rad/s²]",
            format!("{:.2}, {:.2}, {:.1}", ellipse.centre, ellipse.velocity, ellipse.acceleration),
        )
        .remark(format!(
            "not printed. Fitted to the virtual rig's encoder record; the law that drives it measures its angle on {:.2}, {:.2}, {:.1}: the fit of a cycle is not the law's own ellipse, and calibration must leave it free",
            law.omega_centre, law.omega_centre, law.acceleration_semi_axis
        )),
    );
    let (breakaway, top) = (
        ellipse.angle(0.0, 1e-9),
        ellipse.angle(ellipse.centre + ellipse.velocity, 0.0),
    );
    findings.rows.push(Row::statement(
        "α where the disc breaks away, is fastest, sticks",
        "π, 0, −π",
        format!("{breakaway:.4}, {top:.4}, {:.4}", ellipse.angle(0.0, -1e-9)),
        Verdict::holds(
            (breakaway - PI).abs() < 1e-6 && top.abs() < 1e-6,
            "the angle is defined otherwise",
        ),
    ));
    let (outline_x, outline_y): (Vec<f64>, Vec<f64>) = (0..=200)
        .map(|step| PI * f64::from(step) / 100.0)
        .map(|phase| {
            (
                ellipse.centre + ellipse.velocity * phase.cos(),
                ellipse.acceleration * phase.sin(),
            )
        })
        .unzip();
    findings.tables.push(Table::new(
        "phase-plane",
        vec![
            ("time [s]", record.run.time.clone()),
            ("omega2 [rad/s]", record.friction.velocity.clone()),
            (
                "acceleration [rad/s2]",
                record.friction.acceleration.clone(),
            ),
        ],
    ));
    findings.tables.push(Table::new(
        "ellipse",
        vec![
            ("omega2 [rad/s]", outline_x.clone()),
            ("acceleration [rad/s2]", outline_y.clone()),
        ],
    ));
    findings.picture(
        "fig-6.1",
        "Ellipse of the phase plane",
        Figure::new("Phase plane and fitted ellipse, 55 rpm, 50 N, virtual rig (Fig. 6.1)").panel(
            420.0,
            Chart::new(Axis::new("θ̇₂ [rad/s]"), Axis::new("θ̈₂ [rad/s²]"))
                .line(
                    "virtual experiment",
                    &record.friction.velocity[..SHOWN],
                    &record.friction.acceleration[..SHOWN],
                    Style::measured().wide(1.0),
                )
                .line("ellipse", &outline_x, &outline_y, Style::model()),
        ),
    );
    Ok(findings)
}

/// The coefficient fitted over the angle on the ellipse of the law that drives the virtual rig.
fn own_ellipse(record: &RecordedFriction, chosen: &[usize]) -> Result<Row, ExperimentError> {
    let law = driving_law()?;
    let ellipse = Ellipse {
        centre: law.omega_centre,
        velocity: law.omega_centre,
        acceleration: law.acceleration_semi_axis,
    };
    let friction = &record.friction;
    let (angle, coefficient): (Vec<f64>, Vec<f64>) = chosen
        .iter()
        .map(|&index| {
            (
                ellipse.angle(friction.velocity[index], friction.acceleration[index]),
                friction.torque[index] / (record.normal_force[index] * RADIUS),
            )
        })
        .unzip();
    let fit = TwoGaussians::fit(&angle, &coefficient)
        .ok_or_else(|| ExperimentError::Nothing("too few sliding samples".to_owned()))?;
    let true_law = TwoGaussians {
        parameters: [law.a1, law.b1, law.c1, law.a2, law.b2, law.c2],
    };
    let mean = coefficient.iter().sum::<f64>() / coefficient.len() as f64;
    let largest = angle
        .iter()
        .map(|angle| (fit.at(*angle) - true_law.at(*angle)).abs())
        .fold(0.0, f64::max);
    Ok(Row::added(
        "50 N, μ over the angle of the driving law's own ellipse: largest distance of the fit from that law [1]",
        format!("{largest:.4}, {:.1} % of the mean", 100.0 * largest / mean),
    )
    .remark("what encoders, smoothing and inverse dynamics add; the ellipse of the cycle, Fig. 6.1, is another one, on which two Gaussians can only approximate the law"))
}

/// The numbers that a fit of the coefficient should come near to, in words.
fn driving_numbers() -> Result<String, ExperimentError> {
    let law = driving_law()?;
    let numbers = [law.a1, law.b1, law.c1, law.a2, law.b2, law.c2].map(short);
    Ok(format!(
        "; the law that drives the virtual rig has {} on its own ellipse",
        numbers.join(", ")
    ))
}

/// Figs 6.2, 6.3, 6.8 and 6.9.
pub fn gaussians() -> Result<Findings, ExperimentError> {
    let mut findings = Findings::default();
    let mut figure = Figure::new(
        "Friction over α with two fitted Gaussians, virtual rig (Figs 6.2, 6.3, 6.8, 6.9)",
    );
    for (force, numbers) in [(50.0, ["6.2", "6.3"]), (10.0, ["6.8", "6.9"])] {
        let record = recorded_friction(55.0, force)?;
        let ellipse = fit_ellipse(&record)?;
        let chosen = faster(&record, SLIDING);
        let angle: Vec<f64> = chosen
            .iter()
            .map(|index| {
                ellipse.angle(
                    record.friction.velocity[*index],
                    record.friction.acceleration[*index],
                )
            })
            .collect();
        let torque = pick(&record.friction.torque, &chosen);
        let coefficient: Vec<f64> = chosen
            .iter()
            .map(|index| record.friction.torque[*index] / (record.normal_force[*index] * RADIUS))
            .collect();
        let grid: Vec<f64> = (0..=200)
            .map(|step| -PI + PI * f64::from(step) / 100.0)
            .collect();
        let mut panels: Vec<Box<dyn Panel>> = Vec::new();
        let mut columns = vec![("alpha [rad]".to_owned(), angle.clone())];
        for (number, label, values) in [
            (numbers[0], "T_f [N m]", torque),
            (numbers[1], "μ [1]", coefficient),
        ] {
            let fit = TwoGaussians::fit(&angle, &values)
                .ok_or_else(|| ExperimentError::Nothing("too few sliding samples".to_owned()))?;
            let curve: Vec<f64> = grid.iter().map(|angle| fit.at(*angle)).collect();
            let parameters: Vec<String> = fit
                .parameters
                .iter()
                .map(|value| format!("{value:.3}"))
                .collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            findings.rows.push(
                Row::added(
                    &format!("Fig. {number}, {force} N, {label}: a1, b1, c1, a2, b2, c2"),
                    parameters.join(", "),
                )
                .remark(format!(
                    "not printed; residual {:.1} % of the mean{}",
                    100.0 * fit.residual(&angle, &values) / mean,
                    if number == "6.3" {
                        driving_numbers()?
                    } else {
                        String::new()
                    }
                )),
            );
            panels.push(Box::new(
                Chart::new(Axis::new("α [rad]").range(-PI, PI), Axis::new(label))
                    .title(format!("Fig. {number}: {force} N"))
                    .points(
                        "virtual experiment",
                        &angle[..angle.len().min(SHOWN / 2)],
                        &values[..angle.len().min(SHOWN / 2)],
                        Marker::Dot,
                        Style::measured(),
                    )
                    .line("two Gaussians", &grid, &curve, Style::model()),
            ));
            columns.push((label.to_owned(), values));
        }
        if force == 50.0 {
            findings.rows.push(own_ellipse(&record, &chosen)?);
        }
        figure = figure.row(330.0, panels);
        findings.tables.push(Table {
            name: format!("angle-{force}N"),
            columns,
        });
    }
    findings.picture("fig-6.2", "Friction over α", figure);
    Ok(findings)
}
