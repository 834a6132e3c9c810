//! The C interface of FMI 2.0 for co-simulation, as far as a run needs it.

use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::path::Path;
use std::sync::Mutex;

use libloading::Library;

use super::description::Description;
use super::fmu::{Failed, Instance, Log, write_log};

type Handle = *mut c_void;
type Text = *const c_char;

/// `fmi2CallbackLogger` ends in `...`. Rust has no such functions; on the platforms that FMUs run on, the named arguments
/// of a variadic call arrive where those of a plain one do, and nothing beyond them is read.
type Logger = unsafe extern "C" fn(Handle, Text, c_int, Text, Text);

#[repr(C)]
struct Callbacks {
    logger: Logger,
    allocate: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    free: unsafe extern "C" fn(*mut c_void),
    step_finished: Option<unsafe extern "C" fn(Handle, c_int)>,
    environment: *const c_void,
}

unsafe extern "C" {
    fn calloc(count: usize, size: usize) -> *mut c_void;
    #[link_name = "free"]
    fn free_memory(memory: *mut c_void);
}

unsafe extern "C" fn log_message(
    environment: Handle,
    _name: Text,
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

type Instantiate =
    unsafe extern "C" fn(Text, c_int, Text, Text, *const Callbacks, c_int, c_int) -> Handle;
type Plain = unsafe extern "C" fn(Handle) -> c_int;

/// An instance of an FMU for FMI 2.0.
pub(super) struct Fmi2 {
    handle: Handle,
    free_instance: unsafe extern "C" fn(Handle),
    terminate: Plain,
    reset: Plain,
    set_up: unsafe extern "C" fn(Handle, c_int, f64, f64, c_int, f64) -> c_int,
    enter_initialisation: Plain,
    exit_initialisation: Plain,
    set_real: unsafe extern "C" fn(Handle, *const c_uint, usize, *const f64) -> c_int,
    get_real: unsafe extern "C" fn(Handle, *const c_uint, usize, *mut f64) -> c_int,
    get_boolean: unsafe extern "C" fn(Handle, *const c_uint, usize, *mut c_int) -> c_int,
    do_step: unsafe extern "C" fn(Handle, f64, f64, c_int) -> c_int,
    running: bool,
    // Kept while the instance lives: the standard lets it hold on to them.
    _callbacks: Box<Callbacks>,
    _log: Log,
    _library: Library,
}

impl Fmi2 {
    pub(super) fn new(
        library: Library,
        description: &Description,
        resources: &Path,
        log: Log,
    ) -> Result<Self, String> {
        let name = c_text("stickslip")?;
        let token = c_text(&description.token)?;
        let location = c_text(&file_address(resources))?;
        let callbacks = Box::new(Callbacks {
            logger: log_message,
            allocate: calloc,
            free: free_memory,
            step_finished: None,
            environment: std::sync::Arc::as_ptr(&log).cast(),
        });
        // SAFETY: the names and types are those of the standard's headers.
        unsafe {
            let instantiate: Instantiate = symbol(&library, "fmi2Instantiate")?;
            let mut fmu = Self {
                handle: std::ptr::null_mut(),
                free_instance: symbol(&library, "fmi2FreeInstance")?,
                terminate: symbol(&library, "fmi2Terminate")?,
                reset: symbol(&library, "fmi2Reset")?,
                set_up: symbol(&library, "fmi2SetupExperiment")?,
                enter_initialisation: symbol(&library, "fmi2EnterInitializationMode")?,
                exit_initialisation: symbol(&library, "fmi2ExitInitializationMode")?,
                set_real: symbol(&library, "fmi2SetReal")?,
                get_real: symbol(&library, "fmi2GetReal")?,
                get_boolean: symbol(&library, "fmi2GetBoolean")?,
                do_step: symbol(&library, "fmi2DoStep")?,
                running: false,
                _callbacks: callbacks,
                _log: log,
                _library: library,
            };
            // 1 = co-simulation; not visible; with logging.
            fmu.handle = instantiate(
                name.as_ptr(),
                1,
                token.as_ptr(),
                location.as_ptr(),
                &*fmu._callbacks,
                0,
                1,
            );
            if fmu.handle.is_null() {
                Err("fmi2Instantiate gave no instance".to_owned())
            } else {
                Ok(fmu)
            }
        }
    }
}

impl Instance for Fmi2 {
    fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Result<(), Failed> {
        // SAFETY: both slices have the length that is passed.
        answer("fmi2SetReal", unsafe {
            (self.set_real)(
                self.handle,
                references.as_ptr(),
                references.len().min(values.len()),
                values.as_ptr(),
            )
        })
    }

    fn reals(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Failed> {
        // SAFETY: both slices have the length that is passed.
        answer("fmi2GetReal", unsafe {
            (self.get_real)(
                self.handle,
                references.as_ptr(),
                references.len().min(values.len()),
                values.as_mut_ptr(),
            )
        })
    }

    fn boolean(&mut self, reference: u32) -> Result<bool, Failed> {
        let mut value = 0;
        // SAFETY: one reference, one place for its value.
        answer("fmi2GetBoolean", unsafe {
            (self.get_boolean)(self.handle, &reference, 1, &mut value)
        })?;
        Ok(value != 0)
    }

    fn initialise(&mut self, start: f64, stop: f64, tolerance: Option<f64>) -> Result<(), Failed> {
        let (stated, tolerance) = (c_int::from(tolerance.is_some()), tolerance.unwrap_or(0.0));
        // SAFETY: the instance is live.
        unsafe {
            answer(
                "fmi2SetupExperiment",
                (self.set_up)(self.handle, stated, tolerance, start, 1, stop),
            )?;
            answer(
                "fmi2EnterInitializationMode",
                (self.enter_initialisation)(self.handle),
            )?;
            answer(
                "fmi2ExitInitializationMode",
                (self.exit_initialisation)(self.handle),
            )?;
        }
        self.running = true;
        Ok(())
    }

    fn reset(&mut self) -> Result<(), Failed> {
        // SAFETY: the instance is live.
        answer("fmi2Reset", unsafe { (self.reset)(self.handle) })?;
        self.running = false;
        Ok(())
    }

    fn step(&mut self, from: f64, length: f64) -> Result<(), Failed> {
        // SAFETY: the instance is live. 1 = no state before this point is set again.
        answer("fmi2DoStep", unsafe {
            (self.do_step)(self.handle, from, length, 1)
        })
    }
}

impl Drop for Fmi2 {
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

/// Whether a call may be built upon: `OK` and `Warning` may.
pub(super) fn answer(function: &'static str, status: i32) -> Result<(), Failed> {
    if (0..=1).contains(&status) {
        Ok(())
    } else {
        Err(Failed { function, status })
    }
}

/// A function of the library.
///
/// # Safety
/// `T` must be the function's type.
pub(super) unsafe fn symbol<T: Copy>(library: &Library, name: &str) -> Result<T, String> {
    // SAFETY: the caller's promise.
    unsafe { library.get::<T>(name) }
        .map(|symbol| *symbol)
        .map_err(|_| format!("it does not export {name}"))
}

/// A text for C.
pub(super) fn c_text(text: &str) -> Result<CString, String> {
    CString::new(text).map_err(|_| format!("`{text}` contains a null"))
}

/// The address of a directory as a URI.
fn file_address(directory: &Path) -> String {
    let mut address = String::from("file://");
    let path = directory.to_string_lossy().replace('\\', "/");
    if !path.starts_with('/') {
        address.push('/');
    }
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"/-_.~:".contains(&byte) {
            address.push(char::from(byte));
        } else {
            address.push_str(&format!("%{byte:02X}"));
        }
    }
    address
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_escaped() {
        assert_eq!(
            file_address(Path::new("/tmp/a b/ü")),
            "file:///tmp/a%20b/%C3%BC"
        );
    }
}
