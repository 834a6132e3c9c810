//! States that the importer saves, restores and serialises: the original's, with what the instance has beside it in front.

use std::ffi::c_int;
use std::ptr;

use crate::guard::{missing, place, slice, slice_mut};
use crate::instance::{Instance, Refused};
use crate::original::{Handle, is_good};
use crate::own::Own;

/// A state that the importer holds.
struct Saved {
    original: Handle,
    own: Own,
}

/// Saves the state, over an earlier one where there is one.
///
/// # Errors
/// The original cannot, or refuses.
///
/// # Safety
/// `state` is NULL or a place that holds NULL or a state of this instance.
pub unsafe fn get(instance: &mut Instance, state: *mut Handle) -> Result<c_int, Refused> {
    // SAFETY: the caller's promise.
    let (state, old) = unsafe {
        let state = place(state)?;
        let old = state.cast::<Saved>().as_mut();
        (state, old)
    };
    let mut original = old.as_ref().map_or(ptr::null_mut(), |old| old.original);
    let status = instance
        .original
        .save(&mut original)
        .ok_or_else(|| Refused::error("the original cannot save its state"))?;
    if !is_good(status) {
        return Err(Refused::original(status));
    }
    let saved = Saved {
        original,
        own: instance.own.clone(),
    };
    match old {
        Some(old) => *old = saved,
        None => *state = Box::into_raw(Box::new(saved)).cast(),
    }
    Ok(status)
}

/// Goes back to a saved state.
///
/// # Errors
/// NULL, or a status of the original.
///
/// # Safety
/// `state` is NULL or a state of this instance.
pub unsafe fn set(instance: &mut Instance, state: Handle) -> Result<c_int, Refused> {
    // SAFETY: the caller's promise.
    let saved = unsafe { known(state) }?;
    let status = instance.original.restore(saved.original);
    if !is_good(status) {
        return Err(Refused::original(status));
    }
    instance.own.clone_from(&saved.own);
    Ok(status)
}

/// Ends a saved state.
///
/// # Errors
/// The place is NULL.
///
/// # Safety
/// As [`get`]; the state is not used again.
pub unsafe fn free(instance: &mut Instance, state: *mut Handle) -> Result<c_int, Refused> {
    // SAFETY: the caller's promise.
    unsafe {
        let state = place(state)?;
        if !state.is_null() {
            let mut saved = Box::from_raw(state.cast::<Saved>());
            instance.original.forget(&mut saved.original);
            *state = ptr::null_mut();
        }
    }
    Ok(0)
}

/// Size of a serialised state; `function` is the original's function for its part.
///
/// # Errors
/// NULL, or the original lacks the function.
///
/// # Safety
/// As [`set`]; `size` is NULL or a place.
pub unsafe fn size(
    instance: &mut Instance,
    function: &str,
    state: Handle,
    size: *mut usize,
) -> Result<c_int, Refused> {
    type Size = unsafe extern "C" fn(Handle, Handle, *mut usize) -> c_int;
    // SAFETY: the caller's promise, and the type is that of the standards' headers.
    unsafe {
        let (saved, size) = (known(state)?, place(size)?);
        let size_of: Size = instance.original.function(function).map_err(missing)?;
        let status = size_of(instance.original.handle, saved.original, size);
        *size += own_size(instance);
        Ok(status)
    }
}

/// Serialises a state.
///
/// # Errors
/// NULL, too few bytes, or the original lacks the function.
///
/// # Safety
/// As [`set`]; `bytes` is NULL or has `count` bytes.
pub unsafe fn serialize(
    instance: &mut Instance,
    function: &str,
    state: Handle,
    (bytes, count): (*mut u8, usize),
) -> Result<c_int, Refused> {
    type Serialize = unsafe extern "C" fn(Handle, Handle, *mut u8, usize) -> c_int;
    // SAFETY: the caller's promise, and the type is that of the standards' headers.
    unsafe {
        let saved = known(state)?;
        let serialize: Serialize = instance.original.function(function).map_err(missing)?;
        let bytes = slice_mut(bytes, count, "serializedState")?;
        let own = own_size(instance);
        let (own, rest) = bytes
            .split_at_mut_checked(own)
            .ok_or_else(|| too_short(count, own))?;
        for (place, number) in own.chunks_exact_mut(8).zip(saved.own.numbers()) {
            place.copy_from_slice(&number.to_le_bytes());
        }
        let (rest, count) = (rest.as_mut_ptr(), rest.len());
        Ok(serialize(
            instance.original.handle,
            saved.original,
            rest,
            count,
        ))
    }
}

/// A state from its bytes.
///
/// # Errors
/// NULL, bytes that are no state, or the original lacks the function.
///
/// # Safety
/// As [`get`]; `bytes` is NULL or has `count` bytes.
pub unsafe fn deserialize(
    instance: &mut Instance,
    function: &str,
    (bytes, count): (*const u8, usize),
    state: *mut Handle,
) -> Result<c_int, Refused> {
    type Deserialize = unsafe extern "C" fn(Handle, *const u8, usize, *mut Handle) -> c_int;
    // SAFETY: the caller's promise, and the type is that of the standards' headers.
    unsafe {
        let deserialize: Deserialize = instance.original.function(function).map_err(missing)?;
        let bytes = slice(bytes, count, "serializedState")?;
        let state = place(state)?;
        let own = own_size(instance);
        let (numbers, rest) = bytes
            .split_at_checked(own)
            .ok_or_else(|| too_short(count, own))?;
        let numbers = numbers.as_chunks::<8>().0.iter();
        let numbers: Vec<f64> = numbers.map(|own| f64::from_le_bytes(*own)).collect();
        let mut own = instance.own.clone();
        own.take(&numbers)
            .ok_or_else(|| too_short(count, own_size(instance)))?;
        let mut original = ptr::null_mut();
        let status = deserialize(
            instance.original.handle,
            rest.as_ptr(),
            rest.len(),
            &raw mut original,
        );
        if is_good(status) {
            *state = Box::into_raw(Box::new(Saved { original, own })).cast();
        }
        Ok(status)
    }
}

/// Bytes of a serialised state in front of the original's.
fn own_size(instance: &Instance) -> usize {
    8 * instance.own.numbers().len()
}

/// # Safety
/// `state` is NULL or a state of a live instance.
unsafe fn known<'a>(state: Handle) -> Result<&'a Saved, Refused> {
    // SAFETY: the caller's promise.
    unsafe { state.cast::<Saved>().as_ref() }
        .ok_or_else(|| Refused::error("the state is NULL; save one first"))
}

fn too_short(count: usize, own: usize) -> Refused {
    Refused::error(format!(
        "{count} bytes are no state of this FMU, which has {own} of its own before those of the original"
    ))
}
