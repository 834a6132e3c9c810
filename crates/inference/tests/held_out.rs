//! The records to judge on have a say in whether the answer explains the records.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use inference::diagnosis::{Verdict, diagnose};
use inference::problem::{Catalogue, Problem};
use stickslip::plant::Rig;

mod common;
use common::{instruments, prepare_threads, record};

const BELIEVED: &str = include_str!("../../../modelDescription/reduced-rig.toml");

/// What is found from records of the believed rig, judged on two records of `judged`.
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
    let unseen = [record(&judged, 6), record(&judged, 7)];
    diagnose(&problem.checked_on(&unseen), &mut |_| {})
}

#[test]
fn what_shows_in_held_out_records_alone_is_not_in_the_catalogue() {
    let found = judged_on(&format!(
        "{BELIEVED}\n[unbalance]\ntorque = 0.05\nphase = 0.3\n"
    ));
    let check = found.check;
    assert_eq!(found.verdict, Verdict::NotInCatalogue, "{check:?}");
    assert!(check.misfit < 1.1 && check.structure < 7.0, "{check:?}");
    assert!(
        check.reasons[0].starts_with("it misses 2 of 4 windows that start from rest"),
        "{check:?}"
    );
}

#[test]
fn held_out_records_of_the_same_rig_change_nothing() {
    let found = judged_on(BELIEVED);
    assert_eq!(found.verdict, Verdict::NothingMissing, "{:?}", found.check);
}
