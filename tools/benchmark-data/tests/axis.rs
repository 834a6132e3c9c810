//! Driven axes with an FMU as their model: the records obey the axis' equation, but for what is hidden.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use benchmark_data::axis::{AxisCase, KINDS};
use benchmark_data::axis_fmu;
use benchmark_data::case_files::{Case, MadeCase};

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
    let file = |name: &str| &made.files.iter().find(|(own, _)| own == name).unwrap().1;
    let model = file("model.toml");
    let real = |key: &str| {
        let ratio = made
            .answer
            .parameter_ratio
            .get(&format!("parameters.{key}"));
        ratio.map_or(0.0, |ratio| ratio * number(model, key))
    };
    let [inertia, resistance, constant, drag, weight, friction] =
        ["J", "R", "k", "d", "m", "friction"].map(real);
    let rows: Vec<[f64; 3]> = file("run-a.csv")
        .lines()
        .skip(1)
        .map(|line| {
            let mut values = line.split(',').map(|value| value.parse().unwrap());
            [(); 3].map(|()| values.next().unwrap())
        })
        .collect();
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
fn what_is_lost_beside_the_equation_is_what_is_hidden() {
    for case in AxisCase::plan(510_000, KINDS.len(), None).unwrap() {
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

#[test]
fn a_seed_is_a_case_and_a_wrong_kind_is_told() {
    let made = || {
        AxisCase::plan(7, 1, Some("offset")).unwrap()[0]
            .make()
            .unwrap()
            .files
    };
    assert_eq!(made(), made());
    let wrong = AxisCase::plan(7, 1, Some("ofset")).unwrap_err();
    assert!(wrong.to_string().contains("ofset"));
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
