//! The maker against records of the other simulator, which shares no code with it.
//!
//! A replay from rest with the true parameters must stay within what the instruments can see:
//! Δ/√12 = 1.8e-3 rad (disc), 2.3e-4 rad (gearbox), tachometers 0.05 and 0.00625 rad/s.

#![allow(clippy::unwrap_used, reason = "tests")]

use benchmark_data::practice::{Difference, Record, read_answers, read_record, replay, true_rig};
use benchmark_data::rig::NOMINAL;
use benchmark_data::simulator::TrueRig;
use std::path::{Path, PathBuf};

/// 10 s.
const STRETCH: usize = 1000;

fn here() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// The practice records if they lie next to the repository.
fn practice() -> Option<PathBuf> {
    let directory = here().join("../../../shared/records/practice");
    directory.join("ANSWERS.json").exists().then_some(directory)
}

fn differences(case: &str, file: &str) -> Option<Vec<Difference>> {
    let directory = practice()?;
    let answers = read_answers(&directory).unwrap();
    let rig = true_rig(&answers[case]).unwrap();
    let mut record: Record = read_record(&directory.join(case).join(file)).unwrap();
    record.rows.pop();
    Some(replay(&rig, &record, STRETCH).unwrap())
}

/// `rounding` is what the five digits of a parameter ratio can turn the shaft by [rad].
fn assert_within_noise(difference: &Difference, rounding: f64, what: &str) {
    let factor = 1.3;
    let noise_free = |seen: f64, noise: f64| libm::sqrt((seen * seen - noise * noise).max(0.0));
    assert!(
        difference.disc_angle < factor * 1.82e-3 + rounding,
        "{what}: {difference:?}"
    );
    assert!(
        difference.gearbox_angle < factor * 2.3e-4 + rounding,
        "{what}: {difference:?}"
    );
    assert!(
        noise_free(difference.disc_speed, 0.05) < factor * 0.02,
        "{what}: {difference:?}"
    );
    assert!(
        noise_free(difference.gearbox_speed, 0.00625) < factor * 0.003,
        "{what}: {difference:?}"
    );
}

#[test]
fn eight_seconds_of_stick_slip_agree_with_the_committed_reference() {
    let mut record = read_record(&here().join("tests/reference/none-run-a-8s.csv")).unwrap();
    record.rows.pop();
    let rig = TrueRig {
        parameters: NOMINAL,
        law: benchmark_data::hidden_effect::practice_law("stribeck").unwrap(),
        effects: Default::default(),
        disc1: None,
    };
    for difference in replay(&rig, &record, 400).unwrap() {
        assert_within_noise(&difference, 0.0, "reference");
    }
}

#[test]
fn runs_without_brake_agree_within_the_noise_over_their_whole_length() {
    for case in [
        "none-no-brake",
        "unbalance-no-brake",
        "bearing-friction",
        "quadratic-drag",
    ] {
        for file in ["run-a.csv", "run-b.csv", "held-out.csv"] {
            for difference in differences(case, file).unwrap_or_default() {
                // 5e-6 of 150 rad.
                assert_within_noise(&difference, 7.5e-4, case);
            }
        }
    }
}

#[test]
fn stick_slip_agrees_within_the_noise_over_ten_seconds() {
    for case in [
        "none",
        "stribeck",
        "normal-force-wobble",
        "unbalance",
        "shaft-hardening",
    ] {
        for file in ["run-a.csv", "run-b.csv", "held-out.csv"] {
            if let Some(differences) = differences(case, file) {
                assert_within_noise(&differences[0], 0.0, case);
            }
        }
    }
}

#[test]
fn backlash_agrees_within_the_noise_over_forty_seconds() {
    for difference in differences("backlash", "run-a.csv").unwrap_or_default() {
        assert_within_noise(&difference, 0.0, "backlash");
    }
}

/// Under Eq. 6-2 a breakaway that is a millisecond off moves the next ones: a contact that creeps before it breaks away, or whose
/// friction falls only from a finite speed on, drifts by 0.3 rad in this time.
#[test]
fn the_two_gaussian_law_agrees_to_milliseconds_over_forty_seconds() {
    for difference in differences("acceleration-hysteresis", "run-a.csv").unwrap_or_default() {
        assert!(difference.disc_angle < 0.015, "{difference:?}");
        assert!(difference.gearbox_angle < 0.003, "{difference:?}");
    }
}
