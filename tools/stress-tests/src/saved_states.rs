//! The functions about saved states, wrong places for their results included.

use std::ffi::c_int;
use std::ptr;

use crate::library::{Both, Handle};

/// The place of a result, or NULL, which the library must refuse.
pub(crate) fn place<T>(result: &mut T, null: bool) -> *mut T {
    if null { ptr::null_mut() } else { result }
}

impl Both {
    /// Saves into a place that holds `state`; returns what it holds afterwards.
    pub(crate) fn save(&self, instance: Handle, mut state: Handle, null: bool) -> (c_int, Handle) {
        // SAFETY: a place for a handle, or NULL, which the library must refuse.
        let status = unsafe { (self.get_state)(instance, place(&mut state, null)) };
        (status, state)
    }

    pub(crate) fn restore(&self, instance: Handle, state: Handle) -> c_int {
        // SAFETY: handles are numbers; the library must recognise wrong ones.
        unsafe { (self.set_state)(instance, state) }
    }

    pub(crate) fn forget(
        &self,
        instance: Handle,
        mut state: Handle,
        null: bool,
    ) -> (c_int, Handle) {
        // SAFETY: as for `save`.
        let status = unsafe { (self.free_state)(instance, place(&mut state, null)) };
        (status, state)
    }

    pub(crate) fn size(&self, instance: Handle, state: Handle, null: bool) -> (c_int, usize) {
        let mut size = 0;
        // SAFETY: a place for a size, or NULL, which the library must refuse.
        let status = unsafe { (self.state_size)(instance, state, place(&mut size, null)) };
        (status, size)
    }

    pub(crate) fn bytes(
        &self,
        instance: Handle,
        state: Handle,
        size: usize,
        null: bool,
    ) -> (c_int, Vec<u8>) {
        let mut bytes = vec![0; size];
        let first = if null {
            ptr::null_mut()
        } else {
            bytes.as_mut_ptr()
        };
        // SAFETY: an array of that size, or NULL, which the library must refuse.
        let status = unsafe { (self.serialize)(instance, state, first, size) };
        (status, bytes)
    }

    pub(crate) fn state_of(&self, instance: Handle, bytes: &[u8], null: bool) -> (c_int, Handle) {
        let mut state = ptr::null_mut();
        let (first, count) = (bytes.as_ptr(), bytes.len());
        // SAFETY: an array with its length, and a place for a handle or NULL.
        let status = unsafe { (self.deserialize)(instance, first, count, place(&mut state, null)) };
        (status, state)
    }
}
