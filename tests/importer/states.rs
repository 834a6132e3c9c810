//! Saved states as an importer holds them.

use super::{Fmi2, Fmi3, Instance};
use std::ffi::c_void;
use std::ptr;
use stickslip::ffi::{Status, fmi2, fmi3};

impl Instance<'_> {
    #[track_caller]
    pub fn save(&self) -> *mut c_void {
        let mut state = ptr::null_mut();
        // SAFETY: the place of a handle.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2GetFMUstate(self.handle, &mut state),
                Fmi3 => fmi3::fmi3GetFMUState(self.handle, &mut state),
            }
        };
        assert_eq!(status, Status::Ok);
        state
    }

    pub fn try_restore(&self, state: *mut c_void) -> Status {
        // SAFETY: a handle of this library, or one that it must recognise as none.
        unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2SetFMUstate(self.handle, state),
                Fmi3 => fmi3::fmi3SetFMUState(self.handle, state),
            }
        }
    }

    #[track_caller]
    pub fn restore(&mut self, state: *mut c_void) {
        assert_eq!(self.try_restore(state), Status::Ok);
        self.time = self.get("time");
    }

    pub fn free_state(&self, state: &mut *mut c_void) -> Status {
        // SAFETY: the place of a handle.
        unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2FreeFMUstate(self.handle, state),
                Fmi3 => fmi3::fmi3FreeFMUState(self.handle, state),
            }
        }
    }

    #[track_caller]
    pub fn serialized_size(&self, state: *mut c_void) -> usize {
        let mut size = 0;
        // SAFETY: a handle of this library and the place of the result.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2SerializedFMUstateSize(self.handle, state, &mut size),
                Fmi3 => fmi3::fmi3SerializedFMUStateSize(self.handle, state, &mut size),
            }
        };
        assert_eq!(status, Status::Ok);
        size
    }

    pub fn try_serialize(&self, state: *mut c_void, bytes: &mut [u8]) -> Status {
        let (handle, pointer, size) = (self.handle, bytes.as_mut_ptr(), bytes.len());
        // SAFETY: a handle of this library and an array of its own length.
        unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2SerializeFMUstate(handle, state, pointer, size),
                Fmi3 => fmi3::fmi3SerializeFMUState(handle, state, pointer, size),
            }
        }
    }

    #[track_caller]
    pub fn serialize(&self, state: *mut c_void) -> Vec<u8> {
        let mut bytes = vec![0; self.serialized_size(state)];
        assert_eq!(self.try_serialize(state, &mut bytes), Status::Ok);
        bytes
    }

    /// The state, or the status with which the bytes were refused.
    pub fn try_deserialize(&self, bytes: &[u8]) -> Result<*mut c_void, Status> {
        let mut state = ptr::null_mut();
        let (handle, pointer, size) = (self.handle, bytes.as_ptr(), bytes.len());
        // SAFETY: an array and the place of a handle.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2DeSerializeFMUstate(handle, pointer, size, &mut state),
                Fmi3 => fmi3::fmi3DeserializeFMUState(handle, pointer, size, &mut state),
            }
        };
        if status == Status::Ok {
            Ok(state)
        } else {
            assert!(state.is_null());
            Err(status)
        }
    }

    #[track_caller]
    pub fn deserialize(&self, bytes: &[u8]) -> *mut c_void {
        self.try_deserialize(bytes).unwrap()
    }
}
