//! What a balance compares: derivatives that it knows without another run, and moments whose force is known.

#![allow(clippy::unwrap_used, reason = "tests")]

use super::balance::Balance;
use super::base::{DRIVE, of_fmu};
use super::catalogue::entry;
use super::model::Model;
use super::motion::{Measured, Measurement, Motion, Pursuit, Scales};
use super::problem::Problem;
use stickslip::body::{Dimension, Kind, Parameter, Path};
use stickslip::parameter::Range;

fn wave(count: usize, rate: f64) -> Vec<f64> {
    (0..count)
        .map(|at| (rate * at as f64 * 0.01).sin())
        .collect()
}

const MEASUREMENT: Measurement = Measurement {
    motion_low_pass: 20.0,
    compare_low_pass: Some(8.0),
    compare_rate: 50.0,
    edge: 0.5,
    standstill_speed: 0.0,
};

/// A record of an FMU with two uncertain parameters.
fn pursued() -> Motion {
    let count = 1000;
    let position = Measured::Position(wave(count, 3.0));
    let mut motion = Motion::new("run".to_owned(), 0.0, 0.01, position, 20.0, 0.0);
    motion.force = wave(count, 5.0);
    motion.pursuit = Some(Pursuit {
        at: vec![2.0, 0.5],
        at_delays: vec![0.0],
        slopes: vec![wave(count, 4.0), wave(count, 7.0)],
        nominal: vec![0.1; count],
        inertia: 1.5,
        inertia_at_once: 1.2,
        inertia_slopes: vec![0.3, -0.2],
        delayed: vec![vec![0.0; count]],
        offsets: Vec::new(),
    });
    motion
}

/// A model with numbers of those parameters.
fn model() -> Model {
    let parameter = |key: &'static str, size: f64| Parameter {
        key,
        dimension: Dimension::Own { unit: "1", size },
        range: Range::Finite,
        description: "",
        guess: None,
    };
    let base = of_fmu(vec![parameter("a", 0.1), parameter("b", 0.02)]);
    Model::new(Kind::Fmu, Path::Turn, base, vec![2.4, 0.3])
}

#[test]
fn residuals_grow_with_an_fmus_parameters_as_the_pursuits_say() {
    let records = [pursued()];
    let model = model();
    let problem = Balance::new(&records, &MEASUREMENT, &Scales::of(&records))
        .knowing(&[])
        .weighing(&[1.3]);
    let all = |model: &Model| problem.residuals(model);
    let residuals = all(&model);
    for number in 0..2 {
        let slopes = problem.slopes(&model, &residuals, (0, number)).unwrap();
        let moved = |step: f64| {
            let mut moved = model.clone();
            moved.set(0, number, model.value(0, number) + step);
            all(&moved)
        };
        let (more, less) = (moved(1e-4), moved(-1e-4));
        assert_eq!(slopes.len(), residuals.len());
        for ((slopes, more), less) in slopes.iter().zip(&more).zip(&less) {
            assert_eq!(slopes.len(), more.len());
            for ((slope, more), less) in slopes.iter().zip(more).zip(less) {
                let wanted = (more - less) / 2e-4;
                assert!(
                    (slope - wanted).abs() < 1e-6 * (1.0 + wanted.abs()),
                    "{slope} {wanted}"
                );
            }
        }
    }
}

#[test]
fn the_force_is_the_sum_of_what_each_term_gives_and_grows_as_its_slopes_say() {
    let position = Measured::Position(wave(1000, 3.0));
    let mut motion = Motion::new("run".to_owned(), 0.0, 0.01, position, 20.0, 0.0);
    motion.force = wave(1000, 5.0);
    let unfiltered = Measurement {
        compare_low_pass: None,
        compare_rate: 100.0,
        edge: 0.0,
        ..MEASUREMENT
    };
    let records = [motion];
    let scales = Scales::of(&records);
    let problem = Balance::new(&records, &unfiltered, &scales);
    let base = Model::new(Kind::Drive, Path::Line, &DRIVE, vec![2.0, 0.5, 0.1]);
    let effects = [
        "coulomb_friction",
        "stribeck",
        "quadratic_drag",
        "friction_wear",
    ];
    let model = effects.iter().fold(base, |model, name| {
        let entry = entry(name).unwrap();
        let values = entry.starts(model.kind, model.path, &scales).swap_remove(0);
        model.with(entry, values)
    });
    for moment in problem.compared(&model) {
        let force = model.force(&moment.sample);
        assert!((moment.model - force).abs() < 1e-9 * (1.0 + force.abs()));
    }
    let residuals = problem.residuals(&model).concat();
    let mut known = 0;
    for (term, number, _) in model.free() {
        let pieces = problem.residuals(&model);
        let Some(slopes) = problem.slopes(&model, &pieces, (term, number)) else {
            continue;
        };
        known += 1;
        let mut moved = model.clone();
        moved.set(term, number, model.value(term, number) + 1.0);
        let moved = problem.residuals(&moved).concat();
        for ((slope, after), before) in slopes.concat().iter().zip(moved).zip(&residuals) {
            assert!((slope - (after - before)).abs() < 1e-9 * (1.0 + slope.abs()));
        }
    }
    // Inertia, viscous friction, offset, drag, rate of wear: the friction's own numbers change what wears too.
    assert_eq!(known, 5);
}

#[test]
fn a_force_at_rest_shows_in_no_other_moment() {
    let residuals = |at_rest: f64| {
        let mut motion = pursued();
        motion.tells[400..450].fill(false);
        motion.force[400..450].fill(at_rest);
        let records = [motion];
        Balance::new(&records, &MEASUREMENT, &Scales::of(&[pursued()])).residuals(&model())
    };
    assert_eq!(residuals(0.0), residuals(100.0));
}
