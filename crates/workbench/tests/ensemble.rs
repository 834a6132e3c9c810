//! Ensembles: equal to maps where nothing is uncertain, the same bytes from any number of threads and after an interrupt.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "common/interrupt.rs"]
mod interrupt;

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::interrupt::{Interrupted, said};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use workbench::analysis::motion::Motion;
use workbench::ensemble::{Conditions, Settings, Uncertain, at_places};
use workbench::map::{self, Point, Quantity, Study};

const MODEL: &str = include_str!("../../../modelDescription/reduced-rig.toml");
const FILES: [&str; 5] = [
    "ensemble.csv",
    "runs.csv",
    "rigs.csv",
    "ensemble.svg",
    "ensemble.png",
];

fn conditions(speed: &str, force: &str) -> Conditions {
    Conditions {
        speed_rpm: speed.parse().unwrap(),
        normal_force: force.parse().unwrap(),
        normal_force_1: None,
        duration: 30.0,
        tolerance: 1e-9,
    }
}

fn uncertain(name: &str, relative: f64) -> Uncertain {
    Uncertain {
        name: name.to_owned(),
        relative,
    }
}

fn settings(
    conditions: &Conditions,
    runs: usize,
    draw: &[String],
    given: &[Uncertain],
) -> Settings {
    Settings::new(
        MODEL,
        "reduced-rig.toml",
        conditions,
        (runs, 1),
        (draw, given),
    )
    .unwrap()
}

fn rows(settings: &Settings) -> Vec<Vec<Point>> {
    let row = |run| (0..settings.places()).map(move |place| settings.run(run, place));
    (0..settings.runs()).map(|run| row(run).collect()).collect()
}

#[test]
fn without_uncertainty_an_ensemble_is_the_map() {
    let (speed, force) = ("20:60:3", "5:65:3");
    let draw = ["contact.mu_s".to_owned()];
    let given = [uncertain("contact.mu_s", 0.0)];
    let settings = settings(&conditions(speed, force), 2, &draw, &given);
    let bands = at_places(&rows(&settings), settings.places());
    let spans = [
        (Quantity::SpeedRpm, speed.parse().unwrap()),
        (Quantity::NormalForce, force.parse().unwrap()),
    ];
    let map = map::Settings::new(MODEL, "reduced-rig.toml", &spans, 30.0, 1e-9).unwrap();
    let mut kinds = Vec::new();
    for (place, bands) in bands.iter().enumerate() {
        let point = map.run(place / 3, place % 3);
        for motion in Motion::ALL {
            let expected = if point.motion == Some(motion) {
                1.0
            } else {
                0.0
            };
            assert_eq!(
                bands.share(motion).value(),
                expected,
                "place {place}: {motion:?}"
            );
        }
        for (quantiles, value) in bands.quantiles.iter().zip([
            point.minimum,
            point.maximum,
            point.half_amplitude(),
            point.frequency,
            point.stick_fraction,
        ]) {
            for quantile in quantiles {
                assert!(
                    quantile.to_bits() == value.to_bits() || (quantile.is_nan() && value.is_nan())
                );
            }
        }
        kinds.push(point.motion);
    }
    assert!(kinds.contains(&Some(Motion::StickSlip)) && kinds.contains(&Some(Motion::Steady)));
}

#[test]
fn draws_have_the_median_and_the_spread_that_were_asked_for() {
    let given = [uncertain("contact.mu_s", 0.1)];
    let many = settings(&conditions("55", "50"), 4000, &[], &given);
    let names: Vec<&str> = many
        .parameters
        .iter()
        .map(|one| one.name.as_str())
        .collect();
    assert!(
        names.contains(&"disc.inertia") && names.contains(&"contact.mu_s"),
        "{names:?}"
    );
    assert!(
        !names.contains(&"gearbox.ratio"),
        "states no uncertainty: {names:?}"
    );
    for (index, one) in many.parameters.iter().enumerate() {
        let nominal = map::Settings::new(
            MODEL,
            "m",
            &[
                (Quantity::SpeedRpm, "5:6:2".parse().unwrap()),
                (Quantity::NormalForce, "5".parse().unwrap()),
            ],
            1.0,
            1e-9,
        )
        .unwrap()
        .conditions(0, 0)
        .unwrap()
        .0
        .parameter(&one.name)
        .unwrap();
        let mut ratios: Vec<f64> = (0..many.runs())
            .map(|run| many.sample(run)[index] / nominal)
            .collect();
        ratios.sort_by(f64::total_cmp);
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        let spread = ratios.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / ratios.len() as f64;
        let spread = spread.sqrt();
        assert!(
            (ratios[2000] - 1.0).abs() < 0.1 * one.relative,
            "{}: median {}",
            one.name,
            ratios[2000]
        );
        assert!(
            (spread / one.relative - 1.0).abs() < 0.06,
            "{}: {spread} of {}",
            one.name,
            one.relative
        );
        assert!(ratios[0] > 0.0);
    }
    let (names, place) = (&[][..], conditions("55", "50"));
    let other = Settings::new(MODEL, "m", &place, (3, 2), (names, &given)).unwrap();
    assert_ne!(other.sample(0), many.sample(0), "another seed");
    // A larger ensemble begins with the rigs of a smaller one.
    let few = settings(&conditions("55", "50"), 3, &[], &given);
    assert!((0..3).all(|run| few.sample(run) == many.sample(run)));
}

#[test]
fn rigs_that_contradict_themselves_are_drawn_again_and_counted() {
    let draw = ["contact.mu_s".to_owned(), "contact.mu_c".to_owned()];
    let given = [
        uncertain("contact.mu_s", 0.5),
        uncertain("contact.mu_c", 0.5),
    ];
    let settings = settings(&conditions("55", "50"), 200, &draw, &given);
    assert!(settings.refused > 0, "breakaway below sliding is refused");
    let order: Vec<&str> = settings
        .parameters
        .iter()
        .map(|one| one.name.as_str())
        .collect();
    let at = |name| order.iter().position(|other| *other == name).unwrap();
    let (mu_c, mu_s) = (at("contact.mu_c"), at("contact.mu_s"));
    assert!((0..200).all(|run| settings.sample(run)[mu_s] >= settings.sample(run)[mu_c]));
}

fn model() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../modelDescription/reduced-rig.toml")
}

fn ensemble(out: &Path, runs: &str, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    command.arg("ensemble").arg(model()).arg("--out").arg(out);
    command.args(["--runs", runs, "--seed", "7", "--duration", "30"]);
    command.args(more);
    command
}

const GRID: [&str; 4] = ["--speed-rpm", "20:60:3", "--normal-force", "5:65:2"];

fn same(one: &Path, other: &Path) {
    for name in FILES {
        let (left, right) = (
            fs::read(one.join(name)).unwrap(),
            fs::read(other.join(name)).unwrap(),
        );
        assert!(!left.is_empty() && left == right, "{name} differs");
    }
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    for (name, threads) in [("one", "1"), ("two", "2")] {
        let output = ensemble(&at(name), "30", &GRID)
            .args(["--threads", threads])
            .output();
        let output = output.unwrap();
        assert!(output.status.success(), "{}", said(&output));
    }
    same(&at("one"), &at("two"));
    let table = fs::read_to_string(at("one").join("ensemble.csv")).unwrap();
    assert!(
        table.starts_with("speed_rpm,normal_force,runs,failed,no_motion,"),
        "{table}"
    );
    assert_eq!(table.lines().count(), 1 + 6);
    assert_eq!(
        fs::read_to_string(at("one").join("runs.csv"))
            .unwrap()
            .lines()
            .count(),
        1 + 30 * 6
    );
    assert_eq!(
        fs::read_to_string(at("one").join("rigs.csv"))
            .unwrap()
            .lines()
            .count(),
        1 + 30
    );
}

/// The lines that a Parquet file has as CSV.
fn lines_of_parquet(path: &Path) -> Vec<String> {
    let reader = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
    let metadata = reader.metadata().file_metadata();
    let columns = metadata.schema_descr().columns().iter();
    let names: Vec<&str> = columns.map(|column| column.name()).collect();
    let rows = reader.get_row_iter(None).unwrap().map(|row| {
        let row = row.unwrap();
        let fields = row.get_column_iter().map(|(_, field)| match field {
            Field::Null => String::new(),
            Field::Double(value) => format!("{value:?}"),
            Field::Long(value) => value.to_string(),
            Field::Str(word) => word.clone(),
            other => other.to_string(),
        });
        fields.collect::<Vec<String>>().join(",")
    });
    std::iter::once(names.join(",")).chain(rows).collect()
}

#[test]
fn parquet_has_the_numbers_of_csv() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    for format in ["csv", "parquet"] {
        let mut command = ensemble(&at(format), "5", &GRID);
        let output = command.args(["--tables", format]).output().unwrap();
        assert!(output.status.success(), "{}", said(&output));
        let written = format!("ensemble.{format} and runs.{format}, rigs.{format}");
        let screen = String::from_utf8(output.stdout).unwrap();
        assert!(screen.contains(&written), "{screen}");
    }
    for table in ["ensemble", "runs", "rigs"] {
        let csv = fs::read_to_string(at("csv").join(format!("{table}.csv"))).unwrap();
        let parquet = at("parquet").join(format!("{table}.parquet"));
        assert_eq!(lines_of_parquet(&parquet), csv.lines().collect::<Vec<_>>());
    }
    assert!(
        !at("parquet").join("runs.csv").exists(),
        "one format at a time"
    );
}

#[test]
fn one_place_and_one_axis_have_pictures_of_their_own() {
    let place = tempfile::tempdir().unwrap();
    for (name, grid) in [
        ("histograms", ["--speed-rpm", "55", "--normal-force", "50"]),
        ("bands", ["--speed-rpm", "55", "--normal-force", "5:65:5"]),
    ] {
        let out = place.path().join(name);
        let output = ensemble(&out, "40", &grid).output().unwrap();
        assert!(output.status.success(), "{}", said(&output));
        let picture = fs::read_to_string(out.join("ensemble.svg")).unwrap();
        assert!(picture.contains("stick-slip") && picture.contains("frequency [Hz]"));
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_ensemble_is_continued_to_the_same_result() {
    Interrupted {
        study: &|out| ensemble(out, "300", &GRID),
        other: &|out| ensemble(out, "301", &GRID),
        refusal: "belongs to an ensemble with other settings",
        journal: "ensemble.journal",
        files: &FILES,
    }
    .goes_on_to_the_same_result();
}

#[test]
fn what_is_wrong_is_named_with_what_is_right() {
    let place = tempfile::tempdir().unwrap();
    let refused = |runs: &str, more: &[&str], wanted: &[&str]| {
        let all: Vec<&str> = GRID.into_iter().chain(more.iter().copied()).collect();
        let output = ensemble(&place.path().join("out"), runs, &all)
            .output()
            .unwrap();
        let text = said(&output);
        assert_eq!(output.status.code(), Some(2), "{more:?}: {text}");
        for part in wanted {
            assert!(text.contains(part), "{more:?}: {text}");
        }
    };
    refused("0", &[], &["--runs 0", "from 1 to"]);
    refused(
        "5",
        &["--draw", "contact.mus"],
        &["`contact.mus`", "did you mean `contact.mu_s`"],
    );
    refused(
        "5",
        &["--uncertain", "contact.mus=0.1"],
        &["did you mean `contact.mu_s`"],
    );
    refused(
        "5",
        &["--uncertain", "contact.mu_s=1.5"],
        &["contact.mu_s=1.5", "below 1"],
    );
    refused(
        "5",
        &["--uncertain", "contact.mu_s=-0.1"],
        &["contact.mu_s=-0.1", "from 0"],
    );
    refused("5", &["--uncertain", "contact.mu_s"], &["NAME=RELATIVE"]);
    refused(
        "5",
        &["--draw", "gearbox.ratio"],
        &[
            "reduced-rig.toml",
            "no relative_uncertainty of gearbox.ratio",
            "--uncertain gearbox.ratio=",
        ],
    );
    refused("5", &["--normal-force-1", "5"], &["no disc D1"]);
    refused("5", &["--tolerance", "1"], &["--tolerance = 1"]);
    let bare = place.path().join("bare.toml");
    let text: String = MODEL
        .split(", relative_uncertainty = ")
        .enumerate()
        .map(|(index, part)| match (index, part.split_once(" }")) {
            (1.., Some((_, rest))) => format!(" }}{rest}"),
            _ => part.to_owned(),
        })
        .collect();
    assert!(!text.contains("relative_uncertainty"));
    fs::write(&bare, text).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .arg("ensemble")
        .arg(&bare)
        .args(GRID)
        .args(["--runs", "5", "--seed", "1", "--out"])
        .arg(place.path().join("out"))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        said(&output).contains("bare.toml: states no relative_uncertainty of any parameter"),
        "{}",
        said(&output)
    );
    // A file where the directory would be.
    let taken = place.path().join("taken");
    fs::write(&taken, "").unwrap();
    let output = ensemble(&taken, "5", &GRID).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("taken"), "{}", said(&output));
}
