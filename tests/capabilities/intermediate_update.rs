//! The importer's look at switches inside a step (FMI 3).

use super::importer::{self, Component, Fmi3, Instance};
use super::{SUBJECTS, SWITCH, Trial};
use std::cell::RefCell;
use std::ffi::c_void;
use std::ptr;
use stickslip::ffi::Status::{Error, Ok};
use stickslip::ffi::{Status, fmi3};

/// What the importer's callback is to do and has seen.
#[derive(Default)]
struct Looks {
    instance: usize,
    references: Vec<u32>,
    /// Time [s] after the switch at which the step is to end.
    end_after: Option<f64>,
    /// Time [s] and values of each look.
    seen: Vec<(f64, Vec<f64>)>,
}

thread_local! {
    static LOOKS: RefCell<Looks> = RefCell::default();
}

unsafe extern "C" fn look(
    _: *mut c_void,
    time: f64,
    set_requested: u8,
    get_allowed: u8,
    step_finished: u8,
    can_return_early: u8,
    requested: *mut u8,
    early_time: *mut f64,
) {
    assert_eq!((set_requested, get_allowed, step_finished), (0, 1, 1));
    LOOKS.with_borrow_mut(|looks| {
        let handle = ptr::without_provenance_mut(looks.instance);
        let (count, mut values) = (looks.references.len(), vec![0.0; looks.references.len()]);
        let references = looks.references.as_ptr();
        // SAFETY: as many values as references; places of the answers are the component's.
        unsafe {
            let status =
                fmi3::fmi3GetFloat64(handle, references, count, values.as_mut_ptr(), count);
            assert_eq!(status, Ok);
            if let Some(after) = looks.end_after {
                assert_eq!(can_return_early, 1);
                (*requested, *early_time) = (1, time + after);
            }
        }
        looks.seen.push((time, values));
    });
}

/// An instance whose switches inside steps `callback` looks at.
fn looked_at<'a>(
    trial: &Trial<'a>,
    callback: fmi3::IntermediateUpdateCallback,
    early_return: bool,
    end_after: Option<f64>,
) -> Instance<'a> {
    let outputs = trial.outputs();
    let table = &trial.component.table;
    let references: Vec<u32> = outputs
        .iter()
        .map(|name| table.find(name).unwrap().value_reference)
        .collect();
    let request = importer::Request {
        early_return,
        intermediate_update: Some(callback),
        required: references.clone(),
        ..trial.component.request(trial.version)
    };
    let mut instance = trial.component.instance(trial.version, &request);
    instance.initialize(0.0, trial.subject.values);
    LOOKS.set(Looks {
        instance: instance.handle.addr(),
        references,
        end_after,
        seen: Vec::new(),
    });
    instance
}

/// One long step: each switch inside it is shown at its instant, with the values there, and no number changes.
pub fn intermediate_update(trial: &Trial<'_>) {
    let mut watched = looked_at(trial, look, false, None);
    let result = watched.try_step(SWITCH);
    assert_eq!((result.status, result.early), (Ok, false));
    let seen = LOOKS.take().seen;
    let mut eager = trial.component.instantiate_with(trial.version, false, true);
    eager.initialize(0.0, trial.subject.values);
    let mut switches = 0;
    while eager.try_step(SWITCH - eager.time).early {
        let (time, values) = &seen[switches];
        assert_eq!(*time, eager.time);
        let there: Vec<f64> = trial.outputs().iter().map(|name| eager.get(name)).collect();
        assert_eq!(*values, there);
        switches += 1;
    }
    assert!(switches > 0, "there is a switch");
    assert_eq!(seen.len(), switches);
    assert_eq!(trial.bits(&watched), trial.bits(&eager));
}

/// The step ends where the callback wants it to end.
pub fn returns_early_when_asked(trial: &Trial<'_>) {
    let mut watched = looked_at(trial, look, true, Some(1e-3));
    let result = watched.try_step(SWITCH);
    let seen = LOOKS.take().seen;
    assert_eq!((result.status, result.early), (Ok, true));
    assert_eq!(result.reached, seen.last().unwrap().0 + 1e-3);
    let mut plain = trial.start();
    plain.step(result.reached);
    assert!(trial.difference(&watched, &plain) < 1e-12);
    // Into the past it does not go.
    let mut backward = looked_at(trial, look, true, Some(-1e-3));
    assert_eq!(backward.try_step(SWITCH).status, Error);
    assert!(
        backward
            .log
            .take()
            .iter()
            .any(|line| line.text.contains("earlyReturnTime"))
    );
}

unsafe extern "C" fn step_within(
    _: *mut c_void,
    time: f64,
    _: u8,
    _: u8,
    _: u8,
    _: u8,
    _: *mut u8,
    _: *mut f64,
) {
    let handle = LOOKS.with_borrow(|looks| ptr::without_provenance_mut(looks.instance));
    let (mut flags, mut reached) = ([0_u8; 3], 0.0);
    let [a, b, c] = &mut flags;
    // SAFETY: places of the results.
    let status = unsafe { fmi3::fmi3DoStep(handle, time, 0.1, 1, a, b, c, &mut reached) };
    assert_eq!(status, Error);
}

unsafe extern "C" fn free_within(
    _: *mut c_void,
    _: f64,
    _: u8,
    _: u8,
    _: u8,
    _: u8,
    _: *mut u8,
    _: *mut f64,
) {
    fmi3::fmi3FreeInstance(LOOKS.with_borrow(|looks| ptr::without_provenance_mut(looks.instance)));
}

#[test]
fn a_callback_that_does_what_it_must_not_ends_the_step_with_an_error() {
    let subject = &SUBJECTS[0];
    let component = &Component::new(subject.model);
    let trial = Trial {
        subject,
        component,
        version: Fmi3,
    };
    for callback in [step_within, free_within] {
        let mut instance = looked_at(&trial, callback, false, None);
        let status: Status = instance.try_step(SWITCH).status;
        assert_eq!(status, Error);
    }
    // Inputs are not read there.
    let input = component.table.find("u").unwrap().value_reference;
    let request = importer::Request {
        required: vec![input],
        ..component.request(Fmi3)
    };
    let (handle, log) = request.send(Fmi3);
    assert!(handle.is_null());
    assert!(log.take()[0].text.contains("requiredIntermediateVariables"));
}
