//! The record to judge on has a say in whether the answer explains the records.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use inference::diagnosis::{Verdict, diagnose};
use inference::problem::{Catalogue, Problem};
use stickslip::plant::Rig;

mod common;
use common::{instruments, prepare_threads, record};

const BELIEVED: &str = include_str!("../../../modelDescription/reduced-rig.toml");

/// What is found from records of the believed rig, judged on a record of `judged`.
fn judged_on(judged: &str) -> inference::diagnosis::Diagnosis {
    prepare_threads();
    let believed = Rig::from_toml(BELIEVED, "believed").unwrap();
    let judged = Rig::from_toml(judged, "judged").unwrap();
    let problem = Problem::new(
        &believed,
        vec![("disc.inertia".to_owned(), 0.006)],
        &[record(&believed, 4), record(&believed, 5)],
        &instruments(),
        &Catalogue::default(),
    )
    .unwrap();
    diagnose(&problem.checked_on(&[record(&judged, 6)]), &mut |_| {})
}

#[test]
fn what_shows_in_the_held_out_record_alone_is_not_in_the_catalogue() {
    let found = judged_on(&format!(
        "{BELIEVED}\n[unbalance]\ntorque = 0.05\nphase = 0.3\n"
    ));
    let check = found.check;
    assert_eq!(found.verdict, Verdict::NotInCatalogue, "{check:?}");
    assert!(check.misfit < 1.1 && check.structure < 7.0, "{check:?}");
    assert!(
        check.reasons[0].starts_with("windows that start from rest leave"),
        "{check:?}"
    );
}

#[test]
fn a_held_out_record_of_the_same_rig_changes_nothing() {
    let found = judged_on(BELIEVED);
    assert_eq!(found.verdict, Verdict::NothingMissing, "{:?}", found.check);
}
