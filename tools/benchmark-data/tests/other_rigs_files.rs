//! Files of cases on other rigs and with other instruments.

#![allow(clippy::unwrap_used, reason = "tests")]

use benchmark_data::case_files::make_cases;
use benchmark_data::other_rigs::case::{OtherCase, RigChoice};
use benchmark_data::other_rigs::plan::{OtherWish, Sort};
use benchmark_data::plan::{Measured, PlannedCase, Wish};
use benchmark_data::practice::read_answers;
use benchmark_data::recipe::Kind;
use benchmark_data::records::Sensors;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

const SEED: u64 = 620_000;

fn made(common: OtherCase, kind: Option<&str>) -> tempfile::TempDir {
    let cases = OtherWish {
        seed: SEED,
        cases: 1,
        sort: if kind.is_some() {
            Sort::Single
        } else {
            Sort::Clean
        },
        kind: kind.map(str::to_owned),
        common,
    }
    .plan()
    .unwrap();
    let directory = tempfile::tempdir().unwrap();
    make_cases(directory.path(), &cases, 1, &|| ()).unwrap();
    directory
}

fn files(directory: &Path) -> BTreeMap<String, String> {
    fs::read_dir(directory.join("case-0000"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, fs::read_to_string(&path).unwrap())
        })
        .collect()
}

fn header(files: &BTreeMap<String, String>) -> &str {
    files["held-out.csv"].lines().next().unwrap()
}

fn dissertation(measured: Measured) -> Vec<PlannedCase> {
    Wish {
        seed: SEED,
        cases: 1,
        kinds: vec![Kind::clean(benchmark_data::excitation::Brake::Off)],
        scale: (1.0, 1.0),
        share_laws: false,
        rough: false,
        noise: 1.0,
        measured,
    }
    .plan()
    .unwrap()
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

#[test]
fn subsets_of_the_sensors_have_their_columns_and_leave_the_readings_alone() {
    let whole = files(made(OtherCase::default(), None).path());
    for (sensors, columns) in COLUMNS {
        let common = OtherCase {
            sensors,
            ..OtherCase::default()
        };
        let found = files(made(common, None).path());
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
        let directory = tempfile::tempdir().unwrap();
        let measured = Measured {
            sensors,
            unknown: false,
        };
        make_cases(directory.path(), &dissertation(measured), 1, &|| ()).unwrap();
        let found = files(directory.path());
        assert_eq!(header(&found), columns);
        assert_eq!(found.contains_key("sensors.toml"), columns.ends_with(",i"));
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let once = made(OtherCase::default(), Some("unbalance"));
    let again = made(OtherCase::default(), Some("unbalance"));
    assert!(files(once.path()) == files(again.path()));
    let answers = |directory: &Path| fs::read(directory.join("ANSWERS.json")).unwrap();
    assert!(answers(once.path()) == answers(again.path()));
}

#[test]
fn the_model_states_how_well_its_numbers_are_known() {
    let directory = made(OtherCase::default(), Some("unbalance"));
    let model: toml::Table = files(directory.path())["model.toml"].parse().unwrap();
    let answer = &read_answers(directory.path()).unwrap()["case-0000"];
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
        unknown: true,
        ..OtherCase::default()
    };
    let directory = made(common, None);
    assert!(!files(directory.path()).contains_key("sensors.toml"));
    let beside = directory
        .path()
        .join("true-sensors/case-0000/sensors.true.toml");
    let sensors: toml::Table = fs::read_to_string(beside).unwrap().parse().unwrap();
    let answer = read_answers(directory.path()).unwrap()["case-0000"].clone();
    let stated = answer.sensors.unwrap();
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
        let directory = tempfile::tempdir().unwrap();
        let chosen = OtherCase {
            name: "case-0000".to_owned(),
            ..cases[index].clone()
        };
        make_cases(directory.path(), &[chosen], 1, &|| ()).unwrap();
        let found = files(directory.path());
        assert_eq!(
            header(&found),
            "time,u,N2,N1,theta,theta_dot,theta3,theta3_dot,theta1,theta1_dot"
        );
        let model: toml::Table = found["model.toml"].parse().unwrap();
        for section in ["disc1", "shaft1", "contact1"] {
            assert!(model.contains_key(section), "{section}");
        }
        let answer = &read_answers(directory.path()).unwrap()["case-0000"];
        assert_eq!(answer.place.as_deref(), Some(place));
    }
}
