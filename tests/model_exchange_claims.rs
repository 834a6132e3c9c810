//! What the XML of rigs and controllers claims of model exchange is what they can, through the C interface of each version; and both
//! kinds of instance in one library agree.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod importer;

use importer::exchange::Vector;
use importer::{Component, FULL_RIG, Fmi2, Fmi3, Instance, REDUCED_RIG, Version};
use std::path::Path;
use stickslip::cosim::{Causality, VariableType};
use stickslip::ffi::Status::{Discard, Error, Ok};

/// Name, model file and inputs.
type Case = (&'static str, &'static str, &'static [(&'static str, f64)]);

/// Once sliding, once sticking.
const RIGS: [Case; 2] = [
    ("ReducedRig", REDUCED_RIG, &[("u", 3.1), ("N2", 50.0)]),
    (
        "FullRig",
        FULL_RIG,
        &[("u", 3.1), ("N1", 25.0), ("N2", 50.0)],
    ),
];
/// The integral reaches the voltage's limit.
const CONTROLLERS: [Case; 2] = [
    (
        "SpeedController",
        include_str!("../modelDescription/speed-controller.toml"),
        &[("omega_ref", 6.0), ("theta3_dot", 1.0)],
    ),
    (
        "SoftTorque",
        include_str!("../modelDescription/soft-torque.toml"),
        &[("omega_ref", 12.0), ("theta3_dot", 1.0), ("i", 0.1)],
    ),
];
/// Step \[s\] at which the motor's 2 ms are followed well.
const STEP: f64 = 1e-4;

fn start<'a>(component: &'a Component, version: Version, values: &[(&str, f64)]) -> Instance<'a> {
    let mut instance = component.instantiate_for_exchange(version);
    instance.initialize(0.0, values);
    instance.update_discrete_states();
    assert_eq!(instance.enter_continuous_time(), Ok);
    instance
}

fn attributes(name: &str, version: Version) -> Vec<(String, String)> {
    let number = if version == Fmi2 { 2 } else { 3 };
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join(format!("modelDescription/{name}.fmi{number}.xml"));
    let xml = std::fs::read_to_string(path).unwrap();
    let (_, element) = xml.split_once("<ModelExchange ").unwrap();
    let (attributes, _) = element.split_once('>').unwrap();
    let words: Vec<&str> = attributes.trim_end_matches('/').split('"').collect();
    let pair = |pair: &[&str]| {
        (
            pair[0].trim().trim_end_matches('=').to_owned(),
            pair[1].to_owned(),
        )
    };
    words.chunks_exact(2).map(pair).collect()
}

#[test]
fn every_claim_is_kept() {
    for (name, model, values) in RIGS.into_iter().chain(CONTROLLERS) {
        let component = &Component::new(model);
        for version in [Fmi2, Fmi3] {
            let claims = attributes(name, version);
            assert!(claims.len() > 3, "{claims:?}");
            for (claim, value) in &claims {
                match (claim.as_str(), value.as_str()) {
                    ("modelIdentifier", identifier) => assert_eq!(identifier, name),
                    // Every instance of these tests has no functions to allocate and to free with.
                    ("canNotUseMemoryManagementFunctions", "true") => {}
                    // What becomes of an importer that is not told: `test_every_law_has_the_same_switches` of `tests/python`.
                    ("needsCompletedIntegratorStep", "true") => {}
                    ("canGetAndSetFMUstate" | "canGetAndSetFMUState", "true") => {
                        saves(component, version, values);
                    }
                    ("canSerializeFMUstate" | "canSerializeFMUState", "true") => {
                        serialises(component, version, values);
                    }
                    (
                        "providesDirectionalDerivative" | "providesDirectionalDerivatives",
                        "true",
                    ) => {
                        directional(component, version, values);
                    }
                    ("providesAdjointDerivatives", "true") => adjoint(component, version, values),
                    other => panic!("{other:?} is claimed and not tested"),
                }
            }
        }
    }
}

fn bits(instance: &Instance<'_>) -> Vec<u64> {
    let vectors = [Vector::States, Vector::Derivatives, Vector::Indicators];
    let values = vectors.into_iter().flat_map(|which| instance.vector(which));
    values.map(f64::to_bits).collect()
}

fn saves(component: &Component, version: Version, values: &[(&str, f64)]) {
    let mut instance = start(component, version, values);
    instance.integrate(STEP, 0.5);
    let (state, time) = (instance.save(), instance.time);
    assert!(instance.integrate(STEP, 2.5) > 0, "some event");
    let expected = bits(&instance);
    instance.restore(state);
    instance.time = time;
    instance.integrate(STEP, 2.5);
    assert_eq!(bits(&instance), expected);
}

fn serialises(component: &Component, version: Version, values: &[(&str, f64)]) {
    let mut instance = start(component, version, values);
    instance.integrate(STEP, 0.5);
    let bytes = instance.serialize(instance.save());
    let time = instance.time;
    instance.integrate(STEP, 2.5);
    let mut other = component.instantiate_for_exchange(version);
    other.restore(other.deserialize(&bytes));
    other.time = time;
    other.integrate(STEP, 2.5);
    assert_eq!(bits(&other), bits(&instance));
    // The other kind of instance does not take it.
    let stepper = component.start(version, values);
    assert_eq!(stepper.try_restore(stepper.deserialize(&bytes)), Error);
}

/// Names of states, derivatives and real outputs.
fn names(component: &Component) -> (Vec<String>, Vec<String>) {
    let table = &component.table;
    let states = table.states().map(|state| state.name.clone()).collect();
    let outputs = table
        .outputs()
        .filter(|output| output.variable_type == VariableType::Real);
    let unknowns = table
        .derivatives()
        .chain(outputs)
        .map(|unknown| unknown.name.clone());
    (states, unknowns.collect())
}

/// Every derivative and output by every state and input, against differences; where the description lists no dependency the
/// derivative is zero.
fn directional(component: &Component, version: Version, values: &[(&str, f64)]) {
    let mut instance = start(component, version, values);
    let (states, unknowns) = names(component);
    let mut nonzero = 0;
    for time in [0.3, 0.5, 0.7] {
        instance.integrate(STEP, time);
        let x = instance.vector(Vector::States);
        for unknown in &unknowns {
            let row = component.table.find(unknown).unwrap();
            for (place, state) in states.iter().enumerate() {
                let [below, above] = [-1e-5, 1e-5].map(|change| {
                    let mut moved = x.clone();
                    moved[place] += change;
                    assert_eq!(instance.set_states(&moved), Ok);
                    instance.get(unknown)
                });
                assert_eq!(instance.set_states(&x), Ok);
                let difference = (above - below) / 2e-5;
                let derivative = instance.derivative(unknown, state);
                let close = (derivative - difference).abs() < 1e-6 * derivative.abs().max(1.0);
                assert!(
                    close,
                    "{unknown} by {state} at {time}: {derivative}, {difference}"
                );
                let listed = row
                    .dependencies
                    .contains(&component.table.find(state).unwrap().value_reference);
                assert!(
                    listed || derivative == 0.0,
                    "{unknown} by {state} is not in the description"
                );
                nonzero += usize::from(derivative != 0.0);
            }
            for (input, value) in values {
                let [below, above] = [-1e-4, 1e-4].map(|change| {
                    instance.set(input, value + change);
                    instance.get(unknown)
                });
                instance.set(input, *value);
                let difference = (above - below) / 2e-4;
                let derivative = instance.derivative(unknown, input);
                let close = (derivative - difference).abs() < 1e-6 * derivative.abs().max(1.0);
                assert!(
                    close,
                    "{unknown} by {input} at {time}: {derivative}, {difference}"
                );
                nonzero += usize::from(derivative != 0.0);
            }
        }
        assert_eq!(instance.derivative(&unknowns[0], "time"), 0.0);
    }
    let knowns = states.len() + values.len();
    assert!(nonzero > 3 * knowns, "derivatives are there: {nonzero}");
}

fn adjoint(component: &Component, version: Version, values: &[(&str, f64)]) {
    let mut instance = start(component, version, values);
    let (states, unknowns) = names(component);
    instance.integrate(STEP, 0.7);
    let knowns: Vec<&str> = states
        .iter()
        .map(String::as_str)
        .chain(values.iter().map(|(name, _)| *name))
        .collect();
    let unknowns: Vec<&str> = unknowns.iter().map(String::as_str).collect();
    let seed: Vec<f64> = (0..unknowns.len()).map(|n| 1.0 + 0.3 * n as f64).collect();
    let found = instance.try_adjoint(&unknowns, &knowns, &seed).unwrap();
    for (known, found) in knowns.iter().zip(found) {
        let sum: f64 = unknowns
            .iter()
            .zip(&seed)
            .map(|(u, s)| s * instance.derivative(u, known))
            .sum();
        assert!(
            (found - sum).abs() <= 1e-12 * sum.abs().max(1.0),
            "{known}: {found}, {sum}"
        );
    }
}

#[test]
fn both_kinds_of_instance_agree_and_sticking_is_exact() {
    for (_, model, values) in RIGS {
        let component = &Component::new(model);
        for version in [Fmi2, Fmi3] {
            let mut exchange = start(component, version, values);
            let mut stepper = component.start(version, values);
            let mut sticking = 0;
            for end in 1..=30 {
                let end = f64::from(end) * 0.1;
                exchange.integrate(STEP, end);
                stepper.run(0.1, end);
                // Heun's method with events at the ends of its steps is worth no more.
                for output in ["theta", "theta3"] {
                    let difference = (exchange.get(output) - stepper.get(output)).abs();
                    assert!(difference < 5e-3, "{output} at {end}: {difference}");
                }
                if exchange.is("stuck") {
                    sticking += 1;
                    assert_eq!(exchange.get("theta_dot"), 0.0);
                    assert_eq!(exchange.get("der(theta_dot)"), 0.0);
                }
            }
            assert!(sticking > 0);
        }
    }
}

#[test]
fn wrong_vectors_are_refused_and_change_nothing() {
    let component = &Component::new(REDUCED_RIG);
    for version in [Fmi2, Fmi3] {
        let instance = start(component, version, RIGS[0].2);
        let x = instance.vector(Vector::States);
        assert_eq!(x.len(), 5);
        assert_eq!(instance.set_states(&[f64::NAN; 5]), Discard);
        assert_eq!(instance.set_time(f64::INFINITY), Discard);
        assert_eq!(instance.vector(Vector::States), x);
        assert!(
            instance
                .vector(Vector::Nominals)
                .iter()
                .all(|nominal| *nominal > 0.0)
        );
        assert_eq!(instance.try_vector(Vector::Derivatives, 4), Err(Error));
        instance.log.take();
    }
}

#[test]
fn indicators_are_positive_between_events() {
    let component = &Component::new(FULL_RIG);
    let mut instance = start(component, Fmi3, RIGS[1].2);
    for end in 1..20 {
        instance.integrate(STEP, f64::from(end) * 0.07);
        let indicators = instance.vector(Vector::Indicators);
        assert!(
            indicators.iter().all(|indicator| *indicator > 0.0),
            "{indicators:?}"
        );
        // They are variables too.
        let first = component.table.event_indicators().next().unwrap();
        assert_eq!(first.causality, Causality::Local);
        assert_eq!(instance.get(&first.name), indicators[0]);
    }
}

#[test]
fn a_solver_that_was_put_elsewhere_finds_the_disc_sliding() {
    let component = &Component::new(REDUCED_RIG);
    for version in [Fmi2, Fmi3] {
        let instance = start(component, version, RIGS[0].2);
        assert!(instance.is("stuck"));
        let mut x = instance.vector(Vector::States);
        x[1] = 5.0;
        assert_eq!(instance.set_states(&x), Ok);
        assert!(instance.get("T_f") > 0.0);
        assert!(instance.get("der(theta_dot)") < -1.0);
        assert!(
            instance.complete_step(),
            "the mode is put right by an event"
        );
        assert_eq!(instance.enter_events(), Ok);
        assert!(!instance.update_discrete_states());
        assert!(!instance.is("stuck"));
    }
}

#[test]
fn a_rig_that_needs_its_past_is_for_co_simulation_only() {
    let delayed = format!("{REDUCED_RIG}\n[sensor_delay]\ndelay = 0.01\n");
    let component = &Component::new(&delayed);
    assert_eq!(component.table.derivatives().count(), 0);
    for version in [Fmi2, Fmi3] {
        let mut request = component.request(version);
        request.exchange = true;
        let (handle, log) = request.send(version);
        assert!(handle.is_null());
        let lines = log.take();
        assert!(lines[0].text.contains("[sensor_delay]"), "{lines:?}");
        assert!(!component.start(version, RIGS[0].2).handle.is_null());
    }
}
