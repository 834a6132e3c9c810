//! The native model of a `model.toml`, without any FMI between: the same variables as its FMUs.

use std::fs;
use std::path::Path;

use stickslip::cosim::{self, Causality, CoSimulationModel, ModelError, Variability, VariableType};

use super::variable::{Kind, Role, Variable};
use super::{Component, ComponentError, Event};

/// A rig that runs natively.
pub struct Native {
    title: String,
    model: Box<dyn CoSimulationModel>,
    variables: Vec<Variable>,
    switches: u64,
    events: Vec<Event>,
}

impl Native {
    /// Opens the model file `path`.
    ///
    /// # Errors
    /// [`ComponentError`], naming file, section, key and what is right.
    pub fn open(path: &Path) -> Result<Self, ComponentError> {
        let text = fs::read_to_string(path).map_err(|source| ComponentError::Read {
            path: path.to_owned(),
            source,
        })?;
        Self::from_text(&text, &path.display().to_string())
    }

    /// The model of a model file's text; `name` names it in messages.
    ///
    /// # Errors
    /// As for [`Native::open`].
    pub fn from_text(text: &str, name: &str) -> Result<Self, ComponentError> {
        let model = cosim::open(text, name).map_err(refused)?;
        let variables = model.table().variables().iter().map(translate).collect();
        Ok(Self {
            title: name.to_owned(),
            model,
            variables,
            switches: 0,
            events: Vec::new(),
        })
    }
}

impl Component for Native {
    fn title(&self) -> String {
        self.title.clone()
    }

    fn variables(&self) -> &[Variable] {
        &self.variables
    }

    fn set(&mut self, values: &[(usize, f64)]) -> Result<(), ComponentError> {
        for &(position, value) in values {
            let table = self.model.table();
            let row = &table.variables()[position];
            if !row.allows(value) {
                let message = format!(
                    "{} = {value} is out of range: it must be {}",
                    row.name,
                    row.allowed()
                );
                return Err(ComponentError::Model(message));
            }
            let reference = row.value_reference;
            self.model.set_real(reference, value).map_err(refused)?;
        }
        Ok(())
    }

    fn initialise(&mut self, start: f64, _stop: f64) -> Result<(), ComponentError> {
        // Inputs that were set before belong to the start, wherever it is.
        self.model.set_up(start, None);
        self.model.initialise().map_err(refused)
    }

    fn reset(&mut self) -> Result<(), ComponentError> {
        self.model.reset();
        self.events.clear();
        Ok(())
    }

    fn get(&mut self, positions: &[usize], values: &mut [f64]) -> Result<(), ComponentError> {
        for (value, &position) in values.iter_mut().zip(positions) {
            let variable = &self.variables[position];
            *value = match variable.kind {
                Kind::Real => self.model.real(variable.reference).map_err(refused)?,
                Kind::Boolean => {
                    f64::from(self.model.boolean(variable.reference).map_err(refused)?)
                }
                Kind::Other => f64::NAN,
            };
        }
        Ok(())
    }

    fn step(&mut self, _from: f64, to: f64) -> Result<(), ComponentError> {
        self.model.step(to, false).map_err(refused)?;
        let (switches, events) = (&mut self.switches, &mut self.events);
        self.model.drain_notices(&mut |notice| {
            *switches += 1;
            events.push(Event {
                time: notice.time(),
                what: notice.what(),
            });
        });
        Ok(())
    }

    fn switches(&self) -> Option<u64> {
        Some(self.switches)
    }

    fn take_events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.events)
    }
}

fn refused(error: ModelError) -> ComponentError {
    ComponentError::Model(error.to_string())
}

fn translate(row: &cosim::Variable) -> Variable {
    Variable {
        name: row.name.clone(),
        reference: row.value_reference,
        role: match row.causality {
            Causality::Independent => Role::Time,
            Causality::Input => Role::Input,
            Causality::Output => Role::Output,
            Causality::Local
                if row.derivative_of.is_some() || row.event_indicator || row.alias_of.is_some() =>
            {
                Role::Other
            }
            Causality::Local => Role::Local,
            Causality::Parameter => Role::Parameter,
        },
        kind: match row.variable_type {
            VariableType::Real => Kind::Real,
            VariableType::Boolean => Kind::Boolean,
        },
        held: row.variability != Variability::Continuous,
        is_tunable: row.variability == Variability::Tunable,
        unit: row.unit.clone().unwrap_or_default(),
        start: row.start,
        minimum: row.minimum,
        maximum: row.maximum,
        description: row.description.clone(),
    }
}
