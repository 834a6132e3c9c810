//! A well-behaved importer of one instance of either version.

use std::ffi::c_int;
use std::ptr;

use anyhow::{Result, ensure};

use crate::component::Component;
use crate::library::{Birth, Handle, Library};
use crate::standard::Version;

/// A live instance; freed when dropped.
pub struct Rig<'a> {
    library: &'a Library,
    version: Version,
    handle: Handle,
}

// SAFETY: both standards let an importer move an instance between threads; there is no logger and no environment.
unsafe impl Send for Rig<'_> {}

impl<'a> Rig<'a> {
    /// A new instance, at the end of its initialisation at t = 0 with `values` set.
    ///
    /// # Errors
    /// A call does not return OK.
    pub fn start(
        library: &'a Library,
        component: &Component,
        version: Version,
        values: &[(u32, f64)],
    ) -> Result<Self> {
        let resources = component.resources(version)?;
        let birth = Birth {
            name: c"rig".as_ptr(),
            token: component.token.as_ptr(),
            resources: resources.as_ptr(),
            event_mode: false,
            early_return: false,
            logging: false,
            logger: false,
            environment: ptr::null_mut(),
            wrong_interface: false,
        };
        // SAFETY: all texts are valid for the call, and there is no logger.
        let handle = unsafe { library.instantiate(version, &birth) };
        ensure!(!handle.is_null(), "no instance");
        let rig = Self {
            library,
            version,
            handle,
        };
        // SAFETY: no pointers but the handle.
        unsafe {
            let (two, three) = (&library.fmi2, &library.fmi3);
            match version {
                Version::Two => {
                    ok((two.set_up)(handle, 0, 0.0, 0.0, 0, 0.0))?;
                    ok((two.enter_initialization)(handle))?;
                }
                Version::Three => ok((three.enter_initialization)(handle, 0, 0.0, 0.0, 0, 0.0))?,
            }
            for (reference, value) in values {
                rig.set(*reference, *value)?;
            }
            ok((library.of(version).exit_initialization)(handle))?;
        }
        Ok(rig)
    }

    /// Sets a real variable.
    ///
    /// # Errors
    /// The call does not return OK.
    pub fn set(&self, reference: u32, value: f64) -> Result<()> {
        // SAFETY: one variable, one value.
        ok(unsafe {
            match self.version {
                Version::Two => (self.library.fmi2.set_real)(self.handle, &reference, 1, &value),
                Version::Three => {
                    (self.library.fmi3.set_real)(self.handle, &reference, 1, &value, 1)
                }
            }
        })
    }

    /// Reads real variables.
    ///
    /// # Errors
    /// The call does not return OK.
    pub fn get<const N: usize>(&self, references: &[u32; N]) -> Result<[f64; N]> {
        let mut values = [f64::NAN; N];
        let (r, v) = (references.as_ptr(), values.as_mut_ptr());
        // SAFETY: as many values as variables.
        ok(unsafe {
            match self.version {
                Version::Two => (self.library.fmi2.get_real)(self.handle, r, N, v),
                Version::Three => (self.library.fmi3.get_real)(self.handle, r, N, v, N),
            }
        })?;
        Ok(values)
    }

    /// A communication step from `point` of `size` seconds.
    ///
    /// # Errors
    /// The call does not return OK.
    pub fn step(&self, point: f64, size: f64) -> Result<()> {
        let (mut event, mut terminate, mut early, mut reached) = (0, 0, 0, 0.0);
        // SAFETY: places of the four results.
        ok(unsafe {
            match self.version {
                Version::Two => (self.library.fmi2.step)(self.handle, point, size, 1),
                Version::Three => (self.library.fmi3.step)(
                    self.handle,
                    point,
                    size,
                    1,
                    &mut event,
                    &mut terminate,
                    &mut early,
                    &mut reached,
                ),
            }
        })
    }

    /// Saves a state, keeps or frees it, and goes on.
    ///
    /// # Errors
    /// A call does not return OK.
    pub fn save(&self, free: bool) -> Result<()> {
        let functions = self.library.of(self.version);
        let (status, state) = functions.save(self.handle, ptr::null_mut(), false);
        ok(status)?;
        if free {
            ok(functions.forget(self.handle, state, false).0)?;
        }
        Ok(())
    }
}

impl Drop for Rig<'_> {
    fn drop(&mut self) {
        // SAFETY: a live handle.
        unsafe { (self.library.of(self.version).free)(self.handle) }
    }
}

fn ok(status: c_int) -> Result<()> {
    ensure!(status == 0, "status {status}");
    Ok(())
}
