//! From records that cannot tell two effects apart, by the experiment that is proposed, to a single name.
#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail by panicking, like the tests"
)]

mod common;
mod simulated;

use std::fs;
use std::path::Path;

use common::stickslip;
use simulated::{model, record, sensed};
use workbench::diagnose::catalogue::CATALOGUE;
use workbench::diagnose::finding::{Finding, VerdictName};
use workbench::diagnose::sensors::Sensors;
use workbench::files::record::Record;

/// What may be missing; the truth is the first.
const RIVALS: [&str; 2] = ["viscous_drag", "bearing_friction"];

/// `stickslip name` among the rivals alone.
fn named(case: &Path, out: &Path) -> Finding {
    let without: Vec<&str> = CATALOGUE
        .iter()
        .map(|entry| entry.name)
        .filter(|name| !RIVALS.contains(name))
        .collect();
    let mut arguments = vec![
        "name",
        case.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ];
    for name in &without {
        arguments.extend(["--without", name]);
    }
    let (code, text) = stickslip(&arguments);
    assert_eq!(code, 0, "{text}");
    Finding::read(out).unwrap()
}

/// A record from this time on.
fn turning(text: &str, from: f64) -> String {
    let kept = |line: &&str| {
        let time = line.split(',').next().and_then(|cell| cell.parse().ok());
        time.is_none_or(|time: f64| time >= from)
    };
    text.lines()
        .filter(kept)
        .fold(String::new(), |all, line| all + line + "\n")
}

#[test]
fn the_experiment_decides_what_the_records_left_open() {
    let place = tempfile::tempdir().unwrap();
    let (case, out) = (place.path().join("case"), place.path().join("out"));
    fs::create_dir(&case).unwrap();
    let truth = format!("{}\n[viscous_drag]\ncoefficient = 0.00015\n", model());
    // One speed without brake, at which it is already turning: there the two are one.
    let steady = |_| (2.2, 0.0);
    for (name, text) in [
        ("model.toml", model()),
        (
            "run-a.csv",
            turning(&record(&truth, steady, 16.0, 0.01, 21), 4.0),
        ),
        (
            "held-out.csv",
            record(&truth, |_| (2.3, 0.0), 8.0, 0.01, 22),
        ),
    ] {
        fs::write(case.join(name), text).unwrap();
    }
    let open = named(&case, &out);
    assert_eq!(open.verdict, VerdictName::Ambiguous, "{:?}", open.ranking);
    let mut names = open.alternatives.clone();
    names.sort();
    assert_eq!(names, ["bearing_friction", "viscous_drag"]);
    let experiment = open.experiment.unwrap();
    assert!(experiment.expected_power > 0.9, "{experiment:?}");

    // Its inputs run as they are, under both rivals, and the disc's angles differ by more than the encoder's rounding hides.
    let inputs = out.join(&experiment.file);
    let motion = |extra: &str, folder: &str| {
        let file = place.path().join(format!("{folder}.toml"));
        fs::write(&file, format!("{}\n{extra}\n", model())).unwrap();
        let results = place.path().join(folder);
        let (code, text) = stickslip(&[
            "simulate",
            file.to_str().unwrap(),
            "--inputs",
            inputs.to_str().unwrap(),
            "--out",
            results.to_str().unwrap(),
        ]);
        assert_eq!(code, 0, "{text}");
        let result = Record::read(&results.join("result.csv")).unwrap();
        result.require("theta").unwrap().to_vec()
    };
    let found = |name: &str| {
        let effect = open.effects.iter().find(|effect| effect.name == name);
        effect.map(|effect| effect.parameters.values().next().unwrap().value)
    };
    // Where only one of them was added, the other is taken of the size that is the same at 4.6 rad/s.
    let drag = found("viscous_drag").unwrap_or(0.00015);
    let dry = found("bearing_friction").unwrap_or(drag * 4.6);
    let first = motion(&format!("[viscous_drag]\ncoefficient = {drag}"), "drag");
    let second = motion(&format!("[bearing_friction]\ntorque = {dry}"), "dry");
    let deviation = Sensors::dissertation()
        .completed(&inference::record::Instruments::default())
        .deviations()[0];
    let distance: f64 = first
        .iter()
        .zip(&second)
        .map(|(a, b)| ((a - b) / deviation).powi(2))
        .sum();
    assert!(distance > 40.0, "{distance}");

    // Done, it decides.
    let planned = Record::read(&inputs).unwrap();
    fs::write(case.join("run-b.csv"), sensed(&truth, &planned, 23)).unwrap();
    let decided = named(&case, &place.path().join("again"));
    assert_eq!(decided.verdict, VerdictName::Named, "{:?}", decided.ranking);
    assert_eq!(decided.effects[0].name, "viscous_drag");
}
