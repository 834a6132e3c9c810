//! `stickslip diagnose` and its stages on a small case, and what it says to bad input.
//!
//! The case in `tests/data/unbalance` was made by `benchmark-data make --seed 424243 --cases 1 --kind unbalance`, cut to the
//! first 10 s (held-out: 8 s). Hidden: 0.0456 N m at 3.6126 rad, nominal parameters up to 4 % off.
#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail by panicking, like the tests"
)]

mod common;

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use inference::search::fit_effects;
use inference::window::Begin;
use workbench::component::Native;
use workbench::diagnose::amend::{self, amended_model};
use workbench::diagnose::case::Case;
use workbench::diagnose::finding::{Finding, VerdictName};
use workbench::diagnose::gap::{FreeRun, Gap, Measures, ThroughFmu, WindowError};
use workbench::diagnose::made::Made;
use workbench::diagnose::material::CaseArguments;
use workbench::diagnose::naming::{forced_finding, name};
use workbench::diagnose::record_part::Part;
use workbench::diagnose::report::Report;
use workbench::diagnose::residual_torque::residual_torques;
use workbench::diagnose::restart::course;
use workbench::diagnose::restart::{best_starts, window_courses};
use workbench::diagnose::show::{Comparison, Shown};
use workbench::files::record::Record;

use common::{library, stickslip};

fn case_directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/unbalance")
}

fn arguments(directory: &Path) -> CaseArguments {
    CaseArguments {
        case: Some(directory.to_owned()),
        ..CaseArguments::default()
    }
}

fn load() -> Case {
    arguments(&case_directory()).load().unwrap()
}

fn copy(to: &Path) {
    for entry in fs::read_dir(case_directory()).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, to.join(path.file_name().unwrap())).unwrap();
    }
}

#[test]
fn the_right_effect_is_named_with_its_size() {
    let case = load();
    let (finding, experiment) = name(&case, &mut |_| {}).unwrap();
    assert!(experiment.is_none());
    assert_eq!(finding.verdict, VerdictName::Named);
    assert_eq!(finding.effects.len(), 1);
    assert_eq!(finding.effects[0].name, "unbalance");
    let torque = &finding.effects[0].parameters["unbal_T"];
    assert!((torque.value / 0.0456 - 1.0).abs() < 0.03, "{torque:?}");
    assert_eq!(finding.ranking[0].name, "unbalance");
    assert_eq!(finding.structure[0].coordinate, "disc_angle");

    let model = amended_model(&case, &finding).unwrap();
    let text = amend::text(&case, &finding, &model).unwrap();
    assert!(
        text.contains("[unbalance]") && text.contains("status = \"fitted\""),
        "{text}"
    );
    assert!(text.contains("run-a.csv"), "{text}");
    let read = stickslip::plant::ModelFile::parse(&text, "amended").unwrap();
    assert_eq!(read, model);
}

#[test]
fn the_gap_closes_on_the_held_out_record() {
    let case = load();
    let names = ["unbalance".to_owned()];
    let finding = forced_finding(&case, &names, None, &mut |_| {}).unwrap();
    let model = amended_model(&case, &finding).unwrap();
    let text = amend::text(&case, &finding, &model).unwrap();
    let judging = case.judging(Begin::Clear).unwrap();
    let error = |text: &str, rig: &stickslip::plant::Rig<f64>| {
        let plant = judging.units.to_plant(rig).unwrap();
        let starts = best_starts(&judging.data, &plant).to_set(&plant, &judging.units);
        let mut native = Native::from_text(text, "model").unwrap();
        let courses = window_courses(&mut native, &judging, &starts, 0.0).unwrap();
        let (square, residuals) = courses
            .iter()
            .flatten()
            .fold((0.0, 0), |(square, count), course| {
                (square + course.square, count + course.residuals)
            });
        (square / residuals as f64).sqrt()
    };
    let (before, after) = (
        error(&case.model_text, &case.model.rig),
        error(&text, &model.rig),
    );
    assert!(before > 5.0, "{before}");
    assert!((0.85..1.1).contains(&after), "{after}");
}

#[test]
fn a_finding_can_be_disagreed_with() {
    let case = load();
    let names = vec!["viscous_drag".to_owned()];
    let finding = forced_finding(&case, &names, None, &mut |_| {}).unwrap();
    assert_eq!(finding.effects[0].name, "viscous_drag");
    assert!(finding.notes.iter().any(|note| note.contains("--effect")));
    let place = tempfile::tempdir().unwrap();
    finding.write(place.path()).unwrap();
    let read = Finding::read(place.path()).unwrap();
    let problem = case.problem().unwrap();
    let fitted = fit_effects(&problem, &["viscous_drag"], &mut |_| {}).unwrap();
    let fitted = problem
        .units
        .to_si(&fitted.fit.hypothesis.rig_at().unwrap())
        .unwrap();
    let amended = amended_model(&case, &read).unwrap().rig;
    assert_eq!(amended.parameters(), fitted.parameters());
    for parameter in fitted.parameters() {
        let value = |rig: &stickslip::plant::Rig<f64>| rig.parameter(&parameter.name).unwrap();
        let (left, right) = (value(&amended), value(&fitted));
        // Units and JSON may round the last digits.
        assert!(
            (left - right).abs() <= 1e-12 * right.abs(),
            "{}: {left} {right}",
            parameter.name
        );
    }
}

#[test]
fn unknown_effects_are_answered_with_the_known_ones() {
    let mut arguments = arguments(&case_directory());
    arguments.without = vec!["unbalence".to_owned()];
    let message = arguments.load().unwrap_err().to_string();
    assert!(
        message.contains("unbalence") && message.contains("normal_force_wobble"),
        "{message}"
    );
}

/// The same table in degrees, for its angles.
fn in_degrees(record: &Record) -> Record {
    let mut table = Record::new("table", record.time().to_vec()).unwrap();
    for name in record.names() {
        let factor = if matches!(name, "theta" | "theta3") {
            360.0 / TAU
        } else {
            1.0
        };
        let values = record.column(name).unwrap();
        let values = values.iter().map(|value| value * factor).collect();
        table.add_column(name, values).unwrap();
    }
    table
}

#[test]
fn tables_in_memory_read_like_the_files() {
    let mut material = arguments(&case_directory()).material().unwrap();
    let from_files = material.load().unwrap();
    let tables: Vec<Record> = material
        .records
        .iter()
        .map(|part| Record::read(&part.path).unwrap())
        .collect();
    material.records = tables.iter().cloned().map(Part::of_table).collect();
    let from_tables = material.load().unwrap();
    assert_eq!(format!("{from_tables:?}"), format!("{from_files:?}"));

    material.records = tables.iter().map(in_degrees).map(Part::of_table).collect();
    let held_out = Record::read(&material.held_out.unwrap().path).unwrap();
    material.held_out = Some(Part::of_table(in_degrees(&held_out)));
    material
        .model_text
        .push_str("[columns]\ntheta = { column = \"theta\", unit = \"deg\" }\ntheta3 = { column = \"theta3\", unit = \"deg\" }\n");
    let converted = material.load().unwrap();
    assert!(
        converted
            .notes
            .iter()
            .any(|note| note.contains("from deg to rad"))
    );
    let angles = |case: &Case| case.records[0].readings[0].clone();
    for (converted, original) in angles(&converted).iter().zip(angles(&from_files)) {
        assert!((converted - original).abs() <= 1e-14 * original.abs());
    }
}

#[test]
fn too_little_is_refused() {
    let place = tempfile::tempdir().unwrap();
    copy(place.path());
    fs::remove_file(place.path().join("run-b.csv")).unwrap();
    let path = place.path().join("run-a.csv");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(
        &path,
        text.lines()
            .take(202)
            .map(|l| format!("{l}\n"))
            .collect::<String>(),
    )
    .unwrap();
    let message = arguments(place.path()).load().unwrap_err().to_string();
    assert!(message.contains("at least 3 periods"), "{message}");
}

/// A comparison of a model with itself, as a report needs it.
fn comparison(case: &Case) -> Comparison {
    let judging = case.judging(Begin::Clear).unwrap();
    let plant = judging.units.to_plant(&case.model.rig).unwrap();
    let starts = best_starts(&judging.data, &plant).to_set(&plant, &judging.units);
    let shown = || {
        let mut native = Native::from_text(&case.model_text, "model").unwrap();
        let run = &judging.records[0];
        let windows = window_courses(&mut native, &judging, &starts, 0.0).unwrap();
        let (free_run, friction) =
            course(&mut native, run, 0, run.time.len() - 1, &starts[0]).unwrap();
        Shown {
            windows,
            free_run,
            friction,
        }
    };
    let errors = WindowError {
        before: 20.0,
        after: 20.0,
        noise_floor: 1.0,
        closed: Some(0.0),
    };
    let measures = Measures {
        rmse: Some(0.7),
        nrmse: Some(0.2),
        pc: None,
        apl: Some(0.1),
    };
    let gap = Gap {
        held_out: errors,
        free_run: FreeRun {
            before: measures,
            after: measures,
            after_through_fmu: measures,
            reference_speed: 3.0,
        },
        through_fmu: ThroughFmu {
            fmi3: errors,
            fmi2_before: 20.0,
            fmi2_after: 20.0,
        },
        windows: judging.data.windows.len(),
        windows_left_aside: 0,
    };
    let (before, after) = (shown(), shown());
    Comparison {
        gap,
        free_stretch: 0,
        before,
        after,
        judging,
    }
}

#[test]
fn the_report_is_well_formed_and_refers_to_nothing_outside() {
    let case = load();
    let names = vec!["unbalance".to_owned()];
    let mut finding = forced_finding(&case, &names, None, &mut |_| {}).unwrap();
    let comparison = comparison(&case);
    finding.gap = Some(comparison.gap.clone());
    finding.notes.push("less < than & \"more\"".to_owned());
    let problem = case.problem().unwrap();
    let residuals = residual_torques(&problem.long, &problem.units, &case.model.rig).unwrap();
    assert!(
        residuals.iter().any(|r| r.disc.abs() > 0.02),
        "an unbalance of 0.046 N m must show"
    );
    let made = Made::of(&arguments(&case_directory()).material().unwrap(), None).unwrap();
    let page = Report {
        case: &case,
        made: &made,
        finding: &finding,
        comparison: &comparison,
        residuals_before: &residuals,
        residuals_after: &residuals,
        residuals_held_out: &residuals,
    }
    .to_html();
    let document = page.strip_prefix("<!DOCTYPE html>").unwrap();
    let tree = roxmltree::Document::parse(document).unwrap();
    let count = |name: &str| {
        tree.descendants()
            .filter(|node| node.tag_name().name() == name)
            .count()
    };
    assert_eq!(count("h1"), 1);
    assert!(count("figure") == 5, "{} figures", count("figure"));
    assert_eq!(count("figure"), count("figcaption"));
    for file in ["model.toml", "run-a.csv", "held-out.csv"] {
        assert!(page.contains(&format!("{file}</td>")), "{file}");
    }
    assert!(page.contains("less &lt; than &amp; &quot;more&quot;"));
    for node in tree.descendants() {
        for attribute in node.attributes() {
            assert!(!matches!(attribute.name(), "src" | "href"), "{attribute:?}");
        }
    }
    for outside in ["http:", "https:", "url(", "@import", "<link"] {
        assert!(!page.contains(outside), "{outside}");
    }
    for scheme in ["prefers-color-scheme: dark", "@media print"] {
        assert!(page.contains(scheme), "{scheme}");
    }
}

#[test]
fn the_stages_on_each_others_files_as_a_user_runs_them() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("result");
    let (case, out_text) = (case_directory(), out.to_str().unwrap());
    let library = library("stickslip");
    let common = [
        case.to_str().unwrap(),
        "--out",
        out_text,
        "--library",
        &library,
    ];
    let run = |stage: &str, more: &[&str]| stickslip(&[&[stage], &common[..], more].concat());

    // Nothing to show yet: what to run is said.
    let (code, text) = run("show", &[]);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("stickslip name"), "{text}");

    let (code, text) = run("amend", &["--effect", "unbalance"]);
    assert_eq!(code, 0, "{text}");
    let (code, text) = run("show", &[]);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("of the gap is closed"), "{text}");
    for file in [
        "finding.json",
        "model.amended.toml",
        "ReducedRig.fmi2.fmu",
        "ReducedRig.fmi3.fmu",
        "report.html",
    ] {
        assert!(out.join(file).is_file(), "{file}");
    }
    let gap = Finding::read(&out).unwrap().gap.unwrap();
    assert!(gap.through_fmu.fmi3.closed.unwrap() > 0.98, "{gap:?}");
    assert!(
        (gap.through_fmu.fmi3.after / gap.held_out.after - 1.0).abs() < 1e-6,
        "{gap:?}"
    );
    assert!(
        (gap.through_fmu.fmi2_after / gap.held_out.after - 1.0).abs() < 1e-6,
        "{gap:?}"
    );

    // An effect that is not there leaves the gap open, and the exit code says so.
    let (code, text) = run("amend", &["--effect", "load_exponent"]);
    assert_eq!(code, 0, "{text}");
    let (code, text) = run("show", &[]);
    assert_eq!(code, 1, "{text}");

    let (code, text) = run("diagnose", &["--without", "unbalence"]);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("the catalogue has no such effect"), "{text}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_says_what_is_kept_and_exits_with_130() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};

    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("result");
    let mut child = Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(["name", case_directory().to_str().unwrap(), "--out"])
        .arg(&out)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    // Begun, but not finished: candidates are being tried.
    let trying = lines.find(|line| line.as_ref().unwrap().contains("trying"));
    assert!(trying.is_some(), "no progress was shown");
    let asked = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(asked.success());
    let said: Vec<String> = lines.map_while(Result::ok).collect();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(
        said.iter().any(|line| line.contains("nothing was written")),
        "{said:?}"
    );
    assert!(!out.exists());
}
