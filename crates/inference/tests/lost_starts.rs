//! A window that a right model misses, since its start was not found, is found again.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use inference::fit::Fit;
use inference::loss;
use inference::marginal::Disturbance;
use inference::problem::{Catalogue, Problem};
use stickslip::plant::{Rig, index};

mod common;
use common::{instruments, prepare_threads, record};

const BELIEVED: &str = include_str!("../../../modelDescription/reduced-rig.toml");

#[test]
fn a_start_on_the_wrong_side_of_a_breakaway_is_left() {
    prepare_threads();
    let rig = Rig::from_toml(BELIEVED, "believed").unwrap();
    let records: Vec<_> = (3..5)
        .map(|seed| {
            let mut record = record(&rig, seed);
            record.load_deviations = [0.2, 0.0];
            record
        })
        .collect();
    let problem = Problem::new(
        &rig,
        vec![("disc.inertia".to_owned(), 0.006)],
        &records,
        &instruments(),
        &Catalogue::default(),
    )
    .unwrap();
    let data = &problem.long;
    let calm = Disturbance::NONE;
    let right = Fit::at(data, problem.hypothesis(), data.anchors(), calm).improved_calmly(data, 20);
    assert!(right.misfit(data) < 1.1, "{}", right.misfit(data));
    // A disc that turns under load is started at rest, with a shaft that does not drive it.
    let j = (0..data.windows.len())
        .find(|&j| data.windows[j].anchor[index::OMEGA] > 0.5 && data.windows[j].load.is_some())
        .unwrap();
    let mut starts = right.starts.clone();
    starts[j].state[index::OMEGA] = 0.0;
    starts[j].state[index::THETA] = starts[j].state[index::THETA3];
    let lost = Fit::at(data, right.hypothesis.clone(), starts, calm);
    let of = |fit: &Fit| loss::of_window(&fit.reduced(data)[j]);
    assert!(
        of(&lost) > of(&right) + 50.0,
        "{} {}",
        of(&lost),
        of(&right)
    );
    let before = of(&lost);
    let found = lost.with_other_starts(data);
    assert!(of(&found) < before - 50.0, "{} {before}", of(&found));
    let found = found.improved_calmly(data, 20);
    assert!(
        of(&found) < of(&right) + 1.0,
        "{} {}",
        of(&found),
        of(&right)
    );
}
