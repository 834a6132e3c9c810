//! What is missing is found although the analyst's model is so far off that no derivative there leads to it.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use inference::diagnosis::{Diagnosis, Verdict, diagnose};
use inference::problem::{Catalogue, Problem};
use stickslip::expression::Coordinate;
use stickslip::plant::{Port, Rig};

mod common;
use common::{Steps, instruments, prepare_threads, record_of};

/// The drive stops, so that the disc rests and has to let go.
const STOPPED: Steps = [
    (3.0, 40.0, 0.0),
    (0.0, 40.0, 0.0),
    (4.0, 30.0, 0.0),
    (7.0, 20.0, 0.0),
];

/// The reduced rig with the contact `law`.
fn rig(law: &str) -> String {
    let file = include_str!("../../../modelDescription/reduced-rig.toml");
    let contact = file.find("\n[contact]").unwrap();
    let radius = "radius = { value = 0.075, unit = \"m\" }";
    format!("{}\n[contact]\n{radius}\n{law}\n", &file[..contact])
}

/// What is found in records of `truth` with a model that is believed to be `believed`, and with these effects of the catalogue.
fn found(believed: &str, truth: &str, effects: &[&str]) -> Diagnosis {
    prepare_threads();
    let [believed, truth] = [believed, truth].map(|text| Rig::from_toml(text, "test").unwrap());
    let known = inference::effects::EFFECTS.iter().map(|own| own.name);
    let problem = Problem::new(
        &believed,
        vec![("contact.mu_c".to_owned(), 0.02)],
        &[6, 7].map(|seed| record_of(&truth, seed, STOPPED)),
        &instruments(),
        &Catalogue {
            without: known
                .filter(|name| !effects.contains(name))
                .map(str::to_owned)
                .collect(),
            supposed: Vec::new(),
        },
    )
    .unwrap();
    diagnose(&problem, &mut |_| {})
}

#[test]
fn stiction_starts_at_the_friction_at_which_the_disc_let_go() {
    let coulomb = rig("law = \"coulomb\"\nmu_c = { value = 0.15, unit = \"1\" }");
    let stiction = rig(
        "law = \"coulomb_stiction\"\nmu_c = { value = 0.15, unit = \"1\" }\nmu_s = { value = 0.33, unit = \"1\" }",
    );
    let effects = ["stiction", "viscous_drag", "bearing_friction", "backlash"];
    let found = found(&coulomb, &stiction, &effects);
    assert_eq!(found.verdict, Verdict::Named, "{:?}", found.check);
    assert_eq!(found.effects, ["stiction"]);
    let breakaway = found.best.hypothesis.value("contact.mu_s").unwrap();
    assert!((breakaway / 0.33 - 1.0).abs() < 0.03, "{breakaway}");
}

#[test]
fn a_bump_of_friction_over_speed_is_learned() {
    let coulomb = rig("law = \"coulomb\"\nmu_c = { value = 0.15, unit = \"1\" }");
    let bump = format!(
        "{coulomb}\n[[effect]]\nname = \"bump\"\ntitle = \"a bump\"\nport = \"disc.friction\"\n\
         equation = \"1 + height*exp(-((abs(velocity) - centre)/width)^2)\"\n\
         parameters.height = {{ value = 1.5, unit = \"1\", description = \"height\" }}\n\
         parameters.centre = {{ value = 4.0, unit = \"rad/s\", description = \"centre\" }}\n\
         parameters.width = {{ value = 1.0, unit = \"rad/s\", range = \"positive\", description = \"width\" }}\n"
    );
    let found = found(&coulomb, &bump, &["viscous_drag"]);
    assert_eq!(found.verdict, Verdict::NotInCatalogue, "{:?}", found.check);
    let learned = found.learned.unwrap();
    let there = (learned.family.port, learned.family.over);
    assert_eq!(there, (Port::DiscFriction, Coordinate::Velocity));
    let highest = learned.table.values.iter().copied().fold(0.0, f64::max);
    assert!((1.2..1.7).contains(&highest), "{:?}", learned.table.values);
}
