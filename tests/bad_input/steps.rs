//! Steps, communication points and experiments that cannot be.

use crate::importer::{Component, Fmi3, REDUCED_RIG};
use crate::{BOTH, CASE, goes_on, recovers, said};
use stickslip::ffi::Status::{Discard, Error, Ok};

#[test]
fn steps_and_points_that_cannot_be_are_discarded_and_the_next_step_goes_on() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        let mut instance = component.start(version, &CASE);
        instance.run(0.01, 0.5);
        let here = instance.time;
        let size = "the step must be finite and above 0";
        let point = "is not where the last step ended, 0.5 s";
        for (at, step, parts) in [
            (here, 0.0, ["communicationStepSize = 0 s", size]),
            (here, -0.01, ["communicationStepSize = -0.01 s", size]),
            (here, f64::NAN, ["communicationStepSize = NaN s", size]),
            (here, f64::INFINITY, ["communicationStepSize = inf s", size]),
            (f64::NAN, 0.01, ["currentCommunicationPoint = NaN s", point]),
            (
                f64::INFINITY,
                0.01,
                ["currentCommunicationPoint = inf s", point],
            ),
            (0.6, 0.01, ["currentCommunicationPoint = 0.6 s", point]),
            (0.4, 0.01, ["currentCommunicationPoint = 0.4 s", point]),
            (
                here + 2e-9,
                0.01,
                ["currentCommunicationPoint = 0.500000002", point],
            ),
            (0.0, 0.01, ["currentCommunicationPoint = 0 s", point]),
        ] {
            let result = instance.step_from(at, step);
            assert_eq!(result.status, Discard, "{at} {step}");
            said(&instance.log, Discard, &parts);
            if version == Fmi3 {
                assert_eq!(result.reached, here, "lastSuccessfulTime");
            }
        }
        assert_eq!(instance.get("time"), here);
        // The clocks of importers round: within a nanosecond it is the same point.
        assert_eq!(instance.step_from(here + 5e-10, 0.01).status, Ok);
        instance.time = instance.get("time");
        instance.run(0.01, 2.0);
        let difference = instance.get("theta") - {
            let mut other = component.start(version, &CASE);
            other.run(0.01, 2.0);
            other.get("theta")
        };
        assert!(difference.abs() < 1e-12, "{difference}");
    }
}

#[test]
fn experiments_that_cannot_be_are_errors() {
    let component = Component::new(REDUCED_RIG);
    for version in BOTH {
        for (tolerance, start, stop, parts) in [
            (Some(0.0), 0.0, None, ["tolerance = 0", "between 0 and 1"]),
            (
                Some(-1e-6),
                0.0,
                None,
                ["tolerance = -0.000001", "between 0 and 1"],
            ),
            (
                Some(f64::NAN),
                0.0,
                None,
                ["tolerance = NaN", "between 0 and 1"],
            ),
            (Some(2.0), 0.0, None, ["tolerance = 2", "between 0 and 1"]),
            (None, f64::NAN, None, ["startTime = NaN", "must be finite"]),
            (
                None,
                f64::INFINITY,
                None,
                ["startTime = inf", "must be finite"],
            ),
            (
                None,
                0.0,
                Some(f64::NAN),
                ["stopTime = NaN", "after startTime = 0"],
            ),
            (
                None,
                2.0,
                Some(1.0),
                ["stopTime = 1", "after startTime = 2"],
            ),
        ] {
            let mut instance = component.instantiate(version);
            assert_eq!(instance.enter_initialization(tolerance, start, stop), Error);
            said(&instance.log, Error, &parts);
            instance.reset();
            instance.initialize(0.0, &CASE);
            goes_on(&component, &mut instance, 0.5);
        }
        let mut instance = component.instantiate(version);
        assert_eq!(instance.enter_initialization(None, 0.0, Some(0.3)), Ok);
        assert_eq!(instance.exit_initialization(), Ok);
        instance.run(0.1, 0.3);
        assert_eq!(instance.try_step(0.1).status, Error);
        said(
            &instance.log,
            Error,
            &["the step to 0.4 s", "the stop time 0.3 s"],
        );
        recovers(&component, &mut instance);
    }
}
