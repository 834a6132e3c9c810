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

/// The time derivative of a continuous state, which stands in row `place`.
pub(super) fn derivative_row(state: &Variable, place: usize) -> Variable {
    let unit = rate_unit(state.unit.as_deref().unwrap_or("1"));
    let description = format!("Time derivative of {}", state.name);
    Variable {
        initial: Some(Initial::Calculated),
        derivative_of: Some(place as u32),
        ..row(
            &format!("der({})", state.name),
            Causality::Local,
            &unit,
            &description,
        )
    }
}

/// The event indicator of this number, which is lost where what `text` says happens.
pub(super) fn indicator_row(number: usize, text: &str) -> Variable {
    let description = format!("Not positive: {text}");
    Variable {
        initial: Some(Initial::Calculated),
        event_indicator: true,
        ..row(
            &format!("event_indicator[{}]", number + 1),
            Causality::Local,
            "1",
            &description,
        )
    }
}

/// `rad` → `rad/s`, `rad/s` → `rad/s2`, `A` → `A/s`.
fn rate_unit(unit: &str) -> String {
    match unit.strip_suffix("/s") {
        Some(_) => format!("{unit}2"),
        None => format!("{unit}/s"),
    }
}
