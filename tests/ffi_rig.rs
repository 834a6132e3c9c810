//! The rigs through both C interfaces: same numbers as the native model, whatever the importer does.

mod importer;

use importer::{Component, FULL_RIG, Fmi2, Fmi3, Instance, REDUCED_RIG, Version};
use stickslip::ffi::Status;
use stickslip::integrator::{Options, Simulation};
use stickslip::plant::{Rig, RigInputs, STATES, index};

const OUTPUTS: [&str; 6] = ["theta", "theta_dot", "T_f", "theta3", "theta3_dot", "i"];
const VOLTAGE: f64 = 3.108_784_426_666_666_4;

/// 55 rpm and 50 N, from rest.
const CASE: [(&str, f64); 2] = [("u", VOLTAGE), ("N2", 50.0)];

fn outputs(instance: &Instance<'_>) -> [u64; 6] {
    OUTPUTS.map(|name| instance.get(name).to_bits())
}

#[test]
fn native_model_and_both_versions_agree_in_every_bit() {
    let component = Component::new(REDUCED_RIG);
    let mut two = component.start(Fmi2, &CASE);
    let mut three = component.start(Fmi3, &CASE);
    let rig = Rig::from_toml(REDUCED_RIG, "reduced-rig.toml").unwrap();
    let inputs = RigInputs::held(VOLTAGE, 50.0, 0.0);
    let mut native = Simulation::new(rig, Options::default(), 0.0, [0.0; STATES], inputs).unwrap();
    for _ in 0..200 {
        two.step(0.05);
        three.step(0.05);
        native.advance_to(two.time).unwrap();
        assert_eq!(outputs(&two), outputs(&three));
        let state = native.state_at(two.time);
        assert_eq!(two.get("theta").to_bits(), state[index::THETA].to_bits());
        assert_eq!(two.get("i").to_bits(), state[index::CURRENT].to_bits());
    }
}

#[test]
fn the_solution_does_not_depend_on_the_communication_step() {
    let component = Component::new(REDUCED_RIG);
    let mut reference = component.start(Fmi2, &CASE);
    reference.run(0.1, 60.0);
    for size in [1e-4, 1e-3, 3e-3, 0.0073, 0.01, 0.07] {
        let mut instance = component.start(Fmi3, &CASE);
        instance.run(size, 60.0);
        assert_eq!(outputs(&instance), outputs(&reference), "step {size}");
    }
}

#[test]
fn setting_an_input_to_what_it_is_changes_nothing() {
    let component = Component::new(REDUCED_RIG);
    let mut held = component.start(Fmi2, &CASE);
    let mut set_again = component.start(Fmi2, &CASE);
    for _ in 0..500 {
        held.step(0.01);
        set_again.set("u", VOLTAGE);
        set_again.set("N2", 50.0);
        set_again.step(0.01);
    }
    assert_eq!(outputs(&held), outputs(&set_again));
}

#[test]
fn the_full_rig_runs_through_both_versions() {
    let component = Component::new(FULL_RIG);
    let case = [("u", 2.346_216_756_716_312), ("N1", 30.0), ("N2", 20.0)];
    let mut two = component.start(Fmi2, &case);
    let mut three = component.start(Fmi3, &case);
    two.run(0.01, 5.0);
    three.run(0.01, 5.0);
    for name in ["theta", "theta1", "theta1_dot", "T_f1", "theta3"] {
        assert_eq!(two.get(name).to_bits(), three.get(name).to_bits(), "{name}");
    }
    assert!(two.get("theta1") > 1.0);
}

fn continues_bit_for_bit(version: Version, model: &str, case: &[(&str, f64)]) {
    let component = Component::new(model);
    let mut instance = component.start(version, case);
    instance.run(0.007, 3.3);
    let state = instance.save();
    let bytes = instance.serialize(state);
    instance.run(0.007, 9.0);
    let expected = outputs(&instance);

    instance.set("N2", 10.0);
    instance.run(0.01, 10.0);
    instance.restore(state);
    instance.run(0.007, 9.0);
    assert_eq!(outputs(&instance), expected);

    let mut other = component.instantiate(version);
    let copy = other.deserialize(&bytes);
    other.restore(copy);
    other.run(0.007, 9.0);
    assert_eq!(outputs(&other), expected);
}

#[test]
fn a_saved_or_serialised_state_continues_bit_for_bit() {
    continues_bit_for_bit(Fmi2, REDUCED_RIG, &CASE);
    continues_bit_for_bit(Fmi3, FULL_RIG, &[("u", 2.3), ("N1", 30.0), ("N2", 20.0)]);
}

#[test]
fn saving_in_the_middle_of_setting_keeps_what_was_set() {
    let component = Component::new(REDUCED_RIG);
    let mut instance = component.start(Fmi2, &CASE);
    instance.run(0.01, 2.0);
    instance.set("u", 4.0);
    instance.set("contact.mu_s", 0.3);
    let state = instance.save();
    instance.run(0.01, 4.0);
    let expected = outputs(&instance);
    instance.restore(state);
    assert_eq!(
        (instance.get("u"), instance.get("contact.mu_s")),
        (4.0, 0.3)
    );
    instance.run(0.01, 4.0);
    assert_eq!(outputs(&instance), expected);
}

#[test]
fn a_ramp_by_derivatives_agrees_with_many_small_steps_of_it() {
    let component = Component::new(REDUCED_RIG);
    let mut ramp = component.start(Fmi2, &[("u", 1.0), ("N2", 5.0)]);
    assert_eq!(ramp.set_input_derivative("u", 1, 2.0), Status::Ok);
    ramp.step(1.0);
    assert!((ramp.get("u") - 3.0).abs() < 1e-12);

    let mut stairs = component.start(Fmi2, &[("u", 1.0), ("N2", 5.0)]);
    let steps = 4000;
    for n in 0..steps {
        stairs.set("u", 1.0 + 2.0 * (f64::from(n) + 0.5) / f64::from(steps));
        stairs.step(1.0 / f64::from(steps));
    }
    let difference = ramp.get("theta") - stairs.get("theta");
    assert!(
        ramp.get("theta") > 0.05 && difference.abs() < 1e-5,
        "{difference}"
    );
}

#[test]
fn a_value_set_at_a_later_point_ends_a_ramp_whatever_was_read_in_between() {
    let component = Component::new(REDUCED_RIG);
    let mut ramp = component.start(Fmi2, &CASE);
    assert_eq!(ramp.set_input_derivative("u", 1, 2.0), Status::Ok);
    // Reading what depends on inputs makes the run catch up before the step does.
    assert_eq!(ramp.get("T_f"), 0.0);
    ramp.step(0.1);
    ramp.set("u", 1.0);
    ramp.step(0.5);
    assert_eq!(ramp.get("u"), 1.0);
}

#[test]
fn output_derivatives_are_those_of_the_motion() {
    let component = Component::new(REDUCED_RIG);
    for version in [Fmi2, Fmi3] {
        let mut instance = component.start(version, &CASE);
        instance.run(0.01, 8.0);
        let derivative = |name: &str, order: i32| instance.output_derivative(name, order);
        assert!((derivative("theta", 1) - instance.get("theta_dot")).abs() < 1e-9);
        assert!((derivative("theta", 2) - derivative("theta_dot", 1)).abs() < 1e-7);
        let twist = instance.get("theta") - instance.get("theta3");
        let twist_rate = instance.get("theta_dot") - instance.get("theta3_dot");
        let torque = -0.0022 * twist_rate - 0.3482 * twist - instance.get("T_f");
        assert!((derivative("theta_dot", 1) - torque / 0.0149).abs() < 1e-8);
    }
}

#[test]
fn directional_derivatives_agree_with_differences() {
    let component = Component::new(REDUCED_RIG);
    for version in [Fmi2, Fmi3] {
        let mut instance = component.start(version, &CASE);
        // Once sliding, once sticking.
        for slides in [true, false] {
            while instance.is("stuck") == slides || instance.time < 3.0 {
                instance.step(0.01);
            }
            for known in ["N2", "u", "contact.mu_c", "contact.mu_s"] {
                for unknown in OUTPUTS {
                    let exact = instance.derivative(unknown, known);
                    let value = instance.get(known);
                    let state = instance.save();
                    let mut difference = 0.0;
                    if instance.try_set(known, value * (1.0 + 1e-6)) == Status::Ok {
                        difference = instance.get(unknown);
                        instance.restore(state);
                        instance.set(known, value * (1.0 - 1e-6));
                        difference = (difference - instance.get(unknown)) / (2e-6 * value);
                    } else {
                        difference += exact;
                    }
                    instance.restore(state);
                    assert!(
                        (exact - difference).abs() <= 1e-6 * exact.abs().max(1e-3),
                        "{version:?}, slides {slides}: d {unknown}/d {known} = {exact}, {difference}"
                    );
                }
            }
            if slides {
                let expected = instance.get("T_f") / 50.0;
                assert!((instance.derivative("T_f", "N2") - expected).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn torque_is_right_during_initialisation_and_right_after_setting() {
    let component = Component::new(REDUCED_RIG);
    let instance = component.start(Fmi2, &[("N2", 50.0), ("theta_dot", 100.0)]);
    let sliding = 0.075 * 50.0 * (0.12 + 0.08 * (-100.0_f64 / 1.2).exp());
    assert!((instance.get("T_f") - sliding).abs() < 1e-12);
    instance.set("N2", 25.0);
    assert!((instance.get("T_f") - 0.5 * sliding).abs() < 1e-12);

    // Held by the pin against a twisted shaft; without the pin there is no torque.
    let held = component.start(Fmi3, &[("N2", 50.0), ("theta", 0.5)]);
    assert!(held.is("stuck"));
    assert!((held.get("T_f") + 0.5 * 0.3482).abs() < 1e-12);
    held.set("N2", 0.0);
    assert!(held.get("T_f") == 0.0 && !held.is("stuck"));
}

#[test]
fn event_mode_stops_at_every_switch_and_changes_no_number() {
    let component = Component::new(REDUCED_RIG);
    let mut plain = component.start(Fmi3, &CASE);
    plain.run(0.1, 10.0);
    let mut events = component.instantiate_with(Fmi3, true, true);
    events.initialize(0.0, &CASE);
    assert_eq!(events.enter_step_mode(), Status::Ok);
    let (mut next, mut switches, mut stuck) = (1, 0, events.is("stuck"));
    while next <= 100 {
        let result = events.try_step(f64::from(next) * 0.1 - events.time);
        assert_eq!((result.status, result.early), (Status::Ok, result.event));
        assert_eq!(events.enter_event_mode(), Status::Ok);
        let now = events.is("stuck");
        if now != stuck {
            assert!(
                result.event,
                "the disc switched unseen before t = {}",
                events.time
            );
            switches += 1;
            stuck = now;
        }
        assert_eq!(events.enter_step_mode(), Status::Ok);
        if !result.early {
            next += 1;
        }
    }
    assert!(switches >= 10, "{switches} switches");
    assert_eq!(outputs(&events), outputs(&plain));
}

#[test]
fn tunable_parameters_act_from_the_next_step_on() {
    let component = Component::new(REDUCED_RIG);
    let mut tuned = component.start(Fmi2, &CASE);
    let mut plain = component.start(Fmi2, &CASE);
    tuned.run(0.01, 3.0);
    plain.run(0.01, 3.0);
    assert_eq!(tuned.try_set("disc.inertia", 0.02), Status::Error);
    let mut tuned = component.start(Fmi2, &CASE);
    tuned.run(0.01, 3.0);
    tuned.set("contact.mu_s", 0.12);
    assert_eq!(tuned.get("theta").to_bits(), plain.get("theta").to_bits());
    tuned.run(0.01, 6.0);
    plain.run(0.01, 6.0);
    assert_ne!(tuned.get("theta"), plain.get("theta"));
}

#[test]
fn reset_forgets_everything() {
    let component = Component::new(REDUCED_RIG);
    let mut instance = component.start(Fmi2, &[("u", 9.0), ("N2", 7.0), ("theta", 3.0)]);
    instance.set("contact.mu_c", 0.01);
    instance.run(0.01, 1.0);
    instance.reset();
    instance.initialize(0.0, &CASE);
    let mut fresh = component.start(Fmi2, &CASE);
    instance.run(0.01, 3.0);
    fresh.run(0.01, 3.0);
    assert_eq!(outputs(&instance), outputs(&fresh));
}

#[test]
fn sixteen_instances_in_four_threads_do_not_disturb_each_other() {
    let component = Component::new(REDUCED_RIG);
    let mut alone = component.start(Fmi2, &CASE);
    alone.run(0.01, 3.0);
    let expected = outputs(&alone);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                let mut instances: Vec<_> = (0..4)
                    .map(|n| component.start([Fmi2, Fmi3][n % 2], &CASE))
                    .collect();
                for tenth in 1..=30 {
                    let end = f64::from(tenth) / 10.0;
                    instances
                        .iter_mut()
                        .for_each(|instance| instance.run(0.01, end));
                }
                for instance in instances {
                    assert_eq!(outputs(&instance), expected);
                }
            });
        }
    });
}

/// What an importer may not do to the process: keep it busy for ever.
fn refused_soon(instance: &mut Instance<'_>, size: f64) {
    let begin = std::time::Instant::now();
    assert_eq!(instance.try_step(size).status, Status::Error);
    assert!(
        begin.elapsed().as_secs() < 60,
        "{} s for one step",
        begin.elapsed().as_secs()
    );
}

#[test]
fn an_absurd_input_derivative_ends_in_an_error_and_not_in_an_endless_search() {
    let component = Component::new(REDUCED_RIG);
    let mut instance = component.start(Fmi2, &CASE);
    instance.step(0.1);
    assert_eq!(instance.set_input_derivative("u", 1, 1e300), Status::Ok);
    refused_soon(&mut instance, 0.3);
}

#[test]
fn an_absurd_tolerance_ends_in_an_error_within_the_budget_of_the_step() {
    let component = Component::new(REDUCED_RIG);
    for version in [Fmi2, Fmi3] {
        let mut instance = component.instantiate(version);
        let entered = instance.enter_initialization(Some(1e-120), 0.0, None);
        assert_eq!(entered, Status::Ok);
        CASE.iter()
            .for_each(|(name, value)| instance.set(name, *value));
        assert_eq!(instance.exit_initialization(), Status::Ok);
        refused_soon(&mut instance, 1.0);
    }
}
