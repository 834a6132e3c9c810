//! The variable table: the only source of names, value references, units, causality, start values,
//! dispatch and XML.

use crate::parameter::units::{Unit, UnitError};
use std::fmt;

/// The part that a variable plays between the component and its importer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Time.
    Independent,
    /// Set by the importer at communication points.
    Input,
    /// Meant to be connected to other components.
    Output,
    /// For looking at, not for connecting.
    Local,
    /// Set by the importer before the simulation, or during it where [`Variability::Tunable`].
    Parameter,
}

impl Causality {
    /// The word that both standards' XML uses.
    pub fn xml(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Input => "input",
            Self::Output => "output",
            Self::Local => "local",
            Self::Parameter => "parameter",
        }
    }
}

/// When a variable may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variability {
    /// At any time.
    Continuous,
    /// Only at events.
    Discrete,
    /// When the importer changes it at a communication point.
    Tunable,
    /// Not after initialisation.
    Fixed,
}

impl Variability {
    /// The word that both standards' XML uses.
    pub fn xml(self) -> &'static str {
        match self {
            Self::Continuous => "continuous",
            Self::Discrete => "discrete",
            Self::Tunable => "tunable",
            Self::Fixed => "fixed",
        }
    }
}

/// Where the value at the start of a simulation comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Initial {
    /// From the start value; the importer may set another one before the simulation.
    Exact,
    /// Computed from other variables during initialisation.
    Calculated,
}

impl Initial {
    /// The word that both standards' XML uses.
    pub fn xml(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Calculated => "calculated",
        }
    }
}

/// The type of a variable's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VariableType {
    /// `Real` in FMI 2, `Float64` in FMI 3.
    Real,
    /// `Boolean` in both; start values are 0 (false) and 1 (true).
    Boolean,
}

impl fmt::Display for VariableType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Real => "a real",
            Self::Boolean => "a Boolean",
        })
    }
}

/// One row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// The number by which importers address the variable; equal to its place in the table.
    pub value_reference: u32,
    /// Name in importers and in CSV headers; parameters have dotted names.
    pub name: String,
    /// Type of the value.
    pub variable_type: VariableType,
    /// The part that it plays.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// Where its first value comes from; `None` for inputs and time, where the standards fix it.
    pub initial: Option<Initial>,
    /// Name of its unit, defined in [`VariableTable::units`]; `None` for Booleans.
    pub unit: Option<String>,
    /// Name of a display unit of that unit, where people prefer one.
    pub display_unit: Option<&'static str>,
    /// Start value in `unit`; `None` where it is calculated.
    pub start: Option<f64>,
    /// Smallest value that may be set, itself allowed unless [`above_minimum`](Self::above_minimum).
    pub minimum: Option<f64>,
    /// Whether the minimum itself is refused (a mass of zero). The standards' XML cannot say so.
    pub above_minimum: bool,
    /// Largest value that may be set.
    pub maximum: Option<f64>,
    /// Typical size in `unit`, above zero; `None` where 1 serves.
    pub nominal: Option<f64>,
    /// One line for people.
    pub description: String,
    /// The variable whose number this one is under another name: what the dissertation calls it.
    pub alias_of: Option<u32>,
    /// The continuous state whose time derivative this one is.
    pub derivative_of: Option<u32>,
    /// Whether an event may set this continuous state to another value.
    pub reinit: bool,
    /// Whether an event is due where this one changes its sign.
    pub event_indicator: bool,
    /// Value references of the inputs on which an output depends at the same instant.
    pub dependencies: Vec<u32>,
    /// Value references of the known variables on which an output or a calculated local depends
    /// during initialisation.
    pub initial_dependencies: Vec<u32>,
}

impl Variable {
    /// Whether an importer may set the variable before initialisation has ended.
    pub fn settable_before_start(&self) -> bool {
        self.causality == Causality::Input || self.initial == Some(Initial::Exact)
    }

    /// Whether an importer may set the variable between communication steps.
    pub fn settable_between_steps(&self) -> bool {
        self.causality == Causality::Input || self.variability == Variability::Tunable
    }

    /// Whether `value` is finite and within the variable's limits.
    pub fn allows(&self, value: f64) -> bool {
        value.is_finite()
            && self.minimum.is_none_or(|minimum| {
                if self.above_minimum {
                    value > minimum
                } else {
                    value >= minimum
                }
            })
            && self.maximum.is_none_or(|maximum| value <= maximum)
    }

    /// What [`allows`](Self::allows) asks for, in words.
    pub fn allowed(&self) -> String {
        let unit = match self.unit.as_deref() {
            None | Some("1") => String::new(),
            Some(unit) => format!(" {unit}"),
        };
        match (self.minimum, self.maximum) {
            (None, None) => "a finite number".into(),
            (Some(low), None) if self.above_minimum => {
                format!("a finite number above {low}{unit}")
            }
            (Some(low), None) => format!("a finite number not below {low}{unit}"),
            (None, Some(high)) => format!("a finite number not above {high}{unit}"),
            (Some(low), Some(high)) if self.above_minimum => {
                format!("above {low} and at most {high}{unit}")
            }
            (Some(low), Some(high)) => format!("from {low} to {high}{unit}"),
        }
    }
}

/// Every variable of a component, in the order in which the XML lists them.
///
/// The value reference of a variable is its place in the table, so that looking one up is one
/// bounds check.
#[derive(Clone, Debug, PartialEq)]
pub struct VariableTable {
    variables: Vec<Variable>,
    units: Vec<Unit>,
}

impl VariableTable {
    /// The table with the given rows. Value references are assigned here, in order; the unit
    /// definitions are those that the rows use, in the order of first use.
    ///
    /// # Errors
    /// Two rows of one name, or a unit that is not a product of powers of SI units.
    pub fn new(mut variables: Vec<Variable>) -> Result<Self, TableError> {
        let mut units: Vec<Unit> = Vec::new();
        let mut names: Vec<&str> = variables.iter().map(|v| v.name.as_str()).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(TableError::DuplicateName {
                name: pair[0].to_owned(),
            });
        }
        for (place, variable) in variables.iter_mut().enumerate() {
            variable.value_reference = place as u32;
            if let Some(name) = &variable.unit
                && !units.iter().any(|unit| unit.name == *name)
            {
                units.push(Unit::parse(name).map_err(|source| TableError::Unit {
                    variable: variable.name.clone(),
                    source,
                })?);
            }
        }
        Ok(Self { variables, units })
    }

    /// All rows, in order of value reference.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// The definitions of all units that the rows use, each once.
    pub fn units(&self) -> &[Unit] {
        &self.units
    }

    /// The row with this value reference.
    #[inline]
    pub fn get(&self, value_reference: u32) -> Option<&Variable> {
        self.variables.get(value_reference as usize)
    }

    /// The row with this name.
    pub fn find(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|variable| variable.name == name)
    }

    /// The derivatives of the continuous states, in the order of these; none where the component is for co-simulation only.
    pub fn derivatives(&self) -> impl Iterator<Item = &Variable> {
        self.variables
            .iter()
            .filter(|variable| variable.derivative_of.is_some())
    }

    /// The continuous states, in order.
    pub fn states(&self) -> impl Iterator<Item = &Variable> {
        self.derivatives()
            .filter_map(|derivative| self.get(derivative.derivative_of?))
    }

    /// The event indicators, in order.
    pub fn event_indicators(&self) -> impl Iterator<Item = &Variable> {
        self.variables
            .iter()
            .filter(|variable| variable.event_indicator)
    }

    /// The outputs, in order.
    pub fn outputs(&self) -> impl Iterator<Item = &Variable> {
        self.variables
            .iter()
            .filter(|v| v.causality == Causality::Output)
    }
}

/// A table that contradicts itself.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// Two variables share a name.
    #[error("two variables are called \"{name}\"; every name may occur once")]
    DuplicateName {
        /// The shared name.
        name: String,
    },
    /// A unit cannot be expressed in SI base units.
    #[error("variable \"{variable}\": {source}")]
    Unit {
        /// The variable that uses the unit.
        variable: String,
        /// What is wrong with the unit.
        source: UnitError,
    },
}
