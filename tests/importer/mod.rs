//! A minimal importer of both FMI versions, on the exported functions.
#![allow(dead_code, reason = "every test file uses its own part")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod derivatives;
pub mod exchange;
mod log;
mod states;

use std::ffi::{CStr, CString, c_void};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};
use std::{fs, ptr};
use stickslip::cosim::{VariableTable, open};
use stickslip::ffi::{Status, fmi2, fmi3};

pub use log::Log;

pub const REDUCED_RIG: &str = include_str!("../../modelDescription/reduced-rig.toml");
pub const FULL_RIG: &str = include_str!("../../modelDescription/full-rig.toml");

/// Either version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    Fmi2,
    Fmi3,
}
pub use Version::{Fmi2, Fmi3};

/// What an importer passes to an instantiation; `None` becomes NULL.
#[derive(Clone)]
pub struct Request {
    pub name: Option<CString>,
    pub token: Option<CString>,
    pub resources: Option<CString>,
    pub logging: bool,
    pub event_mode: bool,
    pub early_return: bool,
    /// Model exchange instead of co-simulation.
    pub exchange: bool,
    /// FMI 3: what is shown switches inside a step.
    pub intermediate_update: Option<fmi3::IntermediateUpdateCallback>,
    /// FMI 3: value references of what it reads.
    pub required: Vec<u32>,
}

impl Request {
    /// The handle, NULL where there is none, and what was logged.
    pub fn send(&self, version: Version) -> (*mut c_void, Box<Log>) {
        let log = Box::<Log>::default();
        let pointer = |text: &Option<CString>| text.as_ref().map_or(ptr::null(), |t| t.as_ptr());
        let (name, token) = (pointer(&self.name), pointer(&self.token));
        let resources = pointer(&self.resources);
        let logging = self.logging;
        // SAFETY: all pointers are NULL or valid for the call, the log for the life of the instance.
        let handle = unsafe {
            match version {
                Fmi2 => {
                    let functions = fmi2::CallbackFunctions {
                        logger: Some(log::logger_2()),
                        allocate_memory: None,
                        free_memory: None,
                        step_finished: None,
                        component_environment: log.environment(),
                    };
                    let kind = if self.exchange {
                        fmi2::MODEL_EXCHANGE
                    } else {
                        fmi2::CO_SIMULATION
                    };
                    fmi2::fmi2Instantiate(
                        name,
                        kind,
                        token,
                        resources,
                        &functions,
                        0,
                        logging.into(),
                    )
                }
                Fmi3 if self.exchange => fmi3::fmi3InstantiateModelExchange(
                    name,
                    token,
                    resources,
                    0,
                    logging.into(),
                    log.environment(),
                    Some(log::logger_3()),
                ),
                Fmi3 => fmi3::fmi3InstantiateCoSimulation(
                    name,
                    token,
                    resources,
                    0,
                    logging.into(),
                    self.event_mode.into(),
                    self.early_return.into(),
                    self.required.as_ptr(),
                    self.required.len(),
                    log.environment(),
                    Some(log::logger_3()),
                    self.intermediate_update,
                ),
            }
        };
        (handle, log)
    }
}

/// A component in a folder of its own, and what its XML would say.
pub struct Component {
    pub folder: PathBuf,
    pub token: CString,
    pub table: VariableTable,
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

    /// What a plain importer passes for this component.
    pub fn request(&self, version: Version) -> Request {
        let folder = self.folder.to_str().unwrap();
        let location = match version {
            Fmi2 => format!("file://{folder}"),
            Fmi3 => folder.to_owned(),
        };
        Request {
            name: Some(c"rig".to_owned()),
            token: Some(self.token.clone()),
            resources: Some(CString::new(location).unwrap()),
            logging: true,
            event_mode: false,
            early_return: false,
            exchange: false,
            intermediate_update: None,
            required: Vec::new(),
        }
    }

    pub fn instantiate(&self, version: Version) -> Instance<'_> {
        self.instantiate_with(version, false, false)
    }

    pub fn instantiate_with(&self, version: Version, events: bool, early: bool) -> Instance<'_> {
        let request = Request {
            event_mode: events,
            early_return: early,
            ..self.request(version)
        };
        self.instance(version, &request)
    }

    /// An instance for model exchange.
    pub fn instantiate_for_exchange(&self, version: Version) -> Instance<'_> {
        let request = Request {
            exchange: true,
            ..self.request(version)
        };
        self.instance(version, &request)
    }

    pub fn instantiate_named(&self, version: Version, name: &CStr) -> Instance<'_> {
        let request = Request {
            name: Some(name.to_owned()),
            ..self.request(version)
        };
        self.instance(version, &request)
    }

    pub fn instance(&self, version: Version, request: &Request) -> Instance<'_> {
        let (handle, log) = request.send(version);
        assert!(!handle.is_null(), "{:?}", log.take());
        Instance {
            component: self,
            version,
            event_mode: request.event_mode,
            handle,
            time: 0.0,
            log,
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
    pub version: Version,
    pub event_mode: bool,
    pub handle: *mut c_void,
    pub time: f64,
    pub log: Box<Log>,
}

/// What a step of FMI 3 says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepResult {
    pub status: Status,
    pub event: bool,
    pub early: bool,
    /// Time that was reached [s]; FMI 2 does not say.
    pub reached: f64,
}

impl Instance<'_> {
    /// Into initialization mode, with tolerance and stop time [s] where there are any.
    pub fn enter_initialization(
        &self,
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    ) -> Status {
        let (tolerance_defined, tolerance) = (tolerance.is_some(), tolerance.unwrap_or(0.0));
        let (stop_defined, stop) = (stop.is_some(), stop.unwrap_or(0.0));
        // SAFETY: no pointers but the handle.
        unsafe {
            let c = self.handle;
            match self.version {
                Fmi2 => {
                    let (tolerance_defined, stop_defined) =
                        (tolerance_defined.into(), stop_defined.into());
                    match fmi2::fmi2SetupExperiment(
                        c,
                        tolerance_defined,
                        tolerance,
                        start,
                        stop_defined,
                        stop,
                    ) {
                        Status::Ok => fmi2::fmi2EnterInitializationMode(c),
                        refused => refused,
                    }
                }
                Fmi3 => fmi3::fmi3EnterInitializationMode(
                    c,
                    tolerance_defined.into(),
                    tolerance,
                    start,
                    stop_defined.into(),
                    stop,
                ),
            }
        }
    }

    pub fn exit_initialization(&self) -> Status {
        // SAFETY: no pointers but the handle.
        unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2ExitInitializationMode(self.handle),
                Fmi3 => fmi3::fmi3ExitInitializationMode(self.handle),
            }
        }
    }

    #[track_caller]
    pub fn initialize(&mut self, time: f64, values: &[(&str, f64)]) {
        self.time = time;
        assert_eq!(self.enter_initialization(None, time, None), Status::Ok);
        for (name, value) in values {
            self.set(name, *value);
        }
        assert_eq!(self.exit_initialization(), Status::Ok);
    }

    #[track_caller]
    pub fn reset(&mut self) {
        // SAFETY: no pointers but the handle.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2Reset(self.handle),
                Fmi3 => fmi3::fmi3Reset(self.handle),
            }
        };
        assert_eq!(status, Status::Ok);
    }

    pub fn terminate(&self) -> Status {
        // SAFETY: no pointers but the handle.
        unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2Terminate(self.handle),
                Fmi3 => fmi3::fmi3Terminate(self.handle),
            }
        }
    }

    /// Event mode of FMI 3.
    pub fn enter_event_mode(&self) -> Status {
        // SAFETY: no pointers but the handle.
        unsafe { fmi3::fmi3EnterEventMode(self.handle) }
    }

    /// Step mode of FMI 3.
    pub fn enter_step_mode(&self) -> Status {
        // SAFETY: no pointers but the handle.
        unsafe { fmi3::fmi3EnterStepMode(self.handle) }
    }

    pub fn reference(&self, name: &str) -> u32 {
        self.component
            .table
            .find(name)
            .unwrap_or_else(|| panic!("no variable {name}"))
            .value_reference
    }

    /// Sets the real variables with these value references.
    pub fn set_references(&self, references: &[u32], values: &[f64]) -> Status {
        let (count, references, values) = (references.len(), references.as_ptr(), values.as_ptr());
        // SAFETY: as many variables as values.
        unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2SetReal(self.handle, references, count, values),
                Fmi3 => fmi3::fmi3SetFloat64(self.handle, references, count, values, count),
            }
        }
    }

    pub fn try_set(&self, name: &str, value: f64) -> Status {
        self.set_references(&[self.reference(name)], &[value])
    }

    #[track_caller]
    pub fn set(&self, name: &str, value: f64) {
        assert_eq!(self.try_set(name, value), Status::Ok, "{name} = {value}");
    }

    /// Reads the real variable with this value reference.
    pub fn get_reference(&self, reference: u32) -> Result<f64, Status> {
        let mut value = f64::NAN;
        // SAFETY: one variable, one value.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2GetReal(self.handle, &reference, 1, &mut value),
                Fmi3 => fmi3::fmi3GetFloat64(self.handle, &reference, 1, &mut value, 1),
            }
        };
        if status == Status::Ok {
            Ok(value)
        } else {
            Err(status)
        }
    }

    #[track_caller]
    pub fn get(&self, name: &str) -> f64 {
        let value = self.get_reference(self.reference(name));
        assert!(value.is_ok(), "{name}: {value:?}, {:?}", self.log.take());
        value.unwrap()
    }

    /// Reads the Boolean variable with this value reference.
    pub fn get_boolean(&self, reference: u32) -> Result<bool, Status> {
        let (mut byte, mut integer) = (0_u8, 0);
        // SAFETY: one variable, one value.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2GetBoolean(self.handle, &reference, 1, &mut integer),
                Fmi3 => fmi3::fmi3GetBoolean(self.handle, &reference, 1, &mut byte, 1),
            }
        };
        if status == Status::Ok {
            Ok(byte == 1 || integer == 1)
        } else {
            Err(status)
        }
    }

    #[track_caller]
    pub fn is(&self, name: &str) -> bool {
        self.get_boolean(self.reference(name)).unwrap()
    }

    /// One step of `size` seconds from `point`, which may be anything; the clock of the importer stays.
    pub fn step_from(&self, point: f64, size: f64) -> StepResult {
        let (mut event, mut terminate, mut early, mut reached) = (0, 0, 0, point + size);
        // SAFETY: places of the results.
        let status = unsafe {
            match self.version {
                Fmi2 => fmi2::fmi2DoStep(self.handle, point, size, 1),
                Fmi3 => fmi3::fmi3DoStep(
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
        };
        StepResult {
            status,
            event: event == 1,
            early: early == 1,
            reached,
        }
    }

    /// One step of `size` seconds from where the last one ended.
    pub fn try_step(&mut self, size: f64) -> StepResult {
        let result = self.step_from(self.time, size);
        if result.status == Status::Ok {
            self.time = result.reached;
        }
        result
    }

    #[track_caller]
    pub fn step(&mut self, size: f64) {
        let status = self.try_step(size).status;
        assert_eq!(status, Status::Ok, "{:?}", self.log.take());
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
}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        match self.version {
            Fmi2 => fmi2::fmi2FreeInstance(self.handle),
            Fmi3 => fmi3::fmi3FreeInstance(self.handle),
        }
    }
}
