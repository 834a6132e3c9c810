//! Actions on an instance as calls of the C functions, wrong pointers included; and as questions to the judge.

use std::ffi::{CString, c_char};
use std::ptr;

use crate::battle::{Answer, Instance};
use crate::call::{Action, Arrays, Kind, SetUp};
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
        Version::Two => invoke_2(library, instance, action),
        Version::Three => invoke_3(library, instance, action),
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

fn invoke_2(library: &Library, instance: &Instance, action: &Action) -> Answer {
    let (f, own) = (&library.fmi2, instance.handle);
    let mut values = Vec::new();
    // SAFETY: pointers are valid for the counts that go with them, or wrong in a way that the library must notice
    // before it follows them.
    let status = unsafe {
        match action {
            Action::Debug {
                on,
                categories,
                with_null,
            } => {
                let (_owned, pointers) = texts(categories, *with_null);
                (f.debug)(own, (*on).into(), pointers.len(), pointers.as_ptr())
            }
            Action::SetUp(SetUp {
                tolerance,
                start,
                stop,
            }) => {
                let ((has_tolerance, tolerance), (has_stop, stop)) =
                    (defined(*tolerance), defined(*stop));
                (f.set_up)(
                    own,
                    has_tolerance.into(),
                    tolerance,
                    *start,
                    has_stop.into(),
                    stop,
                )
            }
            Action::EnterInitialization(_) => (f.enter_initialization)(own),
            Action::ExitInitialization => (f.exit_initialization)(own),
            Action::Terminate => (f.terminate)(own),
            Action::Reset => (f.reset)(own),
            Action::Get {
                kind,
                references,
                arrays,
            } => {
                let array = Array {
                    references,
                    arrays: *arrays,
                };
                let (r, n) = (array.references(), array.count());
                match kind {
                    Kind::Real => {
                        let mut reals = vec![0.0_f64; references.len()];
                        let status = (f.get_real)(own, r, n, array.places(&mut reals));
                        values.extend(reals.iter().map(|value| value.to_bits()));
                        status
                    }
                    Kind::Boolean => {
                        let mut flags = vec![0; references.len()];
                        let status = (f.get_boolean)(own, r, n, array.places(&mut flags));
                        values.extend(flags.iter().map(|flag| *flag as u64));
                        status
                    }
                    Kind::Integer => {
                        (f.get_integer)(own, r, n, array.places(&mut vec![0; references.len()]))
                    }
                    Kind::Text => (f.get_string)(
                        own,
                        r,
                        n,
                        array.places(&mut vec![ptr::null(); references.len()]),
                    ),
                }
            }
            Action::Set {
                kind,
                references,
                values,
                arrays,
            } => {
                let array = Array {
                    references,
                    arrays: *arrays,
                };
                let (r, n) = (array.references(), array.count());
                match kind {
                    Kind::Real => (f.set_real)(own, r, n, array.values(values)),
                    Kind::Boolean => {
                        (f.set_boolean)(own, r, n, array.values(&vec![2; values.len()]))
                    }
                    Kind::Integer => {
                        (f.set_integer)(own, r, n, array.values(&vec![2; values.len()]))
                    }
                    Kind::Text => {
                        (f.set_string)(own, r, n, array.values(&vec![ptr::null(); values.len()]))
                    }
                }
            }
            Action::InputDerivatives {
                references,
                orders,
                values,
                arrays,
            } => {
                let array = Array {
                    references,
                    arrays: *arrays,
                };
                (f.input_derivatives)(
                    own,
                    array.references(),
                    array.count(),
                    orders.as_ptr(),
                    array.values(values),
                )
            }
            Action::OutputDerivatives {
                references,
                orders,
                arrays,
            } => {
                let array = Array {
                    references,
                    arrays: *arrays,
                };
                let mut reals = vec![0.0_f64; references.len()];
                let status = (f.output_derivatives)(
                    own,
                    array.references(),
                    array.count(),
                    orders.as_ptr(),
                    array.places(&mut reals),
                );
                values.extend(reals.iter().map(|value| value.to_bits()));
                status
            }
            Action::Directional {
                unknowns,
                knowns,
                seed,
                arrays,
            } => {
                let array = Array {
                    references: unknowns,
                    arrays: *arrays,
                };
                let mut reals = vec![0.0_f64; unknowns.len()];
                let status = (f.directional)(
                    own,
                    array.references(),
                    array.count(),
                    knowns.as_ptr(),
                    knowns.len(),
                    seed.as_ptr(),
                    array.places(&mut reals),
                );
                values.extend(reals.iter().map(|value| value.to_bits()));
                status
            }
            Action::Step { offset, size, .. } => (f.step)(own, instance.point + offset, *size, 1),
            Action::Cancel => (f.cancel)(own),
            Action::GetStatus { kind, asked, null } => {
                let (mut whole, mut real, mut text) = (9, 9.0, ptr::null());
                let whole_place = if *null {
                    ptr::null_mut()
                } else {
                    &raw mut whole
                };
                let real_place = if *null {
                    ptr::null_mut()
                } else {
                    &raw mut real
                };
                let status = match kind {
                    None => (f.get_status)(own, *asked, whole_place),
                    Some(Kind::Real) => (f.get_real_status)(own, *asked, real_place),
                    Some(Kind::Boolean) => (f.get_boolean_status)(own, *asked, whole_place),
                    Some(Kind::Integer) => (f.get_integer_status)(own, *asked, whole_place),
                    Some(Kind::Text) => (f.get_string_status)(own, *asked, &mut text),
                };
                values.push(if *kind == Some(Kind::Real) {
                    real.to_bits()
                } else {
                    whole as u64
                });
                status
            }
            Action::Unsupported(false) => (f.set_time)(own, 1.0),
            _ => (f.get_derivatives)(own, ptr::null_mut(), 3),
        }
    };
    Answer { status, values }
}

fn invoke_3(library: &Library, instance: &Instance, action: &Action) -> Answer {
    let (f, own) = (&library.fmi3, instance.handle);
    let mut values = Vec::new();
    // SAFETY: as for FMI 2.
    let status = unsafe {
        match action {
            Action::Debug {
                on,
                categories,
                with_null,
            } => {
                let (_owned, pointers) = texts(categories, *with_null);
                (f.debug)(own, (*on).into(), pointers.len(), pointers.as_ptr())
            }
            Action::SetUp(set_up) | Action::EnterInitialization(set_up) => {
                let SetUp {
                    tolerance,
                    start,
                    stop,
                } = *set_up;
                let ((has_tolerance, tolerance), (has_stop, stop)) =
                    (defined(tolerance), defined(stop));
                (f.enter_initialization)(
                    own,
                    has_tolerance.into(),
                    tolerance,
                    start,
                    has_stop.into(),
                    stop,
                )
            }
            Action::ExitInitialization => (f.exit_initialization)(own),
            Action::EnterConfiguration => (f.enter_configuration)(own),
            Action::ExitConfiguration => (f.exit_configuration)(own),
            Action::EnterEvent => (f.enter_event)(own),
            Action::Evaluate => (f.evaluate)(own),
            Action::Update { null } => {
                let mut flags = [9_u8; 5];
                let mut next = 9.0_f64;
                let [a, b, c, d, e] = &mut flags;
                let first: *mut u8 = if *null { ptr::null_mut() } else { a };
                let status = (f.update)(own, first, b, c, d, e, &mut next);
                values.extend(flags.iter().map(|flag| u64::from(*flag)));
                values.push(next.to_bits());
                status
            }
            Action::EnterStep => (f.enter_step)(own),
            Action::Terminate => (f.terminate)(own),
            Action::Reset => (f.reset)(own),
            Action::Get {
                kind,
                references,
                arrays,
            } => {
                let array = Array {
                    references,
                    arrays: *arrays,
                };
                let (r, n, m) = (array.references(), array.count(), array.value_count());
                match kind {
                    Kind::Real => {
                        let mut reals = vec![0.0_f64; references.len()];
                        let status = (f.get_real)(own, r, n, array.places(&mut reals), m);
                        values.extend(reals.iter().map(|value| value.to_bits()));
                        status
                    }
                    Kind::Boolean => {
                        let mut flags = vec![9; references.len()];
                        let status = (f.get_boolean)(own, r, n, array.places(&mut flags), m);
                        values.extend(flags.iter().map(|flag| u64::from(*flag)));
                        status
                    }
                    Kind::Integer => {
                        (f.get_integer)(own, r, n, array.places(&mut vec![0; references.len()]), m)
                    }
                    Kind::Text => (f.get_string)(
                        own,
                        r,
                        n,
                        array.places(&mut vec![ptr::null(); references.len()]),
                        m,
                    ),
                }
            }
            Action::Set {
                kind,
                references,
                values,
                arrays,
            } => {
                let array = Array {
                    references,
                    arrays: *arrays,
                };
                let (r, n, m) = (array.references(), array.count(), array.value_count());
                match kind {
                    Kind::Real => (f.set_real)(own, r, n, array.values(values), m),
                    Kind::Boolean => {
                        (f.set_boolean)(own, r, n, array.values(&vec![2; values.len()]), m)
                    }
                    Kind::Integer => {
                        (f.set_integer)(own, r, n, array.values(&vec![2; values.len()]), m)
                    }
                    Kind::Text => {
                        (f.set_string)(own, r, n, array.values(&vec![ptr::null(); values.len()]), m)
                    }
                }
            }
            Action::OutputDerivatives {
                references,
                orders,
                arrays,
            } => {
                let array = Array {
                    references,
                    arrays: *arrays,
                };
                let mut reals = vec![0.0_f64; references.len()];
                let status = (f.output_derivatives)(
                    own,
                    array.references(),
                    array.count(),
                    orders.as_ptr(),
                    array.places(&mut reals),
                    array.value_count(),
                );
                values.extend(reals.iter().map(|value| value.to_bits()));
                status
            }
            Action::Directional {
                unknowns,
                knowns,
                seed,
                arrays,
            } => {
                let array = Array {
                    references: unknowns,
                    arrays: *arrays,
                };
                let mut reals = vec![0.0_f64; unknowns.len()];
                let status = (f.directional)(
                    own,
                    array.references(),
                    array.count(),
                    knowns.as_ptr(),
                    knowns.len(),
                    seed.as_ptr(),
                    seed.len(),
                    array.places(&mut reals),
                    array.value_count(),
                );
                values.extend(reals.iter().map(|value| value.to_bits()));
                status
            }
            Action::Step { offset, size, null } => {
                let mut flags = [9_u8; 3];
                let mut reached = f64::NAN;
                let [event, terminate, early] = &mut flags;
                let first: *mut u8 = if *null { ptr::null_mut() } else { event };
                let point = instance.point + offset;
                let status = (f.step)(own, point, *size, 1, first, terminate, early, &mut reached);
                values.extend(flags.iter().map(|flag| u64::from(*flag)));
                values.push(reached.to_bits());
                status
            }
            Action::Unsupported(false) => (f.set_time)(own, 1.0),
            _ => (f.get_interval)(own, ptr::null(), 1, ptr::null_mut(), ptr::null_mut()),
        }
    };
    Answer { status, values }
}
