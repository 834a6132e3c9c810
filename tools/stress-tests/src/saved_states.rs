//! The functions about saved states, which both versions have under other names.

use std::ffi::c_int;
use std::ptr;

use crate::library::{Handle, Library};
use crate::standard::Version;

/// The functions of one version.
pub(crate) struct Functions {
    get: unsafe extern "C" fn(Handle, *mut Handle) -> c_int,
    set: unsafe extern "C" fn(Handle, Handle) -> c_int,
    free: unsafe extern "C" fn(Handle, *mut Handle) -> c_int,
    size: unsafe extern "C" fn(Handle, Handle, *mut usize) -> c_int,
    serialize: unsafe extern "C" fn(Handle, Handle, *mut u8, usize) -> c_int,
    deserialize: unsafe extern "C" fn(Handle, *const u8, usize, *mut Handle) -> c_int,
}

impl Functions {
    pub(crate) fn of(library: &Library, version: Version) -> Self {
        let (two, three) = (&library.fmi2, &library.fmi3);
        match version {
            Version::Two => Self {
                get: two.get_state,
                set: two.set_state,
                free: two.free_state,
                size: two.state_size,
                serialize: two.serialize,
                deserialize: two.deserialize,
            },
            Version::Three => Self {
                get: three.get_state,
                set: three.set_state,
                free: three.free_state,
                size: three.state_size,
                serialize: three.serialize,
                deserialize: three.deserialize,
            },
        }
    }

    /// Saves into a place that holds `state`; returns what it holds afterwards.
    pub(crate) fn save(&self, instance: Handle, mut state: Handle, null: bool) -> (c_int, Handle) {
        let place = if null {
            ptr::null_mut()
        } else {
            &raw mut state
        };
        // SAFETY: a place for a handle, or NULL, which the library must refuse.
        let status = unsafe { (self.get)(instance, place) };
        (status, state)
    }

    pub(crate) fn restore(&self, instance: Handle, state: Handle) -> c_int {
        // SAFETY: handles are numbers; the library must recognise wrong ones.
        unsafe { (self.set)(instance, state) }
    }

    pub(crate) fn free(&self, instance: Handle, mut state: Handle, null: bool) -> (c_int, Handle) {
        let place = if null {
            ptr::null_mut()
        } else {
            &raw mut state
        };
        // SAFETY: as for `save`.
        let status = unsafe { (self.free)(instance, place) };
        (status, state)
    }

    pub(crate) fn size(&self, instance: Handle, state: Handle, null: bool) -> (c_int, usize) {
        let mut size = 0;
        let place = if null { ptr::null_mut() } else { &raw mut size };
        // SAFETY: a place for a size, or NULL, which the library must refuse.
        let status = unsafe { (self.size)(instance, state, place) };
        (status, size)
    }

    pub(crate) fn serialize(
        &self,
        instance: Handle,
        state: Handle,
        size: usize,
        null: bool,
    ) -> (c_int, Vec<u8>) {
        let mut bytes = vec![0; size];
        let place = if null {
            ptr::null_mut()
        } else {
            bytes.as_mut_ptr()
        };
        // SAFETY: an array of that size, or NULL, which the library must refuse.
        let status = unsafe { (self.serialize)(instance, state, place, size) };
        (status, bytes)
    }

    pub(crate) fn deserialize(
        &self,
        instance: Handle,
        bytes: &[u8],
        null: bool,
    ) -> (c_int, Handle) {
        let mut state = ptr::null_mut();
        let place = if null {
            ptr::null_mut()
        } else {
            &raw mut state
        };
        // SAFETY: an array with its length, and a place for a handle or NULL.
        let status = unsafe { (self.deserialize)(instance, bytes.as_ptr(), bytes.len(), place) };
        (status, state)
    }
}
