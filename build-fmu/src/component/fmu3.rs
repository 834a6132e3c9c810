//! The C interface of FMI 3.0 for co-simulation, as far as a run needs it.

use std::ffi::{CStr, c_char, c_int, c_uint, c_void};
use std::path::Path;
use std::sync::Mutex;

use libloading::Library;

use super::description::Description;
use super::fmu::{Failed, Instance, Log, write_log};
use super::fmu2::{answer, c_text, symbol};

type Handle = *mut c_void;
type Text = *const c_char;
type Logger = unsafe extern "C" fn(*const c_void, c_int, Text, Text);

type Instantiate = unsafe extern "C" fn(
    Text,
    Text,
    Text,
    bool,
    bool,
    bool,
    bool,
    *const c_uint,
    usize,
    *const c_void,
    Logger,
    *const c_void,
) -> Handle;
type Plain = unsafe extern "C" fn(Handle) -> c_int;
type DoStep = unsafe extern "C" fn(
    Handle,
    f64,
    f64,
    bool,
    *mut bool,
    *mut bool,
    *mut bool,
    *mut f64,
) -> c_int;

unsafe extern "C" fn log_message(
    environment: *const c_void,
    status: c_int,
    category: Text,
    message: Text,
) {
    if environment.is_null() || message.is_null() || status == 0 {
        return;
    }
    // SAFETY: the environment is the log that the instance keeps alive; the standard promises text that ends in a null.
    let (log, message) = unsafe {
        (
            &*environment.cast::<Mutex<Vec<String>>>(),
            CStr::from_ptr(message),
        )
    };
    let category = if category.is_null() {
        ""
    } else {
        unsafe { CStr::from_ptr(category) }
            .to_str()
            .unwrap_or_default()
    };
    write_log(log, format!("[{category}] {}", message.to_string_lossy()));
}

/// An instance of an FMU for FMI 3.0.
pub(super) struct Fmi3 {
    handle: Handle,
    free_instance: unsafe extern "C" fn(Handle),
    terminate: Plain,
    reset: Plain,
    enter_initialisation: unsafe extern "C" fn(Handle, bool, f64, f64, bool, f64) -> c_int,
    exit_initialisation: Plain,
    set_real: unsafe extern "C" fn(Handle, *const c_uint, usize, *const f64, usize) -> c_int,
    get_real: unsafe extern "C" fn(Handle, *const c_uint, usize, *mut f64, usize) -> c_int,
    get_boolean: unsafe extern "C" fn(Handle, *const c_uint, usize, *mut bool, usize) -> c_int,
    do_step: DoStep,
    running: bool,
    // Kept while the instance lives: it writes to it.
    _log: Log,
    _library: Library,
}

impl Fmi3 {
    pub(super) fn new(
        library: Library,
        description: &Description,
        resources: &Path,
        log: Log,
    ) -> Result<Self, String> {
        let name = c_text("stickslip")?;
        let token = c_text(&description.token)?;
        let location = c_text(&resources.display().to_string())?;
        let environment = std::sync::Arc::as_ptr(&log).cast();
        let none: *const c_void = std::ptr::null();
        // SAFETY: the names and types are those of the standard's headers.
        unsafe {
            let instantiate: Instantiate = symbol(&library, "fmi3InstantiateCoSimulation")?;
            let mut fmu = Self {
                handle: std::ptr::null_mut(),
                free_instance: symbol(&library, "fmi3FreeInstance")?,
                terminate: symbol(&library, "fmi3Terminate")?,
                reset: symbol(&library, "fmi3Reset")?,
                enter_initialisation: symbol(&library, "fmi3EnterInitializationMode")?,
                exit_initialisation: symbol(&library, "fmi3ExitInitializationMode")?,
                set_real: symbol(&library, "fmi3SetFloat64")?,
                get_real: symbol(&library, "fmi3GetFloat64")?,
                get_boolean: symbol(&library, "fmi3GetBoolean")?,
                do_step: symbol(&library, "fmi3DoStep")?,
                running: false,
                _log: log,
                _library: library,
            };
            // Not visible, with logging, without event mode and without early return.
            fmu.handle = instantiate(
                name.as_ptr(),
                token.as_ptr(),
                location.as_ptr(),
                false,
                true,
                false,
                false,
                none.cast(),
                0,
                environment,
                log_message,
                none,
            );
            if fmu.handle.is_null() {
                Err("fmi3InstantiateCoSimulation gave no instance".to_owned())
            } else {
                Ok(fmu)
            }
        }
    }
}

impl Instance for Fmi3 {
    fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Result<(), Failed> {
        // SAFETY: both slices have the lengths that are passed.
        answer("fmi3SetFloat64", unsafe {
            (self.set_real)(
                self.handle,
                references.as_ptr(),
                references.len(),
                values.as_ptr(),
                values.len(),
            )
        })
    }

    fn reals(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Failed> {
        // SAFETY: both slices have the lengths that are passed.
        answer("fmi3GetFloat64", unsafe {
            (self.get_real)(
                self.handle,
                references.as_ptr(),
                references.len(),
                values.as_mut_ptr(),
                values.len(),
            )
        })
    }

    fn boolean(&mut self, reference: u32) -> Result<bool, Failed> {
        let mut value = false;
        // SAFETY: one reference, one place for its value.
        answer("fmi3GetBoolean", unsafe {
            (self.get_boolean)(self.handle, &reference, 1, &mut value, 1)
        })?;
        Ok(value)
    }

    fn initialise(&mut self, start: f64, stop: f64, tolerance: Option<f64>) -> Result<(), Failed> {
        let (stated, tolerance) = (tolerance.is_some(), tolerance.unwrap_or(0.0));
        // SAFETY: the instance is live.
        unsafe {
            answer(
                "fmi3EnterInitializationMode",
                (self.enter_initialisation)(self.handle, stated, tolerance, start, true, stop),
            )?;
            answer(
                "fmi3ExitInitializationMode",
                (self.exit_initialisation)(self.handle),
            )?;
        }
        self.running = true;
        Ok(())
    }

    fn reset(&mut self) -> Result<(), Failed> {
        // SAFETY: the instance is live.
        answer("fmi3Reset", unsafe { (self.reset)(self.handle) })?;
        self.running = false;
        Ok(())
    }

    fn step(&mut self, from: f64, length: f64) -> Result<(), Failed> {
        let (mut event, mut terminate, mut early, mut reached) = (false, false, false, from);
        // SAFETY: the instance is live; no state before this point is set again.
        let status = unsafe {
            (self.do_step)(
                self.handle,
                from,
                length,
                true,
                &mut event,
                &mut terminate,
                &mut early,
                &mut reached,
            )
        };
        answer("fmi3DoStep", status)?;
        // Early return was not allowed: an FMU that does it, or that wants to end, cannot be run on.
        if early || terminate {
            Err(Failed {
                function: "fmi3DoStep",
                status: 2,
            })
        } else {
            Ok(())
        }
    }
}

impl Drop for Fmi3 {
    fn drop(&mut self) {
        if self.handle.is_null() {
            return;
        }
        // SAFETY: the instance is live and is not used again.
        unsafe {
            if self.running {
                (self.terminate)(self.handle);
            }
            (self.free_instance)(self.handle);
        }
    }
}
