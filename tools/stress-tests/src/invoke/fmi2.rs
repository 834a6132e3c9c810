//! Actions as calls of FMI 2.

use std::ptr;

use super::{Array, defined, texts};
use crate::call::{Action, Kind, SetUp};
use crate::call_sequence::{Answer, Instance};
use crate::library::Library;

/// Carries out the action on the instance.
pub(super) fn invoke(library: &Library, instance: &Instance, action: &Action) -> Answer {
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
