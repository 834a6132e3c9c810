//! Effects that files of the user's describe, on small plants.

use std::fs;

use workbench::diagnose::finding::VerdictName;

use crate::records::{BALANCE, DRIVE, balance, drive};
use crate::{Place, names};

/// Friction that is higher around one speed, as the page on equations has it; no effect of the catalogue is like it.
fn slow_resonance() -> &'static str {
    let page = include_str!("../../../../docs/equations.md");
    let (_, last) = page.rsplit_once("```toml\n").unwrap();
    last.split("```").next().unwrap()
}

/// Nine ripples per turn.
const RIPPLE: &str = r#"
[[effect]]
name = "nine_teeth"
title = "a wheel with nine teeth"
port = "plant.force"
equation = "-ripple*cos(9*position - phase)"
parameters.ripple = { unit = "force", description = "Largest torque" }
parameters.phase = { unit = "rad", description = "Nine times the angle of the largest torque" }
"#;

/// Friction that is there from one moment on.
const ONSET: &str = r#"
[[effect]]
name = "onset"
title = "friction that is there from one moment on"
port = "plant.friction"
equation = "later*(1 + tanh((time - moment)/transition))/2*direction"
parameters.later = { unit = "force", description = "Friction after the moment" }
parameters.moment = { unit = "s", range = "positive", description = "When it begins" }
parameters.transition = { unit = "s", range = "positive", description = "Time that it takes" }
"#;

fn bump(_: f64, rate: f64, _: f64, _: f64, _: f64) -> f64 {
    0.8 * (-((rate.abs() - 3.0) / 0.8).powi(2)).exp() * rate.signum()
}

fn suspecting(model: &str, hidden: fn(f64, f64, f64, f64, f64) -> f64, suspects: &[&str]) -> Place {
    let place = Place::new(model, &balance(hidden, 71), &balance(hidden, 72));
    fs::create_dir(place.file("effects")).unwrap();
    for (at, text) in suspects.iter().enumerate() {
        fs::write(place.file("effects").join(format!("own-{at}.toml")), text).unwrap();
    }
    place
}

#[test]
fn a_suspect_that_is_what_is_missing_is_named_and_its_model_lacks_nothing() {
    let place = suspecting(BALANCE, bump, &[slow_resonance(), RIPPLE]);
    let (found, text) = place.diagnosed(0);
    assert_eq!(found.finding.verdict, VerdictName::Named, "{text}");
    assert_eq!(names(&found), ["slow_resonance"], "{text}");
    let numbers = &found.finding.effects[0].parameters;
    for (key, truth) in [("height", 0.8), ("centre", 3.0), ("width", 0.8)] {
        let value = numbers[key].value;
        assert!((value / truth - 1.0).abs() < 0.05, "{key} {value}");
    }
    let amended = fs::read_to_string(place.file("out").join("model.amended.toml")).unwrap();
    assert!(amended.contains("name = \"slow_resonance\""), "{amended}");
    assert!(amended.contains("status = \"fitted\""), "{amended}");
    let again = Place::new(&amended, &balance(bump, 73), &balance(bump, 74));
    let (found, text) = again.diagnosed(0);
    assert_eq!(found.finding.verdict, VerdictName::NothingMissing, "{text}");
}

#[test]
fn a_phase_is_found_from_wherever_it_starts() {
    let hidden = |q: f64, _: f64, _: f64, _: f64, _: f64| -0.8 * (9.0 * q - 4.0).cos();
    let place = suspecting(BALANCE, hidden, &[slow_resonance(), RIPPLE]);
    let (found, text) = place.diagnosed(0);
    assert_eq!(names(&found), ["nine_teeth"], "{text}");
}

#[test]
fn suspects_that_are_not_missing_are_not_named_beside_what_is() {
    let hidden = |_: f64, rate: f64, _: f64, _: f64, _: f64| 0.6 * rate.signum();
    let place = suspecting(BALANCE, hidden, &[slow_resonance(), RIPPLE]);
    let (found, text) = place.diagnosed(0);
    assert_eq!(names(&found), ["coulomb_friction"], "{text}");
    let ranking = &found.finding.ranking;
    assert!(ranking.iter().any(|one| one.name == "nine_teeth"), "{text}");
}

#[test]
fn a_suspect_that_sets_in_at_once_is_named_with_its_moment() {
    let hidden = |_: f64, rate: f64, _: f64, _: f64, time: f64| {
        if time > 11.0 {
            0.8 * rate.signum()
        } else {
            0.0
        }
    };
    let place = suspecting(BALANCE, hidden, &[ONSET]);
    let (found, text) = place.diagnosed(0);
    assert_eq!(names(&found), ["onset"], "{text}");
    let moment = found.finding.effects[0].parameters["moment"].value;
    assert!((moment - 11.0).abs() < 0.1, "{moment}");
}

#[test]
fn a_suspect_of_many_numbers_does_not_pass_for_a_sum_of_plain_effects() {
    let hidden = |_: f64, rate: f64, _: f64, _: f64, time: f64| {
        0.6 * (1.0 + 0.8 * time / 25.0) * rate.signum()
    };
    let place = suspecting(BALANCE, hidden, &[ONSET]);
    let (found, text) = place.diagnosed(0);
    assert_eq!(
        names(&found),
        ["coulomb_friction", "friction_wear"],
        "{text}"
    );
}

#[test]
fn a_suspicion_that_is_wrong_leaves_the_verdict_open() {
    let place = suspecting(BALANCE, bump, &[RIPPLE]);
    let (found, text) = place.diagnosed(1);
    assert_eq!(found.finding.verdict, VerdictName::NotInCatalogue, "{text}");
}

#[test]
fn a_suspect_in_newtons_can_be_put_into_a_drive_by_hand() {
    let grip = "[[effect]]\nname = \"grip\"\ntitle = \"a seal that grips\"\nport = \"plant.friction\"\n\
                equation = \"grip*tanh(velocity/width)\"\n\
                parameters.grip = { unit = \"N\", description = \"d\" }\n\
                parameters.width = { unit = \"mm/s\", range = [0.0001, 0.01], description = \"d\" }\n";
    let place = Place::new(DRIVE, &drive(5.0, 1), &drive(5.0, 2));
    let suspects = tempfile::tempdir().unwrap();
    fs::write(suspects.path().join("grip.toml"), grip).unwrap();
    let directory = suspects.path().to_str().unwrap();
    let further = ["--catalogue", directory, "--effect", "grip"];
    let (code, text) = place.run("amend", &further);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("mm/s") && text.contains("grip"), "{text}");
    fs::write(
        suspects.path().join("grip.toml"),
        grip.replace("mm/s", "m/s"),
    )
    .unwrap();
    let (code, text) = place.run("amend", &further);
    assert_eq!(code, 0, "{text}");
    let found = place.finding();
    let force = found.finding.effects[0].parameters["grip"].value;
    assert!((force / 5.0 - 1.0).abs() < 0.05, "{force}");
}

#[test]
fn files_that_cannot_be_used_are_refused_with_what_would_be_right() {
    let table: &[(&str, &str, &[&str])] = &[
        (
            "plant.force",
            "disc.torque",
            &["plant.force or plant.friction", "balance"],
        ),
        ("nine_teeth", "Nine teeth", &["small letters"]),
        ("nine_teeth", "unbalance", &["unbalance", "catalogue has"]),
        ("ripple*cos", "ripple*velocity*cos", &["equation", "N.m"]),
        ("9*position", "9*load", &["load"]),
        (
            "9*position",
            "sign(velocity)",
            &["direction of a small plant"],
        ),
        ("ripple*cos", "ripple/velocity*cos", &["velocity"]),
        (
            "unit = \"force\"",
            "unit = \"farce\"",
            &["farce", "parameters.ripple.unit"],
        ),
        ("-ripple*cos", "1.0*ripple/ripple*cos", &["equation"]),
        ("description = \"Largest", "colour = \"Largest", &["colour"]),
        (
            "{ unit = \"rad\",",
            "{ unit = \"rad\", range = [2, 1],",
            &["range", "lowest"],
        ),
        (
            "{ unit = \"rad\",",
            "{ unit = \"rad\", status = \"guessed\",",
            &["parameters.phase.status", "guessed", "assumed"],
        ),
        ("title = \"a wheel with nine teeth\"", "", &["title"]),
        ("parameters.phase", "parameters.velocity", &["velocity"]),
        (
            "port =",
            "kinds = [\"drive\"]\nport =",
            &["kinds", "balance"],
        ),
        ("port =", "path = \"line\"\nport =", &["path", "turn"]),
    ];
    for (from, to, words) in table {
        assert!(RIPPLE.contains(from), "{from}");
        let place = suspecting(BALANCE, bump, &[&RIPPLE.replacen(from, to, 1)]);
        let (code, message) = place.run("diagnose", &[]);
        assert_eq!(code, 2, "{to}: {message}");
        for word in ["own-0.toml"].iter().chain(*words) {
            assert!(message.contains(word), "{to}: {word}: {message}");
        }
        assert!(!place.file("out").join("finding.json").exists());
    }
    for (text, word) in [("", "[[effect]]"), ("effect = 3", "[[effect]]")] {
        let (code, message) = suspecting(BALANCE, bump, &[text]).run("diagnose", &[]);
        assert_eq!(code, 2, "{text}: {message}");
        assert!(
            message.contains("own-0.toml") && message.contains(word),
            "{text}: {message}"
        );
    }
    let place = suspecting(BALANCE, bump, &[RIPPLE, RIPPLE]);
    let (code, message) = place.run("diagnose", &[]);
    assert_eq!(code, 2, "{message}");
    assert!(
        message.contains("own-0.toml has an effect of this name"),
        "{message}"
    );
    let constant = RIPPLE.replace(
        "-ripple*cos(9*position - phase)",
        "(2 + cos(ripple))*weight*exp(phase)",
    );
    let constant = format!(
        "{}parameters.weight = {{ unit = \"force\", range = [1.0, 2.0], description = \"d\" }}\n",
        constant.replace("unit = \"force\"", "unit = \"1\"")
    );
    let place = suspecting(BALANCE, bump, &[&constant]);
    let (code, message) = place.run("diagnose", &[]);
    assert_eq!(code, 2, "{message}");
    assert!(
        message.contains("nine_teeth: no value of a parameter"),
        "{message}"
    );
}

#[test]
fn an_effect_in_a_model_needs_its_values() {
    let place = suspecting(&format!("{BALANCE}{RIPPLE}"), bump, &[]);
    fs::remove_dir(place.file("effects")).unwrap();
    let (code, message) = place.run("diagnose", &[]);
    assert_eq!(code, 2, "{message}");
    for word in ["model.toml", "nine_teeth", "value"] {
        assert!(message.contains(word), "{word}: {message}");
    }
}
