//! A diagnosis of the full rig: what is missing is named with the disc on which it acts.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use inference::diagnosis::{Verdict, diagnose};
use inference::effects::EFFECTS;
use inference::problem::{Catalogue, Problem};
use stickslip::plant::Rig;

mod common;
use common::{instruments, prepare_threads, record};

const BELIEVED: &str = include_str!("../../../modelDescription/full-rig.toml");
/// What is known of the rig, as relative standard deviations.
const UNCERTAINTIES: [(&str, f64); 6] = [
    ("disc1.inertia", 0.006),
    ("shaft1.stiffness", 0.02),
    ("contact1.mu_c", 0.02),
    ("disc.inertia", 0.006),
    ("shaft.stiffness", 0.02),
    ("motor.coulomb_torque", 0.04),
];

/// The effects that are named in records of the believed rig with `effect`, where the catalogue has these alone.
fn named(effect: &str, catalogue: &[&str]) -> (Verdict, Vec<&'static str>) {
    let believed = Rig::from_toml(BELIEVED, "believed").unwrap();
    let truth = Rig::from_toml(&format!("{BELIEVED}\n{effect}"), "truth").unwrap();
    let without = EFFECTS
        .iter()
        .map(|effect| effect.name)
        .filter(|name| !catalogue.contains(name));
    let problem = Problem::new(
        &believed,
        UNCERTAINTIES
            .map(|(name, deviation)| (name.to_owned(), deviation))
            .to_vec(),
        &[record(&truth, 1)],
        &instruments(),
        &Catalogue {
            without: without.map(str::to_owned).collect(),
            supposed: Vec::new(),
        },
    )
    .unwrap();
    let found = diagnose(&problem, &mut |_| {});
    (found.verdict, found.effects)
}

/// Effects on either disc.
const ON_DISCS: [&str; 8] = [
    "bearing_friction",
    "unbalance",
    "viscous_drag",
    "quadratic_drag",
    "bearing_friction1",
    "unbalance1",
    "viscous_drag1",
    "quadratic_drag1",
];

#[test]
fn an_effect_is_named_with_the_disc_on_which_it_acts() {
    prepare_threads();
    for (section, name) in [
        ("[unbalance1]\ntorque = 0.03\nphase = 0.7\n", "unbalance1"),
        ("[viscous_drag]\ncoefficient = 0.008\n", "viscous_drag"),
    ] {
        assert_eq!(named(section, &ON_DISCS), (Verdict::Named, vec![name]));
    }
}

#[test]
fn a_model_that_lacks_nothing_is_left_in_peace() {
    prepare_threads();
    assert_eq!(named("", &ON_DISCS), (Verdict::NothingMissing, Vec::new()));
}

#[test]
fn what_the_catalogue_does_not_have_of_disc_d1_gets_no_name() {
    prepare_threads();
    let unbalance = "[unbalance1]\ntorque = 0.03\nphase = 0.7\n";
    let (verdict, _) = named(unbalance, &["viscous_drag1", "bearing_friction"]);
    assert_eq!(verdict, Verdict::NotInCatalogue);
}
