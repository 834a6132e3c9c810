//! Records of tachometers alone that begin in the middle of the motion: nothing measured tells the twist of the shaft there.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use inference::diagnosis::{Verdict, diagnose};
use inference::problem::{Catalogue, Problem};
use inference::record::{RawRecord, channel};
use stickslip::plant::Rig;

mod common;
use common::{instruments, prepare_threads, record};

const BELIEVED: &str = include_str!("../../../modelDescription/reduced-rig.toml");

fn twist(record: &RawRecord, at: usize) -> f64 {
    record.readings[channel::THETA][at] - record.readings[channel::THETA3][at]
}

/// The sample at which the shaft is twisted most.
fn twisted_most(record: &RawRecord) -> usize {
    let size = |at: &usize| twist(record, *at).abs();
    let samples = 0..record.time.len() / 2;
    samples.max_by(|a, b| size(a).total_cmp(&size(b))).unwrap()
}

/// A record from a sample on, with its tachometers alone.
fn rest(record: &RawRecord, first: usize) -> RawRecord {
    let mut rest = record.clone();
    for series in [&mut rest.time, &mut rest.voltage, &mut rest.normal_force] {
        series.drain(..first);
    }
    rest.readings = Default::default();
    for channel in [channel::OMEGA, channel::OMEGA3] {
        rest.readings[channel] = record.readings[channel][first..].to_vec();
    }
    rest
}

#[test]
fn a_right_model_is_left_in_peace() {
    prepare_threads();
    let rig = Rig::from_toml(BELIEVED, "believed").unwrap();
    let whole = [record(&rig, 4), record(&rig, 5)];
    let rests = whole.each_ref().map(|own| rest(own, twisted_most(own)));
    let problem = Problem::new(
        &rig,
        vec![("disc.inertia".to_owned(), 0.006)],
        &rests,
        &instruments(),
        &Catalogue::default(),
    )
    .unwrap();
    for (run, whole) in problem.long.runs.iter().zip(&whole) {
        let first = twisted_most(whole);
        let error = |at: usize| {
            run.traces.disc.angle[at] - run.traces.gear.angle[at] - twist(whole, first + at)
        };
        let mean = (0..run.len()).map(error).sum::<f64>() / run.len() as f64;
        assert!(mean.abs() < 0.05 * problem.long.scales.twist, "{mean}");
    }
    let found = diagnose(&problem, &mut |_| {});
    assert_eq!(found.verdict, Verdict::NothingMissing, "{:?}", found.check);
}
