//! Joints with a torque beside a predicted one: what is hidden is in the difference, and nothing else but noise.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use benchmark_data::balance::{BalanceCase, KINDS};
use benchmark_data::case_files::Case;

/// Root mean squares of the measured torque but for the load's, and of what the prediction, scaled, leaves of it.
fn torques(record: &str, scale: f64) -> [f64; 2] {
    let (mut all, mut left, mut count) = (0.0, 0.0, 0.0);
    for line in record.lines().skip(1) {
        let values: Vec<f64> = line
            .split(',')
            .map(|value| value.parse().unwrap())
            .collect();
        all += (values[3] - values.get(5).unwrap_or(&0.0)).powi(2);
        left += (values[3] - scale * values[4]).powi(2);
        count += 1.0;
    }
    [(all / count), (left / count)].map(f64::sqrt)
}

/// As [`torques`], of the record to learn from.
fn torques_of(case: &BalanceCase) -> [f64; 2] {
    let made = case.make().unwrap();
    let mut files = made.files.iter();
    let (_, record) = files.find(|(name, _)| name == "run-a.csv").unwrap();
    torques(record, made.answer.parameter_ratio["balance.scale"])
}

#[test]
fn the_difference_holds_what_is_hidden() {
    for case in BalanceCase::plan(500_000, 2 * KINDS.len(), None).unwrap() {
        let [all, left] = torques_of(&case);
        assert!(all.is_finite() && all > 0.0, "{}", case.kind);
        let [_, noise] = torques_of(&BalanceCase {
            kind: "none",
            ..case.clone()
        });
        if case.kind == "none" {
            assert!(left < 0.012 * all, "{}", left / all);
        } else {
            assert!(left > 1.2 * noise, "{} {}", case.kind, left / noise);
        }
    }
}

#[test]
fn a_seed_is_a_case_and_a_wrong_kind_is_told() {
    let made = || {
        BalanceCase::plan(7, 1, Some("offset")).unwrap()[0]
            .make()
            .unwrap()
            .files
    };
    assert_eq!(made(), made());
    assert!(
        BalanceCase::plan(7, 1, Some("ofset"))
            .unwrap_err()
            .to_string()
            .contains("ofset")
    );
}
