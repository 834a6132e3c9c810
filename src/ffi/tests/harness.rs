//! An importer in a few lines: a resource folder, a log, and calls with slices instead of pointers.

use crate::cosim::Token;
use crate::cosim::test_model::{MODEL_TOML, open, table};
use crate::ffi::fmi2::{self, CallbackFunctions};
use crate::ffi::{Fmi2Logger, Status, fmi3};
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};
use std::{fs, mem, ptr};

pub(super) const NULL: *mut c_void = ptr::null_mut();

/// A folder with a `model.toml`, removed when dropped.
pub(super) struct Resources(pub(super) PathBuf);

impl Resources {
    pub(super) fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("stickslip ffi {} {number}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("model.toml"), MODEL_TOML).unwrap();
        Self(folder)
    }

    pub(super) fn uri(&self) -> CString {
        let path = self.0.to_str().unwrap().replace(' ', "%20");
        CString::new(format!("file://{path}")).unwrap()
    }
}

impl Drop for Resources {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

pub(super) fn token() -> CString {
    CString::new(Token::new(&table(), MODEL_TOML).to_string()).unwrap()
}

/// What arrived in the log: status, category, message.
#[derive(Default)]
pub(super) struct Messages(pub(super) Vec<(c_int, String, String)>);

impl Messages {
    pub(super) fn take(&mut self) -> Vec<(c_int, String, String)> {
        mem::take(&mut self.0)
    }

    /// The only message since the last look.
    #[track_caller]
    pub(super) fn only(&mut self) -> String {
        let messages = self.take();
        assert_eq!(messages.len(), 1, "{messages:?}");
        messages[0].2.clone()
    }
}

unsafe fn note(env: *mut c_void, status: c_int, category: *const c_char, message: *const c_char) {
    // SAFETY: the environment is the harness's own list, and the strings are the library's.
    unsafe {
        let text = |pointer| CStr::from_ptr(pointer).to_str().unwrap().to_owned();
        (*env.cast::<Messages>())
            .0
            .push((status, text(category), text(message)));
    }
}

pub(super) unsafe extern "C" fn logger3(
    env: *mut c_void,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: as for `note`.
    unsafe { note(env, status, category, message) };
}

unsafe extern "C" fn plain_logger2(
    env: *mut c_void,
    name: *const c_char,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: as for `note`.
    unsafe {
        assert_eq!(CStr::from_ptr(name), c"test");
        note(env, status, category, message);
    }
}

/// A logger of FMI 2. Importers in languages without variadic functions do the same.
pub(super) fn logger2() -> Fmi2Logger {
    // SAFETY: without variable arguments both kinds are called alike on the platforms of the tests.
    unsafe {
        mem::transmute::<
            unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char),
            Fmi2Logger,
        >(plain_logger2)
    }
}

/// An instance of FMI 2 with its log.
pub(super) struct Fmi2 {
    pub(super) handle: *mut c_void,
    pub(super) log: Box<Messages>,
    _resources: Resources,
}

impl Fmi2 {
    pub(super) fn new() -> Self {
        let resources = Resources::new();
        let mut log = Box::<Messages>::default();
        let functions = CallbackFunctions {
            logger: Some(logger2()),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            component_environment: (&raw mut *log).cast(),
        };
        let (token, uri) = (token(), resources.uri());
        let name = c"test".as_ptr();
        // SAFETY: all pointers are valid for the call.
        let handle = unsafe {
            let texts = [name, token.as_ptr(), uri.as_ptr()];
            fmi2::new_instance(open, 1, texts, &functions, 0)
        };
        assert!(!handle.is_null(), "{:?}", log.0);
        Self {
            handle,
            log,
            _resources: resources,
        }
    }

    /// An instance that is ready to step.
    pub(super) fn running() -> Self {
        let instance = Self::new();
        // SAFETY: no pointers but the handle.
        unsafe {
            let c = instance.handle;
            assert_eq!(
                fmi2::fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0),
                Status::Ok
            );
            assert_eq!(fmi2::fmi2EnterInitializationMode(c), Status::Ok);
            assert_eq!(fmi2::fmi2ExitInitializationMode(c), Status::Ok);
        }
        instance
    }

    pub(super) fn set(&self, reference: u32, value: f64) -> Status {
        // SAFETY: one variable, one value.
        unsafe { fmi2::fmi2SetReal(self.handle, &reference, 1, &value) }
    }

    #[track_caller]
    pub(super) fn get(&self, reference: u32) -> f64 {
        let mut value = f64::NAN;
        // SAFETY: one variable, one value.
        let status = unsafe { fmi2::fmi2GetReal(self.handle, &reference, 1, &mut value) };
        assert_eq!(status, Status::Ok);
        value
    }

    pub(super) fn step(&self, point: f64, size: f64) -> Status {
        // SAFETY: no pointers but the handle.
        unsafe { fmi2::fmi2DoStep(self.handle, point, size, 1) }
    }

    pub(super) fn save(&self) -> *mut c_void {
        let mut state = NULL;
        // SAFETY: the place of a handle.
        let status = unsafe { fmi2::fmi2GetFMUstate(self.handle, &mut state) };
        assert_eq!(status, Status::Ok);
        state
    }
}

impl Drop for Fmi2 {
    fn drop(&mut self) {
        fmi2::fmi2FreeInstance(self.handle);
    }
}

/// What a step of FMI 3 returned.
#[derive(Debug, PartialEq)]
pub(super) struct Step3 {
    pub(super) status: Status,
    pub(super) event: bool,
    pub(super) early: bool,
    pub(super) time: f64,
}

/// An instance of FMI 3 with its log.
pub(super) struct Fmi3 {
    pub(super) handle: *mut c_void,
    pub(super) log: Box<Messages>,
    _resources: Resources,
}

impl Fmi3 {
    pub(super) fn new(event_mode: bool, early_return: bool, logging: bool) -> Self {
        let resources = Resources::new();
        let mut log = Box::<Messages>::default();
        let folder = CString::new(resources.0.to_str().unwrap()).unwrap();
        let token = token();
        // SAFETY: all pointers are valid for the call.
        let handle = unsafe {
            fmi3::new_instance(
                "fmi3InstantiateCoSimulation",
                open,
                [c"test".as_ptr(), token.as_ptr(), folder.as_ptr()],
                logging.into(),
                (&raw mut *log).cast(),
                Some(logger3),
                |instance| {
                    instance.event_mode_used = event_mode;
                    instance.early_return_allowed = early_return;
                    Ok(())
                },
            )
        };
        assert!(!handle.is_null(), "{:?}", log.0);
        Self {
            handle,
            log,
            _resources: resources,
        }
    }

    /// An instance that has left its initialisation.
    pub(super) fn running(event_mode: bool, early_return: bool) -> Self {
        let instance = Self::new(event_mode, early_return, true);
        // SAFETY: no pointers but the handle.
        unsafe {
            let c = instance.handle;
            assert_eq!(
                fmi3::fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0),
                Status::Ok
            );
            assert_eq!(fmi3::fmi3ExitInitializationMode(c), Status::Ok);
        }
        instance
    }

    pub(super) fn set(&self, reference: u32, value: f64) -> Status {
        // SAFETY: one variable, one value.
        unsafe { fmi3::fmi3SetFloat64(self.handle, &reference, 1, &value, 1) }
    }

    #[track_caller]
    pub(super) fn get(&self, reference: u32) -> f64 {
        let mut value = f64::NAN;
        // SAFETY: one variable, one value.
        let status = unsafe { fmi3::fmi3GetFloat64(self.handle, &reference, 1, &mut value, 1) };
        assert_eq!(status, Status::Ok);
        value
    }

    pub(super) fn step(&self, point: f64, size: f64) -> Step3 {
        let (mut event, mut terminate, mut early, mut time) = (9, 9, 9, f64::NAN);
        // SAFETY: places of the four results.
        let status = unsafe {
            fmi3::fmi3DoStep(
                self.handle,
                point,
                size,
                1,
                &mut event,
                &mut terminate,
                &mut early,
                &mut time,
            )
        };
        Step3 {
            status,
            event: event == 1,
            early: early == 1,
            time,
        }
    }

    /// Event mode without anything to do.
    pub(super) fn pass_event_mode(&self) {
        let mut flags = [9_u8; 5];
        let mut next = 0.0;
        let [need, terminate, nominals, values, defined] = &mut flags;
        // SAFETY: places of the six results.
        unsafe {
            assert_eq!(
                fmi3::fmi3UpdateDiscreteStates(
                    self.handle,
                    need,
                    terminate,
                    nominals,
                    values,
                    defined,
                    &mut next
                ),
                Status::Ok
            );
            assert_eq!(flags, [0; 5]);
            assert_eq!(fmi3::fmi3EnterStepMode(self.handle), Status::Ok);
        }
    }
}

impl Drop for Fmi3 {
    fn drop(&mut self) {
        fmi3::fmi3FreeInstance(self.handle);
    }
}
