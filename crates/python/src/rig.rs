//! Rigs: a model file's text with what can be asked of it.

use std::path::{Path, PathBuf};

use build_fmu::build::Source;
use build_fmu::library;
use build_fmu::platform::{FmiVersion, Platform};
use pyo3::prelude::*;
use stickslip::body::is_small_plant;
use stickslip::controller::is_controller;
use stickslip::parameter::ParameterInfo;
use stickslip::plant::{ModelFile, Provenance, RigKind};
use workbench::component::{Component, Native, Role, closest};
use workbench::diagnose::rig_columns::RigColumns;

use crate::errors::{InputError, any_error, input_error};

/// A variable as Python's tables have it: name, role, unit, start, minimum, maximum, description.
type VariableRow = (
    String,
    &'static str,
    String,
    Option<f64>,
    Option<f64>,
    Option<f64>,
    String,
);

/// A rig with its numbers.
#[pyclass(frozen)]
pub struct Rig {
    /// What messages call it.
    pub name: String,
    /// Text of the model file without `[columns]`.
    pub text: String,
    /// Text of its `[columns]`.
    pub columns: String,
    /// What the text describes.
    pub model: ModelFile,
}

impl Rig {
    fn parse(text: &str, name: &str) -> PyResult<Self> {
        for (is_other, what) in [
            (is_controller(text), "a controller"),
            (is_small_plant(text), "a small plant"),
        ] {
            if is_other {
                return Err(InputError::new_err(format!(
                    "{name}: is {what}; a rig is needed here"
                )));
            }
        }
        let (columns, text) = RigColumns::split(text);
        let model = ModelFile::parse(&text, name).map_err(|error| input_error(&error))?;
        Ok(Self {
            name: name.to_owned(),
            text,
            columns,
            model,
        })
    }

    /// The same rig with another model.
    fn with_model(&self, model: ModelFile) -> PyResult<Self> {
        model.rig.check().map_err(|error| input_error(&error))?;
        Ok(Self {
            name: self.name.clone(),
            text: model.to_toml(),
            columns: self.columns.clone(),
            model,
        })
    }

    /// The rig as a component that runs natively.
    ///
    /// # Errors
    /// As for [`Native::from_text`].
    pub fn component(&self) -> anyhow::Result<Native> {
        Ok(Native::from_text(&self.text, &self.name)?)
    }
}

#[pymethods]
impl Rig {
    #[new]
    fn new(text: &str, name: &str) -> PyResult<Self> {
        Self::parse(text, name)
    }

    /// What messages call it.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Text of the whole model file.
    #[getter]
    fn text(&self) -> String {
        let is_open = !(self.columns.is_empty() || self.text.ends_with('\n'));
        let end = if is_open { "\n" } else { "" };
        format!("{}{end}{}", self.text, self.columns)
    }

    /// `reduced` or `full`.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.model.rig.kind() {
            RigKind::Reduced => "reduced",
            RigKind::Full => "full",
        }
    }

    /// Name of the friction law of the pin on disc D2.
    #[getter]
    fn law(&self) -> &'static str {
        self.model.rig.law.name()
    }

    /// Names of the effects that are on.
    #[getter]
    fn effects(&self) -> Vec<&'static str> {
        let rig = &self.model.rig;
        let sections = rig.sections();
        rig.effect_names()
            .filter(|name| sections.iter().any(|(section, _)| section == name))
            .collect()
    }

    /// Name, value, unit, description and relative uncertainty of every parameter.
    #[getter]
    fn parameters(&self) -> Vec<(String, f64, &'static str, &'static str, Option<f64>)> {
        let rig = &self.model.rig;
        let all = rig.parameters().into_iter();
        all.enumerate()
            .filter_map(|(at, parameter)| {
                let provenance = self.model.provenance.get(&parameter.name);
                Some((
                    parameter.name,
                    rig.parameter_at(at)?,
                    parameter.info.unit,
                    parameter.info.description.trim(),
                    provenance.and_then(|own| own.relative_uncertainty),
                ))
            })
            .collect()
    }

    /// All variables of its FMUs that have a meaning of their own.
    fn variables(&self) -> PyResult<Vec<VariableRow>> {
        let component = self.component().map_err(|error| any_error(&error))?;
        let rows = component.variables().iter().map(|variable| {
            (
                variable.name.clone(),
                match variable.role {
                    Role::Time => "time",
                    Role::Input => "input",
                    Role::Output => "output",
                    Role::Local => "local",
                    Role::Parameter => "parameter",
                    Role::Other => "other",
                },
                variable.unit.clone(),
                variable.start,
                variable.minimum,
                variable.maximum,
                variable.description.clone(),
            )
        });
        Ok(rows.collect())
    }

    /// The rig with other values of parameters, given with their dotted names. A number that is replaced keeps its relative
    /// uncertainty and loses its source.
    fn with_parameters(&self, values: Vec<(String, f64)>) -> PyResult<Self> {
        let mut model = self.model.clone();
        for (name, value) in values {
            if model.rig.position(&name).is_none() {
                return Err(self.unknown_parameter(&name));
            }
            model
                .rig
                .set_parameter(&name, value)
                .map_err(|error| input_error(&error))?;
            if let Some(provenance) = model.provenance.get_mut(&name) {
                *provenance = Provenance {
                    source: None,
                    status: None,
                    interval95: None,
                    relative_uncertainty: provenance.relative_uncertainty,
                };
            }
        }
        self.with_model(model)
    }

    /// The rig with an effect switched on, of which every number is given by its key, or with other numbers of one that is on.
    fn with_effect(&self, effect: &str, values: Vec<(String, f64)>) -> PyResult<Self> {
        let mut model = self.model.clone();
        let infos = self.effect_parameters(effect)?;
        if let Some((key, _)) = values
            .iter()
            .find(|(key, _)| infos.iter().all(|info| info.key != key))
        {
            return Err(InputError::new_err(format!(
                "{effect} has no number `{key}`; it has {}",
                keys(infos)
            )));
        }
        let value = |info: &'static ParameterInfo| {
            values
                .iter()
                .find(|(key, _)| key == info.key)
                .map(|(_, value)| *value)
                .or_else(|| self.model.rig.parameter(&format!("{effect}.{}", info.key)))
                .ok_or_else(|| {
                    InputError::new_err(format!(
                        "{effect}: `{}` is missing ({} [{}]); it needs {}",
                        info.key,
                        info.description.trim(),
                        info.unit,
                        keys(infos)
                    ))
                })
        };
        match model.rig.insert_effect(effect, value) {
            Some(inserted) => inserted?,
            None => return Err(self.unknown_effect(effect)),
        }
        self.with_model(model)
    }

    /// The rig without an effect.
    fn without_effect(&self, effect: &str) -> PyResult<Self> {
        let mut model = self.model.clone();
        self.effect_parameters(effect)?;
        if !model.rig.remove_effect(effect) {
            return Err(InputError::new_err(format!(
                "{}: has no effect {effect} that could be taken out",
                self.name
            )));
        }
        model
            .provenance
            .retain(|name, _| name.split('.').next() != Some(effect));
        self.with_model(model)
    }

    /// Voltage [V] that turns the undisturbed rig at `speed` [rad/s] at the gearbox output.
    fn voltage_for(&self, speed: f64) -> f64 {
        self.model.rig.voltage_for_speed(speed)
    }

    /// Writes FMUs; returns their paths.
    fn build(
        &self,
        py: Python<'_>,
        out: PathBuf,
        versions: Vec<u8>,
        platforms: Vec<String>,
        libraries: Vec<PathBuf>,
    ) -> PyResult<Vec<PathBuf>> {
        py.detach(|| self.built(&out, &versions, &platforms, &libraries))
            .map_err(|error| any_error(&error))
    }
}

impl Rig {
    fn built(
        &self,
        out: &Path,
        versions: &[u8],
        platforms: &[String],
        libraries: &[PathBuf],
    ) -> anyhow::Result<Vec<PathBuf>> {
        let source = Source::from_text(self.text.clone(), &self.name)?;
        let platforms = platforms
            .iter()
            .map(|name| name.parse())
            .collect::<Result<Vec<Platform>, _>>()?;
        let libraries = library::select(&platforms, libraries)?;
        let wanted = FmiVersion::ALL.into_iter().filter(|version| {
            versions
                .iter()
                .any(|number| version.number().starts_with(&number.to_string()))
        });
        wanted
            .map(|version| Ok(source.build(&libraries, version, out)?.path))
            .collect()
    }

    fn effect_parameters(&self, effect: &str) -> PyResult<&'static [ParameterInfo]> {
        let is_possible = self.model.rig.effect_names().any(|name| name == effect);
        let infos = self.model.rig.effect_infos(effect);
        infos
            .filter(|_| is_possible)
            .ok_or_else(|| self.unknown_effect(effect))
    }

    fn unknown_effect(&self, effect: &str) -> PyErr {
        let known: Vec<&str> = self.model.rig.effect_names().collect();
        InputError::new_err(format!(
            "{}: cannot have an effect `{effect}`{}; it can have {}",
            self.name,
            meant(closest(effect, known.iter().copied())),
            known.join(", ")
        ))
    }

    fn unknown_parameter(&self, name: &str) -> PyErr {
        let parameters = self.model.rig.parameters();
        let names: Vec<&str> = parameters.iter().map(|own| own.name.as_str()).collect();
        InputError::new_err(format!(
            "{}: has no parameter `{name}`{}; it has {}",
            self.name,
            meant(closest(name, names.iter().copied())),
            names.join(", ")
        ))
    }
}

fn meant(near: Option<&str>) -> String {
    near.map(|near| format!(" (is `{near}` meant?)"))
        .unwrap_or_default()
}

fn keys(infos: &[ParameterInfo]) -> String {
    let keys: Vec<&str> = infos.iter().map(|info| info.key).collect();
    keys.join(", ")
}
