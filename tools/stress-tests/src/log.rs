//! The importer's side of the log: what arrives is kept until the caller has compared it.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::mem;

use stickslip::ffi::{Fmi2Logger, Fmi3Logger};

/// One message as it arrived.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// Its status.
    pub status: c_int,
    /// Its category.
    pub category: String,
    /// Its text.
    pub text: String,
}

/// Messages since the last look. Its address is the instance environment, so it stays in its box.
#[derive(Debug, Default)]
pub struct Inbox {
    messages: Vec<Message>,
}

impl Inbox {
    /// The messages since the last look.
    pub fn take(&mut self) -> Vec<Message> {
        mem::take(&mut self.messages)
    }

    /// The environment pointer by which the loggers find this inbox.
    pub fn environment(&mut self) -> *mut c_void {
        (&raw mut *self).cast()
    }
}

/// # Safety
/// `environment` is that of a live [`Inbox`] that nobody else uses; the texts end with a zero byte.
unsafe fn note(
    environment: *mut c_void,
    status: c_int,
    category: *const c_char,
    text: *const c_char,
) {
    // SAFETY: the caller's promise.
    unsafe {
        let owned = |text: *const c_char| CStr::from_ptr(text).to_string_lossy().into_owned();
        let message = Message {
            status,
            category: owned(category),
            text: owned(text),
        };
        (*environment.cast::<Inbox>()).messages.push(message);
    }
}

unsafe extern "C" fn note_2(
    environment: *mut c_void,
    _instance_name: *const c_char,
    status: c_int,
    category: *const c_char,
    text: *const c_char,
) {
    // SAFETY: the library hands back the environment it was given, and strings of its own.
    unsafe { note(environment, status, category, text) };
}

unsafe extern "C" fn note_3(
    environment: *mut c_void,
    status: c_int,
    category: *const c_char,
    text: *const c_char,
) {
    // SAFETY: as above.
    unsafe { note(environment, status, category, text) };
}

/// The logger for FMI 2. It ignores variable arguments, as importers in languages without them do.
#[must_use]
pub fn logger_2() -> Fmi2Logger {
    type Plain =
        unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char);
    // SAFETY: without variable arguments both kinds are called alike on 64-bit Linux, Windows and macOS.
    unsafe { mem::transmute::<Plain, Fmi2Logger>(note_2) }
}

/// The logger for FMI 3.
#[must_use]
pub fn logger_3() -> Fmi3Logger {
    note_3
}
