//! Getting and setting variables of an instance.

use super::instance::Instance;
use super::pointers::Output;
use super::status::{Outcome, Phase, Refusal};
use crate::cosim::{Causality, ModelError, Variability, Variable, VariableType};

impl Instance {
    pub(super) fn variable(&self, value_reference: u32) -> Result<&Variable, Refusal> {
        self.model.table().get(value_reference).ok_or_else(|| {
            Refusal::error(format_args!(
                "there is no variable with value reference {value_reference}; the largest is {}",
                self.model.table().variables().len().saturating_sub(1)
            ))
        })
    }

    pub(super) fn typed(
        &self,
        value_reference: u32,
        asked: VariableType,
    ) -> Result<&Variable, Refusal> {
        let variable = self.variable(value_reference)?;
        if variable.variable_type == asked {
            return Ok(variable);
        }
        Err(Refusal::error(format_args!(
            "\"{}\" (value reference {value_reference}) is {}, not {asked}",
            variable.name, variable.variable_type
        )))
    }

    /// Reads real variables.
    pub(super) fn get_reals(&mut self, references: &[u32], values: &mut Output<f64>) -> Outcome {
        for (place, reference) in references.iter().enumerate() {
            self.typed(*reference, VariableType::Real)?;
            let value = self.model.real(*reference).map_err(discard)?;
            values.write(place, self.finite(value, "", *reference)?);
        }
        Ok(())
    }

    /// A number on its way out. One that overflowed on the way is none: importers would go on calculating with it.
    pub(super) fn finite(&self, value: f64, what: &str, reference: u32) -> Result<f64, Refusal> {
        if value.is_finite() {
            return Ok(value);
        }
        Err(Refusal::discard(format_args!(
            "{what}\"{}\" is {value}: with inputs, derivatives or directions this large it cannot be calculated",
            self.variable(reference)?.name
        )))
    }

    /// Reads Boolean variables.
    pub(super) fn get_booleans<T: From<bool>>(
        &mut self,
        references: &[u32],
        values: &mut Output<T>,
    ) -> Outcome {
        for (place, reference) in references.iter().enumerate() {
            self.typed(*reference, VariableType::Boolean)?;
            values.write(
                place,
                self.model.boolean(*reference).map_err(discard)?.into(),
            );
        }
        Ok(())
    }

    /// Sets real variables: all of them, or none if one cannot be set.
    pub(super) fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Outcome {
        for (reference, value) in references.iter().zip(values) {
            let variable = self.typed(*reference, VariableType::Real)?;
            self.settable(variable)?;
            if !variable.allows(*value) {
                return Err(Refusal::discard(format_args!(
                    "\"{}\" cannot be {value}: it must be {}",
                    variable.name,
                    variable.allowed()
                )));
            }
        }
        for (reference, value) in references.iter().zip(values) {
            self.model.set_real(*reference, *value).map_err(discard)?;
        }
        Ok(())
    }

    /// Refuses to set variables of a type that no settable variable has.
    pub(super) fn set_none(&mut self, references: &[u32], asked: VariableType) -> Outcome {
        for reference in references {
            let variable = self.typed(*reference, asked)?;
            self.settable(variable)?;
        }
        Ok(())
    }

    /// Refuses to read or set variables of a type that no variable has.
    pub(super) fn no_variable_of_type(&self, references: &[u32], asked: &str) -> Outcome {
        let Some(reference) = references.first() else {
            return Ok(());
        };
        let variable = self.variable(*reference)?;
        Err(Refusal::error(format_args!(
            "\"{}\" (value reference {reference}) is {}, not {asked}",
            variable.name, variable.variable_type
        )))
    }

    fn settable(&self, variable: &Variable) -> Outcome {
        // A solver may set states one by one too.
        let is_state = || {
            let reference = variable.value_reference;
            let mut states = self.model.table().states();
            self.exchange && states.any(|state| state.value_reference == reference)
        };
        let events_apart = self.event_mode_used && variable.causality != Causality::Input;
        let allowed = match self.phase {
            Phase::Instantiated | Phase::Initialization => variable.settable_before_start(),
            Phase::Step => variable.settable_between_steps() && !events_apart,
            Phase::Event => variable.settable_between_steps() || is_state(),
            Phase::ContinuousTime => variable.causality == Causality::Input || is_state(),
            _ => false,
        };
        if allowed {
            return Ok(());
        }
        let when = match (variable.settable_before_start(), variable.variability) {
            (false, _) => "it is computed and can never be set",
            (true, Variability::Tunable) => {
                "a tunable parameter is set before the simulation or at communication points (in model exchange \
                 and with event mode in use, in event mode)"
            }
            (true, _) => "it can be set before the simulation only",
        };
        Err(Refusal::error(format_args!(
            "\"{}\" must not be set in the state \"{}\": {when}",
            variable.name,
            self.phase.name(self.interface)
        )))
    }
}

/// A value that the model cannot give or take.
pub(super) fn discard(error: ModelError) -> Refusal {
    Refusal::discard(error)
}
