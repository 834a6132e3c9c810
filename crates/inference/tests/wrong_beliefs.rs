//! Numbers that are further off than the model says: no effect is named in their stead.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use inference::diagnosis::{Verdict, diagnose};
use inference::problem::{Catalogue, Problem};
use stickslip::plant::Rig;

mod common;
use common::{instruments, prepare_threads, record};

const BELIEVED: &str = include_str!("../../../modelDescription/reduced-rig.toml");

#[test]
fn a_disc_that_is_heavier_than_was_known_is_no_effect() {
    prepare_threads();
    let rig = Rig::from_toml(BELIEVED, "believed").unwrap();
    let mut truth = rig;
    let inertia = truth.parameter("disc.inertia").unwrap();
    truth.set_parameter("disc.inertia", 1.08 * inertia).unwrap();
    let records = [4, 5, 6].map(|seed| record(&truth, seed));
    let stated = [
        ("disc.inertia", 0.006),
        ("shaft.stiffness", 0.02),
        ("motor.torque_constant", 0.02),
        ("motor.back_emf_constant", 0.01),
        ("motor.coulomb_torque", 0.04),
        ("contact.mu_c", 0.02),
        ("contact.mu_s", 0.02),
    ];
    let problem = Problem::new(
        &rig,
        stated.map(|(name, own)| (name.to_owned(), own)).to_vec(),
        &records,
        &instruments(),
        &Catalogue::default(),
    )
    .unwrap();
    let found = diagnose(&problem, &mut |_| {});
    assert_eq!(found.verdict, Verdict::Parameters, "{:?}", found.check);
    assert!(found.is_doubting && found.effects.is_empty());
}
