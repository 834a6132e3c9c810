//! Random calls of a solver, legal and not, on instances for model exchange of both versions: every status is the one that the
//! standard wants, evaluation leaves no trace, and a reset makes the instance as new.
//!
//! `STICKSLIP_CALLS=1000000` makes that many for each version; without it there are fewer.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod common;
mod importer;

use common::Uniform;
use importer::exchange::Vector;
use importer::{Component, FULL_RIG, Fmi2, Fmi3, Instance, REDUCED_RIG, Version};
use stickslip::ffi::Status::{Discard, Error, Ok};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Event,
    Continuous,
}

/// What is asked of a component: two inputs with their starts, a derivative and a state.
struct Subject {
    model: &'static str,
    inputs: [(&'static str, f64); 2],
    derivative: &'static str,
    state: &'static str,
}

const RIG: Subject = Subject {
    model: REDUCED_RIG,
    inputs: [("u", 3.1), ("N2", 50.0)],
    derivative: "der(theta_dot)",
    state: "theta",
};

const CONTROLLER: Subject = Subject {
    model: include_str!("../modelDescription/soft-torque.toml"),
    inputs: [("omega_ref", 12.0), ("theta3_dot", 2.0)],
    derivative: "der(filtered_torque)",
    state: "filtered_torque",
};

/// An instance and what is known of it.
struct Trial<'a> {
    subject: &'a Subject,
    instance: Instance<'a>,
    phase: Phase,
    random: Uniform,
    calls: usize,
    events: usize,
    refusals: usize,
    /// Whether what sticks stands still: bristles give way.
    rigid: bool,
}

impl<'a> Trial<'a> {
    fn new(subject: &'a Subject, component: &'a Component, version: Version, seed: u64) -> Self {
        let mut instance = component.instantiate_for_exchange(version);
        instance.initialize(0.0, &subject.inputs);
        Self {
            subject,
            instance,
            phase: Phase::Event,
            random: Uniform(seed),
            calls: 0,
            events: 0,
            refusals: 0,
            rigid: component.table.find("stuck").is_some()
                && component.table.find("presliding_deflection").is_none(),
        }
    }

    fn pick(&mut self, count: usize) -> usize {
        ((self.random.next() * count as f64) as usize).min(count - 1)
    }

    /// States that a rig may be in, some of them at rest.
    fn states(&mut self) -> Vec<f64> {
        let count = self.instance.state_count();
        let rest = self.pick(3) == 0;
        let mut state = |place: usize| match place {
            1 | 6 if rest => 0.0,
            0 | 2 | 5 => self.random.between(-3.0, 3.0),
            _ => self.random.between(-20.0, 20.0),
        };
        (0..count).map(&mut state).collect()
    }

    fn bits(&self, which: Vector) -> Vec<u64> {
        self.instance
            .vector(which)
            .into_iter()
            .map(f64::to_bits)
            .collect()
    }

    /// After an error the instance needs a reset; then it is as new.
    fn reset(&mut self) {
        self.refusals += 1;
        self.instance.log.take();
        self.instance.reset();
        self.instance.initialize(0.0, &self.subject.inputs);
        self.phase = Phase::Event;
    }

    fn call(&mut self) {
        self.calls += 1;
        let continuous = self.phase == Phase::Continuous;
        match self.pick(14) {
            0 => {
                let status = self.instance.enter_continuous_time();
                if continuous {
                    assert_eq!(status, Error);
                    return self.reset();
                }
                assert_eq!(status, Ok);
                self.phase = Phase::Continuous;
            }
            1 => {
                let status = self.instance.enter_events();
                if !continuous {
                    assert_eq!(status, Error);
                    return self.reset();
                }
                assert_eq!(status, Ok);
                self.phase = Phase::Event;
            }
            2 if !continuous => {
                self.events += usize::from(self.instance.update_discrete_states());
                // Nothing is left to iterate.
                assert!(!self.instance.update_discrete_states());
                if self.rigid && self.instance.is("stuck") {
                    assert_eq!(self.instance.get("der(theta_dot)"), 0.0);
                }
            }
            3 | 4 => {
                let states = self.states();
                let status = self.instance.set_states(&states);
                if !continuous {
                    assert_eq!(status, Error);
                    return self.reset();
                }
                assert_eq!(status, Ok);
                assert_eq!(self.instance.vector(Vector::States), states);
            }
            5 => {
                let time = self.random.between(0.0, 100.0);
                assert_eq!(self.instance.set_time(time), Ok);
            }
            6 => {
                let which = [Vector::Derivatives, Vector::Indicators][self.pick(2)];
                assert_eq!(self.bits(which), self.bits(which));
            }
            7 => {
                let value = self.random.between(-10.0, 10.0);
                self.instance.set(self.subject.inputs[0].0, value);
            }
            8 => {
                let value = self.random.between(-10.0, 100.0);
                self.instance.set(self.subject.inputs[1].0, value);
            }
            9 if continuous => {
                self.instance.complete_step();
            }
            10 => {
                let before = [
                    self.bits(Vector::Derivatives),
                    self.bits(Vector::Indicators),
                ];
                let saved = self.instance.save();
                let bytes = self.instance.serialize(saved);
                if continuous {
                    let states = self.states();
                    assert_eq!(self.instance.set_states(&states), Ok);
                } else {
                    self.instance.update_discrete_states();
                }
                self.instance.set(self.subject.inputs[1].0, 7.0);
                let back = self.instance.deserialize(&bytes);
                self.instance.restore(back);
                let after = [
                    self.bits(Vector::Derivatives),
                    self.bits(Vector::Indicators),
                ];
                assert_eq!(before, after);
                for mut state in [saved, back] {
                    assert_eq!(self.instance.free_state(&mut state), Ok);
                }
            }
            11 if continuous => {
                // Somewhere else and back: evaluation leaves no trace.
                let (here, before) = (
                    self.instance.vector(Vector::States),
                    self.bits(Vector::Derivatives),
                );
                let there = self.states();
                assert_eq!(self.instance.set_states(&there), Ok);
                let _ = self.bits(Vector::Indicators);
                assert_eq!(self.instance.set_states(&here), Ok);
                assert_eq!(self.bits(Vector::Derivatives), before);
            }
            12 => {
                let derivative = self
                    .instance
                    .derivative(self.subject.derivative, self.subject.state);
                assert!(derivative.is_finite());
                if self.instance.version == Fmi3 {
                    let adjoint = self
                        .instance
                        .try_adjoint(
                            &[self.subject.derivative],
                            &[self.subject.state, self.subject.inputs[0].0],
                            &[1.0],
                        )
                        .unwrap();
                    assert_eq!(adjoint[0], derivative);
                }
            }
            13 => {
                assert_eq!(self.instance.set_time(f64::NAN), Discard);
                let status = self.instance.set_references(&[3], &[f64::INFINITY]);
                assert!(matches!(status, Discard | Error), "{status:?}");
                self.instance.log.take();
                if status == Error {
                    self.reset();
                }
            }
            _ => {}
        }
    }
}

#[test]
fn random_calls_are_answered_as_the_standard_wants() {
    let wanted = std::env::var("STICKSLIP_CALLS").map_or(20_000, |calls| calls.parse().unwrap());
    let two_gaussian = include_str!("../modelDescription/reduced-rig-two-gaussian.toml");
    let loose = format!(
        "{REDUCED_RIG}\n[backlash]\ngap = 0.05\n[presliding]\nstiffness = 200.0\ndamping = 0.1\n"
    );
    let loose: &'static str = loose.leak();
    let rig = |model| Subject { model, ..RIG };
    let subjects = [
        RIG,
        rig(FULL_RIG),
        rig(two_gaussian),
        rig(loose),
        CONTROLLER,
    ];
    for version in [Fmi2, Fmi3] {
        let (mut calls, mut events, mut refusals) = (0, 0, 0);
        for (number, subject) in subjects.iter().enumerate() {
            let component = Component::new(subject.model);
            let mut trial = Trial::new(subject, &component, version, 4711 + number as u64);
            for _ in 0..wanted / subjects.len() {
                trial.call();
            }
            calls += trial.calls;
            events += trial.events;
            refusals += trial.refusals;
        }
        println!(
            "{version:?}: {calls} calls, {events} events that set states, {refusals} resets after errors"
        );
        assert!(
            calls > wanted / 2 && events > 5 && refusals > 100,
            "{calls} {events} {refusals}"
        );
    }
}
