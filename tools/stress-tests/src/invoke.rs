//! Actions on an instance as calls of the C functions, wrong pointers included; and as questions to the judge.

use std::ffi::{CString, c_char, c_int};
use std::ptr;

use crate::call::{Action, Array, Arrays, Kind};
use crate::call_sequence::{Answer, Instance};
use crate::expectation::Verdict;
use crate::library::Library;
use crate::saved_states::place;
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
            Action::Get { kind, array } => expected.get(*kind, array),
            Action::Set {
                kind,
                array,
                values,
            } => expected.set(*kind, array, values),
            Action::InputDerivatives {
                array,
                orders,
                values,
            } if two => expected.input_derivatives(array, orders, values),
            Action::OutputDerivatives { array, orders } => {
                expected.output_derivatives(array, orders)
            }
            Action::Directional {
                unknowns,
                knowns,
                seed,
            } => expected.directional(unknowns, knowns, seed),
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

impl Array {
    /// The pointer to the references, their number, and that of the values.
    fn pointers(&self) -> (*const u32, usize, usize) {
        let references = self.references.as_ptr();
        let references = match self.wrong {
            Arrays::NoReferences => ptr::null(),
            Arrays::Misaligned => references.wrapping_byte_add(1),
            _ => references,
        };
        let count = self.references.len();
        match self.wrong {
            Arrays::HugeCount => (references, usize::MAX / 4, usize::MAX / 4),
            Arrays::OtherCount => (references, count, count + 1),
            _ => (references, count, count),
        }
    }

    fn values<T>(&self, values: &[T]) -> *const T {
        if self.wrong == Arrays::NoValues {
            ptr::null()
        } else {
            values.as_ptr()
        }
    }

    /// As many values as there are references, all alike.
    fn receive<T: Copy>(
        &self,
        before: T,
        bits: fn(T) -> u64,
        values: &mut Vec<u64>,
        getter: impl FnOnce(*mut T) -> c_int,
    ) -> c_int {
        let mut places = vec![before; self.references.len()];
        let status = getter(if self.wrong == Arrays::NoValues {
            ptr::null_mut()
        } else {
            places.as_mut_ptr()
        });
        values.extend(places.into_iter().map(bits));
        status
    }
}

/// Carries out the action on the instance.
pub(crate) fn invoke(library: &Library, instance: &Instance, action: &Action) -> Answer {
    let (own, version) = (instance.handle, instance.expected.version);
    let (both, f2, f3) = (library.of(version), &library.fmi2, &library.fmi3);
    let mut values = Vec::new();
    let out = &mut values;
    // SAFETY: pointers are valid for the counts that go with them, or wrong in a way that the library must notice
    // before it follows them.
    let status = unsafe {
        match (action, version) {
            (
                Action::Debug {
                    on,
                    categories,
                    with_null,
                },
                _,
            ) => {
                let (_owned, pointers) = texts(categories, *with_null);
                let (count, first) = (pointers.len(), pointers.as_ptr());
                match version {
                    Version::Two => (f2.debug)(own, (*on).into(), count, first),
                    Version::Three => (f3.debug)(own, (*on).into(), count, first),
                }
            }
            (Action::EnterInitialization(_), Version::Two) => (f2.enter_initialization)(own),
            (Action::SetUp(set_up) | Action::EnterInitialization(set_up), _) => {
                // A tolerance or stop time that is not defined is not looked at, whatever it is.
                let (tolerance, stop) = (set_up.tolerance, set_up.stop);
                let (has_tolerance, has_stop) = (tolerance.is_some(), stop.is_some());
                let tolerance = tolerance.unwrap_or(f64::NAN);
                let (start, stop) = (set_up.start, stop.unwrap_or(f64::NAN));
                match version {
                    Version::Two => {
                        let (has_tolerance, has_stop) = (has_tolerance.into(), has_stop.into());
                        (f2.set_up)(own, has_tolerance, tolerance, start, has_stop, stop)
                    }
                    Version::Three => {
                        let (has_tolerance, has_stop) = (has_tolerance.into(), has_stop.into());
                        (f3.enter_initialization)(
                            own,
                            has_tolerance,
                            tolerance,
                            start,
                            has_stop,
                            stop,
                        )
                    }
                }
            }
            (Action::ExitInitialization, _) => (both.exit_initialization)(own),
            (Action::Terminate, _) => (both.terminate)(own),
            (Action::Reset, _) => (both.reset)(own),
            (Action::EnterConfiguration, Version::Three) => (f3.enter_configuration)(own),
            (Action::ExitConfiguration, Version::Three) => (f3.exit_configuration)(own),
            (Action::EnterEvent, Version::Three) => (f3.enter_event)(own),
            (Action::Evaluate, Version::Three) => (f3.evaluate)(own),
            (Action::EnterStep, Version::Three) => (f3.enter_step)(own),
            (Action::Update { null }, Version::Three) => {
                let mut flags = [9_u8; 5];
                let mut next = 9.0_f64;
                let [a, b, c, d, e] = &mut flags;
                let status = (f3.update)(own, place(a, *null), b, c, d, e, &mut next);
                out.extend(flags.map(u64::from));
                out.push(next.to_bits());
                status
            }
            (Action::Get { kind, array }, _) => {
                let (r, n, m) = array.pointers();
                match (kind, version) {
                    (Kind::Real, Version::Two) => {
                        array.receive(0.0, f64::to_bits, out, |v| (f2.get_real)(own, r, n, v))
                    }
                    (Kind::Real, Version::Three) => {
                        array.receive(0.0, f64::to_bits, out, |v| (f3.get_real)(own, r, n, v, m))
                    }
                    (Kind::Boolean, Version::Two) => {
                        array.receive(0, |v| v as u64, out, |v| (f2.get_boolean)(own, r, n, v))
                    }
                    (Kind::Boolean, Version::Three) => {
                        array.receive(9, u64::from, out, |v| (f3.get_boolean)(own, r, n, v, m))
                    }
                    (Kind::Integer, Version::Two) => {
                        array.receive(0, |_| 0, out, |v| (f2.get_integer)(own, r, n, v))
                    }
                    (Kind::Integer, Version::Three) => {
                        array.receive(0, |_| 0, out, |v| (f3.get_integer)(own, r, n, v, m))
                    }
                    (Kind::Text, Version::Two) => {
                        array.receive(ptr::null(), |_| 0, out, |v| (f2.get_string)(own, r, n, v))
                    }
                    (Kind::Text, Version::Three) => array.receive(
                        ptr::null(),
                        |_| 0,
                        out,
                        |v| (f3.get_string)(own, r, n, v, m),
                    ),
                }
            }
            (
                Action::Set {
                    kind,
                    array,
                    values,
                },
                _,
            ) => {
                let (r, n, m) = array.pointers();
                let (wholes, flags) = (vec![2; values.len()], vec![2; values.len()]);
                let texts = vec![ptr::null(); values.len()];
                let (wholes, flags) = (array.values(&wholes), array.values(&flags));
                let (reals, texts) = (array.values(values), array.values(&texts));
                match (kind, version) {
                    (Kind::Real, Version::Two) => (f2.set_real)(own, r, n, reals),
                    (Kind::Real, Version::Three) => (f3.set_real)(own, r, n, reals, m),
                    (Kind::Boolean, Version::Two) => (f2.set_boolean)(own, r, n, wholes),
                    (Kind::Boolean, Version::Three) => (f3.set_boolean)(own, r, n, flags, m),
                    (Kind::Integer, Version::Two) => (f2.set_integer)(own, r, n, wholes),
                    (Kind::Integer, Version::Three) => (f3.set_integer)(own, r, n, wholes, m),
                    (Kind::Text, Version::Two) => (f2.set_string)(own, r, n, texts),
                    (Kind::Text, Version::Three) => (f3.set_string)(own, r, n, texts, m),
                }
            }
            (
                Action::InputDerivatives {
                    array,
                    orders,
                    values,
                },
                Version::Two,
            ) => {
                let (r, n, _) = array.pointers();
                (f2.input_derivatives)(own, r, n, orders.as_ptr(), array.values(values))
            }
            (Action::OutputDerivatives { array, orders }, _) => {
                let (r, n, m) = array.pointers();
                let orders = orders.as_ptr();
                array.receive(0.0, f64::to_bits, out, |v| match version {
                    Version::Two => (f2.output_derivatives)(own, r, n, orders, v),
                    Version::Three => (f3.output_derivatives)(own, r, n, orders, v, m),
                })
            }
            (
                Action::Directional {
                    unknowns,
                    knowns,
                    seed,
                },
                _,
            ) => {
                let (r, n, m) = unknowns.pointers();
                let (known, count) = (knowns.as_ptr(), knowns.len());
                let (first, seeds) = (seed.as_ptr(), seed.len());
                unknowns.receive(0.0, f64::to_bits, out, |v| match version {
                    Version::Two => (f2.directional)(own, r, n, known, count, first, v),
                    Version::Three => (f3.directional)(own, r, n, known, count, first, seeds, v, m),
                })
            }
            // `judge` has moved the expectation's time on already; the point is where the step began.
            (Action::Step { offset, size, null }, _) => {
                let point = instance.point + offset;
                if version == Version::Two {
                    (f2.step)(own, point, *size, 1)
                } else {
                    let mut flags = [9_u8; 3];
                    let mut reached = f64::NAN;
                    let [event, end, early] = &mut flags;
                    let event = place(event, *null);
                    let status = (f3.step)(own, point, *size, 1, event, end, early, &mut reached);
                    out.extend(flags.map(u64::from));
                    out.push(reached.to_bits());
                    status
                }
            }
            (Action::Cancel, Version::Two) => (f2.cancel)(own),
            (Action::GetStatus { kind, asked, null }, Version::Two) => {
                let (mut whole, mut real, mut text) = (9, 9.0, ptr::null());
                let (to_whole, to_real) = (place(&mut whole, *null), place(&mut real, *null));
                let status = match kind {
                    None => (f2.get_status)(own, *asked, to_whole),
                    Some(Kind::Real) => (f2.get_real_status)(own, *asked, to_real),
                    Some(Kind::Boolean) => (f2.get_boolean_status)(own, *asked, to_whole),
                    Some(Kind::Integer) => (f2.get_integer_status)(own, *asked, to_whole),
                    Some(Kind::Text) => (f2.get_string_status)(own, *asked, &mut text),
                };
                out.push(if *kind == Some(Kind::Real) {
                    real.to_bits()
                } else {
                    whole as u64
                });
                status
            }
            (Action::Unsupported(false), _) => (both.set_time)(own, 1.0),
            (_, Version::Two) => (f2.get_derivatives)(own, ptr::null_mut(), 3),
            (_, Version::Three) => {
                (f3.get_interval)(own, ptr::null(), 1, ptr::null_mut(), ptr::null_mut())
            }
        }
    };
    Answer { status, values }
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
