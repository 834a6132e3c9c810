//! What acts in a few windows only is not in the catalogue, though most windows are explained.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use inference::diagnosis::{Diagnosis, Verdict, diagnose};
use inference::problem::{Catalogue, Problem};
use inference::record::{RawRecord, channel};
use stickslip::plant::Rig;

mod common;
use common::{instruments, prepare_threads, record};

const BELIEVED: &str = include_str!("../../../modelDescription/reduced-rig.toml");
/// Samples for which the encoder reads too little.
const SLIPPED: usize = 20;

/// A record in which the disc's encoder slips and reads up to `angle` [rad] too little for a moment, three times.
fn disturbed(rig: &Rig<f64>, seed: u64, angle: f64) -> RawRecord {
    let mut record = record(rig, seed);
    for first in [190, 350, 520] {
        for sample in 0..SLIPPED {
            let part = sample as f64 / SLIPPED as f64;
            record.readings[channel::THETA][first + sample] -=
                angle * (std::f64::consts::PI * part).sin();
        }
    }
    record
}

fn found(angle: f64) -> Diagnosis {
    prepare_threads();
    let rig = Rig::from_toml(BELIEVED, "believed").unwrap();
    let problem = Problem::new(
        &rig,
        vec![("disc.inertia".to_owned(), 0.006)],
        &[record(&rig, 4), disturbed(&rig, 5, angle)],
        &instruments(),
        &Catalogue::default(),
    )
    .unwrap();
    diagnose(&problem, &mut |_| {})
}

#[test]
fn what_acts_in_three_windows_is_flagged() {
    let found = found(0.1);
    let check = found.check;
    assert_eq!(found.verdict, Verdict::NotInCatalogue, "{check:?}");
    assert!(check.misfit < 1.1, "{check:?}");
    assert!((3..10).contains(&check.missed.missed), "{check:?}");
    let is_told = |reason: &String| reason.starts_with("it misses ");
    assert!(check.reasons.iter().any(is_told), "{check:?}");
}

#[test]
fn undisturbed_records_are_explained() {
    let found = found(0.0);
    assert_eq!(found.verdict, Verdict::NothingMissing, "{:?}", found.check);
}
