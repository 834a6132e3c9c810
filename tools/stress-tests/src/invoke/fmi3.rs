//! Actions as calls of FMI 3.

use std::ptr;

use super::{Array, defined, texts};
use crate::call::{Action, Kind, SetUp};
use crate::call_sequence::{Answer, Instance};
use crate::library::Library;

/// Carries out the action on the instance.
pub(super) fn invoke(library: &Library, instance: &Instance, action: &Action) -> Answer {
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
