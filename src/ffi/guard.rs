//! The one gate that every exported function passes: live handle, right interface, right phase, no
//! panic beyond it.

use super::handles::HandleError;
use super::instance::{INSTANCES, Instance};
use super::status::{Interface, Outcome, Phases, Refusal, Status};
use std::any::Any;
use std::ffi::c_void;
use std::mem;
use std::panic::{AssertUnwindSafe, catch_unwind};

#[cfg(not(panic = "unwind"))]
compile_error!(
    "a panic that aborts would take the importer's process with it: build with panic = \"unwind\""
);

/// Runs the body of an exported function on the instance behind `handle`.
///
/// A handle that is not live has no log: the status is all that can be said.
#[inline]
pub(super) fn call(
    interface: Interface,
    handle: *mut c_void,
    function: &'static str,
    allowed: Phases,
    mut body: impl FnMut(&mut Instance) -> Outcome,
) -> Status {
    call_any(interface, handle, function, allowed, &mut body)
}

/// The one gate of all functions that are not called at every step: more than a hundred, each of which would have it again.
#[inline(never)]
fn call_any(
    interface: Interface,
    handle: *mut c_void,
    function: &'static str,
    allowed: Phases,
    body: &mut dyn FnMut(&mut Instance) -> Outcome,
) -> Status {
    call_often(interface, handle, function, allowed, body)
}

/// The same as [`call`] for functions that are called at every step, with a gate of their own.
#[inline(always)]
pub(super) fn call_often(
    interface: Interface,
    handle: *mut c_void,
    function: &'static str,
    allowed: Phases,
    body: impl FnOnce(&mut Instance) -> Outcome,
) -> Status {
    contain(Status::Error, || {
        let outcome = INSTANCES.with(handle, |instance| {
            if instance.interface != interface {
                return instance.refuse(
                    function,
                    &Refusal::error("the instance was made through the other FMI version"),
                );
            }
            let outcome = catch_unwind(AssertUnwindSafe(|| {
                instance.require(allowed)?;
                body(instance)
            }));
            match outcome {
                Ok(Ok(())) => Status::Ok,
                Ok(Err(refusal)) => instance.refuse(function, &refusal),
                Err(payload) => instance.refuse(function, &panicked(payload)),
            }
        });
        match outcome {
            Ok(status) => status,
            Err(HandleError::Dead | HandleError::Busy) => Status::Error,
        }
    })
}

/// Runs `body`; a panic ends here and gives `fallback`.
pub(super) fn contain<R>(fallback: R, body: impl FnOnce() -> R) -> R {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|payload| {
        // Dropping a foreign payload could panic again.
        mem::forget(payload);
        fallback
    })
}

/// The refusal that a panic turns into.
pub(super) fn panicked(payload: Box<dyn Any + Send>) -> Refusal {
    let message = payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".into());
    mem::forget(payload);
    Refusal::error(format_args!(
        "internal error, please report it: {message}; the instance can be reset or freed"
    ))
}

/// Ends an instance. A handle that is not live is left alone, as both standards want for NULL.
pub(super) fn free(interface: Interface, handle: *mut c_void) {
    contain((), || {
        let ours = INSTANCES.with(handle, |instance| instance.interface == interface);
        if ours == Ok(true) {
            drop(INSTANCES.remove(handle));
        }
    });
}

/// Declares exported functions, one line each: arguments, the phases in which the standard allows the
/// call, and what it does with the instance. `often` marks those that are called at every step.
macro_rules! exports {
    ($interface:expr; $(
        $(#[$often:ident])? fn $name:ident(|$instance:ident| $($argument:ident : $type:ty),*) in $phases:expr => $body:expr;
    )*) => { $(
        #[doc = concat!("`", stringify!($name), "` of the standard.")]
        ///
        /// # Safety
        /// Pointers are NULL or as the standard describes them.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            instance: *mut std::ffi::c_void $(, $argument: $type)*
        ) -> $crate::ffi::Status {
            $crate::ffi::guard::gate!($($often)?)($interface, instance, stringify!($name), $phases, |$instance| {
                // SAFETY: the caller's promise about the pointers.
                #[allow(unused_unsafe)]
                unsafe { $body }
            })
        }
    )* };
}
pub(super) use exports;

/// The gate of a function that [`exports`] declares.
macro_rules! gate {
    () => {
        $crate::ffi::guard::call
    };
    (often) => {
        $crate::ffi::guard::call_often
    };
}
pub(super) use gate;

/// Declares exported functions that the component does not support: any call returns an error.
macro_rules! unsupported {
    ($interface:expr; $(
        fn $name:ident($($type:ty),*) because $reason:expr;
    )*) => { $(
        #[doc = concat!("`", stringify!($name), "` of the standard; not supported.")]
        #[unsafe(no_mangle)]
        pub extern "C" fn $name(instance: *mut std::ffi::c_void $(, _: $type)*) -> $crate::ffi::Status {
            $crate::ffi::guard::call(
                $interface, instance, stringify!($name), $crate::ffi::status::ANY,
                |_| Err($crate::ffi::status::Refusal::error($reason)),
            )
        }
    )* };
}
pub(super) use unsupported;
