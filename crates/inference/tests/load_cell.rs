//! An error of the load cell in each level of the load is no effect, as far as its noise allows it.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use inference::diagnosis::{Verdict, diagnose};
use inference::problem::{Catalogue, Problem};
use stickslip::plant::Rig;

mod common;
use common::{instruments, prepare_threads, record};

const BELIEVED: &str = include_str!("../../../modelDescription/reduced-rig.toml");

/// The records of a rig whose load cell tells too much by `bias`, and how far off it calls itself in a level of the load.
fn read_by_a_poor_load_cell(bias: f64, stated: f64) -> Problem {
    prepare_threads();
    let rig = Rig::from_toml(BELIEVED, "believed").unwrap();
    let records: Vec<_> = (4..7)
        .map(|seed| {
            let mut record = record(&rig, seed);
            for force in record.normal_force.iter_mut().filter(|force| **force > 0.0) {
                *force += bias;
            }
            let per_level = record.time.len() as f64 / 4.0;
            record.load_deviations[0] = stated * per_level.sqrt();
            record
        })
        .collect();
    Problem::new(
        &rig,
        vec![("disc.inertia".to_owned(), 0.006)],
        &records,
        &instruments(),
        &Catalogue::default(),
    )
    .unwrap()
}

#[test]
fn what_an_error_of_the_load_cell_can_be_gets_no_effect_named() {
    for bias in [0.05, 0.1] {
        let found = diagnose(&read_by_a_poor_load_cell(bias, 2.0 * bias), &mut |_| {});
        assert_eq!(
            found.verdict,
            Verdict::NothingMissing,
            "{:?}",
            found.effects
        );
    }
}

#[test]
fn an_error_that_the_load_cell_cannot_have_is_named() {
    let found = diagnose(&read_by_a_poor_load_cell(0.1, 0.0), &mut |_| {});
    assert_eq!(found.verdict, Verdict::Named);
    assert_eq!(found.effects, ["load_cell_bias"]);
}
