//! What the XML of the four components claims of their abilities is what they can: every attribute of `CoSimulation`
//! has a check here, through the C interface of its version. A new claim without a check fails. That what is not claimed
//! is refused is tested in `src/ffi/tests`, several instances in one process in `ffi_rig.rs`.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

#[path = "../importer/mod.rs"]
mod importer;
mod intermediate_update;

use importer::{Component, FULL_RIG, Fmi2, Fmi3, Instance, REDUCED_RIG, Version};
use intermediate_update::{intermediate_update, returns_early_when_asked};
use std::path::Path;
use stickslip::cosim::{Causality, VariableType};
use stickslip::ffi::Status::{Error, Ok};

/// A component and a case of it.
struct Subject {
    name: &'static str,
    model: &'static str,
    values: &'static [(&'static str, f64)],
    /// Times [s] at which no output has a kink as a function of an input.
    smooth: &'static [f64],
}

/// Time [s] until which every subject has a switch.
const SWITCH: f64 = 5.0;

/// Once stuck, then sliding.
const RIG_SMOOTH: &[f64] = &[0.3, 1.7, 3.1, 3.5];

const SUBJECTS: [Subject; 4] = [
    Subject {
        name: "ReducedRig",
        model: REDUCED_RIG,
        values: &[("u", 3.1), ("N2", 50.0)],
        smooth: RIG_SMOOTH,
    },
    Subject {
        name: "FullRig",
        model: FULL_RIG,
        values: &[("u", 3.1), ("N1", 25.0), ("N2", 50.0)],
        smooth: RIG_SMOOTH,
    },
    // The integral reaches the voltage's limit after 0.57 s, and the voltage stays on the edge of leaving it.
    Subject {
        name: "SpeedController",
        model: include_str!("../../modelDescription/speed-controller.toml"),
        values: &[("omega_ref", 6.0), ("theta3_dot", 1.0)],
        smooth: &[0.1, 0.5],
    },
    // The integral reaches the voltage's limit within some seconds.
    Subject {
        name: "SoftTorque",
        model: include_str!("../../modelDescription/soft-torque.toml"),
        values: &[("omega_ref", 8.0), ("theta3_dot", 1.0), ("i", 0.1)],
        smooth: &[0.001, 0.3, 1.0],
    },
];

/// A component in one version, and what is asked of it.
struct Trial<'a> {
    subject: &'a Subject,
    component: &'a Component,
    version: Version,
}

impl Trial<'_> {
    fn start(&self) -> Instance<'_> {
        self.component.start(self.version, self.subject.values)
    }

    fn outputs(&self) -> Vec<String> {
        let outputs = self.component.table.outputs();
        let real = outputs.filter(|output| output.variable_type == VariableType::Real);
        real.map(|variable| variable.name.clone()).collect()
    }

    fn bits(&self, instance: &Instance<'_>) -> Vec<u64> {
        let names = self.outputs();
        names
            .iter()
            .map(|name| instance.get(name).to_bits())
            .collect()
    }

    /// Largest difference of the outputs of two instances, relative where they are large.
    fn difference(&self, one: &Instance<'_>, other: &Instance<'_>) -> f64 {
        let difference = |name: &String| {
            let (one, other) = (one.get(name), other.get(name));
            (one - other).abs() / one.abs().max(1.0)
        };
        self.outputs().iter().map(difference).fold(0.0, f64::max)
    }
}

/// The attributes of the element `CoSimulation` in the kept description.
fn claims(name: &str, version: Version) -> Vec<(String, String)> {
    let number = if version == Fmi2 { 2 } else { 3 };
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join(format!("modelDescription/{name}.fmi{number}.xml"));
    let xml = std::fs::read_to_string(path).unwrap();
    let (_, element) = xml.split_once("<CoSimulation ").unwrap();
    let (attributes, _) = element.split_once('>').unwrap();
    let mut words = attributes.trim_end_matches('/').split('"');
    let mut claims = Vec::new();
    while let (Some(key), Some(value)) = (words.next(), words.next()) {
        claims.push((
            key.trim().trim_end_matches('=').to_owned(),
            value.to_owned(),
        ));
    }
    claims
}

#[test]
fn every_claim_is_kept() {
    for subject in &SUBJECTS {
        let component = &Component::new(subject.model);
        for version in [Fmi2, Fmi3] {
            let trial = Trial {
                subject,
                component,
                version,
            };
            let claims = claims(subject.name, version);
            assert!(claims.len() > 5, "{claims:?}");
            for (claim, value) in &claims {
                println!("{} {version:?}: {claim} = {value}", subject.name);
                match (claim.as_str(), value.as_str()) {
                    ("modelIdentifier", name) => assert_eq!(name, subject.name),
                    ("canHandleVariableCommunicationStepSize", "true") => any_step_size(&trial),
                    ("canInterpolateInputs", "true") => input_derivatives(&trial),
                    ("maxOutputDerivativeOrder", order) => {
                        output_derivatives(&trial, order.parse().unwrap());
                    }
                    // Every instance of these tests has no functions to allocate and to free with.
                    ("canNotUseMemoryManagementFunctions", "true") => trial.start().step(1.0),
                    ("canGetAndSetFMUstate" | "canGetAndSetFMUState", "true") => saves(&trial),
                    ("canSerializeFMUstate" | "canSerializeFMUState", "true") => serialises(&trial),
                    (
                        "providesDirectionalDerivative" | "providesDirectionalDerivatives",
                        "true",
                    ) => {
                        directional_derivatives(&trial);
                    }
                    ("providesAdjointDerivatives", "true") => adjoint_derivatives(&trial),
                    ("mightReturnEarlyFromDoStep", "true") => returns_early(&trial),
                    ("hasEventMode", "true") => event_mode(&trial),
                    ("providesIntermediateUpdate", "true") => intermediate_update(&trial),
                    ("canReturnEarlyAfterIntermediateUpdate", "true") => {
                        returns_early_when_asked(&trial);
                    }
                    other => panic!("{other:?} is claimed and not tested"),
                }
            }
        }
    }
}

fn any_step_size(trial: &Trial<'_>) {
    let (mut even, mut uneven) = (trial.start(), trial.start());
    even.run(0.1, 6.0);
    let mut size = 1e-4;
    while uneven.time < 6.0 - size {
        uneven.step(size);
        size = (1.7 * size) % 0.3 + 1e-6;
    }
    uneven.step(6.0 - uneven.time);
    assert!(trial.difference(&even, &uneven) < 1e-12);
}

/// A cubic of time in every input, set once, against the same cubic set anew on the way about other points.
fn input_derivatives(trial: &Trial<'_>) {
    let inputs: Vec<_> = trial
        .component
        .table
        .variables()
        .iter()
        .filter(|variable| variable.causality == Causality::Input)
        .map(|variable| variable.name.clone())
        .collect();
    assert!(inputs.len() > 1);
    let value = |t: f64| 2.0 + t - 0.3 * t * t + 0.05 * t * t * t;
    let derivatives = |t: f64| [1.0 - 0.6 * t + 0.15 * t * t, -0.6 + 0.3 * t, 0.3];
    let set = |instance: &Instance<'_>, t: f64| {
        for input in &inputs {
            instance.set(input, value(t));
            for (order, derivative) in (1..).zip(derivatives(t)) {
                assert_eq!(instance.set_input_derivative(input, order, derivative), Ok);
            }
        }
    };
    let (mut once, mut anew) = (trial.start(), trial.start());
    set(&once, 0.0);
    once.run(0.5, 3.0);
    while anew.time < 2.9 {
        set(&anew, anew.time);
        anew.step(0.25);
    }
    for input in &inputs {
        assert!((once.get(input) - value(3.0)).abs() < 1e-12, "{input}");
    }
    assert!((anew.time - 3.0).abs() < 1e-12);
    let difference = trial.difference(&once, &anew);
    assert!(difference < 1e-9, "{difference:e}");
}

/// Each order against the difference of the order below a little before and after; the order beyond is refused.
fn output_derivatives(trial: &Trial<'_>, maximum: i32) {
    let width = 1e-5;
    let mut instance = trial.start();
    instance.run(0.01, 0.3 - width);
    let names = trial.outputs();
    let read = |instance: &Instance<'_>, name: &str, order: i32| match order {
        0 => instance.get(name),
        order => instance.output_derivative(name, order),
    };
    let mut at = Vec::new();
    for _ in 0..3 {
        let values: Vec<Vec<f64>> = names
            .iter()
            .map(|name| (0..=maximum).map(|o| read(&instance, name, o)).collect())
            .collect();
        at.push(values);
        instance.step(width);
    }
    for (place, name) in names.iter().enumerate() {
        for order in 1..=maximum as usize {
            let [before, now, after] = [0, 1, 2].map(|time| &at[time][place]);
            let difference = (after[order - 1] - before[order - 1]) / (2.0 * width);
            let error = (now[order] - difference).abs() / now[order].abs().max(1.0);
            assert!(
                error < 1e-4,
                "{name}, order {order}: {} and {difference}",
                now[order]
            );
        }
    }
    let mut moving = false;
    for name in &names {
        moving |= instance.output_derivative(name, 1) != 0.0;
    }
    assert!(moving, "something moves");
    let beyond = instance.try_output_derivative(&names[0], maximum + 1);
    assert_eq!(beyond, Err(Error));
}

fn saves(trial: &Trial<'_>) {
    let mut instance = trial.start();
    instance.run(0.007, 2.0);
    let state = instance.save();
    instance.run(0.007, 6.0);
    let expected = trial.bits(&instance);
    instance.restore(state);
    assert_eq!(instance.time, 2.0);
    instance.run(0.007, 6.0);
    assert_eq!(trial.bits(&instance), expected);
}

fn serialises(trial: &Trial<'_>) {
    let mut instance = trial.start();
    instance.run(0.007, 2.0);
    let bytes = instance.serialize(instance.save());
    instance.run(0.007, 6.0);
    let mut other = trial.component.instantiate(trial.version);
    other.restore(other.deserialize(&bytes));
    other.run(0.007, 6.0);
    assert_eq!(trial.bits(&other), trial.bits(&instance));
}

/// Every output by every input, singly and in one direction, against differences.
fn directional_derivatives(trial: &Trial<'_>) {
    let mut instance = trial.start();
    let mut depends = 0;
    for time in trial.subject.smooth {
        instance.run(0.01, *time);
        for unknown in trial.outputs() {
            let (mut sum, mut knowns, mut seed) = (0.0, Vec::new(), Vec::new());
            for (name, value) in trial.subject.values {
                let difference = difference_quotient(&mut instance, &unknown, name, *value);
                let derivative = instance.derivative(&unknown, name);
                let error = (derivative - difference).abs();
                assert!(
                    error < 1e-8 * derivative.abs().max(1.0),
                    "{unknown} by {name} at {time}: {derivative} and {difference}"
                );
                depends += usize::from(derivative != 0.0);
                knowns.push(*name);
                seed.push(1.0 + sum);
                sum += derivative * (1.0 + sum);
            }
            let together = instance.try_directional(&unknown, &knowns, &seed).unwrap();
            assert!((together - sum).abs() < 1e-12 * sum.abs().max(1.0));
        }
    }
    assert!(depends > 0, "some output depends on some input");
}

/// All outputs together, with seeds of their own, against one after the other.
fn adjoint_derivatives(trial: &Trial<'_>) {
    let mut instance = trial.start();
    let outputs = trial.outputs();
    let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
    let seed: Vec<f64> = (0..outputs.len()).map(|n| 1.0 + 0.7 * n as f64).collect();
    let knowns: Vec<&str> = trial.subject.values.iter().map(|(name, _)| *name).collect();
    let mut depends = 0;
    for time in trial.subject.smooth {
        instance.run(0.01, *time);
        let found = instance.try_adjoint(&outputs, &knowns, &seed).unwrap();
        for (known, found) in knowns.iter().zip(found) {
            let terms = outputs.iter().zip(&seed);
            let sum: f64 = terms
                .map(|(output, seed)| seed * instance.derivative(output, known))
                .sum();
            assert!(
                (found - sum).abs() <= 1e-12 * sum.abs().max(1.0),
                "{known}: {found}, {sum}"
            );
            depends += usize::from(found != 0.0);
        }
    }
    assert!(depends > 0, "some output depends on some input");
}

/// Change of an output per change of an input at once, about the input's `value`.
fn difference_quotient(instance: &mut Instance<'_>, unknown: &str, known: &str, value: f64) -> f64 {
    let (state, width) = (instance.save(), 1e-4 * value);
    let [below, above] = [-width, width].map(|change| {
        instance.set(known, value + change);
        let read = instance.get(unknown);
        instance.restore(state);
        read
    });
    (above - below) / (2.0 * width)
}

/// Early return without event mode: a long step ends at the first switch, and only there.
fn returns_early(trial: &Trial<'_>) {
    let component = trial.component;
    let mut eager = component.instantiate_with(trial.version, false, true);
    eager.initialize(0.0, trial.subject.values);
    let mut returns = 0;
    while eager.time < SWITCH {
        let begin = eager.time;
        let result = eager.try_step(SWITCH - begin);
        assert_eq!((result.status, result.event), (Ok, false));
        assert_eq!(result.early, eager.time < SWITCH);
        returns += usize::from(result.early);
    }
    assert!(returns > 0, "there is a switch");
    let mut patient = trial.start();
    assert!(!patient.try_step(SWITCH).early, "nobody asked for it");
    assert!(trial.difference(&eager, &patient) < 1e-12);
}

/// Event mode: every switch asks for it, it may be entered and left anywhere, and no number changes.
fn event_mode(trial: &Trial<'_>) {
    let component = trial.component;
    let mut events = component.instantiate_with(trial.version, true, true);
    events.initialize(0.0, trial.subject.values);
    assert_eq!(events.enter_step_mode(), Ok);
    let mut handled = 0;
    while events.time < SWITCH {
        let result = events.try_step((SWITCH - events.time).min(0.5));
        assert_eq!(result.status, Ok);
        if result.event {
            handled += 1;
        }
        assert_eq!(events.enter_event_mode(), Ok);
        assert_eq!(events.enter_step_mode(), Ok);
    }
    assert!(handled > 0, "there is a switch");
    let mut plain = trial.start();
    plain.run(0.5, SWITCH);
    assert!(trial.difference(&events, &plain) < 1e-12);
    assert_eq!(plain.enter_event_mode(), Error, "nobody asked for it");
}
