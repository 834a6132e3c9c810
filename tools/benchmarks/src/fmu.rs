//! The built library through its C ABI, FMI 2 and FMI 3: only what a co-simulation needs.

use std::ffi::{CString, c_char, c_double, c_int, c_void};
use std::path::Path;
use std::ptr;

use anyhow::{Context, Result, bail, ensure};
use libloading::Library;
use stickslip::cosim::{self, MODEL_FILE};

use crate::files;

type Handle = *mut c_void;
type Text = *const c_char;
type Status = c_int;
type Logger2 = unsafe extern "C" fn(*mut c_void, Text, Status, Text, Text, ...);
type Logger3 = unsafe extern "C" fn(*mut c_void, Status, Text, Text);

/// `fmi2CallbackFunctions`.
#[repr(C)]
struct Callbacks2 {
    logger: Option<Logger2>,
    allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    step_finished: Option<unsafe extern "C" fn(*mut c_void, Status)>,
    component_environment: *mut c_void,
}

type Instantiate2 =
    unsafe extern "C" fn(Text, c_int, Text, Text, *const Callbacks2, c_int, c_int) -> Handle;
type Instantiate3 = unsafe extern "C" fn(
    Text,
    Text,
    Text,
    bool,
    bool,
    bool,
    bool,
    *const u32,
    usize,
    *mut c_void,
    Option<Logger3>,
    Option<unsafe extern "C" fn()>,
) -> Handle;
type Setup2 = unsafe extern "C" fn(Handle, c_int, c_double, c_double, c_int, c_double) -> Status;
type EnterInitialization3 =
    unsafe extern "C" fn(Handle, bool, c_double, c_double, bool, c_double) -> Status;
type Plain = unsafe extern "C" fn(Handle) -> Status;
type Free = unsafe extern "C" fn(Handle);

/// The functions that a step calls, per version of the standard.
#[derive(Clone, Copy)]
enum Calls {
    Fmi2 {
        do_step: unsafe extern "C" fn(Handle, c_double, c_double, c_int) -> Status,
        get: unsafe extern "C" fn(Handle, *const u32, usize, *mut c_double) -> Status,
        set: unsafe extern "C" fn(Handle, *const u32, usize, *const c_double) -> Status,
    },
    Fmi3 {
        do_step: unsafe extern "C" fn(
            Handle,
            c_double,
            c_double,
            bool,
            *mut bool,
            *mut bool,
            *mut bool,
            *mut c_double,
        ) -> Status,
        get: unsafe extern "C" fn(Handle, *const u32, usize, *mut c_double, usize) -> Status,
        set: unsafe extern "C" fn(Handle, *const u32, usize, *const c_double, usize) -> Status,
    },
}

/// Version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0.
    Fmi2,
    /// FMI 3.0.
    Fmi3,
}

/// One instance, ready to step.
pub struct Instance<'a> {
    handle: Handle,
    calls: Calls,
    free: Free,
    _library: &'a Library,
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle is live and freed once.
        unsafe { (self.free)(self.handle) }
    }
}

fn function<T: Copy>(library: &Library, name: &str) -> Result<T> {
    // SAFETY: the types above are those of the standard's headers.
    let symbol = unsafe { library.get::<T>(name.as_bytes()) };
    symbol
        .map(|symbol| *symbol)
        .with_context(|| format!("the library exports no {name}"))
}

fn ok(status: Status, what: &str) -> Result<()> {
    ensure!(status == 0, "{what} returned status {status}");
    Ok(())
}

/// Opens the library.
///
/// # Errors
/// When it is not there or cannot be loaded.
pub fn load(path: &Path) -> Result<Library> {
    // SAFETY: it is this workspace's own library; loading it runs no code of consequence.
    unsafe { Library::new(path) }.with_context(|| {
        format!(
            "loading {}: build it with `cargo build --release`",
            path.display()
        )
    })
}

/// A fresh instance of the model, initialised at t = 0 with `inputs` (names and values).
///
/// # Errors
/// When the model or a call is refused.
pub fn instantiate<'a>(
    library: &'a Library,
    version: Version,
    model_toml: &str,
    inputs: &[(&str, f64)],
) -> Result<Instance<'a>> {
    let resources = files::build_folder()?.join("resources");
    files::write_atomically(&resources.join(MODEL_FILE), model_toml)?;
    let token = CString::new(cosim::open(model_toml, MODEL_FILE)?.token().to_string())?;
    let folder = resources
        .to_str()
        .context("the build folder's path is not Unicode")?;
    let instance = match version {
        Version::Fmi2 => fmi2(library, &token, &CString::new(format!("file://{folder}"))?)?,
        Version::Fmi3 => fmi3(library, &token, &CString::new(folder)?)?,
    };
    let references = value_references(model_toml, &inputs.iter().map(|i| i.0).collect::<Vec<_>>())?;
    let values: Vec<f64> = inputs.iter().map(|i| i.1).collect();
    ok(instance.set(&references, &values), "setting the inputs")?;
    let exit = match version {
        Version::Fmi2 => "fmi2ExitInitializationMode",
        Version::Fmi3 => "fmi3ExitInitializationMode",
    };
    // SAFETY: the handle is live.
    ok(
        unsafe { function::<Plain>(library, exit)?(instance.handle) },
        exit,
    )?;
    Ok(instance)
}

fn fmi2<'a>(library: &'a Library, token: &CString, resources: &CString) -> Result<Instance<'a>> {
    let callbacks = Callbacks2 {
        logger: None,
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: ptr::null_mut(),
    };
    let new: Instantiate2 = function(library, "fmi2Instantiate")?;
    // SAFETY: all texts and the callbacks outlive the call, which copies them.
    let handle = unsafe {
        new(
            c"benchmark".as_ptr(),
            1,
            token.as_ptr(),
            resources.as_ptr(),
            &raw const callbacks,
            0,
            0,
        )
    };
    if handle.is_null() {
        bail!("fmi2Instantiate returned NULL");
    }
    let instance = Instance {
        handle,
        calls: Calls::Fmi2 {
            do_step: function(library, "fmi2DoStep")?,
            get: function(library, "fmi2GetReal")?,
            set: function(library, "fmi2SetReal")?,
        },
        free: function(library, "fmi2FreeInstance")?,
        _library: library,
    };
    // SAFETY: the handle is live.
    ok(
        unsafe { function::<Setup2>(library, "fmi2SetupExperiment")?(handle, 0, 0.0, 0.0, 0, 0.0) },
        "fmi2SetupExperiment",
    )?;
    // SAFETY: the handle is live.
    ok(
        unsafe { function::<Plain>(library, "fmi2EnterInitializationMode")?(handle) },
        "fmi2EnterInitializationMode",
    )?;
    Ok(instance)
}

fn fmi3<'a>(library: &'a Library, token: &CString, resources: &CString) -> Result<Instance<'a>> {
    let new: Instantiate3 = function(library, "fmi3InstantiateCoSimulation")?;
    // SAFETY: all texts outlive the call, which copies them.
    let handle = unsafe {
        new(
            c"benchmark".as_ptr(),
            token.as_ptr(),
            resources.as_ptr(),
            false,
            false,
            false,
            false,
            ptr::null(),
            0,
            ptr::null_mut(),
            None,
            None,
        )
    };
    if handle.is_null() {
        bail!("fmi3InstantiateCoSimulation returned NULL");
    }
    let instance = Instance {
        handle,
        calls: Calls::Fmi3 {
            do_step: function(library, "fmi3DoStep")?,
            get: function(library, "fmi3GetFloat64")?,
            set: function(library, "fmi3SetFloat64")?,
        },
        free: function(library, "fmi3FreeInstance")?,
        _library: library,
    };
    let enter: EnterInitialization3 = function(library, "fmi3EnterInitializationMode")?;
    // SAFETY: the handle is live.
    ok(
        unsafe { enter(handle, false, 0.0, 0.0, false, 0.0) },
        "fmi3EnterInitializationMode",
    )?;
    Ok(instance)
}

/// Value references of variables by name.
///
/// # Errors
/// When the model has no such variable.
pub fn value_references(model_toml: &str, names: &[&str]) -> Result<Vec<u32>> {
    let model = cosim::open(model_toml, MODEL_FILE)?;
    let reference = |name: &&str| {
        let variable = model
            .table()
            .find(name)
            .with_context(|| format!("the model has no variable `{name}`"))?;
        Ok(variable.value_reference)
    };
    names.iter().map(reference).collect()
}

impl Instance<'_> {
    /// One communication step; the standard's status.
    #[inline]
    pub fn do_step(&self, point: f64, size: f64) -> Status {
        match self.calls {
            // SAFETY: the handle is live.
            Calls::Fmi2 { do_step, .. } => unsafe { do_step(self.handle, point, size, 1) },
            Calls::Fmi3 { do_step, .. } => {
                let (mut event, mut terminate, mut early, mut last) = (false, false, false, 0.0);
                // SAFETY: the handle is live and the places are writable.
                unsafe {
                    do_step(
                        self.handle,
                        point,
                        size,
                        true,
                        &raw mut event,
                        &raw mut terminate,
                        &raw mut early,
                        &raw mut last,
                    )
                }
            }
        }
    }

    /// Reads variables into `values`, as long as `references`; the standard's status.
    #[inline]
    pub fn get(&self, references: &[u32], values: &mut [f64]) -> Status {
        let count = references.len().min(values.len());
        match self.calls {
            // SAFETY: the handle is live, both arrays have `count` places.
            Calls::Fmi2 { get, .. } => unsafe {
                get(self.handle, references.as_ptr(), count, values.as_mut_ptr())
            },
            Calls::Fmi3 { get, .. } => {
                // SAFETY: as above.
                unsafe {
                    get(
                        self.handle,
                        references.as_ptr(),
                        count,
                        values.as_mut_ptr(),
                        count,
                    )
                }
            }
        }
    }

    /// Sets variables; the standard's status.
    #[inline]
    pub fn set(&self, references: &[u32], values: &[f64]) -> Status {
        let count = references.len().min(values.len());
        match self.calls {
            // SAFETY: the handle is live, both arrays have `count` places.
            Calls::Fmi2 { set, .. } => unsafe {
                set(self.handle, references.as_ptr(), count, values.as_ptr())
            },
            // SAFETY: as above.
            Calls::Fmi3 { set, .. } => unsafe {
                set(
                    self.handle,
                    references.as_ptr(),
                    count,
                    values.as_ptr(),
                    count,
                )
            },
        }
    }
}
