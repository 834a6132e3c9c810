//! Values, variables, derivatives and parameters that cannot be.

use crate::importer::{Component, Fmi2, Instance, REDUCED_RIG};
use crate::{BOTH, CASE, goes_on, goes_on_nearly, recovers, said};
use stickslip::ffi::Status::{self, Discard, Error, Ok};

#[test]
fn values_that_cannot_be_are_discarded_and_the_old_ones_hold() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let mut instance = component.start(version, &CASE);
        instance.run(0.01, 0.5);
        let setter = if version == Fmi2 {
            "fmi2SetReal"
        } else {
            "fmi3SetFloat64"
        };
        for (name, value, was, right) in [
            ("u", f64::NAN, "NaN", "a finite number"),
            ("u", f64::INFINITY, "inf", "a finite number"),
            ("N2", f64::NEG_INFINITY, "-inf", "a finite number"),
            ("N2", f64::NAN, "NaN", "a finite number"),
            ("contact.mu_s", -0.1, "-0.1", "not below 0"),
            ("contact.omega_s", 0.0, "0", "above 0"),
            ("motor.resistance", f64::NAN, "NaN", "above 0"),
        ] {
            let before = instance.get(name).to_bits();
            assert_eq!(instance.try_set(name, value), Discard, "{name} = {value}");
            let quoted = format!("\"{name}\" cannot be {was}");
            said(&instance.log, Discard, &[setter, &quoted, right]);
            assert_eq!(instance.get(name).to_bits(), before);
        }
        // The first of the two would do: all or none.
        let references = ["u", "N2"].map(|name| instance.reference(name));
        assert_eq!(
            instance.set_references(&references, &[9.0, f64::NAN]),
            Discard
        );
        said(&instance.log, Discard, &["\"N2\" cannot be NaN"]);
        assert_eq!(instance.get("u"), 3.1);
        goes_on(&component, &mut instance, 2.0);
    }
}

#[test]
fn start_values_out_of_range_are_discarded_before_the_simulation() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let mut instance = component.instantiate(version);
        for (name, value, right) in [
            ("disc.inertia", 0.0, "above 0"),
            ("gearbox.ratio", -8.0, "above 0"),
            ("shaft.damping", -1e-9, "not below 0"),
            ("theta_dot", f64::NAN, "a finite number"),
        ] {
            assert_eq!(instance.try_set(name, value), Discard);
            let quoted = format!("\"{name}\" cannot be {value}");
            said(&instance.log, Discard, &[&quoted, right]);
        }
        instance.initialize(0.0, &CASE);
        goes_on(&component, &mut instance, 1.0);
    }
}

#[test]
fn variables_that_are_not_there_or_not_to_be_set_are_errors() {
    let component = Component::new(REDUCED_RIG);
    let (stuck, theta) = (
        component.table.find("stuck").unwrap().value_reference,
        component.table.find("theta").unwrap().value_reference,
    );
    let largest = component.table.variables().len() - 1;
    let unknown = format!("no variable with value reference 4000000000; the largest is {largest}");
    for version in BOTH {
        type Call<'a> = Box<dyn Fn(&Instance<'_>) -> Status + 'a>;
        let set = |reference: u32| -> Call<'_> {
            Box::new(move |instance| instance.set_references(&[reference], &[1.0]))
        };
        let get = |reference: u32| -> Call<'_> {
            Box::new(move |instance| instance.get_reference(reference).unwrap_err())
        };
        let read_boolean = |reference: u32| -> Call<'_> {
            Box::new(move |instance| instance.get_boolean(reference).unwrap_err())
        };
        let named = |name: &'static str| -> Call<'_> {
            Box::new(move |instance| instance.try_set(name, 1.0))
        };
        let before_start = "it can be set before the simulation only";
        let cases: [(Call<'_>, &[&str]); 9] = [
            (set(4_000_000_000), &[&unknown]),
            (get(4_000_000_000), &[&unknown]),
            (read_boolean(4_000_000_000), &[&unknown]),
            (set(stuck), &["\"stuck\"", "is a Boolean, not a real"]),
            (get(stuck), &["\"stuck\"", "is a Boolean, not a real"]),
            (
                read_boolean(theta),
                &["\"theta\"", "is a real, not a Boolean"],
            ),
            (named("T_f"), &["\"T_f\" must not be set", "it is computed"]),
            (named("theta"), &["\"theta\" must not be set", before_start]),
            (
                named("disc.inertia"),
                &["\"disc.inertia\" must not", before_start],
            ),
        ];
        for (call, parts) in cases {
            let mut instance = component.start(version, &CASE);
            instance.run(0.01, 0.2);
            assert_eq!(call(&instance), Error, "{parts:?}");
            said(&instance.log, Error, parts);
            recovers(&component, &mut instance);
        }
    }
}

#[test]
fn parameters_that_contradict_each_other_are_errors_that_name_both() {
    let component = Component::new(REDUCED_RIG);
    let parts = ["contact: the breakaway level mu_s = 0.2 is below the sliding level mu_c = 0.5"];
    for version in BOTH {
        let mut instance = component.instantiate(version);
        instance.set("contact.mu_c", 0.5);
        assert_eq!(instance.enter_initialization(None, 0.0, None), Ok);
        assert_eq!(instance.exit_initialization(), Error);
        said(&instance.log, Error, &parts);
        instance.reset();
        let consistent = [("contact.mu_c", 0.5), ("contact.mu_s", 0.6)];
        instance.initialize(0.0, &consistent);
        assert_eq!(instance.get("contact.mu_s"), 0.6);

        // While it runs, both may be set one after the other; what counts is the next step.
        let mut instance = component.start(version, &CASE);
        instance.run(0.01, 0.5);
        instance.set("contact.mu_c", 0.5);
        instance.set("contact.mu_s", 0.6);
        instance.step(0.01);
        instance.set("contact.mu_s", 0.2);
        assert_eq!(instance.try_step(0.01).status, Error);
        said(&instance.log, Error, &parts);
        instance.reset();
        instance.initialize(0.0, &CASE);
        goes_on(&component, &mut instance, 1.0);
    }
}

#[test]
fn derivatives_of_or_by_what_has_none_are_errors() {
    let component = Component::new(REDUCED_RIG);
    type Call = fn(&Instance<'_>) -> Status;
    let both: [(Call, &[&str]); 6] = [
        (
            |i| i.try_output_derivative("u", 1).unwrap_err(),
            &["\"u\" is not an output"],
        ),
        (
            |i| i.try_output_derivative("theta", 0).unwrap_err(),
            &["order 0 of the derivative of \"theta\" must be from 1 to 2"],
        ),
        (
            |i| i.try_output_derivative("theta", 3).unwrap_err(),
            &["order 3 of the derivative of \"theta\" must be from 1 to 2"],
        ),
        (
            |i| i.try_directional("u", &["u"], &[1.0]).unwrap_err(),
            &["\"u\" cannot be an unknown", "outputs and locals can"],
        ),
        (
            |i| i.try_directional("T_f", &["theta"], &[1.0]).unwrap_err(),
            &[
                "\"theta\" cannot be a known",
                "inputs and tunable parameters can",
            ],
        ),
        (
            |i| {
                i.try_directional("T_f", &["disc.inertia"], &[1.0])
                    .unwrap_err()
            },
            &["\"disc.inertia\" cannot be a known"],
        ),
    ];
    let fmi2: [(Call, &[&str]); 3] = [
        (
            |i| i.set_input_derivative("theta", 1, 1.0),
            &["\"theta\" is not an input"],
        ),
        (
            |i| i.set_input_derivative("u", 0, 1.0),
            &["order 0 of the derivative of \"u\" must be from 1 to 3"],
        ),
        (
            |i| i.set_input_derivative("u", 4, 1.0),
            &["order 4 of the derivative of \"u\" must be from 1 to 3"],
        ),
    ];
    for version in BOTH {
        let only: &[_] = if version == Fmi2 { &fmi2 } else { &[] };
        for (call, parts) in both.iter().chain(only) {
            let mut instance = component.start(version, &CASE);
            instance.run(0.01, 0.2);
            assert_eq!(call(&instance), Error, "{parts:?}");
            said(&instance.log, Error, parts);
            recovers(&component, &mut instance);
        }
    }
    let mut instance = component.start(Fmi2, &CASE);
    assert_eq!(instance.set_input_derivative("u", 1, f64::NAN), Discard);
    let parts = ["the derivative of \"u\" cannot be NaN", "a finite number"];
    said(&instance.log, Discard, &parts);
    goes_on(&component, &mut instance, 1.0);
}

#[test]
fn numbers_that_overflow_are_discarded_and_never_handed_out() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let mut instance = component.start(version, &CASE);
        instance.run(0.01, 0.2);
        for seed in [f64::NAN, f64::INFINITY] {
            let found = instance.try_directional("T_f", &["N2"], &[seed]);
            assert_eq!(found.unwrap_err(), Discard);
            let parts = ["the directional derivative of \"T_f\" is", "this large"];
            said(&instance.log, Discard, &parts);
        }
        instance.set("u", 1e308);
        assert_eq!(instance.try_output_derivative("i", 2), Err(Discard));
        said(&instance.log, Discard, &["OutputDerivatives"]);
        for (name, value) in CASE {
            instance.set(name, value);
        }
        goes_on_nearly(&component, &mut instance, 1.0);
    }
}
