//! What is written: the same bytes for the same seed, the schema, the instruments.

#![allow(clippy::unwrap_used, reason = "tests")]

use benchmark_data::case_files::{make_cases, model_toml};
use benchmark_data::effects::Effects;
use benchmark_data::excitation::Excitation;
use benchmark_data::hidden_effect::practice_law;
use benchmark_data::instruments::{DISC_ENCODER_STEP, MOTOR_ENCODER_STEP, Noise, record_csv};
use benchmark_data::plan::{Group, Measured, PlannedCase, Suite, Wish};
use benchmark_data::practice::{read_answers, read_record};
use benchmark_data::random::{Purpose, Stream};
use benchmark_data::recipe::Kind;
use benchmark_data::simulator::{Sample, State};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

fn one_case(kind: &str, seed: u64) -> Vec<PlannedCase> {
    Wish {
        seed,
        cases: 1,
        kinds: Kind::singles()
            .into_iter()
            .chain(Kind::outsiders())
            .filter(|candidate| candidate.name == kind)
            .collect(),
        scale: (0.6, 1.4),
        share_laws: false,
        rough: false,
        noise: 1.0,
        measured: Measured::default(),
    }
    .plan()
    .unwrap()
}

fn bytes(directory: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, fs::read(path).unwrap())
        })
        .collect();
    files.sort();
    files
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_does_not() {
    let make = |seed: u64| {
        let directory = tempfile::tempdir().unwrap();
        make_cases(
            directory.path(),
            &one_case("unbalance_no_brake", seed),
            1,
            &|| (),
        )
        .unwrap();
        bytes(&directory.path().join("case-0000"))
    };
    let (first, again, other) = (make(3), make(3), make(4));
    assert!(first == again, "the same seed gave other bytes");
    assert!(first != other, "another seed gave the same bytes");
    let names: Vec<&str> = first.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        ["held-out.csv", "model.toml", "run-a.csv", "run-b.csv"]
    );
}

#[test]
fn answers_have_the_schema_of_the_practice_records() {
    let directory = tempfile::tempdir().unwrap();
    make_cases(
        directory.path(),
        &one_case("bearing_friction", 5),
        1,
        &|| (),
    )
    .unwrap();
    let text = fs::read_to_string(directory.path().join("ANSWERS.json")).unwrap();
    let answers: serde_json::Value = serde_json::from_str(&text).unwrap();
    let keys: BTreeSet<&str> = answers["case-0000"]
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect();
    let expected = BTreeSet::from([
        "kind",
        "rough",
        "seed",
        "scale",
        "spread",
        "base",
        "truth",
        "effects",
        "parameter_ratio",
    ]);
    assert_eq!(keys, expected);
    let answer = &read_answers(directory.path()).unwrap()["case-0000"];
    let torque = answer.effects["bearing_T"];
    assert!((torque - 0.05 * answer.scale).abs() < 1e-12);
    let record = read_record(&directory.path().join("case-0000/run-a.csv")).unwrap();
    assert_eq!(record.rows.len(), 4001);
    assert_eq!(record.rows[4000][0], 40.0);
    assert!(record.rows.iter().all(|row| row[2] == 0.0));
}

#[test]
fn a_directory_with_something_in_it_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("kept"), "").unwrap();
    let cases = one_case("bearing_friction", 5);
    let refused = make_cases(directory.path(), &cases, 1, &|| ());
    assert!(refused.unwrap_err().to_string().contains("not empty"));
}

#[test]
fn model_files_parse_and_name_every_law() {
    for name in ["coulomb", "coulomb_stiction", "stribeck", "two_gaussian_mu"] {
        let model: toml::Table = model_toml(&practice_law(name).unwrap()).parse().unwrap();
        assert_eq!(model["contact"]["law"].as_str(), Some(name));
        assert_eq!(model["motor"]["coulomb_torque"].as_float(), Some(0.1196));
        assert_eq!(model["gearbox"]["ratio"].as_float(), Some(8.0));
    }
}

#[test]
fn instruments_round_down_and_add_their_noise() {
    let count = 20_000;
    let samples: Vec<Sample> = (0..count)
        .map(|index| {
            let angle = 1e-3 * index as f64;
            let state = State {
                disc_angle: angle,
                disc_speed: 2.0,
                gearbox_angle: angle,
                gearbox_speed: 3.0,
                ..State::default()
            };
            Sample {
                state,
                seen_disc_angle: angle,
                seen_disc_speed: 2.0,
                acceleration: 0.0,
            }
        })
        .collect();
    let inputs = Excitation {
        voltage: vec![1.0; count],
        normal_force: vec![30.0; count],
        ..Excitation::default()
    };
    let hidden = Effects {
        cell_bias: -4.0,
        ..Effects::default()
    };
    let mut stream = Stream::new(8, Purpose::Sensors(0));
    let text = record_csv(&inputs, &samples, &hidden, Noise::scaled(1.0), &mut stream);
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("record.csv");
    fs::write(&path, text).unwrap();
    let rows = read_record(&path).unwrap().rows;

    let statistics = |column: usize| {
        let mean = rows.iter().map(|row| row[column]).sum::<f64>() / count as f64;
        let square: f64 = rows.iter().map(|row| (row[column] - mean).powi(2)).sum();
        (mean, libm::sqrt(square / count as f64))
    };
    for (column, mean, deviation) in [(2, 26.0, 0.2), (4, 2.0, 0.05), (6, 3.0, 0.00625)] {
        let (found_mean, found_deviation) = statistics(column);
        assert!(
            (found_mean - mean).abs() < 0.04 * deviation,
            "column {column}"
        );
        assert!(
            (found_deviation / deviation - 1.0).abs() < 0.02,
            "column {column}"
        );
    }
    for (column, step) in [(3, DISC_ENCODER_STEP), (5, MOTOR_ENCODER_STEP)] {
        for (row, sample) in rows.iter().zip(&samples) {
            let lag = sample.state.disc_angle - row[column];
            assert!((-1e-6..step + 1e-6).contains(&lag), "{lag}");
            let steps = row[column] / step;
            assert!((steps - steps.round()).abs() < 1e-3, "{steps}");
        }
    }
}

#[test]
fn case_names_of_a_suite_do_not_tell_the_kind() {
    let plan = Suite::Final.plan(&Group::ALL, Some(30));
    for case in plan {
        for effect in case.recipe.kind.effects {
            assert!(!case.name.contains(effect.name()), "{}", case.name);
        }
    }
}
