//! Records as they come from a bench: what cannot be used is refused in words that say what would be right, what can be
//! used in part is used and said. Sampling that is faster or slower than usual must not change the answer.
#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail by panicking, like the tests"
)]

mod refused;
#[path = "../simulated/mod.rs"]
mod simulated;

use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Instant;

use inference::record::RawRecord;
use simulated::{Inputs, model, other_steps, record, steps};
use workbench::diagnose::case::Case;
use workbench::diagnose::catalogue::CATALOGUE;
use workbench::diagnose::finding::VerdictName;
use workbench::diagnose::material::CaseArguments;
use workbench::diagnose::naming::name;

/// Hidden in the records: torque [N m] of an unbalance.
const TORQUE: f64 = 0.05;

fn truth() -> String {
    format!("{}\n[unbalance]\ntorque = {TORQUE}\nphase = 1.0\n", model())
}

/// Files of a case by name, of 10 s at 10 ms.
fn files() -> &'static [(&'static str, String)] {
    static FILES: OnceLock<Vec<(&'static str, String)>> = OnceLock::new();
    FILES.get_or_init(|| {
        let made =
            |inputs: Inputs, seconds: f64, seed: u64| record(&truth(), inputs, seconds, 0.01, seed);
        vec![
            ("model.toml", model()),
            ("run-a.csv", made(steps, 10.0, 1)),
            ("run-b.csv", made(|t| (1.9, 8.0 + 2.0 * t), 10.0, 2)),
            ("held-out.csv", made(other_steps, 8.0, 3)),
        ]
    })
}

fn write(place: &Path, files: &[(&str, String)]) {
    for (name, text) in files {
        fs::write(place.join(name), text).unwrap();
    }
}

fn load(directory: &Path) -> Result<Case, String> {
    let arguments = CaseArguments {
        case: Some(directory.to_owned()),
        ..CaseArguments::default()
    };
    arguments.load().map_err(|error| error.to_string())
}

/// The case with one file put through `change`; an empty result takes the file away.
fn changed(file: &str, change: impl Fn(&str) -> String) -> Result<Case, String> {
    let place = tempfile::tempdir().unwrap();
    write(place.path(), files());
    let path = place.path().join(file);
    let text = change(&fs::read_to_string(&path).unwrap_or_default());
    fs::write(&path, text).unwrap();
    load(place.path())
}

/// A record with one column put through `change`, which is given the row and the value.
fn column(text: &str, name: &str, change: impl Fn(usize, f64) -> String) -> String {
    let mut lines = text.lines();
    let header = lines.next().unwrap();
    let at = header.split(',').position(|found| found == name).unwrap();
    let mut result = format!("{header}\n");
    for (row, line) in lines.enumerate() {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        fields[at] = change(row, fields[at].parse().unwrap());
        result.push_str(&fields.join(","));
        result.push('\n');
    }
    result
}

fn scaled(text: &str, name: &str, factor: f64) -> String {
    column(text, name, |_, value| (value * factor).to_string())
}

fn lines(text: &str, keep: impl Fn(usize) -> bool) -> String {
    text.lines()
        .enumerate()
        .filter(|(line, _)| *line == 0 || keep(line - 1))
        .map(|(_, line)| format!("{line}\n"))
        .collect()
}

type Change = fn(&str) -> String;

#[test]
fn what_can_be_used_is_used_and_said() {
    let whole = changed("model.toml", str::to_owned).unwrap();
    assert_eq!(whole.records.len(), 2);
    // The model states no uncertainties and no file the instruments; nothing else has to be said.
    assert!(
        whole.notes.len() == 2
            && whole.notes[0].contains("no relative_uncertainty")
            && whole.notes[1].contains("no sensors.toml"),
        "{:?}",
        whole.notes
    );
    let table: &[(&str, Change, &str, usize)] = &[
        (
            "run-a.csv",
            |t| lines(t, |row| !(400..450).contains(&row)),
            "2 stretches with 9.49 of 10.00 s",
            3,
        ),
        (
            "run-a.csv",
            |t| {
                column(t, "theta", |row, v| {
                    if row == 500 {
                        "NaN".into()
                    } else {
                        v.to_string()
                    }
                })
            },
            "2 stretches with 9.98 of 10.00 s",
            3,
        ),
        (
            "run-a.csv",
            |t| {
                column(t, "N2", |row, v| {
                    if row == 50 {
                        String::new()
                    } else {
                        v.to_string()
                    }
                })
            },
            "one stretch with 9.49 of 10.00 s",
            2,
        ),
        (
            "run-a.csv",
            |t| {
                t.lines()
                    .enumerate()
                    .map(|(j, l)| format!("{l},{}\n", if j == 0 { "temperature" } else { "1" }))
                    .collect()
            },
            "columns not used: temperature",
            2,
        ),
    ];
    for (file, change, words, runs) in table {
        let case = changed(file, change).unwrap();
        assert!(
            case.notes.iter().any(|note| note.contains(words)),
            "{words}: {:?}",
            case.notes
        );
        assert_eq!(case.records.len(), *runs, "{words}");
    }
}

#[test]
fn constant_inputs_are_said() {
    let place = tempfile::tempdir().unwrap();
    write(place.path(), files());
    fs::remove_file(place.path().join("run-b.csv")).unwrap();
    for (inputs, words) in [
        (
            (|_| (2.0, 30.0)) as Inputs,
            "voltage and normal force are the same throughout",
        ),
        (
            |t| (1.5 + 0.2 * t, 30.0),
            "the normal force is the same throughout",
        ),
        (|t| (2.0, 10.0 + t), "the voltage is the same throughout"),
    ] {
        fs::write(
            place.path().join("run-a.csv"),
            record(&truth(), inputs, 8.0, 0.01, 9),
        )
        .unwrap();
        let case = load(place.path()).unwrap();
        assert!(
            case.notes.iter().any(|note| note.contains(words)),
            "{words}: {:?}",
            case.notes
        );
    }
}

#[test]
fn files_that_are_not_there_are_named() {
    let place = tempfile::tempdir().unwrap();
    let message = load(&place.path().join("nowhere")).unwrap_err();
    assert!(message.contains("nowhere"), "{message}");
    let message = load(place.path()).unwrap_err();
    assert!(message.contains("run-*.csv"), "{message}");
}

#[test]
fn without_a_record_to_judge_on_the_last_one_or_its_last_quarter_is_held_out() {
    let place = tempfile::tempdir().unwrap();
    write(place.path(), &files()[..3]);
    let case = load(place.path()).unwrap();
    let said = |case: &Case, words: &str| case.notes.iter().any(|note| note.contains(words));
    assert!(said(&case, "the last one is held out") && said(&case, "run-b.csv"));
    assert_eq!(case.records.len(), 1);
    fs::remove_file(place.path().join("run-b.csv")).unwrap();
    let case = load(place.path()).unwrap();
    assert!(said(&case, "the last quarter of"), "{:?}", case.notes);
    let end = |records: &[RawRecord]| records.last().and_then(|r| r.time.last().copied());
    assert!(end(&case.records) < end(&case.held_out));
}

#[test]
fn tables_of_spreadsheets_are_read_like_our_own() {
    let own = changed("run-a.csv", str::to_owned).unwrap();
    let foreign = changed("run-a.csv", |t| {
        t.replace(',', ";")
            .replace('.', ",")
            .replace("theta;", "Theta [rad];")
    });
    let foreign = foreign.unwrap();
    assert_eq!(own.records[0].readings, foreign.records[0].readings);
    let note = "semicolons between values and decimal commas, `Theta [rad]` taken as theta";
    assert!(
        foreign.notes.iter().any(|n| n.contains(note)),
        "{:?}",
        foreign.notes
    );
}

#[test]
fn a_stretch_after_a_hole_is_followed_from_where_the_disc_is() {
    // The hole ends while the disc sticks, many turns from zero.
    let case = changed("run-a.csv", |text| {
        lines(text, |row| !(150..300).contains(&row))
    })
    .unwrap();
    let data = case.problem().unwrap().long;
    let second = data.windows.iter().find(|window| window.run == 1).unwrap();
    let angle = data.runs[1].readings[0][0];
    assert!(
        angle > 1.0 && (second.anchor[0] - angle).abs() < 0.05,
        "{angle} {:?}",
        second.anchor
    );
}

/// Diagnosis of the hidden unbalance from records sampled every `interval`, among a few candidates.
fn diagnosed(interval: f64) -> (Case, f64, f64) {
    let place = tempfile::tempdir().unwrap();
    let made = |inputs: Inputs, seed: u64| record(&truth(), inputs, 10.0, interval, seed);
    write(
        place.path(),
        &[
            ("model.toml", model()),
            ("run-a.csv", made(steps, 11)),
            ("held-out.csv", made(other_steps, 12)),
        ],
    );
    let kept = ["unbalance", "normal_force_wobble", "viscous_drag"];
    let arguments = CaseArguments {
        case: Some(place.path().to_owned()),
        without: CATALOGUE
            .iter()
            .map(|entry| entry.name.to_owned())
            .filter(|name| !kept.contains(&name.as_str()))
            .collect(),
        ..CaseArguments::default()
    };
    let case = arguments.load().unwrap();
    let begun = Instant::now();
    let (finding, _) = name(&case, &mut |_| {}).unwrap();
    let seconds = begun.elapsed().as_secs_f64();
    assert_eq!(finding.verdict, VerdictName::Named, "{interval} s");
    assert_eq!(finding.effects[0].name, "unbalance", "{interval} s");
    (
        case,
        finding.effects[0].parameters["unbal_T"].value,
        seconds,
    )
}

#[test]
fn the_answer_does_not_depend_on_the_sampling() {
    let (usual, _, usual_seconds) = diagnosed(0.01);
    let (fast, fast_torque, fast_seconds) = diagnosed(0.001);
    let (slow, slow_torque, _) = diagnosed(0.02);
    assert!(
        fast.notes
            .iter()
            .any(|note| note.contains("one sample in 10 is used")),
        "{:?}",
        fast.notes
    );
    let interval = |case: &Case| case.records[0].time[1] - case.records[0].time[0];
    assert!((interval(&fast) / interval(&usual) - 1.0).abs() < 1e-9);
    assert!((interval(&slow) - 0.02).abs() < 1e-9);
    for torque in [fast_torque, slow_torque] {
        assert!((torque / TORQUE - 1.0).abs() < 0.05, "{torque}");
    }
    // The load on the machine may change between the two; ten times as many samples would take ten times as long.
    assert!(
        fast_seconds < 4.0 * usual_seconds + 2.0,
        "{fast_seconds} s instead of {usual_seconds} s"
    );
}
