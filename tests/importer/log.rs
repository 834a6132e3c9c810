//! The importer's side of the log.

use std::cell::RefCell;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::mem;
use stickslip::ffi::{Fmi2Logger, Fmi3Logger};

/// One message as it arrived.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    pub status: c_int,
    pub category: String,
    pub text: String,
}

/// The messages since the last look. Its address is the instance environment.
#[derive(Default)]
pub struct Log(RefCell<Vec<Message>>);

impl Log {
    /// The messages since the last look.
    pub fn take(&self) -> Vec<Message> {
        self.0.take()
    }

    /// The only message since the last look; `what` names the call for whoever reads the failure.
    #[track_caller]
    pub fn only(&self, what: &str) -> Message {
        let mut messages = self.take();
        assert_eq!(messages.len(), 1, "{what}: {messages:?}");
        messages.remove(0)
    }

    pub(super) fn environment(&self) -> *mut c_void {
        (&raw const *self).cast_mut().cast()
    }
}

unsafe extern "C" fn note(
    environment: *mut c_void,
    status: c_int,
    category: *const c_char,
    text: *const c_char,
) {
    // SAFETY: the library hands back the environment it was given, a `Log`, and strings of its own.
    unsafe {
        let owned = |text: *const c_char| CStr::from_ptr(text).to_str().unwrap().to_owned();
        let message = Message {
            status,
            category: owned(category),
            text: owned(text),
        };
        (*environment.cast::<Log>()).0.borrow_mut().push(message);
    }
}

unsafe extern "C" fn note_2(
    environment: *mut c_void,
    _instance_name: *const c_char,
    status: c_int,
    category: *const c_char,
    text: *const c_char,
) {
    // SAFETY: as above.
    unsafe { note(environment, status, category, text) };
}

/// The logger for FMI 2. It ignores variable arguments, as importers in languages without them do.
pub(super) fn logger_2() -> Fmi2Logger {
    type Plain =
        unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char);
    // SAFETY: without variable arguments both kinds are called alike on 64-bit Linux, Windows and macOS.
    unsafe { mem::transmute::<Plain, Fmi2Logger>(note_2) }
}

/// The logger for FMI 3.
pub(super) fn logger_3() -> Fmi3Logger {
    note
}
