//! The original: its library, loaded, and the functions of it that a step needs, the same for both standards.

use std::ffi::{c_char, c_int, c_uint, c_void};
use std::path::{Path, PathBuf};

use libloading::Library;
use thiserror::Error;

/// Handles of instances and of saved states.
pub type Handle = *mut c_void;
/// Texts of C.
pub type Text = *const c_char;

/// `OK` of both standards.
pub const OK: c_int = 0;
/// `Warning` of both standards: the result can be used.
pub const WARNING: c_int = 1;
/// `Error` of both standards.
pub const ERROR: c_int = 3;

/// Whether a call can be built upon.
pub fn is_good(status: c_int) -> bool {
    status == OK || status == WARNING
}

/// Why there is no original.
#[derive(Debug, Error)]
pub enum OriginalError {
    /// FMI has no folder for this machine.
    #[error("FMUs are not known to run on {0}")]
    System(&'static str),
    /// Its library cannot be loaded.
    #[error("the original's library {} cannot be loaded: {source}", path.display())]
    Load {
        /// The library.
        path: PathBuf,
        /// The loader's reason.
        source: libloading::Error,
    },
    /// It lacks a function.
    #[error("the original's library lacks {0}")]
    Function(String),
    /// It gives no instance.
    #[error("the original gave no instance; its own messages say why")]
    NoInstance,
}

/// How far the original went.
#[derive(Clone, Copy, Debug)]
pub struct Stepped {
    /// Status of the step.
    pub status: c_int,
    /// Time that it reached [s].
    pub time: f64,
    /// Whether it wants the simulation to end.
    pub ends: bool,
}

type OnState = unsafe extern "C" fn(Handle, *mut Handle) -> c_int;
type SetState = unsafe extern "C" fn(Handle, Handle) -> c_int;

/// Functions whose arguments differ between the standards.
#[derive(Clone, Copy)]
pub enum Own {
    /// FMI 2: set, get, step, free.
    Two(
        unsafe extern "C" fn(Handle, *const c_uint, usize, *const f64) -> c_int,
        unsafe extern "C" fn(Handle, *const c_uint, usize, *mut f64) -> c_int,
        unsafe extern "C" fn(Handle, f64, f64, c_int) -> c_int,
    ),
    /// FMI 3.
    Three(
        unsafe extern "C" fn(Handle, *const c_uint, usize, *const f64, usize) -> c_int,
        unsafe extern "C" fn(Handle, *const c_uint, usize, *mut f64, usize) -> c_int,
        unsafe extern "C" fn(Handle, f64, f64, u8, *mut u8, *mut u8, *mut u8, *mut f64) -> c_int,
    ),
}

/// Functions that save and restore a state.
#[derive(Clone, Copy)]
pub struct States {
    get: OnState,
    set: SetState,
    free: OnState,
}

/// An instance of the original.
pub struct Original {
    /// Its instance.
    pub handle: Handle,
    own: Own,
    states: Option<States>,
    free: unsafe extern "C" fn(Handle),
    prefix: &'static str,
    // Last: the instance ends before its library.
    library: Library,
}

// SAFETY: both standards let an importer move an instance between threads as long as calls do not overlap.
unsafe impl Send for Original {}

impl Original {
    /// Loads the library of the original in `folder` for this machine.
    ///
    /// # Errors
    /// [`OriginalError`].
    pub fn load(folder: &Path, identifier: &str, is_three: bool) -> Result<Library, OriginalError> {
        let (two, three) = match std::env::consts::OS {
            "linux" => ("linux", "linux"),
            "macos" => ("darwin", "darwin"),
            "windows" => ("win", "windows"),
            other => return Err(OriginalError::System(other)),
        };
        let platform = if is_three {
            format!("{}-{three}", std::env::consts::ARCH)
        } else {
            format!("{two}{}", usize::BITS)
        };
        let file = format!("{identifier}.{}", std::env::consts::DLL_EXTENSION);
        let path = folder.join("binaries").join(platform).join(file);
        // SAFETY: whoever made this FMU put the library inside to be run.
        unsafe { Library::new(&path) }.map_err(|source| OriginalError::Load { path, source })
    }

    /// Takes over the instance `handle` of `library`.
    ///
    /// # Errors
    /// A function that is needed is not there.
    ///
    /// # Safety
    /// `handle` is a live instance for co-simulation that `library` made through the standard that `is_three` names.
    pub unsafe fn new(
        library: Library,
        handle: Handle,
        is_three: bool,
        can_restore: bool,
    ) -> Result<Self, OriginalError> {
        // SAFETY: the names and types are those of the standards' headers.
        unsafe {
            let (prefix, own, states) = if is_three {
                let own = Own::Three(
                    symbol(&library, "fmi3SetFloat64")?,
                    symbol(&library, "fmi3GetFloat64")?,
                    symbol(&library, "fmi3DoStep")?,
                );
                ("fmi3", own, ["GetFMUState", "SetFMUState", "FreeFMUState"])
            } else {
                let own = Own::Two(
                    symbol(&library, "fmi2SetReal")?,
                    symbol(&library, "fmi2GetReal")?,
                    symbol(&library, "fmi2DoStep")?,
                );
                ("fmi2", own, ["GetFMUstate", "SetFMUstate", "FreeFMUstate"])
            };
            let [get, set, free] = states.map(|name| format!("{prefix}{name}"));
            let states = if can_restore {
                Some(States {
                    get: symbol(&library, &get)?,
                    set: symbol(&library, &set)?,
                    free: symbol(&library, &free)?,
                })
            } else {
                None
            };
            Ok(Self {
                handle,
                own,
                states,
                free: symbol(&library, &format!("{prefix}FreeInstance"))?,
                prefix,
                library,
            })
        }
    }

    /// A function of the original by its name without the standard's prefix.
    ///
    /// # Errors
    /// It is not there.
    ///
    /// # Safety
    /// `T` is the function's type.
    pub unsafe fn function<T: Copy>(&self, name: &str) -> Result<T, OriginalError> {
        debug_assert!(name.starts_with(self.prefix));
        // SAFETY: the caller's promise.
        unsafe { symbol(&self.library, name) }
    }

    /// Sets reals.
    pub fn set(&self, references: &[u32], values: &[f64]) -> c_int {
        let count = references.len().min(values.len());
        // SAFETY: the instance is live and both arrays have the length that is passed.
        unsafe {
            match self.own {
                Own::Two(set, ..) => set(self.handle, references.as_ptr(), count, values.as_ptr()),
                Own::Three(set, ..) => set(
                    self.handle,
                    references.as_ptr(),
                    count,
                    values.as_ptr(),
                    count,
                ),
            }
        }
    }

    /// Reads one real.
    pub fn get(&self, reference: u32) -> Result<f64, c_int> {
        let mut value = f64::NAN;
        // SAFETY: the instance is live; one reference and one place for its value.
        let status = unsafe {
            match self.own {
                Own::Two(_, get, _) => get(self.handle, &raw const reference, 1, &raw mut value),
                Own::Three(_, get, _) => {
                    get(self.handle, &raw const reference, 1, &raw mut value, 1)
                }
            }
        };
        if is_good(status) {
            Ok(value)
        } else {
            Err(status)
        }
    }

    /// Steps from `from` over `length`, both in seconds.
    pub fn step(&self, from: f64, length: f64, may_go_back: bool) -> Stepped {
        let (mut event, mut ends, mut early, mut time) = (0, 0, 0, from + length);
        // SAFETY: the instance is live; the places outlive the call.
        let status = unsafe {
            match self.own {
                Own::Two(_, _, step) => step(self.handle, from, length, c_int::from(!may_go_back)),
                Own::Three(_, _, step) => step(
                    self.handle,
                    from,
                    length,
                    u8::from(!may_go_back),
                    &raw mut event,
                    &raw mut ends,
                    &raw mut early,
                    &raw mut time,
                ),
            }
        };
        Stepped {
            status,
            time: if early == 0 { from + length } else { time },
            ends: ends != 0,
        }
    }

    /// Saves the state into `state`, which holds an earlier one or NULL; `None` where the original cannot.
    pub fn save(&self, state: &mut Handle) -> Option<c_int> {
        let states = self.states?;
        // SAFETY: the instance is live, and the state is NULL or one of its own.
        Some(unsafe { (states.get)(self.handle, state) })
    }

    /// Goes back to a saved state.
    pub fn restore(&self, state: Handle) -> c_int {
        self.states.map_or(ERROR, |states| {
            // SAFETY: the state is one of this instance.
            unsafe { (states.set)(self.handle, state) }
        })
    }

    /// Ends a saved state.
    pub fn forget(&self, state: &mut Handle) {
        if let Some(states) = self.states
            && !state.is_null()
        {
            // SAFETY: the state is one of this instance and is not used again.
            unsafe { (states.free)(self.handle, state) };
            *state = std::ptr::null_mut();
        }
    }
}

impl Drop for Original {
    fn drop(&mut self) {
        // SAFETY: the instance is live and is not used again.
        unsafe { (self.free)(self.handle) }
    }
}

/// A function of a library.
///
/// # Errors
/// It is not there.
///
/// # Safety
/// `T` is the function's type.
pub unsafe fn symbol<T: Copy>(library: &Library, name: &str) -> Result<T, OriginalError> {
    // SAFETY: the caller's promise.
    unsafe { library.get::<T>(name) }
        .map(|symbol| *symbol)
        .map_err(|_| OriginalError::Function(name.to_owned()))
}
