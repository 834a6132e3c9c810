//! A pursuit at two ports finds the force at each, on two masses with a spring between them.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::f64::consts::TAU;

use super::pursuit::{Pursued, PursuedPort, pursue, substeps};
use super::swing;
use crate::component::{Component, ComponentError, Variable};
use inference::body::motion::{Measured, Motion};

const MASSES: [f64; 2] = [1.0, 2.0];
const STIFFNESS: f64 = 30.0;
const INTERVAL: f64 = 0.01;

/// Two masses with a spring between them: forces 0 and 1, positions 2 and 3, velocities 4 and 5.
#[derive(Default)]
struct Masses {
    values: [f64; 6],
}

impl Component for Masses {
    fn title(&self) -> String {
        "two masses".to_owned()
    }

    fn variables(&self) -> &[Variable] {
        &[]
    }

    fn set(&mut self, values: &[(usize, f64)]) -> Result<(), ComponentError> {
        for (at, value) in values {
            self.values[*at] = *value;
        }
        Ok(())
    }

    fn initialise(&mut self, _: f64, _: f64) -> Result<(), ComponentError> {
        Ok(())
    }

    fn reset(&mut self) -> Result<(), ComponentError> {
        self.values = [0.0; 6];
        Ok(())
    }

    fn get(&mut self, positions: &[usize], values: &mut [f64]) -> Result<(), ComponentError> {
        for (value, at) in values.iter_mut().zip(positions) {
            *value = self.values[*at];
        }
        Ok(())
    }

    fn step(&mut self, from: f64, to: f64) -> Result<(), ComponentError> {
        let h = (to - from) / 20.0;
        for _ in 0..20 {
            let spring = STIFFNESS * (self.values[2] - self.values[3]);
            for (at, pull) in [-spring, spring].into_iter().enumerate() {
                self.values[4 + at] += h * (self.values[at] + pull) / MASSES[at];
                self.values[2 + at] += h * self.values[4 + at];
            }
        }
        Ok(())
    }

    fn switches(&self) -> Option<u64> {
        None
    }
}

/// Position, velocity and acceleration at each mass: the second has rest to begin with, as the first has.
fn motion(time: f64) -> [[f64; 3]; 2] {
    let wave = |size: f64, rate: f64| {
        let (sine, cosine) = (rate * time).sin_cos();
        [
            size * (1.0 - cosine),
            size * rate * sine,
            size * rate * rate * cosine,
        ]
    };
    [wave(0.1, 5.0), wave(0.3, 3.0)]
}

/// A record of the motion at a mass, compared up to a frequency [Hz].
fn port(at: usize, cut_off: f64) -> PursuedPort {
    let times = || (0..800).map(|at| f64::from(at) * INTERVAL);
    PursuedPort {
        input: (at, 1.0),
        position: Some((2 + at, 1.0)),
        velocity: Some((4 + at, 1.0)),
        load: None,
        measured_position: times().map(|t| motion(t)[at][0]).collect(),
        measured_velocity: times().map(|t| motion(t)[at][1]).collect(),
        is_absolute: true,
        cut_off,
    }
}

fn pursued(ports: Vec<PursuedPort>) -> Pursued {
    Pursued {
        own_step: None,
        settings: Vec::new(),
        ports,
        inputs: Vec::new(),
        begin: 0.0,
        interval: INTERVAL,
    }
}

#[test]
fn noise_meets_the_inertia_that_follows_at_the_cut_off() {
    for cut_off in [1.5, 2.0, 8.0] {
        let frequency = TAU * cut_off;
        let calm = pursued(vec![port(0, cut_off)]);
        let mut swung = calm.clone();
        swing::add(&mut swung.ports[0], frequency, INTERVAL);
        let [calm, swung] = [calm, swung].map(|own| {
            let found = pursue(&mut Masses::default(), &own, &mut |_| {}).unwrap();
            found.into_iter().next().unwrap()
        });
        let position = Measured::Position(calm.position.clone());
        let motion = Motion::new("run".to_owned(), 0.0, INTERVAL, position, cut_off, 0.0);
        let found = swing::inertia(&motion, &calm, &swung, frequency);
        // The second mass on its spring follows the first so much.
        let follows = STIFFNESS / (STIFFNESS - MASSES[1] * frequency * frequency);
        let expected = (MASSES[0] + MASSES[1] * follows).abs();
        assert!(
            (found / expected - 1.0).abs() < 0.03,
            "{cut_off} Hz: {found} {expected}"
        );
    }
}

#[test]
fn the_force_at_each_port_is_what_moves_it_against_the_other() {
    let pursued = pursued(vec![port(0, 8.0), port(1, 8.0)]);
    let found = pursue(&mut Masses::default(), &pursued, &mut |_| {}).unwrap();
    for (own, mass) in found.iter().zip(MASSES) {
        assert!((own.inertia / mass - 1.0).abs() < 0.02, "{}", own.inertia);
    }
    for at in 100..700 {
        let time = at as f64 * INTERVAL;
        let [one, other] = motion(time);
        let spring = STIFFNESS * (one[0] - other[0]);
        let wanted = [MASSES[0] * one[2] + spring, MASSES[1] * other[2] - spring];
        for (own, wanted) in found.iter().zip(wanted) {
            assert!(
                (own.force[at] - wanted).abs() < 0.1,
                "{time} s: {} {wanted}",
                own.force[at]
            );
        }
    }
}

#[test]
fn as_many_steps_lie_before_a_sample_as_behind_it() {
    for cut_off in [0.1, 0.75, 1.5, 3.0, 4.1] {
        let (count, step) = substeps(0.02, cut_off, None);
        assert!(count > 0 && count % 2 == 0, "{count}");
        assert!((count as f64 * step / 0.02 - 1.0).abs() < 1e-12, "{step}");
    }
}

#[test]
fn an_fmu_with_a_step_of_its_own_is_stepped_by_multiples_of_it() {
    let (count, _) = substeps(0.02, 4.1, None);
    assert_eq!(count, 8);
    assert_eq!(substeps(0.02, 4.1, Some(0.001)), (10, 0.002));
    // The interval is no even multiple of these: the FMU says whether it takes other steps.
    assert_eq!(substeps(0.02, 4.1, Some(0.003)), (8, 0.0025));
    assert_eq!(substeps(0.02, 4.1, Some(0.02)), (8, 0.0025));
}
