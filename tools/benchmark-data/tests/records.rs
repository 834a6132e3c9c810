//! What is written: the same bytes for the same seed, the schema, the instruments.

#![allow(clippy::unwrap_used, reason = "tests")]

use benchmark_data::answers::Answer;
use benchmark_data::case_files::{Case, make_cases, model_toml};
use benchmark_data::effects::Effects;
use benchmark_data::excitation::{Brake, Excitation};
use benchmark_data::hidden_effect::practice_law;
use benchmark_data::instruments::{DISC_ENCODER_STEP, Instruments, MOTOR_ENCODER_STEP, record_csv};
use benchmark_data::other_rigs::case::{OtherCase, RigChoice};
use benchmark_data::other_rigs::plan::{OtherWish, Sort};
use benchmark_data::plan::{Group, Measured, PlannedCase, Suite, Wish};
use benchmark_data::practice::{read_answers, read_record};
use benchmark_data::random::{Purpose, Stream};
use benchmark_data::recipe::Kind;
use benchmark_data::records::Sensors;
use benchmark_data::simulator::{Sample, State};
use clap::ValueEnum as _;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;

const SEED: u64 = 620_000;

fn planned(kind: Kind, seed: u64, measured: Measured) -> Vec<PlannedCase> {
    Wish {
        seed,
        cases: 1,
        kinds: vec![kind],
        scale: (0.6, 1.4),
        share_laws: false,
        rough: false,
        noise: 1.0,
        measured,
    }
    .plan()
    .unwrap()
}

fn one_case(kind: &str, seed: u64) -> Vec<PlannedCase> {
    let kind = Kind::singles().into_iter().find(|own| own.name == kind);
    planned(kind.unwrap(), seed, Measured::default())
}

fn other_rig(common: OtherCase, kind: Option<&str>) -> Vec<OtherCase> {
    OtherWish {
        seed: SEED,
        cases: 1,
        sort: kind.map_or(Sort::Clean, |_| Sort::Single),
        kind: kind.map(str::to_owned),
        common,
    }
    .plan()
    .unwrap()
}

fn made<C: Case>(cases: &[C]) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    make_cases(directory.path(), cases, 1, &|| ()).unwrap();
    directory
}

/// The files of the only case by their names.
fn files(directory: &tempfile::TempDir) -> BTreeMap<String, String> {
    fs::read_dir(directory.path().join("case-0000"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, fs::read_to_string(&path).unwrap())
        })
        .collect()
}

fn answer(directory: &tempfile::TempDir) -> Answer {
    read_answers(directory.path()).unwrap()["case-0000"].clone()
}

fn header(files: &BTreeMap<String, String>) -> &str {
    files["held-out.csv"].lines().next().unwrap()
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_does_not() {
    let make = |seed: u64| files(&made(&one_case("unbalance_no_brake", seed)));
    let (first, again, other) = (make(3), make(3), make(4));
    assert!(first == again, "the same seed gave other bytes");
    assert!(first != other, "another seed gave the same bytes");
    let names: Vec<&String> = first.keys().collect();
    assert_eq!(
        names,
        ["held-out.csv", "model.toml", "run-a.csv", "run-b.csv"]
    );
    let other_rigs = [(); 2].map(|()| made(&other_rig(OtherCase::default(), Some("unbalance"))));
    let [once, again] = other_rigs.map(|directory| {
        (
            files(&directory),
            fs::read(directory.path().join("ANSWERS.json")).unwrap(),
        )
    });
    assert!(once == again, "the same seed gave other bytes");
}

#[test]
fn answers_have_the_schema_of_the_practice_records() {
    let directory = made(&one_case("bearing_friction", 5));
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
    let answer = answer(&directory);
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
    let tools = Instruments::dissertation(&mut stream.clone());
    let text = record_csv(&inputs, &samples, &hidden, &tools, &mut stream);
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
    let plan = Suite::Final.plan(Group::value_variants(), Some(30));
    for case in plan {
        for (effect, _) in case.recipe.kind.effects {
            assert!(!case.name.contains(effect.name()), "{}", case.name);
        }
    }
}

const COLUMNS: [(Sensors, &str); 5] = [
    (Sensors::All, "time,u,N2,theta,theta_dot,theta3,theta3_dot"),
    (Sensors::Encoders, "time,u,N2,theta,theta3"),
    (Sensors::Tachometers, "time,u,N2,theta_dot,theta3_dot"),
    (Sensors::NoDisc, "time,u,N2,theta3,i"),
    (
        Sensors::Current,
        "time,u,N2,theta,theta_dot,theta3,theta3_dot,i",
    ),
];

fn measured(sensors: Sensors) -> Measured {
    Measured {
        sensors,
        ..Measured::default()
    }
}

#[test]
fn subsets_of_the_sensors_have_their_columns_and_leave_the_readings_alone() {
    let whole = files(&made(&other_rig(OtherCase::default(), None)));
    for (sensors, columns) in COLUMNS {
        let common = OtherCase {
            measured: measured(sensors),
            ..OtherCase::default()
        };
        let found = files(&made(&other_rig(common, None)));
        assert_eq!(header(&found), columns);
        assert_eq!(
            found["sensors.toml"].contains("current_noise"),
            columns.ends_with(",i")
        );
        let all: Vec<&str> = header(&whole).split(',').collect();
        for (row, full) in found["run-a.csv"].lines().zip(whole["run-a.csv"].lines()) {
            let full: Vec<&str> = full.split(',').collect();
            for (name, value) in columns.split(',').zip(row.split(',')) {
                if let Some(place) = all.iter().position(|known| *known == name) {
                    assert_eq!(value, full[place], "{name}");
                }
            }
        }
    }
}

#[test]
fn subsets_of_the_sensors_work_on_the_dissertation_s_rig() {
    for (sensors, columns) in COLUMNS {
        let cases = planned(Kind::clean(Brake::Off), SEED, measured(sensors));
        let found = files(&made(&cases));
        assert_eq!(header(&found), columns);
        assert_eq!(found.contains_key("sensors.toml"), columns.ends_with(",i"));
    }
}

#[test]
fn the_model_states_how_well_its_numbers_are_known() {
    let directory = made(&other_rig(OtherCase::default(), Some("unbalance")));
    let model: toml::Table = files(&directory)["model.toml"].parse().unwrap();
    let answer = answer(&directory);
    let known = |section: &str, key: &str| model[section][key]["relative_uncertainty"].as_float();
    let expected = 0.006 * answer.spread / 0.02;
    assert!((known("disc", "inertia").unwrap() - expected).abs() < 1e-6);
    for (section, key) in [
        ("shaft", "damping"),
        ("motor", "coulomb_torque"),
        ("contact", "mu_c"),
    ] {
        assert!(known(section, key).unwrap() > expected, "{key}");
    }
    assert!(
        model["motor"]["inertia"]
            .get("relative_uncertainty")
            .is_none()
    );
    assert!(answer.effects["unbal_T"] >= 0.099 * answer.facts["friction_torque"]);
    assert!(answer.effects["unbal_T"] <= 0.601 * answer.facts["friction_torque"]);
}

#[test]
fn nobody_knows_the_instruments_but_the_answers() {
    let common = OtherCase {
        measured: Measured {
            unknown: true,
            ..Measured::default()
        },
        ..OtherCase::default()
    };
    let directory = made(&other_rig(common, None));
    assert!(!files(&directory).contains_key("sensors.toml"));
    let beside = directory
        .path()
        .join("true-sensors/case-0000/sensors.true.toml");
    let sensors: toml::Table = fs::read_to_string(beside).unwrap().parse().unwrap();
    let stated = answer(&directory).sensors.unwrap();
    assert_eq!(
        sensors["disc_velocity_noise"].as_float(),
        Some(stated["disc_velocity_noise"])
    );
}

#[test]
fn the_full_rig_has_both_discs_and_says_where_the_effect_is() {
    for (index, place) in ["disc1", "disc2"].into_iter().enumerate() {
        let cases = OtherWish {
            seed: SEED,
            cases: 2,
            sort: Sort::Single,
            kind: Some("unbalance".to_owned()),
            common: OtherCase {
                rig: RigChoice::Full,
                ..OtherCase::default()
            },
        }
        .plan()
        .unwrap();
        let chosen = OtherCase {
            name: "case-0000".to_owned(),
            ..cases[index].clone()
        };
        let directory = made(&[chosen]);
        let found = files(&directory);
        assert_eq!(
            header(&found),
            "time,u,N2,N1,theta,theta_dot,theta3,theta3_dot,theta1,theta1_dot"
        );
        let model: toml::Table = found["model.toml"].parse().unwrap();
        for section in ["disc1", "shaft1", "contact1"] {
            assert!(model.contains_key(section), "{section}");
        }
        assert_eq!(answer(&directory).place.as_deref(), Some(place));
    }
}
