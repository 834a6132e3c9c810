//! Saving, restoring and serialising the state of an instance.

use super::handles::HandleError;
use super::instance::Instance;
use super::pointers::Output;
use super::saved::{STATES, SavedState};
use super::status::{Interface, Outcome, Phase, Refusal, Status};
use crate::cosim::state::{seal, sealed_size, unseal};
use crate::cosim::{StateError, StateReader, StateWriter};
use std::ffi::c_void;
use std::ptr;

impl Instance {
    fn save(&self) -> SavedState {
        let mut writer = StateWriter::default();
        writer.flag(self.interface == Interface::Fmi3);
        writer.flag(self.exchange);
        writer.integer(self.phase as u64);
        writer.flag(self.after_error);
        writer.real(self.time);
        writer.flag(self.stop_time.is_some());
        writer.real(self.stop_time.unwrap_or(0.0));
        writer.integer(self.last_step as u64);
        self.model.save(&mut writer);
        SavedState {
            token: self.model.token(),
            content: writer.into_bytes(),
        }
    }

    fn restore(&mut self, saved: &SavedState) -> Result<(), StateError> {
        let (found, expected) = (saved.token, self.model.token());
        if found != expected {
            let (found, expected) = (found.to_string(), expected.to_string());
            return Err(StateError::Foreign { found, expected });
        }
        let mut reader = StateReader::new(&saved.content);
        if reader.flag()? != (self.interface == Interface::Fmi3) {
            return Err(StateError::Content(
                "it was saved through the other FMI version".into(),
            ));
        }
        if reader.flag()? != self.exchange {
            return Err(StateError::Content(
                "it was saved by an instance of the other kind, model exchange or co-simulation"
                    .into(),
            ));
        }
        let number = reader.integer()?;
        let phase = Phase::from_number(number)
            .ok_or_else(|| StateError::Content(format!("there is no phase {number}")))?;
        if phase == Phase::Event && !self.event_mode_used && !self.exchange {
            return Err(StateError::Content(
                "it was saved in event mode, which this instance does not use".into(),
            ));
        }
        let after_error = reader.flag()?;
        let time = reader.real()?;
        let stop_time = reader.flag()?.then_some(reader.real()?);
        let last_step = match reader.integer()? {
            0 => Status::Ok,
            1 => Status::Warning,
            2 => Status::Discard,
            _ => Status::Error,
        };
        self.model.restore(&mut reader)?;
        reader.finish()?;
        (self.phase, self.after_error) = (phase, after_error);
        (self.time, self.stop_time, self.last_step) = (time, stop_time, last_step);
        Ok(())
    }

    /// Saves the state in a new one, or in the one that `handle` names.
    pub(super) fn get_state(&mut self, handle: *mut c_void) -> Result<*mut c_void, Refusal> {
        let saved = self.save();
        if handle.is_null() {
            return self.keep(saved);
        }
        STATES
            .with(handle, |state| *state = saved)
            .map_err(|error| self.unusable(handle, error))?;
        Ok(handle)
    }

    fn keep(&mut self, saved: SavedState) -> Result<*mut c_void, Refusal> {
        let handle = STATES
            .insert(saved)
            .ok_or_else(|| Refusal::error("too many saved states; free some of them"))?;
        // States that were freed are forgotten now and then, so that the list does not grow.
        if self.saved_states.len() == self.saved_states.capacity() {
            self.saved_states.retain(|handle| STATES.is_live(*handle));
        }
        self.saved_states.push(handle);
        Ok(handle)
    }

    /// Continues from a saved state.
    pub(super) fn set_state(&mut self, handle: *mut c_void) -> Outcome {
        STATES
            .with(handle, |state| self.restore(state))
            .map_err(|error| self.unusable(handle, error))?
            .map_err(Refusal::error)
    }

    fn unusable(&self, handle: *mut c_void, error: HandleError) -> Refusal {
        let argument = match self.interface {
            Interface::Fmi2 => "FMUstate",
            Interface::Fmi3 => "FMUState",
        };
        let reason = match error {
            HandleError::Dead if handle.is_null() => "is NULL".to_owned(),
            HandleError::Dead => {
                format!(
                    "{handle:?} is not a live one: it was freed, or never came from this library"
                )
            }
            HandleError::Busy => format!("{handle:?} is in use by another call"),
        };
        Refusal::error(format_args!(
            "argument '{argument}' {reason}; expected a state that was saved or deserialised here and not freed"
        ))
    }

    /// Ends a saved state. One that was freed before, or NULL, is left alone.
    pub(super) fn free_state(&mut self, state: *mut *mut c_void) -> Outcome {
        if state.is_null() {
            return Ok(());
        }
        if !state.is_aligned() {
            return Err(Refusal::error(format_args!(
                "the pointer to the state ({state:p}) cannot point to one"
            )));
        }
        // SAFETY: aligned; the standard says that the argument points to a handle.
        let handle = unsafe { state.read() };
        if handle.is_null() {
            return Ok(());
        }
        match STATES.remove(handle) {
            Ok(_) => {
                // SAFETY: as above.
                unsafe { state.write(ptr::null_mut()) };
                Ok(())
            }
            Err(_) => Err(Refusal::warning(
                "the state is not a live one (was it freed before?); nothing was freed",
            )),
        }
    }

    /// Number of bytes of the serialised state.
    pub(super) fn serialized_size(&self, handle: *mut c_void) -> Result<usize, Refusal> {
        STATES
            .with(handle, |state| sealed_size(state.content.len()))
            .map_err(|error| self.unusable(handle, error))
    }

    /// Writes a saved state as bytes into an array of `size`.
    pub(super) fn serialize(
        &self,
        handle: *mut c_void,
        bytes: &mut Output<u8>,
        size: usize,
    ) -> Outcome {
        let sealed = STATES
            .with(handle, |s| seal(s.token, &s.content))
            .map_err(|error| self.unusable(handle, error))?;
        if size < sealed.len() {
            return Err(Refusal::error(format_args!(
                "size = {size} is too small for the serialised state of {} bytes",
                sealed.len()
            )));
        }
        for (place, byte) in sealed.into_iter().enumerate() {
            bytes.write(place, byte);
        }
        Ok(())
    }

    /// Makes a saved state of bytes; the instance itself does not change.
    pub(super) fn deserialize(&mut self, bytes: &[u8]) -> Result<*mut c_void, Refusal> {
        let token = self.model.token();
        let content = unseal(token, bytes).map_err(Refusal::error)?.to_vec();
        self.keep(SavedState { token, content })
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        for handle in &self.saved_states {
            // A state that the importer freed already is gone; that is as it should be.
            let _ = STATES.remove(*handle);
        }
    }
}
