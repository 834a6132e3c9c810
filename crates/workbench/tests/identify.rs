//! `stickslip identify` on a user's own files: right answers, and words for what cannot be used.
#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail by panicking, like the tests"
)]

mod common;

use std::f64::consts::TAU;
use std::fs;

use common::stickslip;

/// Runs `identify KIND FILE …` on a file with this text; exit code and all that was printed.
fn identify(kind: &str, text: &str, options: &[&str]) -> (i32, String) {
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("test.csv");
    fs::write(&file, text).unwrap();
    let arguments = ["identify", kind, file.to_str().unwrap()];
    stickslip(&[&arguments, options].concat())
}

/// The number behind `label`.
fn number(words: &str, label: &str) -> f64 {
    let line = words.lines().find(|line| line.contains(label)).unwrap();
    let rest = line.split_once(label).unwrap().1;
    rest.split_whitespace().next().unwrap().parse().unwrap()
}

/// A decay with ω_n = 6 rad/s and ξ = 0.03, every 10 ms.
fn decay() -> String {
    let mut text = "time,twist\n".to_owned();
    for index in 0..2000 {
        let time = f64::from(index) * 0.01;
        let damped = 6.0 * (1.0 - 0.03_f64.powi(2)).sqrt();
        let twist = (-0.18 * time).exp() * (damped * time).cos();
        text.push_str(&format!("{time},{twist}\n"));
    }
    text
}

#[test]
fn a_static_test_gives_the_stiffness() {
    let (code, words) = identify(
        "static",
        "\u{feff}torque,twist\n0.5,0.26\n1.0,0.51\n1.5,0.76\n2.0,1.01\n",
        &[],
    );
    assert_eq!(code, 0, "{words}");
    assert!(
        (number(&words, "line with an offset") - 2.0).abs() < 1e-9,
        "{words}"
    );
}

#[test]
fn a_decay_gives_frequency_damping_and_stiffness() {
    let options = [
        "--column",
        "twist",
        "--smallest",
        "0.05",
        "--inertia",
        "0.1",
    ];
    let (code, words) = identify("decay", &decay(), &options);
    assert_eq!(code, 0, "{words}");
    assert!(
        (number(&words, "natural frequency") - 6.0).abs() < 0.01,
        "{words}"
    );
    assert!(
        (number(&words, "damping ratio") - 0.03).abs() < 0.001,
        "{words}"
    );
    assert!((number(&words, "stiffness") - 3.6).abs() < 0.02, "{words}");
}

#[test]
fn a_spectrum_gives_the_peak() {
    let mut text = "time,x\n".to_owned();
    for index in 0..1000 {
        let time = f64::from(index) * 0.01;
        text.push_str(&format!("{time},{}\n", (TAU * 1.3 * time).sin()));
    }
    let (code, words) = identify("spectrum", &text, &["--column", "x", "--peaks", "1"]);
    assert_eq!(code, 0, "{words}");
    let peak: f64 = words
        .lines()
        .last()
        .unwrap()
        .split_whitespace()
        .next()
        .unwrap()
        .parse()
        .unwrap();
    assert!((peak - 1.3).abs() < 1e-3, "{words}");
}

#[test]
fn static_tests_that_say_too_little_are_refused() {
    for (text, word) in [
        ("", "is empty"),
        ("torque;twist\n1;2\n", "separated by commas"),
        ("torque,twist\n1,0.1\n2,0.2\n", "three points"),
        ("torque,twist\n1,0.1\n2,0.1\n3,0.1\n", "different twists"),
        (
            "torque,twist\n1,0.1\n2,x\n3,0.3\n",
            "line 3, column `twist`: `x` is not a number",
        ),
        (
            "torque,twist\n1,0.1\n2,0.2,7\n3,0.3\n",
            "line 3: has 3 values",
        ),
    ] {
        let (code, words) = identify("static", text, &[]);
        assert!(code == 2 && words.contains(word), "{word}: {code} {words}");
    }
}

#[test]
fn records_and_options_that_cannot_be_used_are_refused() {
    let hole = decay()
        .lines()
        .enumerate()
        .filter(|(index, _)| !(300..340).contains(index))
        .map(|(_, line)| format!("{line}\n"))
        .collect::<String>();
    let decay = decay();
    let column = ["--column", "twist"];
    for (kind, text, options, word) in [
        (
            "decay",
            &decay,
            &["--column", "twits", "--smallest", "0.05"][..],
            "`twits`",
        ),
        (
            "decay",
            &decay,
            &["--column", "twist", "--smallest", "5"],
            "fewer than four swings",
        ),
        (
            "decay",
            &decay,
            &["--column", "twist", "--smallest", "0"],
            "--smallest is 0",
        ),
        (
            "decay",
            &decay,
            &["--column", "twist", "--smallest", "0.05", "--inertia=-1"],
            "--inertia is -1",
        ),
        (
            "decay",
            &hole,
            &["--column", "twist", "--smallest", "0.05"],
            "even samples",
        ),
        ("spectrum", &hole, &column, "even samples"),
        (
            "spectrum",
            &decay,
            &["--column", "twist", "--peaks", "0"],
            "--peaks is 0",
        ),
        (
            "spectrum",
            &decay,
            &["--column", "twist", "--lowest", "80"],
            "no peak between 80 Hz",
        ),
    ] {
        let (code, words) = identify(kind, text, options);
        assert!(code == 2 && words.contains(word), "{word}: {code} {words}");
    }
}
