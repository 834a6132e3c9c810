//! `stickslip studio` over a real socket: whom it answers, what it answers, what it survives.
#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail by panicking, like the tests"
)]

mod client;
#[path = "../common/mod.rs"]
mod common;
mod hostile;
#[allow(dead_code, reason = "one of its plants is enough here")]
#[path = "../small_plants/records.rs"]
mod records;

use std::fs;
use std::io::{Read as _, Write as _};
use std::net::Shutdown;
use std::path::Path;
use std::time::Duration;

use serde_json::{Value, json};
use workbench::files::record::Record;

use crate::client::{Studio, case_directory};
use crate::common::stickslip;

#[test]
fn simulated_is_what_the_command_line_simulates() {
    let place = tempfile::tempdir().unwrap();
    let studio = Studio::on_case(place.path());
    let model = place.path().join("case/model.toml");
    let out = place.path().join("out");
    let (model, out) = (model.to_str().unwrap(), out.to_str().unwrap());
    let (code, text) = stickslip(&[
        "simulate",
        model,
        "--speed-rpm",
        "55",
        "--normal-force",
        "50",
        "--set",
        "contact.mu_s=0.2",
        "--duration",
        "20",
        "--out",
        out,
    ]);
    assert_eq!(code, 0, "{text}");
    let expected = Record::read(&Path::new(out).join("result.csv")).unwrap();
    let settings = json!({"contact.mu_s": 0.2});
    let held = studio.post(
        "api/simulate",
        &json!({"model": "believed", "settings": settings, "drive": {
            "by": "held", "speed_rpm": 55.0, "normal_force": 50.0, "duration": 20.0, "step": 0.01}}),
    );
    assert_eq!(held.column("time"), expected.time());
    for name in ["theta", "theta_dot", "theta3_dot", "T_f", "stuck"] {
        assert_eq!(held.column(name), expected.column(name).unwrap(), "{name}");
    }
    let record = place.path().join("case/run-a.csv");
    let (code, text) = stickslip(&[
        "simulate",
        model,
        "--inputs",
        record.to_str().unwrap(),
        "--out",
        out,
    ]);
    assert_eq!(code, 0, "{text}");
    let expected = Record::read(&Path::new(out).join("result.csv")).unwrap();
    let rest = studio.post(
        "api/simulate",
        &json!({"model": "believed", "drive": {"by": "rest", "record": "run-a.csv", "step": 0.01}}),
    );
    assert_eq!(
        rest.column("theta_dot"),
        expected.column("theta_dot").unwrap()
    );
    // From the measured state, at the record's own times.
    let measured = studio.get("api/records/run-a.csv");
    for windows in [false, true] {
        let drive = json!({"by": "record", "record": "run-a.csv", "windows": windows});
        let run = studio.post(
            "api/simulate",
            &json!({"model": "believed", "drive": drive}),
        );
        assert_eq!(run.column("time"), measured.column("time"));
    }
    let wrong = studio.post(
        "api/simulate",
        &json!({"model": "believed", "settings": {"disc.inertia": -1.0}, "drive": {"by": "record", "record": "run-a.csv"}}),
    );
    assert_eq!(wrong.status, 422);
    assert!(wrong.text().contains("disc.inertia"), "{}", wrong.text());
}

#[test]
fn choices_outlive_the_studio() {
    let place = tempfile::tempdir().unwrap();
    let studio = Studio::on_case(place.path());
    let uses = json!([
        {"record": "run-a.csv", "span": [0.0, 5.0], "role": "learn"},
        {"record": "run-b.csv", "role": "hold_out"},
        {"record": "held-out.csv", "role": "off"},
    ]);
    let change = json!({"uses": uses, "without": ["stribeck"], "settings": ["believed", {"disc.inertia": 0.016}], "view": {"tab": "rig"}});
    assert_eq!(studio.post("api/state", &change).status, 200);
    let script = studio.get("files/repeat.py").text();
    for part in ["run-a.csv@0:5\"]", "run-b.csv\"", "without=[\"stribeck\"]"] {
        assert!(script.contains(part), "{part}: {script}");
    }
    let shell = studio.get("files/shell.txt").text();
    assert!(
        shell.contains("@0:5 --held-out ") && shell.ends_with("--out result"),
        "{shell}"
    );
    // Killed, not ended.
    drop(studio);
    let again = Studio::on_case(place.path());
    let choices = again.get("api/state").json()["choices"].clone();
    assert_eq!(choices["uses"].as_array().unwrap().len(), 3);
    assert_eq!(choices["settings"]["believed"]["disc.inertia"], 0.016);
    assert_eq!(choices["view"]["tab"], "rig");
    // Numbers that are believed from now on stand in the studio's folder, and the case's model stays as it was.
    let before = fs::read(place.path().join("case/model.toml")).unwrap();
    assert_eq!(
        again
            .post("api/believe", &json!(["believed", {"disc.inertia": 0.016}]))
            .status,
        200
    );
    let text = again.get("files/model.studio.toml").text();
    assert!(text.contains("inertia = 0.016"), "{text}");
    assert_eq!(
        fs::read(place.path().join("case/model.toml")).unwrap(),
        before
    );
}

#[test]
fn columns_are_mapped_by_hand() {
    let place = tempfile::tempdir().unwrap();
    let studio = Studio::start(&["--out", place.path().to_str().unwrap()]);
    let model = fs::read(case_directory().join("model.toml")).unwrap();
    assert_eq!(
        studio.own("PUT", "api/records/model.toml", &model).status,
        200
    );
    let text = fs::read_to_string(case_directory().join("run-a.csv")).unwrap();
    let (header, rest) = text.split_once('\n').unwrap();
    let foreign = header
        .replace("theta_dot", "disc speed")
        .replacen("time", "t", 1);
    let foreign = format!("{foreign}\n{rest}");
    assert_eq!(
        studio
            .own("PUT", "api/records/foreign.csv", foreign.as_bytes())
            .status,
        200
    );
    let record = studio.get("api/state").json()["records"][0].clone();
    assert!(record["problem"].as_str().is_some(), "{record}");
    let headings: Vec<&str> = record["headings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|own| own[0].as_str().unwrap())
        .collect();
    assert!(
        headings.contains(&"t") && headings.contains(&"disc speed"),
        "{headings:?}"
    );
    let columns =
        json!({"time": {"column": "t", "unit": "s"}, "theta_dot": {"column": "disc speed"}});
    assert_eq!(
        studio
            .post("api/state", &json!({"columns": columns}))
            .status,
        200
    );
    let record = studio.get("api/state").json()["records"][0].clone();
    assert_eq!(record["problem"], Value::Null, "{record}");
    assert!(
        studio
            .get("api/records/foreign.csv")
            .column("theta_dot")
            .len()
            > 100
    );
}

#[test]
fn two_studios_on_one_folder_and_a_folder_that_disappears() {
    let place = tempfile::tempdir().unwrap();
    let studio = Studio::on_case(place.path());
    let case = place.path().join("case");
    let (code, text) = stickslip(&["studio", case.to_str().unwrap(), "--no-browser"]);
    assert_eq!(code, 2);
    assert!(
        text.contains("is open in another studio") && text.contains(&studio.port.to_string()),
        "{text}"
    );
    assert!(!text.contains(&studio.token), "{text}");
    fs::remove_dir_all(case.join("studio")).unwrap();
    let change = json!({"without": ["stribeck"]});
    let gone = studio.post("api/state", &change);
    assert_eq!(gone.status, 410);
    assert!(
        gone.text().contains("the studio's folder is gone"),
        "{}",
        gone.text()
    );
    assert_eq!(
        studio.post("api/diagnosis", &json!({"do": "start"})).status,
        410
    );
    assert_eq!(studio.post("api/state", &json!({"anew": true})).status, 200);
    let kept = fs::read_to_string(case.join("studio/studio.json")).unwrap();
    assert!(kept.contains("stribeck"), "{kept}");
    // The records of the case go, too: said, not crashed.
    fs::remove_file(case.join("run-a.csv")).unwrap();
    let problem = studio.get("api/state").json()["records"][0]["problem"].clone();
    assert!(
        problem.as_str().unwrap().contains("cannot be read"),
        "{problem}"
    );
}

#[test]
fn a_diagnosis_is_held_stopped_resumed_and_done() {
    let place = tempfile::tempdir().unwrap();
    let studio = Studio::on_case(place.path());
    let wish = |what: &str| studio.post("api/diagnosis", &json!({"do": what}));
    assert_eq!(wish("stop").status, 409);
    assert_eq!(wish("start").status, 200);
    assert_eq!(wish("start").status, 409);
    assert_eq!(wish("pause").status, 200);
    // It holds at its next step, and does nothing then.
    std::thread::sleep(Duration::from_secs(2));
    let held = studio.get("api/diagnosis").json();
    assert_eq!(held["phase"], "held", "{held}");
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(studio.get("api/diagnosis").json()["told"], held["told"]);
    wish("stop");
    assert_eq!(studio.wait(&["stopped"])["phase"], "stopped");
    assert_eq!(wish("start").status, 200);
    studio.wait(&["running", "done"]);
    // The program dies in the middle.
    drop(studio);
    let studio = Studio::on_case(place.path());
    assert!(
        ["cut off", "idle"].contains(
            &studio.get("api/diagnosis").json()["phase"]
                .as_str()
                .unwrap()
        )
    );
    assert_eq!(
        studio.post("api/diagnosis", &json!({"do": "start"})).status,
        200
    );
    let done = studio.wait(&["done", "failed"]);
    assert_eq!(done["phase"], "done", "{done}");
    assert_eq!(done["settled"], true);
    let state = studio.get("api/state").json();
    assert_eq!(state["finding"]["effects"][0]["name"], "unbalance");
    assert_eq!(state["is_of_now"], true);
    assert!(studio.get("report/").text().contains("Missing: unbalance"));
    assert!(
        studio
            .get("files/model.amended.toml")
            .text()
            .contains("[unbalance]")
    );
    let names: Vec<&str> = state["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|file| file["name"].as_str().unwrap())
        .collect();
    assert!(
        names.contains(&"ReducedRig.fmi3.fmu") && names.contains(&"ReducedRig.fmi2.fmu"),
        "{names:?}"
    );
    // Cut off behind the finding: what goes on begins there, and searches nothing anew.
    drop(studio);
    let out = place.path().join("case/studio");
    fs::remove_file(out.join("report.html")).unwrap();
    let kept = fs::read_to_string(out.join("studio.json")).unwrap();
    fs::write(
        out.join("studio.json"),
        kept.replace("\"is_done\": true", "\"is_done\": false"),
    )
    .unwrap();
    let studio = Studio::on_case(place.path());
    assert_eq!(studio.get("api/diagnosis").json()["phase"], "cut off");
    assert_eq!(
        studio.post("api/diagnosis", &json!({"do": "start"})).status,
        200
    );
    let again = studio.wait(&["done", "failed"]);
    assert_eq!(again["phase"], "done", "{again}");
    assert_eq!(again["tried"], json!({}));
    assert_eq!(
        studio.get("api/state").json()["finding"]["effects"],
        state["finding"]["effects"]
    );
    assert!(out.join("report.html").is_file());
    // Another effect, put in by hand: worse on the held-out record.
    let wish = json!({"do": "by_hand", "effects": ["viscous_drag"]});
    assert_eq!(studio.post("api/diagnosis", &wish).status, 200);
    assert_eq!(studio.wait(&["done", "failed"])["phase"], "done");
    let hand = studio.get("api/state").json()["by_hand"][0].clone();
    assert_eq!(hand["name"], "viscous_drag");
    let after = |finding: &Value| finding["gap"]["through_fmu"]["after"].as_f64().unwrap();
    assert!(after(&hand["finding"]) > after(&state["finding"]), "{hand}");
    let wrong = studio.post(
        "api/diagnosis",
        &json!({"do": "by_hand", "effects": ["../x"]}),
    );
    assert_eq!(wrong.status, 422);
}

#[test]
fn a_small_plant_is_diagnosed_too() {
    let place = tempfile::tempdir().unwrap();
    let case = place.path().join("drive");
    fs::create_dir_all(&case).unwrap();
    fs::write(case.join("model.toml"), records::DRIVE).unwrap();
    for (name, seed) in [("run-a.csv", 1), ("run-b.csv", 2), ("held-out.csv", 3)] {
        fs::write(case.join(name), records::drive(15.0, seed)).unwrap();
    }
    let library = common::library("stickslip");
    let studio = Studio::start(&[case.to_str().unwrap(), "--library", &library]);
    let state = studio.get("api/state").json();
    assert_eq!(state["models"][0]["kind"], "small plant");
    let known = state["effects"].as_array().unwrap();
    assert!(
        known
            .iter()
            .any(|effect| effect["name"] == "coulomb_friction"),
        "{known:?}"
    );
    assert_eq!(
        studio.post("api/diagnosis", &json!({"do": "start"})).status,
        200
    );
    let done = studio.wait(&["done", "failed"]);
    assert_eq!(done["phase"], "done", "{done}");
    let state = studio.get("api/state").json();
    assert_eq!(state["finding"]["verdict"], "named", "{state}");
    assert!(
        state["finding"]["small_plant"]["steps"]
            .as_array()
            .unwrap()
            .len()
            > 1
    );
    assert!(studio.get("report/").text().contains("coulomb friction"));
    let first = &state["finding"]["effects"][0]["name"];
    let wish = json!({"do": "by_hand", "effects": [first]});
    assert_eq!(studio.post("api/diagnosis", &wish).status, 200);
    assert_eq!(studio.wait(&["done", "failed"])["phase"], "done");
}
