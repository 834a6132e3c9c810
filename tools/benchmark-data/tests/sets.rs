//! Axes with an FMU as their model, joints with a torque beside a predicted one: the records obey the model, but for what is hidden.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use benchmark_data::axis::AXES;
use benchmark_data::axis_fmu;
use benchmark_data::balance::JOINTS;
use benchmark_data::case_files::{Case, MadeCase};
use benchmark_data::kinds::SetCase;

/// The rows of the record to learn from.
fn rows(made: &MadeCase) -> Vec<Vec<f64>> {
    let rows = file(made, "run-a.csv").lines().skip(1);
    rows.map(|line| {
        line.split(',')
            .map(|value| value.parse().unwrap())
            .collect()
    })
    .collect()
}

fn file<'a>(made: &'a MadeCase, name: &str) -> &'a str {
    &made.files.iter().find(|(own, _)| own == name).unwrap().1
}

fn number(text: &str, key: &str) -> f64 {
    let line = text
        .lines()
        .find(|line| line.starts_with(&format!("{key} = {{")))
        .unwrap();
    let value = line.split("value = ").nth(1).unwrap();
    value.split(',').next().unwrap().parse().unwrap()
}

/// Work that the axis' own equation, at its real parameters, does not account for, over that of the motor.
fn missing_work(made: &MadeCase) -> f64 {
    let model = file(made, "model.toml");
    let real = |key: &str| {
        let ratio = made
            .answer
            .parameter_ratio
            .get(&format!("parameters.{key}"));
        ratio.map_or(0.0, |ratio| ratio * number(model, key))
    };
    let [inertia, resistance, constant, drag, weight, friction] =
        ["J", "R", "k", "d", "m", "friction"].map(real);
    let rows = rows(made);
    // Over spans so long that the encoder's noise does not count.
    let wide = 10;
    let rates: Vec<f64> = (wide..rows.len() - wide)
        .map(|at| {
            (rows[at + wide][2] - rows[at - wide][2]) / (rows[at + wide][0] - rows[at - wide][0])
        })
        .collect();
    let energy = |at: usize| 0.5 * inertia * rates[at].powi(2) - weight * rows[at + wide][2].cos();
    let (mut motor, mut lost) = (0.0, 0.0);
    for (rate, row) in rates.iter().zip(&rows[wide..]) {
        let step = rows[1][0] - rows[0][0];
        motor += step * rate * constant * (row[1] - constant * rate) / resistance;
        lost += step * (drag * rate * rate + friction * rate.abs());
    }
    (motor - lost - energy(rates.len() - 1) + energy(0)) / lost
}

#[test]
fn what_an_axis_loses_beside_its_equation_is_what_is_hidden() {
    for case in AXES.plan(510_000, AXES.kinds.len(), None).unwrap() {
        let missing = missing_work(&case.make().unwrap());
        match case.kind {
            "none" => assert!(missing.abs() < 0.15, "{missing}"),
            "coulomb_friction" | "viscous_drag" | "quadratic_drag" => {
                assert!(missing > 0.3, "{}: {missing}", case.kind)
            }
            _ => assert!(missing.is_finite(), "{}", case.kind),
        }
    }
}

/// Root mean squares of the measured torque but for the load's, and of what the prediction, scaled, leaves of it.
fn torques(case: &SetCase) -> [f64; 2] {
    let made = case.make().unwrap();
    let scale = made.answer.parameter_ratio["balance.scale"];
    let rows = rows(&made);
    let (mut all, mut left) = (0.0, 0.0);
    for row in &rows {
        all += (row[3] - row.get(5).unwrap_or(&0.0)).powi(2);
        left += (row[3] - scale * row[4]).powi(2);
    }
    [all, left].map(|sum| f64::sqrt(sum / rows.len() as f64))
}

#[test]
fn the_difference_of_a_joint_s_torques_holds_what_is_hidden() {
    for case in JOINTS.plan(500_000, 2 * JOINTS.kinds.len(), None).unwrap() {
        let [all, left] = torques(&case);
        assert!(all.is_finite() && all > 0.0, "{}", case.kind);
        let mut clean = case.clone();
        clean.kind = "none";
        let [_, noise] = torques(&clean);
        if case.kind == "none" {
            assert!(left < 0.012 * all, "{}", left / all);
        } else {
            assert!(left > 1.2 * noise, "{} {}", case.kind, left / noise);
        }
    }
}

#[test]
fn a_seed_is_a_case_and_a_wrong_kind_is_told() {
    for set in [AXES, JOINTS] {
        let made = || set.plan(7, 1, Some("offset")).unwrap()[0].make().unwrap();
        assert_eq!(made().files, made().files);
        let wrong = set.plan(7, 1, Some("ofset")).unwrap_err();
        assert!(wrong.to_string().contains("ofset"));
    }
}

#[test]
fn the_fmu_is_written_and_nothing_beside_it() {
    let directory = tempfile::tempdir().unwrap();
    axis_fmu::write(directory.path()).unwrap();
    let files: Vec<_> = std::fs::read_dir(directory.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(files, [axis_fmu::FILE]);
}
