//! Everything that a model description says besides its form.

use stickslip::cosim::{Identity, Initial, Variable, VariableTable};

use super::quantity::{QuantityType, quantity_type};

/// What the XML of either standard is written from.
#[derive(Debug, Clone, Copy)]
pub struct Facts<'a> {
    /// Model identifier, description and default experiment.
    pub identity: &'a Identity,
    /// `guid` in FMI 2, `instantiationToken` in FMI 3.
    pub token: &'a str,
    /// The one variable table.
    pub table: &'a VariableTable,
    /// `generationDateAndTime`; `None`: the XML has none.
    pub generated: Option<&'a str>,
}

impl Facts<'_> {
    /// The quantity types that the variables use, each once, in the order of the units.
    pub(super) fn types(&self) -> Vec<(&str, QuantityType)> {
        let units = self.table.units().iter();
        units
            .filter_map(|unit| Some((unit.name.as_str(), quantity_type(&unit.name)?)))
            .collect()
    }

    /// Outputs and derivatives whose first value is calculated: both standards list these unknowns of the initialisation, and
    /// no other locals.
    pub(super) fn initial_unknowns(&self) -> impl Iterator<Item = &Variable> {
        self.table
            .outputs()
            .chain(self.table.derivatives())
            .filter(|variable| variable.initial == Some(Initial::Calculated))
    }
}

/// Place of a variable in `ModelVariables`, counted from 1 as FMI 2 does; the table numbers from 0.
pub(super) fn index(value_reference: u32) -> u32 {
    value_reference + 1
}

/// Name of the tool as written into the XML.
pub(super) fn generation_tool() -> String {
    format!("stickslip build-fmu {}", env!("CARGO_PKG_VERSION"))
}
