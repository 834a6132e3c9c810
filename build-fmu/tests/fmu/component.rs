//! FMUs of the shipped rigs, and one way to run an instance of either version.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use build_fmu::build::Source;
use build_fmu::library;
use build_fmu::platform::FmiVersion;
use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::fmi2::types::fmi2Status;
use fmi_rs::fmi2::{CS, FMU2};
use fmi_rs::fmi3::FMU3;
use fmi_rs::fmi3::builder::FMU3Builder;
use fmi_rs::fmi3::types::fmi3Status;

/// A model file that ships with the project.
pub fn shipped_model(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../modelDescription")
        .join(name)
}

/// Builds the FMU of a shipped model file into `folder`.
pub fn build(model: &str, version: FmiVersion, folder: &Path) -> PathBuf {
    let source = Source::read(&shipped_model(model)).unwrap();
    let library = library::find(None).unwrap();
    source.build(&[library], version, folder).unwrap().path
}

enum Instance {
    Fmi2(Arc<FMU2<CS>>),
    Fmi3(Arc<FMU3>),
}

/// An instance in a Rust importer. The builder keeps the unpacked FMU on disk as long as it lives.
pub struct Component {
    instance: Instance,
    names: Vec<(String, u32)>,
    time: f64,
    _unpacked: Box<dyn std::any::Any>,
}

impl Component {
    /// Loads an FMU and instantiates it.
    pub fn load(path: &Path, version: FmiVersion) -> Self {
        match version {
            FmiVersion::Fmi2 => {
                let builder = FMU2Builder::new(&path).unwrap();
                let variables = builder.model_description.modelVariables.iter();
                Self {
                    names: variables
                        .map(|v| (v.name.clone(), v.valueReference))
                        .collect(),
                    instance: Instance::Fmi2(builder.instantiate_cs("rig").unwrap()),
                    time: 0.0,
                    _unpacked: Box::new(builder),
                }
            }
            FmiVersion::Fmi3 => {
                let mut builder = FMU3Builder::new(&path).unwrap();
                builder.eventModeUsed = false;
                builder.earlyReturnAllowed = false;
                let variables = builder.model_description.modelVariables.iter();
                Self {
                    names: variables
                        .map(|v| (v.name.clone(), v.valueReference))
                        .collect(),
                    instance: Instance::Fmi3(builder.instantiate_cs("rig").unwrap()),
                    time: 0.0,
                    _unpacked: Box::new(builder),
                }
            }
        }
    }

    /// Sets start values and goes through initialisation at time 0.
    pub fn initialise(&mut self, values: &[(&str, f64)]) {
        for (name, value) in values {
            self.set(name, *value);
        }
        match &self.instance {
            Instance::Fmi2(fmu) => {
                assert_eq!(fmu.setupExperiment(None, 0.0, None), fmi2Status::Ok);
                assert_eq!(fmu.enterInitializationMode(), fmi2Status::Ok);
                assert_eq!(fmu.exitInitializationMode(), fmi2Status::Ok);
            }
            Instance::Fmi3(fmu) => {
                assert_eq!(fmu.enterInitializationMode(None, 0.0, None), fmi3Status::Ok);
                assert_eq!(fmu.exitInitializationMode(), fmi3Status::Ok);
            }
        }
    }

    fn reference(&self, name: &str) -> u32 {
        self.names
            .iter()
            .find(|(known, _)| known == name)
            .unwrap()
            .1
    }

    /// Sets a real variable.
    pub fn set(&self, name: &str, value: f64) {
        let reference = [self.reference(name)];
        match &self.instance {
            Instance::Fmi2(fmu) => assert_eq!(fmu.setReal(&reference, &[value]), fmi2Status::Ok),
            Instance::Fmi3(fmu) => assert_eq!(fmu.setFloat64(&reference, &[value]), fmi3Status::Ok),
        }
    }

    /// Reads a real variable.
    pub fn get(&self, name: &str) -> f64 {
        let (reference, mut value) = ([self.reference(name)], [f64::NAN]);
        match &self.instance {
            Instance::Fmi2(fmu) => {
                assert_eq!(fmu.getReal(&reference, &mut value), fmi2Status::Ok);
            }
            Instance::Fmi3(fmu) => {
                assert_eq!(fmu.getFloat64(&reference, &mut value), fmi3Status::Ok);
            }
        }
        value[0]
    }

    /// Goes to the communication point `time` [s].
    pub fn step_to(&mut self, time: f64) {
        let size = time - self.time;
        match &self.instance {
            Instance::Fmi2(fmu) => assert_eq!(fmu.doStep(self.time, size, 1), fmi2Status::Ok),
            Instance::Fmi3(fmu) => {
                let (mut event, mut terminate, mut early, mut reached) = (false, false, false, 0.0);
                let status = fmu.doStep(
                    self.time,
                    size,
                    true,
                    &mut event,
                    &mut terminate,
                    &mut early,
                    &mut reached,
                );
                assert_eq!(status, fmi3Status::Ok);
                assert!(!terminate && !early);
            }
        }
        self.time = time;
    }
}
