//! The built FMUs in the Rust importer `fmi` 0.8, second to `fmi-rs` (`build-fmu/tests/fmu`): another reading of the
//! standards, with C bindings made from their headers.
//!
//! What `fmi` 0.8.0 cannot do, so that it can be looked at again with a later version:
//!
//! - **FMI 3.0 with units.** Its schema reads the exponents `A` and `K` of a `BaseUnit` as `a` and `k`, knows no `unit`,
//!   `displayUnit` and `nominal` of a `Float64`, and refuses what it does not know: any FMU with a unit fails to parse. A test
//!   expects that refusal; [`Component::load`] gives the parser a text without units and everything else of the FMU as it
//!   is shipped.
//! - **Saved states.** Its functions for them are commented out in both versions.
//! - **Directional derivatives** in FMI 2.0 for as many unknowns as knowns only; in FMI 3.0 not at all.

use std::error::Error;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

use fmi::fmi2::import::Fmi2Import;
use fmi::fmi2::instance::{CoSimulation as _, Common as _, InstanceCS as Instance2};
use fmi::fmi3::import::Fmi3Import;
use fmi::fmi3::instance::InstanceCS as Instance3;
use fmi::fmi3::{CoSimulation as _, Common as _, Fmi3Model as _, GetSet as _};
use fmi::traits::FmiImport as _;
use fmi::{EventFlags, import};

/// Whatever went wrong; a test shows it.
pub type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Root of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Builds both FMUs of a shipped model file into `folder` with the shipped program.
///
/// # Errors
/// The program is missing, or refuses.
pub fn build(model: &str, folder: &Path) -> Result<()> {
    let program = root().join("target/release/build-fmu");
    let output = Command::new(&program)
        .arg(root().join("modelDescription").join(model))
        .arg("--out")
        .arg(folder)
        .output()
        .map_err(|error| {
            format!(
                "{}: {error}; tests/run importer builds it",
                program.display()
            )
        })?;
    if output.status.success() {
        return Ok(());
    }
    Err(String::from_utf8_lossy(&output.stderr).into())
}

enum Instance {
    Two(Box<Instance2>),
    Three(Box<Instance3>),
}

/// What a step says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Whether the component wants event mode; FMI 3.0 only.
    pub event: bool,
    /// Where it ended [s].
    pub time: f64,
}

/// An FMU with one instance. The import keeps the unpacked files as long as it lives.
pub struct Component {
    instance: Instance,
    names: Vec<(String, u32)>,
    event_mode: bool,
    _import: Box<dyn std::any::Any>,
}

impl Component {
    /// Loads an FMU of either version and instantiates it; FMI 3.0 with event mode and early return if asked.
    ///
    /// # Errors
    /// The importer refuses it.
    pub fn load(path: &Path, event_mode: bool) -> Result<Self> {
        if path.to_string_lossy().ends_with(".fmi2.fmu") {
            let import: Fmi2Import = import::from_path(path)?;
            let instance = import.instantiate_cs("rig", false, true)?;
            let variables = import.model_description().get_model_variables();
            return Ok(Self {
                names: variables
                    .map(|variable| (variable.name.clone(), variable.value_reference))
                    .collect(),
                instance: Instance::Two(Box::new(instance)),
                event_mode: false,
                _import: Box::new(import),
            });
        }
        let folder = tempfile::tempdir()?;
        zip::ZipArchive::new(File::open(path)?)?.extract(folder.path())?;
        let xml = std::fs::read_to_string(folder.path().join("modelDescription.xml"))?;
        let import = Fmi3Import::new(folder, &without_units(&xml))?;
        let instance = import.instantiate_cs("rig", false, true, event_mode, event_mode, &[])?;
        let variables = import.model_description().model_variables.iter_abstract();
        Ok(Self {
            names: variables
                .map(|variable| (variable.name().to_owned(), variable.value_reference()))
                .collect(),
            instance: Instance::Three(Box::new(instance)),
            event_mode,
            _import: Box::new(import),
        })
    }

    /// Sets values and goes through initialisation at time 0.
    ///
    /// # Errors
    /// The component refuses.
    pub fn initialise(&mut self, values: &[(&str, f64)]) -> Result<()> {
        match &mut self.instance {
            Instance::Two(fmu) => {
                fmu.setup_experiment(None, 0.0, None)?;
                fmu.enter_initialization_mode()?;
            }
            Instance::Three(fmu) => {
                fmu.enter_initialization_mode(None, 0.0, None)?;
            }
        }
        for (name, value) in values {
            self.set(name, *value)?;
        }
        match &mut self.instance {
            Instance::Two(fmu) => {
                fmu.exit_initialization_mode()?;
            }
            Instance::Three(fmu) => {
                fmu.exit_initialization_mode()?;
                if self.event_mode {
                    fmu.enter_step_mode()?;
                }
            }
        }
        Ok(())
    }

    fn reference(&self, name: &str) -> Result<u32> {
        let found = self.names.iter().find(|(known, _)| known == name);
        let (_, reference) = found.ok_or_else(|| format!("there is no variable {name}"))?;
        Ok(*reference)
    }

    /// Sets a real variable.
    ///
    /// # Errors
    /// There is none of this name, or the component refuses the value.
    pub fn set(&mut self, name: &str, value: f64) -> Result<()> {
        let reference = [self.reference(name)?];
        match &mut self.instance {
            Instance::Two(fmu) => {
                fmu.set_real(&reference, &[value])?;
            }
            Instance::Three(fmu) => {
                fmu.set_float64(&reference, &[value])?;
            }
        }
        Ok(())
    }

    /// Reads a real variable.
    ///
    /// # Errors
    /// There is none of this name.
    pub fn get(&mut self, name: &str) -> Result<f64> {
        let (reference, mut value) = ([self.reference(name)?], [f64::NAN]);
        match &mut self.instance {
            Instance::Two(fmu) => {
                fmu.get_real(&reference, &mut value)?;
            }
            Instance::Three(fmu) => {
                fmu.get_float64(&reference, &mut value)?;
            }
        }
        Ok(value[0])
    }

    /// A step of `size` from `point`, both in seconds.
    ///
    /// # Errors
    /// The component refuses it.
    pub fn step(&mut self, point: f64, size: f64) -> Result<Step> {
        match &mut self.instance {
            Instance::Two(fmu) => {
                fmu.do_step(point, size, true)?;
                Ok(Step {
                    event: false,
                    time: fmu.last_successful_time()?,
                })
            }
            Instance::Three(fmu) => {
                let (mut event, mut terminate, mut early, mut time) = (false, false, false, 0.0);
                fmu.do_step(
                    point,
                    size,
                    true,
                    &mut event,
                    &mut terminate,
                    &mut early,
                    &mut time,
                )?;
                assert!(!terminate && early == (time < point + size));
                Ok(Step { event, time })
            }
        }
    }

    /// Through event mode of FMI 3.0, where nothing is left to do.
    ///
    /// # Errors
    /// FMI 2.0, or the component refuses.
    pub fn handle_event(&mut self) -> Result<()> {
        let Instance::Three(fmu) = &mut self.instance else {
            return Err("FMI 2.0 for co-simulation has no event mode".into());
        };
        let mut flags = EventFlags::default();
        fmi::fmi3::Common::enter_event_mode(&mut **fmu)?;
        fmi::fmi3::Common::update_discrete_states(&mut **fmu, &mut flags)?;
        assert!(!flags.discrete_states_need_update && !flags.terminate_simulation);
        fmu.enter_step_mode()?;
        Ok(())
    }

    /// Derivative of `unknown` with respect to `known`; FMI 2.0 only.
    ///
    /// # Errors
    /// FMI 3.0, or the component refuses.
    pub fn derivative(&mut self, unknown: &str, known: &str) -> Result<f64> {
        let (unknown, known) = ([self.reference(unknown)?], [self.reference(known)?]);
        let mut value = [f64::NAN];
        match &self.instance {
            Instance::Two(fmu) => {
                fmu.get_directional_derivative(&unknown, &known, &[1.0], &mut value)?;
                Ok(value[0])
            }
            Instance::Three(_) => Err("fmi 0.8 has no directional derivatives in FMI 3.0".into()),
        }
    }
}

/// The description without the definitions of units and types and without what `fmi` 0.8 does not know of a variable.
fn without_units(xml: &str) -> String {
    let mut text = String::new();
    let mut within = false;
    for line in xml.lines() {
        let element = line.trim_start();
        within |= element.starts_with("<UnitDefinitions");
        if !within {
            let attributes = ["unit", "displayUnit", "nominal", "declaredType"];
            text += &attributes
                .into_iter()
                .fold(line.to_owned(), without_attribute);
            text.push('\n');
        }
        within &= !element.starts_with("</TypeDefinitions");
    }
    text
}

fn without_attribute(line: String, name: &str) -> String {
    let begin = format!(" {name}=\"");
    let Some((before, rest)) = line.split_once(&begin) else {
        return line;
    };
    let after = rest.split_once('"').map_or("", |(_, after)| after);
    format!("{before}{after}")
}
