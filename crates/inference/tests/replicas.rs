//! A replica is a record that the fitted model itself would have left.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::sync::Arc;

use inference::fit::Fit;
use inference::hypothesis::Estimate;
use inference::marginal::Disturbance;
use inference::policy::LN_PRIOR_ODDS;
use inference::problem::{Catalogue, Problem};
use inference::record::channel;
use inference::replica::{replica, settled_on_replica};
use inference::structure::structures;
use inference::window::Begin;
use stickslip::plant::Rig;

mod common;
use common::{instruments, prepare_threads, record};

const BELIEVED: &str = include_str!("../../../modelDescription/reduced-rig.toml");

/// A record of a rig, and the same rig fitted to it, with friction that fluctuates by this share.
fn explained(relative: f64) -> (Problem, Fit) {
    prepare_threads();
    let rig = Rig::from_toml(BELIEVED, "believed").unwrap();
    let mut record = record(&rig, 3);
    record.load_deviations = [0.2, 0.0];
    let problem = Problem::new(
        &rig,
        vec![("disc.inertia".to_owned(), 0.006)],
        &[record],
        &instruments(),
        &Catalogue::default(),
    )
    .unwrap();
    let data = &problem.long;
    let fluctuating = Disturbance {
        relative,
        ..Disturbance::NONE
    };
    let fit = Fit::at(data, problem.hypothesis(), data.anchors(), fluctuating);
    (problem, fit)
}

#[test]
fn a_right_model_leaves_the_instruments_noise_of_a_replica() {
    for relative in [0.0, 0.04] {
        let (problem, fit) = explained(relative);
        let runs = replica(&problem, &fit, 1).unwrap();
        let data = problem.windows_of(Arc::new(runs), Begin::Clear);
        let misfit = Fit::at(
            &data,
            fit.hypothesis.clone(),
            data.anchors(),
            fit.disturbance,
        )
        .improved(&data, 4)
        .typical_misfit(&data);
        assert!((0.8..1.2).contains(&misfit), "{relative}: {misfit}");
        let (settled, data) = settled_on_replica(&problem, &fit, 1).unwrap();
        let left = structures(&data.divided(), &settled);
        assert!(left[0].gain < -LN_PRIOR_ODDS, "{:?}", left[0]);
    }
}

#[test]
fn friction_fluctuates_in_a_replica_as_it_was_found_to() {
    let [(problem, calm), (_, rough)] = [0.0, 0.04].map(|relative| {
        let (problem, fit) = explained(relative);
        let runs = replica(&problem, &fit, 7).unwrap();
        (problem, runs)
    });
    // Both have the same noise, so that what they do not share is the fluctuation.
    let largest = calm[0].readings[channel::OMEGA]
        .iter()
        .zip(&rough[0].readings[channel::OMEGA])
        .map(|(calm, rough)| (calm - rough).abs())
        .fold(0.0, f64::max);
    assert!(largest > 4.0 * problem.instruments.noise[channel::OMEGA]);
}

#[test]
fn a_seed_gives_the_same_replica_again() {
    let (problem, fit) = explained(0.04);
    let readings = |seed| replica(&problem, &fit, seed).unwrap()[0].readings.clone();
    assert_eq!(readings(5), readings(5));
    assert_ne!(readings(5), readings(6));
}

#[test]
fn fluctuating_friction_makes_numbers_less_certain_than_curvature_tells() {
    let deviations = |relative: f64| {
        let (problem, fit) = explained(relative);
        let inertia = |estimates: Vec<Estimate>| {
            let found = estimates.iter().find(|own| own.name == "disc.inertia");
            found.unwrap().deviation
        };
        [
            inertia(fit.estimates(&problem.long)),
            inertia(fit.replayed_estimates(&problem).estimates),
        ]
    };
    let [told, replayed] = deviations(0.04);
    assert!(replayed > 1.2 * told, "{replayed} {told}");
    let [told, replayed] = deviations(0.0);
    assert!((1.0..2.0).contains(&(replayed / told)), "{replayed} {told}");
}
