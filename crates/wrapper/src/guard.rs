//! The gate of every exported function: a handle that is one of ours, and no panic beyond it.

use std::ffi::c_int;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::instance::{Instance, Refused};
use crate::original::{ERROR, Handle, OriginalError};

#[cfg(not(panic = "unwind"))]
compile_error!(
    "a panic that aborts would take the importer's process with it: build with panic = \"unwind\""
);

/// Runs the body of an exported function on the instance behind `handle`.
///
/// # Safety
/// `handle` is NULL or an instance of this library that is live and in no other call.
pub unsafe fn call(
    handle: Handle,
    function: &str,
    body: impl FnOnce(&mut Instance) -> Result<c_int, Refused>,
) -> c_int {
    contain(ERROR, || {
        // SAFETY: the caller's promise.
        let Some(instance) = (unsafe { handle.cast::<Instance>().as_mut() }) else {
            return ERROR;
        };
        match body(instance) {
            Ok(status) => status,
            Err(refused) => instance.refuse(function, &refused),
        }
    })
}

/// Runs `body`; a panic ends here and gives `fallback`.
pub fn contain<R>(fallback: R, body: impl FnOnce() -> R) -> R {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|payload| {
        // Dropping a foreign payload could panic again.
        std::mem::forget(payload);
        fallback
    })
}

/// Exports functions that run on an instance.
macro_rules! exports {
    ($( fn $name:ident(|$instance:ident| $($argument:ident : $type:ty),*) => $body:expr; )*) => { $(
        #[doc = concat!("`", stringify!($name), "` of the standard.")]
        ///
        /// # Safety
        /// Pointers are NULL or as the standard describes them.
        #[unsafe(no_mangle)]
        #[allow(clippy::too_many_arguments, reason = "the standard has as many")]
        pub unsafe extern "C" fn $name(
            instance: $crate::original::Handle $(, $argument: $type)*
        ) -> std::ffi::c_int {
            // SAFETY: the caller's promise.
            unsafe { $crate::guard::call(instance, stringify!($name), |$instance| $body) }
        }
    )* };
}
pub(crate) use exports;

/// Exports functions that go to the original as they are.
macro_rules! forwarded {
    ($( fn $name:ident($($argument:ident : $type:ty),*); )*) => {
        $crate::guard::exports! { $(
            fn $name(|instance| $($argument: $type),*) => {
                let function: unsafe extern "C" fn($crate::original::Handle $(, $type)*) -> std::ffi::c_int =
                    instance.original.function(stringify!($name))
                        .map_err(|error| $crate::instance::Refused::error(error.to_string()))?;
                Ok(function(instance.original.handle $(, $argument)*))
            };
        )* }
    };
}
pub(crate) use forwarded;

/// Exports functions that an FMU around an FMU does not have.
macro_rules! unsupported {
    ($( fn $name:ident($($type:ty),*) because $reason:expr; )*) => { $(
        #[doc = concat!("`", stringify!($name), "` of the standard; not supported.")]
        ///
        /// # Safety
        /// The instance is NULL or live.
        #[unsafe(no_mangle)]
        #[allow(clippy::too_many_arguments, reason = "the standard has as many")]
        pub unsafe extern "C" fn $name(
            instance: $crate::original::Handle $(, _: $type)*
        ) -> std::ffi::c_int {
            // SAFETY: the caller's promise.
            unsafe {
                $crate::guard::call(instance, stringify!($name), |_| {
                    Err($crate::instance::Refused::error($reason))
                })
            }
        }
    )* };
}
pub(crate) use unsupported;

/// A slice of a C array; empty for NULL with no elements.
///
/// # Errors
/// NULL with elements.
///
/// # Safety
/// The array is NULL or has `count` elements that live as long as the slice.
pub unsafe fn slice<'a, T>(array: *const T, count: usize, name: &str) -> Result<&'a [T], Refused> {
    match (array.is_null(), count) {
        (_, 0) => Ok(&[]),
        (true, _) => Err(Refused::error(format!("argument '{name}' is NULL"))),
        // SAFETY: the caller's promise.
        (false, _) => Ok(unsafe { std::slice::from_raw_parts(array, count) }),
    }
}

/// The same, to be written.
///
/// # Errors
/// NULL with elements.
///
/// # Safety
/// As [`slice`], and nothing else refers to the array.
pub unsafe fn slice_mut<'a, T>(
    array: *mut T,
    count: usize,
    name: &str,
) -> Result<&'a mut [T], Refused> {
    match (array.is_null(), count) {
        (_, 0) => Ok(&mut []),
        (true, _) => Err(Refused::error(format!("argument '{name}' is NULL"))),
        // SAFETY: the caller's promise.
        (false, _) => Ok(unsafe { std::slice::from_raw_parts_mut(array, count) }),
    }
}

/// A function that the original lacks.
pub fn missing(error: OriginalError) -> Refused {
    Refused::error(error.to_string())
}

/// The place for a result.
///
/// # Errors
/// It is NULL.
///
/// # Safety
/// It is NULL or lives as long as the reference.
pub unsafe fn place<'a, T>(pointer: *mut T) -> Result<&'a mut T, Refused> {
    // SAFETY: the caller's promise.
    unsafe { pointer.as_mut() }.ok_or_else(|| Refused::error("a place for a result is NULL"))
}
