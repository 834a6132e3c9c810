//! What the C side passes by pointer: checked views of its arrays and strings.

use super::status::Refusal;
use std::ffi::{CStr, c_char};
use std::ptr::NonNull;
use std::slice;

fn check<T>(pointer: *const T, count: usize, argument: &str) -> Result<(), Refusal> {
    if pointer.is_null() {
        return Err(Refusal::error(format_args!(
            "argument '{argument}' is NULL; expected an array of {count}"
        )));
    }
    if !pointer.is_aligned() || count > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(Refusal::error(format_args!(
            "argument '{argument}' ({pointer:p}, {count} elements) cannot be an array"
        )));
    }
    Ok(())
}

/// An array that the importer passes in. NULL is an array of length zero.
///
/// # Safety
/// A pointer that is not NULL points to `count` initialised values that nobody changes during `'a`.
pub(super) unsafe fn input<'a, T>(
    pointer: *const T,
    count: usize,
    argument: &str,
) -> Result<&'a [T], Refusal> {
    if count == 0 {
        return Ok(&[]);
    }
    check(pointer, count, argument)?;
    // SAFETY: not NULL, aligned and of a possible size; the rest is the caller's promise.
    Ok(unsafe { slice::from_raw_parts(pointer, count) })
}

/// An array that the importer wants filled; it may be uninitialised, so it is only written.
pub(super) struct Output<T> {
    pointer: NonNull<T>,
    count: usize,
}

impl<T> Output<T> {
    /// Writes element `place`; beyond the end nothing happens.
    pub(super) fn write(&mut self, place: usize, value: T) {
        if place < self.count {
            // SAFETY: within the array that the importer promised to be writable.
            unsafe { self.pointer.add(place).write(value) };
        }
    }
}

/// An array that the importer wants filled.
///
/// # Safety
/// A pointer that is not NULL points to `count` writable values that nobody else uses meanwhile.
pub(super) unsafe fn output<T>(
    pointer: *mut T,
    count: usize,
    argument: &str,
) -> Result<Output<T>, Refusal> {
    if count > 0 {
        check(pointer, count, argument)?;
    }
    Ok(Output {
        pointer: NonNull::new(pointer).unwrap_or(NonNull::dangling()),
        count,
    })
}

/// A single value that the importer wants written.
///
/// # Safety
/// As for [`output`] with one element.
pub(super) unsafe fn place<T>(pointer: *mut T, argument: &str) -> Result<Output<T>, Refusal> {
    // SAFETY: the caller's promise.
    unsafe { output(pointer, 1, argument) }
}

/// A string that the importer passes in; `None` for NULL.
///
/// # Safety
/// A pointer that is not NULL points to a string that ends with a zero byte and stays during `'a`.
pub(super) unsafe fn text<'a>(pointer: *const c_char) -> Option<&'a CStr> {
    // SAFETY: not NULL; the rest is the caller's promise.
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) })
}

/// The strings of an array, none of which may be NULL.
///
/// # Safety
/// As for [`input`] and [`text`].
pub(super) unsafe fn texts<'a>(
    pointer: *const *const c_char,
    count: usize,
    argument: &str,
) -> Result<Vec<&'a CStr>, Refusal> {
    // SAFETY: the caller's promise about the pointers.
    let entries = unsafe { input(pointer, count, argument)? };
    let entry = |(place, pointer): (usize, &*const c_char)| {
        // SAFETY: the caller's promise about the pointers.
        unsafe { text(*pointer) }.ok_or_else(|| {
            Refusal::error(format_args!(
                "entry {place} of '{argument}' is NULL; expected a text"
            ))
        })
    };
    entries.iter().enumerate().map(entry).collect()
}

/// Array lengths that must agree.
pub(super) fn same_length(
    (what, count): (&str, usize),
    (other, other_count): (&str, usize),
) -> Result<(), Refusal> {
    if count == other_count {
        return Ok(());
    }
    Err(Refusal::error(format_args!(
        "{what} = {count} must equal {other} = {other_count}: every variable is a scalar"
    )))
}
