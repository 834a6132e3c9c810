//! FMI 2.0.5 `modelDescription.xml`.

use stickslip::cosim::{MAX_OUTPUT_DERIVATIVE_ORDER, Variable, VariableType};

use super::common::{Dialect, boolean_start, description, head, real};
use super::facts::{Facts, index};
use super::xml::{Attributes, Document, XmlError};

pub(super) fn write(facts: &Facts<'_>) -> Result<String, XmlError> {
    let dialect = Dialect {
        version: "2.0",
        token: "guid",
        root: |root, facts| {
            let indicators = facts.table.event_indicators().count();
            root.text("numberOfEventIndicators", indicators.to_string())
        },
        model_exchange_flags,
        capability_flags,
        type_definitions,
        // Their number says all. They are the last rows, so that places stay what they are.
        lists: |row| !row.event_indicator,
        variable: scalar_variable,
        model_structure,
    };
    description(facts, &dialect)
}

fn model_exchange_flags(facts: &Facts<'_>) -> Attributes {
    Attributes::new()
        .text("modelIdentifier", facts.identity.model_identifier)
        .flag("canNotUseMemoryManagementFunctions", true)
        .flag("canGetAndSetFMUstate", true)
        .flag("canSerializeFMUstate", true)
        .flag("providesDirectionalDerivative", true)
}

fn capability_flags(facts: &Facts<'_>) -> Attributes {
    Attributes::new()
        .text("modelIdentifier", facts.identity.model_identifier)
        .flag("canHandleVariableCommunicationStepSize", true)
        .flag("canInterpolateInputs", true)
        .text(
            "maxOutputDerivativeOrder",
            MAX_OUTPUT_DERIVATIVE_ORDER.to_string(),
        )
        .flag("canNotUseMemoryManagementFunctions", true)
        .flag("canGetAndSetFMUstate", true)
        .flag("canSerializeFMUstate", true)
        .flag("providesDirectionalDerivative", true)
}

fn type_definitions(xml: &mut Document, facts: &Facts<'_>) -> Result<(), XmlError> {
    xml.element("TypeDefinitions", Attributes::new(), |xml| {
        facts.types().iter().try_for_each(|(unit, quantity)| {
            let simple_type = Attributes::new()
                .text("name", quantity.name)
                .text("description", quantity.description);
            xml.element("SimpleType", simple_type, |xml| {
                xml.leaf(
                    "Real",
                    Attributes::new()
                        .text("quantity", quantity.quantity)
                        .text("unit", *unit),
                )
            })
        })
    })
}

fn scalar_variable(xml: &mut Document, variable: &Variable) -> Result<(), XmlError> {
    let mut second;
    let mut variable = variable;
    if let Some(first) = variable.alias_of {
        // Variables that share a value reference are aliases; only the first of such a set has a start value.
        second = variable.clone();
        (second.value_reference, second.initial) = (first, None);
        variable = &second;
    }
    let typed = |xml: &mut Document| match variable.variable_type {
        VariableType::Real => {
            let derivative = variable.derivative_of.map(|state| index(state).to_string());
            let attributes = real(Attributes::new(), variable)
                .optional_text("derivative", derivative.as_deref());
            let reinit = variable.reinit.then_some("true");
            xml.leaf("Real", attributes.optional_text("reinit", reinit))
        }
        VariableType::Boolean => xml.leaf(
            "Boolean",
            Attributes::new().optional_text("start", boolean_start(variable.start)),
        ),
    };
    xml.element("ScalarVariable", head(variable), typed)
}

fn model_structure(xml: &mut Document, facts: &Facts<'_>) -> Result<(), XmlError> {
    xml.element("ModelStructure", Attributes::new(), |xml| {
        xml.element("Outputs", Attributes::new(), |xml| {
            facts
                .table
                .outputs()
                .try_for_each(|output| unknown(xml, output, &output.dependencies))
        })?;
        if facts.table.derivatives().next().is_some() {
            xml.element("Derivatives", Attributes::new(), |xml| {
                let mut derivatives = facts.table.derivatives();
                derivatives.try_for_each(|variable| unknown(xml, variable, &variable.dependencies))
            })?;
        }
        if facts.initial_unknowns().next().is_none() {
            return Ok(());
        }
        xml.element("InitialUnknowns", Attributes::new(), |xml| {
            facts
                .initial_unknowns()
                .try_for_each(|variable| unknown(xml, variable, &variable.initial_dependencies))
        })
    })
}

fn unknown(xml: &mut Document, variable: &Variable, dependencies: &[u32]) -> Result<(), XmlError> {
    let attributes = Attributes::new()
        .text("index", index(variable.value_reference).to_string())
        .list(
            "dependencies",
            dependencies.iter().map(|reference| index(*reference)),
        );
    xml.leaf("Unknown", attributes)
}
