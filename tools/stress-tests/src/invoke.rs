//! Actions on an instance as calls of the C functions, wrong pointers included; and as questions to the judge.

mod fmi2;
mod fmi3;

use std::ffi::{CString, c_char};
use std::ptr;

use crate::call::{Action, Arrays};
use crate::call_sequence::{Answer, Instance};
use crate::expectation::Verdict;
use crate::library::Library;
use crate::standard::{Function, State, Version};

impl Instance {
    /// What the action must give, and how many events the log must hear of.
    pub(crate) fn judge(&mut self, action: &Action) -> (Verdict, usize) {
        let expected = &mut self.expected;
        let two = expected.version == Version::Two;
        let verdict = match action {
            Action::Debug {
                on,
                categories,
                with_null,
            } => expected.debug(*on, categories, *with_null),
            Action::SetUp(set_up) if two => expected.set_up(Function::SetUp, set_up),
            // What the version does not have is asked for as the nearest thing that it has.
            Action::SetUp(set_up) | Action::EnterInitialization(set_up) if !two => expected
                .set_up(Function::EnterInitialization, set_up)
                .and_then(|_| expected.enter(Function::EnterInitialization, State::Initialization)),
            Action::SetUp(_) | Action::EnterInitialization(_) => {
                expected.enter(Function::EnterInitialization, State::Initialization)
            }
            Action::ExitInitialization => expected.initialise(),
            Action::Terminate => expected.enter(Function::Terminate, State::Terminated),
            Action::Reset => expected.reset(),
            Action::EnterConfiguration if !two => {
                expected.enter(Function::EnterConfiguration, State::Configuration)
            }
            Action::ExitConfiguration if !two => {
                expected.enter(Function::ExitConfiguration, State::Instantiated)
            }
            Action::EnterEvent if !two => expected.enter_event(),
            Action::Evaluate if !two => expected.nothing(Function::UpdateStates, false),
            Action::Update { null } if !two => {
                let verdict = expected.nothing(Function::UpdateStates, *null);
                verdict.map(|_| vec![0; 6])
            }
            Action::EnterStep if !two => expected.enter(Function::EnterStep, State::Step),
            Action::Get {
                kind,
                references,
                arrays,
            } => expected.get(*kind, references, *arrays),
            Action::Set {
                kind,
                references,
                values,
                arrays,
            } => expected.set(*kind, references, values, *arrays),
            Action::InputDerivatives {
                references,
                orders,
                values,
                arrays,
            } if two => expected.input_derivatives(references, orders, values, *arrays),
            Action::OutputDerivatives {
                references,
                orders,
                arrays,
            } => expected.output_derivatives(references, orders, *arrays),
            Action::Directional {
                unknowns,
                knowns,
                seed,
                arrays,
            } => expected.directional(unknowns, knowns, seed, *arrays),
            Action::Step { offset, size, null } => {
                let point = expected.time + offset;
                return expected.step(point, *size, *null);
            }
            Action::GetStatus { kind, asked, null } if two => {
                expected.get_status(*kind, *asked, *null)
            }
            // Not supported, or legal only while a step is in progress.
            _ => expected.nothing(Function::Cancel, false),
        };
        (verdict, 0)
    }
}

/// Pointers and counts of array arguments, with what is wrong with them.
struct Array<'a> {
    references: &'a [u32],
    arrays: Arrays,
}

impl Array<'_> {
    fn references(&self) -> *const u32 {
        match self.arrays {
            Arrays::NoReferences => ptr::null(),
            Arrays::Misaligned => self.references.as_ptr().wrapping_byte_add(1),
            _ => self.references.as_ptr(),
        }
    }

    fn count(&self) -> usize {
        match self.arrays {
            Arrays::HugeCount => usize::MAX / 4,
            _ => self.references.len(),
        }
    }

    fn value_count(&self) -> usize {
        match self.arrays {
            Arrays::HugeCount => usize::MAX / 4,
            Arrays::OtherCount => self.references.len() + 1,
            _ => self.references.len(),
        }
    }

    fn values<T>(&self, values: &[T]) -> *const T {
        if self.arrays == Arrays::NoValues {
            ptr::null()
        } else {
            values.as_ptr()
        }
    }

    fn places<T>(&self, values: &mut [T]) -> *mut T {
        if self.arrays == Arrays::NoValues {
            ptr::null_mut()
        } else {
            values.as_mut_ptr()
        }
    }
}

/// Carries out the action on the instance.
pub(crate) fn invoke(library: &Library, instance: &Instance, action: &Action) -> Answer {
    // `judge` has moved the expectation's time on already; the point is where the step began.
    match instance.expected.version {
        Version::Two => fmi2::invoke(library, instance, action),
        Version::Three => fmi3::invoke(library, instance, action),
    }
}

fn texts(categories: &[&str], with_null: bool) -> (Vec<CString>, Vec<*const c_char>) {
    let owned: Vec<CString> = categories
        .iter()
        .map(|name| CString::new(*name).unwrap_or_default())
        .collect();
    let mut pointers: Vec<*const c_char> = owned.iter().map(|name| name.as_ptr()).collect();
    if with_null {
        pointers.push(ptr::null());
    }
    (owned, pointers)
}

fn defined(value: Option<f64>) -> (bool, f64) {
    // A tolerance or stop time that is not defined is not looked at, whatever it is.
    (value.is_some(), value.unwrap_or(f64::NAN))
}
