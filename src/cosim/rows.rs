//! Rows of the variable table, the same for every component.

use super::variables::{Causality, Initial, Variability, Variable, VariableType};
use crate::parameter::{Parameter, Range};

/// A continuous real variable without start value.
pub(super) fn row(name: &str, causality: Causality, unit: &str, description: &str) -> Variable {
    Variable {
        value_reference: 0,
        name: name.into(),
        variable_type: VariableType::Real,
        causality,
        variability: Variability::Continuous,
        initial: None,
        unit: Some(unit.into()),
        display_unit: None,
        start: None,
        minimum: None,
        above_minimum: false,
        maximum: None,
        nominal: None,
        description: description.into(),
        alias_of: None,
        derivative_of: None,
        reinit: false,
        event_indicator: false,
        dependencies: Vec::new(),
        initial_dependencies: Vec::new(),
    }
}

/// An input that starts at zero.
pub(super) fn input(name: &str, unit: &str, nominal: f64, description: &str) -> Variable {
    Variable {
        start: Some(0.0),
        nominal: Some(nominal),
        ..row(name, Causality::Input, unit, description)
    }
}

/// A parameter that starts with its value in `model.toml`.
pub(super) fn parameter_row(parameter: &Parameter, start: Option<f64>) -> Variable {
    let info = &parameter.info;
    Variable {
        variability: if info.built_in {
            Variability::Fixed
        } else {
            Variability::Tunable
        },
        initial: Some(Initial::Exact),
        display_unit: (info.unit == "rad").then_some("deg"),
        start,
        minimum: info.range.minimum(),
        above_minimum: info.range == Range::Positive,
        maximum: info.range.maximum(),
        ..row(
            &parameter.name,
            Causality::Parameter,
            info.unit,
            info.description.trim(),
        )
    }
}

/// A Boolean that changes at events.
pub(super) fn flag(name: &str, description: &str) -> Variable {
    Variable {
        variable_type: VariableType::Boolean,
        variability: Variability::Discrete,
        initial: Some(Initial::Calculated),
        unit: None,
        ..row(name, Causality::Local, "1", description)
    }
}
