//! Model files: those of the project and of the practice records load, survive a round trip, and what
//! is wrong with one is said by file, section, key, value and remedy.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod common;

use common::{LAWS, rig_text};
use std::path::Path;
use stickslip::plant::{
    DISC1_EFFECT_NAMES, EFFECT_NAMES, ModelFile, ModelFileError, Rig, RigKind, effect_infos,
};

const TWO_GAUSSIAN: &str = include_str!("../modelDescription/reduced-rig-two-gaussian.toml");

fn message(text: &str) -> String {
    ModelFile::parse(text, "model.toml")
        .unwrap_err()
        .to_string()
}

fn stribeck() -> String {
    rig_text(false, common::law("stribeck"), "")
}

/// The file with one line replaced; the line must be there.
fn with(old: &str, new: &str) -> String {
    let text = stribeck();
    assert!(text.contains(old), "{old}");
    text.replacen(old, new, 1)
}

#[test]
fn the_rigs_of_the_dissertation_state_where_every_number_comes_from() {
    for (text, kind) in [
        (common::REDUCED_RIG, RigKind::Reduced),
        (common::FULL_RIG, RigKind::Full),
        (TWO_GAUSSIAN, RigKind::Reduced),
    ] {
        let model = ModelFile::parse(text, "model.toml").unwrap();
        assert_eq!(model.rig.kind(), kind);
        for parameter in model.rig.parameters() {
            let provenance = &model.provenance[&parameter.name];
            assert!(
                provenance.source.is_some() && provenance.status.is_some(),
                "{}",
                parameter.name
            );
        }
    }
    let full = Rig::from_toml(common::FULL_RIG, "full-rig.toml").unwrap();
    assert_eq!(full.parameter("disc1.inertia"), Some(0.0288));
    assert_eq!(full.parameter("shaft1.stiffness"), Some(2.905));
    assert_eq!(full.parameter("shaft1.damping"), Some(0.0214));
}

#[test]
fn every_law_and_effect_survives_a_round_trip() {
    for law in LAWS {
        for full in [false, true] {
            let model = ModelFile::parse(&rig_text(full, law, ""), law.0).unwrap();
            let again = ModelFile::parse(&model.to_toml(), law.0).unwrap();
            assert_eq!(model, again, "{}", law.0);
        }
    }
    for name in EFFECT_NAMES.iter().chain(DISC1_EFFECT_NAMES) {
        let mut section = format!("[{name}]\n");
        for info in effect_infos(name).unwrap() {
            let value = [0.013, 1.0, 0.5]
                .into_iter()
                .find(|value| info.range.contains(*value))
                .unwrap();
            section += &format!("{} = {value}\n", info.key);
        }
        let is_on_disc1 = DISC1_EFFECT_NAMES.contains(name);
        let text = rig_text(is_on_disc1, common::law("coulomb"), &section);
        let model = ModelFile::parse(&text, name).unwrap();
        let again = ModelFile::parse(&model.to_toml(), name).unwrap();
        assert_eq!(model, again, "{name}");
        let disc1 = model.rig.disc1.iter();
        let mut active = disc1.flat_map(|disc1| disc1.effects.active());
        let first = model.rig.effects.active().first().copied();
        assert_eq!(first.or_else(|| active.next()).unwrap().0, *name);
    }
}

#[test]
fn a_rig_without_disc_d1_has_no_effects_on_it() {
    let text = rig_text(
        false,
        common::law("coulomb"),
        "[viscous_drag1]\ncoefficient = 0.01\n",
    );
    let error = ModelFile::parse(&text, "model.toml").unwrap_err();
    assert!(
        matches!(error, ModelFileError::UnknownSection { .. }),
        "{error}"
    );
}

#[test]
fn provenance_survives_a_round_trip() {
    let text = with(
        "inertia = 0.0149",
        "inertia = { value = 0.0149, unit = \"kg m2\", source = \"a \\\"quoted\\\" table\", status = \"fitted\", relative_uncertainty = 0.006, interval95 = [0.0147, 0.0151] }",
    );
    let model = ModelFile::parse(&text, "model.toml").unwrap();
    let provenance = &model.provenance["disc.inertia"];
    assert_eq!(provenance.source.as_deref(), Some("a \"quoted\" table"));
    assert_eq!(provenance.interval95, Some([0.0147, 0.0151]));
    assert_eq!(
        ModelFile::parse(&model.to_toml(), "model.toml").unwrap(),
        model
    );
}

#[test]
fn practice_models_load() {
    let copy = include_str!("data/practice-model.toml");
    assert_eq!(Rig::from_toml(copy, "copy").unwrap().law.name(), "stribeck");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/records/practice");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!(
            "{} is not there: only the kept copy was read",
            folder.display()
        );
        return;
    };
    for entry in entries {
        let path = entry.unwrap().path().join("model.toml");
        if path.is_file() {
            let text = std::fs::read_to_string(&path).unwrap();
            Rig::from_toml(&text, &path.display().to_string()).unwrap();
        }
    }
}

#[test]
fn what_is_not_toml() {
    let text = message("[disc\ninertia = 1");
    assert!(
        text.starts_with("model.toml: not valid TOML:") && text.contains("line 1"),
        "{text}"
    );
}

#[test]
fn missing_and_unknown_sections() {
    assert_eq!(
        message(&with("[disc]\ninertia = 0.0149\n", "")),
        "model.toml: section [disc] is missing; it needs inertia"
    );
    assert_eq!(
        message(stribeck().split("[contact]").next().unwrap()),
        "model.toml: section [contact] is missing; it needs radius, law and the law's parameters"
    );
    let text = message(&(stribeck() + "[disk]\ninertia = 1.0\n"));
    assert!(
        text.starts_with("model.toml: there is no section [disk]; known are disc, shaft, gearbox,")
            && text.contains("backlash"),
        "{text}"
    );
    // Half a full rig.
    let text = message(&(stribeck() + "[disc1]\ninertia = 0.03\n"));
    assert!(text.contains("section [contact1] is missing"), "{text}");
}

#[test]
fn missing_and_unknown_keys() {
    assert_eq!(
        message(&with("damping = 0.0022\n", "")),
        "model.toml: [shaft] lacks damping (Torsional viscous damping, N.m.s/rad)"
    );
    assert_eq!(
        message(&with("mu_c = 0.12\n", "")),
        "model.toml: [contact] lacks mu_c (Sliding friction coefficient at high slip velocity, 1)"
    );
    assert_eq!(
        message(&with("inertia = 0.0149", "inertia = 0.0149\nmass = 4.56")),
        "model.toml: [disc] has no key \"mass\"; known are inertia"
    );
    let text = message(&with("law = \"stribeck\"\n", ""));
    assert!(
        text.starts_with("model.toml: [contact] lacks law (friction law, one of coulomb,"),
        "{text}"
    );
    assert_eq!(
        message(&with(
            "ratio = 8.0",
            "ratio = { value = 8.0, origin = \"x\" }"
        )),
        "model.toml: [gearbox] has no key \"ratio.origin\"; known are value, unit, source, status, relative_uncertainty, interval95"
    );
}

#[test]
fn whole_numbers_do_for_every_number() {
    let text = with(
        "ratio = 8.0",
        "ratio = { value = 8, status = \"measured\", relative_uncertainty = 0, interval95 = [7, 9] }",
    );
    let file = ModelFile::parse(&text, "model.toml").unwrap();
    let provenance = &file.provenance["gearbox.ratio"];
    assert_eq!(provenance.relative_uncertainty, Some(0.0));
    assert_eq!(provenance.interval95, Some([7.0, 9.0]));
}

#[test]
fn wrong_types() {
    let text = message(&with("ratio = 8.0", "ratio = \"eight\""));
    assert_eq!(
        text,
        "model.toml: [gearbox] ratio = \"eight\" must be a number or { value = …, unit = …, source = …, status = … }"
    );
    for (old, new, part) in [
        (
            "ratio = 8.0",
            "ratio = { unit = \"1\" }",
            "[gearbox] ratio = { unit = \"1\" } must be a number",
        ),
        (
            "ratio = 8.0",
            "ratio = { value = 8.0, status = \"guessed\" }",
            "ratio.status = \"guessed\" must be one of published, measured, corrected, calibrated, fitted, assumed",
        ),
        (
            "ratio = 8.0",
            "ratio = { value = 8.0, unit = \"rpm\" }",
            "[gearbox] ratio.unit = \"rpm\" must be \"1\"; convert the value",
        ),
        (
            "inertia = 0.0149",
            "inertia = { value = 149.0, unit = \"kg cm2\" }",
            "[disc] inertia.unit = \"kg cm2\" must be \"kg.m2\"; convert the value",
        ),
        (
            "inertia = 0.0149",
            "inertia = { value = 0.0149, unit = 3 }",
            "[disc] inertia.unit = 3 must be \"kg.m2\"",
        ),
        (
            "ratio = 8.0",
            "ratio = { value = 8.0, relative_uncertainty = -0.1 }",
            "[gearbox] ratio.relative_uncertainty = -0.1 must be one standard deviation over the value, 0 or above",
        ),
        (
            "ratio = 8.0",
            "ratio = { value = 8.0, relative_uncertainty = inf }",
            "[gearbox] ratio.relative_uncertainty = inf must be one standard deviation",
        ),
        (
            "ratio = 8.0",
            "ratio = { value = 8.0, interval95 = [9.0, 7.0] }",
            "ratio.interval95 = [9.0, 7.0] must be two numbers, the lower one first",
        ),
        (
            "ratio = 8.0",
            "ratio = { value = 8.0, source = 3 }",
            "ratio.source = 3 must be a text",
        ),
        (
            "ratio = 8.0",
            "ratio = { value = 8.0, interval95 = [1.0] }",
            "ratio.interval95 = [1.0] must be two numbers",
        ),
        (
            "law = \"stribeck\"",
            "law = 3",
            "[contact] law = 3 must be one of coulomb, coulomb_stiction, stribeck",
        ),
        (
            "law = \"stribeck\"",
            "law = \"lugre\"",
            "[contact] law = \"lugre\" must be one of coulomb, coulomb_stiction, stribeck",
        ),
    ] {
        let text = message(&with(old, new));
        assert!(text.contains(part), "{text}");
    }
    let text = message(&format!(
        "disc = 3\n{}",
        stribeck().replacen("[disc]\ninertia = 0.0149\n", "", 1)
    ));
    assert!(
        text.contains("[disc] = 3 must be a section with inertia"),
        "{text}"
    );
}

#[test]
fn values_out_of_range() {
    for (old, new, expected) in [
        (
            "inertia = 0.0149",
            "inertia = 0.0",
            "model.toml: disc.inertia = 0 is out of range: it must be a finite number above 0",
        ),
        (
            "damping = 0.0022",
            "damping = -1.0",
            "model.toml: shaft.damping = -1 is out of range: it must be a finite number not below 0",
        ),
        (
            "radius = 0.075",
            "radius = nan",
            "model.toml: contact.radius = NaN is out of range: it must be a finite number above 0",
        ),
        (
            "ratio = 8.0",
            "ratio = inf",
            "model.toml: gearbox.ratio = inf is out of range: it must be a finite number above 0",
        ),
        (
            "mu_s = 0.2",
            "mu_s = 0.1",
            "model.toml: contact: the breakaway level mu_s = 0.1 is below the sliding level mu_c = 0.12; mu_s must not be smaller",
        ),
    ] {
        assert_eq!(message(&with(old, new)), expected);
    }
    let text = message(&(stribeck() + "[normal_force_wobble]\namplitude = 1.5\nphase = 0.0\n"));
    assert_eq!(
        text,
        "model.toml: normal_force_wobble.amplitude = 1.5 is out of range: it must be a number from 0 to 1"
    );
    // A hysteretic law whose lower branch would drive the disc.
    let law = (
        "wojewoda",
        "mu_c = 0.1\nmu_s = 0.25\nomega_s = 1.2\nstochastic_amplitude = 0.0\ncorrelation_angle = 0.3\nseed = 3",
    );
    let text = message(&rig_text(false, law, ""));
    assert!(
        text.contains("contact: the lower branch reaches") && text.contains("raise mu_c = 0.1"),
        "{text}"
    );
}

#[test]
fn setting_parameters_checks_names_and_ranges() {
    let mut rig = common::rig(false, common::law("stribeck"), "");
    for (position, parameter) in rig.parameters().into_iter().enumerate() {
        assert_eq!(rig.position(&parameter.name), Some(position));
        assert_eq!(rig.parameter(&parameter.name), rig.parameter_at(position));
    }
    rig.set_parameter("contact.mu_s", 0.3).unwrap();
    assert_eq!(rig.parameter("contact.mu_s"), Some(0.3));
    assert_eq!(
        rig.set_parameter("contact.mu", 0.3)
            .unwrap_err()
            .to_string(),
        "there is no parameter \"contact.mu\" in this model"
    );
    assert!(rig.set_parameter("disc.inertia", f64::NAN).is_err());
    assert!(rig.set_parameter_at(1000, 1.0).is_err());
    assert_eq!(rig.parameter_at(1000), None);
    rig.set_parameter("contact.mu_c", 0.4).unwrap();
    assert!(rig.check().is_err());
}

#[test]
fn errors_are_values() {
    let error = ModelFile::parse(&with("ratio = 8.0\n", ""), "model.toml").unwrap_err();
    assert!(matches!(error, ModelFileError::MissingKey { ref key, .. } if key == "ratio"));
}
