//! A minimal importer of both FMI versions, on the exported functions.
#![allow(dead_code, reason = "every test file uses its own part")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use std::ffi::{CString, c_void};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};
use std::{fs, ptr};
use stickslip::cosim::{VariableTable, open};
use stickslip::ffi::{Status, fmi2, fmi3};

pub const REDUCED_RIG: &str = include_str!("../../modelDescription/reduced-rig.toml");
pub const FULL_RIG: &str = include_str!("../../modelDescription/full-rig.toml");

/// Either version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    Fmi2,
    Fmi3,
}
pub use Version::{Fmi2, Fmi3};

/// A component in a folder of its own, and what its XML would say.
pub struct Component {
    folder: PathBuf,
    token: CString,
    table: VariableTable,
}

impl Component {
    pub fn new(model_toml: &str) -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let folder =
            std::env::temp_dir().join(format!("stickslip-{}-{number}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("model.toml"), model_toml).unwrap();
        let model = open(model_toml, "model.toml").unwrap();
        let token = CString::new(model.token().to_string()).unwrap();
        Self {
            folder,
            token,
            table: (**model.table()).clone(),
        }
    }

    pub fn instantiate(&self, version: Version) -> Instance<'_> {
        self.instantiate_with(version, false, false)
    }

    pub fn instantiate_with(&self, version: Version, events: bool, early: bool) -> Instance<'_> {
        let folder = self.folder.to_str().unwrap();
        let (name, token) = (c"rig".as_ptr(), self.token.as_ptr());
        // SAFETY: all pointers are valid for the call.
        let handle = unsafe {
            match version {
                Fmi2 => {
                    let functions = fmi2::CallbackFunctions {
                        logger: None,
                        allocate_memory: None,
                        free_memory: None,
                        step_finished: None,
                        component_environment: ptr::null_mut(),
                    };
                    let uri = CString::new(format!("file://{folder}")).unwrap();
                    fmi2::fmi2Instantiate(name, 1, token, uri.as_ptr(), &functions, 0, 0)
                }
                Fmi3 => {
                    let folder = CString::new(folder).unwrap();
                    fmi3::fmi3InstantiateCoSimulation(
                        name,
                        token,
                        folder.as_ptr(),
                        0,
                        0,
                        events.into(),
                        early.into(),
                        ptr::null(),
                        0,
                        ptr::null_mut(),
                        None,
                        None,
                    )
                }
            }
        };
        assert!(!handle.is_null());
        Instance {
            component: self,
            version,
            handle,
            time: 0.0,
        }
    }

    /// An instance at t = 0 with these values set before its initialisation ended.
    pub fn start(&self, version: Version, values: &[(&str, f64)]) -> Instance<'_> {
        let mut instance = self.instantiate(version);
        instance.initialize(0.0, values);
        instance
    }
}

impl Drop for Component {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// A live instance.
pub struct Instance<'a> {
    component: &'a Component,
    version: Version,
    pub handle: *mut c_void,
    pub time: f64,
}

/// What a step of FMI 3 says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepResult {
    pub status: Status,
    pub event: bool,
    pub early: bool,
}

impl Instance<'_> {
    pub fn initialize(&mut self, time: f64, values: &[(&str, f64)]) {
        self.time = time;
        // SAFETY: no pointers but the handle.
        unsafe {
            let c = self.handle;
            match self.version {
                Fmi2 => {
                    assert_eq!(
                        fmi2::fmi2SetupExperiment(c, 0, 0.0, time, 0, 0.0),
                        Status::Ok
                    );
                    assert_eq!(fmi2::fmi2EnterInitializationMode(c), Status::Ok);
                }
                Fmi3 => assert_eq!(
                    fmi3::fmi3EnterInitializationMode(c, 0, 0.0, time, 0, 0.0),
                    Status::Ok
                ),
            }
            for (name, value) in values {
                self.set(name, *value);
            }
            let status = match self.version {
                Fmi2 => fmi2::fmi2ExitInitializationMode(c),
                Fmi3 => fmi3::fmi3ExitInitializationMode(c),
            };
            assert_eq!(status, Status::Ok);
        }
    }

    pub fn reference(&self, name: &str) -> u32 {
        self.component
            .table
            .find(name)
            .unwrap_or_else(|| panic!("no variable {name}"))
            .value_reference
    }

    pub fn try_set(&self, name: &str, value: f64) -> Status {
        let reference = self.reference(name);
        // SAFETY: one variable, one value.
        unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2SetReal(self.handle, &reference, 1, &value),
                Fmi3 => fmi3::fmi3SetFloat64(self.handle, &reference, 1, &value, 1),
            }
        }
    }

    #[track_caller]
    pub fn set(&self, name: &str, value: f64) {
        assert_eq!(self.try_set(name, value), Status::Ok, "{name} = {value}");
    }

    #[track_caller]
    pub fn get(&self, name: &str) -> f64 {
        let reference = self.reference(name);
        let mut value = f64::NAN;
        // SAFETY: one variable, one value.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2GetReal(self.handle, &reference, 1, &mut value),
                Fmi3 => fmi3::fmi3GetFloat64(self.handle, &reference, 1, &mut value, 1),
            }
        };
        assert_eq!(status, Status::Ok, "{name}");
        value
    }

    #[track_caller]
    pub fn is(&self, name: &str) -> bool {
        let reference = self.reference(name);
        let (mut byte, mut integer) = (9_u8, 9);
        // SAFETY: one variable, one value.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2GetBoolean(self.handle, &reference, 1, &mut integer),
                Fmi3 => fmi3::fmi3GetBoolean(self.handle, &reference, 1, &mut byte, 1),
            }
        };
        assert_eq!(status, Status::Ok, "{name}");
        byte == 1 || integer == 1
    }

    /// One step of `size` seconds from where the last one ended.
    pub fn try_step(&mut self, size: f64) -> StepResult {
        let (mut event, mut terminate, mut early, mut reached) = (0, 0, 0, self.time + size);
        // SAFETY: places of the results.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2DoStep(self.handle, self.time, size, 1),
                Fmi3 => fmi3::fmi3DoStep(
                    self.handle,
                    self.time,
                    size,
                    1,
                    &mut event,
                    &mut terminate,
                    &mut early,
                    &mut reached,
                ),
            }
        };
        if status == Status::Ok {
            self.time = reached;
        }
        StepResult {
            status,
            event: event == 1,
            early: early == 1,
        }
    }

    #[track_caller]
    pub fn step(&mut self, size: f64) {
        assert_eq!(self.try_step(size).status, Status::Ok);
    }

    /// Steps of `size` up to `end`; the last one is as long as it must be.
    #[track_caller]
    pub fn run(&mut self, size: f64, end: f64) {
        let begin = self.time;
        let mut count = 0.0;
        while self.time < end {
            count += 1.0;
            let next = (begin + count * size).min(end);
            self.step(next - self.time);
        }
    }

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

    pub fn restore(&mut self, state: *mut c_void) {
        // SAFETY: a handle of this library.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2SetFMUstate(self.handle, state),
                Fmi3 => fmi3::fmi3SetFMUState(self.handle, state),
            }
        };
        assert_eq!(status, Status::Ok);
        self.time = self.get("time");
    }

    pub fn serialize(&self, state: *mut c_void) -> Vec<u8> {
        let mut size = 0;
        // SAFETY: a handle of this library and places of the results.
        unsafe {
            match self.version {
                Fmi2 => {
                    let c = self.handle;
                    assert_eq!(
                        fmi2::fmi2SerializedFMUstateSize(c, state, &mut size),
                        Status::Ok
                    );
                    let mut bytes = vec![0; size];
                    let status = fmi2::fmi2SerializeFMUstate(c, state, bytes.as_mut_ptr(), size);
                    assert_eq!(status, Status::Ok);
                    bytes
                }
                Fmi3 => {
                    let c = self.handle;
                    assert_eq!(
                        fmi3::fmi3SerializedFMUStateSize(c, state, &mut size),
                        Status::Ok
                    );
                    let mut bytes = vec![0; size];
                    let status = fmi3::fmi3SerializeFMUState(c, state, bytes.as_mut_ptr(), size);
                    assert_eq!(status, Status::Ok);
                    bytes
                }
            }
        }
    }

    pub fn deserialize(&self, bytes: &[u8]) -> *mut c_void {
        let mut state = ptr::null_mut();
        // SAFETY: an array and the place of a handle.
        let status = unsafe {
            let c = self.handle;
            match self.version {
                Fmi2 => fmi2::fmi2DeSerializeFMUstate(c, bytes.as_ptr(), bytes.len(), &mut state),
                Fmi3 => fmi3::fmi3DeserializeFMUState(c, bytes.as_ptr(), bytes.len(), &mut state),
            }
        };
        assert_eq!(status, Status::Ok);
        state
    }

    /// Derivative of `unknown` in the direction of `known`.
    pub fn derivative(&self, unknown: &str, known: &str) -> f64 {
        let (unknown, known) = (self.reference(unknown), self.reference(known));
        let mut sensitivity = f64::NAN;
        let c = self.handle;
        // SAFETY: one unknown, one known.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2GetDirectionalDerivative(
                    c,
                    &unknown,
                    1,
                    &known,
                    1,
                    &1.0,
                    &mut sensitivity,
                ),
                Fmi3 => fmi3::fmi3GetDirectionalDerivative(
                    c,
                    &unknown,
                    1,
                    &known,
                    1,
                    &1.0,
                    1,
                    &mut sensitivity,
                    1,
                ),
            }
        };
        assert_eq!(status, Status::Ok);
        sensitivity
    }
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        match self.version {
            Fmi2 => fmi2::fmi2FreeInstance(self.handle),
            Fmi3 => fmi3::fmi3FreeInstance(self.handle),
        }
    }
}
