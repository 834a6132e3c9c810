//! The same inputs give the same bytes, wherever, whenever and beside whatever else.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use stress_tests::component::{Component, FULL_RIG, REDUCED_RIG};
use stress_tests::library::{Library, beside_program};
use stress_tests::program::{command, files};
use stress_tests::random::Random;
use stress_tests::rig::Rig;
use stress_tests::standard::Version;

/// Surroundings of a process: variables, working directory.
const SURROUNDINGS: [(&[(&str, &str)], &str); 5] = [
    (&[], "."),
    (
        &[
            ("LC_ALL", "de_DE.UTF-8"),
            ("LANG", "de_DE.UTF-8"),
            ("LC_NUMERIC", "de_DE.UTF-8"),
        ],
        "/",
    ),
    (
        &[("LC_ALL", "tr_TR.UTF-8"), ("TZ", "Pacific/Kiritimati")],
        "/tmp",
    ),
    (
        &[
            ("TZ", "America/St_Johns"),
            ("HOME", "/nowhere"),
            ("RAYON_NUM_THREADS", "1"),
        ],
        "/",
    ),
    (
        &[
            ("RAYON_NUM_THREADS", "7"),
            ("COLUMNS", "20"),
            ("NO_COLOR", "1"),
        ],
        "/",
    ),
];

fn same_everywhere(line: &str) {
    let place = tempfile::tempdir().unwrap();
    let model = place.path().join("rig.toml");
    fs::write(&model, REDUCED_RIG).unwrap();
    let mut first = None;
    for (number, (variables, directory)) in SURROUNDINGS.into_iter().enumerate() {
        let out = place.path().join(number.to_string());
        let mut command = command(line, &[("model", &model), ("out", &out)]).unwrap();
        command
            .env("SOURCE_DATE_EPOCH", "1")
            .envs(variables.iter().copied());
        succeeds(command.current_dir(directory));
        let found = files(&out, true).unwrap();
        assert!(!found.is_empty());
        let expected = first.get_or_insert_with(|| found.clone());
        for (name, bytes) in &found {
            assert!(
                expected.get(name) == Some(bytes),
                "{line}: {} in surroundings {number}",
                name.display()
            );
        }
        assert_eq!(expected.len(), found.len());
    }
}

fn succeeds(command: &mut Command) {
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
}

#[test]
fn fmus_runs_and_maps_do_not_depend_on_locale_time_zone_threads_or_directory() {
    same_everywhere("build-fmu {model} --out {out}");
    same_everywhere("stickslip simulate {model} --speed-rpm 55 --normal-force 50 --out {out}");
    same_everywhere("stickslip map --speed-rpm 20:60:5 --normal-force 0:70:5 {model} --out {out}");
}

#[test]
fn records_may_lie_in_the_directory_in_any_order() {
    let case =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../crates/workbench/tests/data/unbalance");
    let mut names: Vec<PathBuf> = fs::read_dir(&case)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    names.sort();
    let mut outcomes = Vec::new();
    for backwards in [false, true] {
        let place = tempfile::tempdir().unwrap();
        let copy = place.path().join("case");
        fs::create_dir(&copy).unwrap();
        if backwards {
            names.reverse();
        }
        for name in &names {
            fs::copy(name, copy.join(name.file_name().unwrap())).unwrap();
        }
        let mut command = command("stickslip locate case --out out", &[]).unwrap();
        succeeds(command.current_dir(place.path()));
        outcomes.push(files(&place.path().join("out"), true).unwrap());
    }
    assert!(!outcomes[0].is_empty() && outcomes[0] == outcomes[1]);
}

#[test]
fn any_pattern_of_steps_that_holds_the_inputs_ends_in_the_same_bits() {
    let library = Library::load(&beside_program().unwrap()).unwrap();
    for (text, names) in [(REDUCED_RIG, ["u", "N2"]), (FULL_RIG, ["u", "N1"])] {
        let component = Component::new(text).unwrap();
        let [voltage, force] = component.references(names).unwrap();
        let inputs = [(voltage, 3.1), (force, 40.0)];
        let outputs = ["theta", "theta_dot", "T_f", "i"];
        let outputs = component.references(outputs).unwrap();
        let mut ends = Vec::new();
        for seed in 0..30 {
            let mut random = Random::new(seed);
            let version = random.pick(&[Version::Two, Version::Three]);
            let rig = Rig::start(&library, &component, version, &inputs).unwrap();
            let mut time = 0.0_f64;
            while time < 10.0 {
                let size = random.pick(&[1e-4, 1e-3, 0.01, 0.3]) * (0.5 + random.uniform());
                let next = (time + size).min(10.0);
                if random.once_in(3) {
                    let (reference, value) = random.pick(&inputs);
                    rig.set(reference, value).unwrap();
                }
                if random.once_in(5) {
                    rig.get(&outputs).unwrap();
                }
                if random.once_in(50) {
                    rig.save(true).unwrap();
                }
                rig.step(time, next - time).unwrap();
                time = next;
            }
            ends.push(rig.get(&outputs).unwrap().map(f64::to_bits));
        }
        ends.dedup();
        assert_eq!(ends.len(), 1);
    }
}
