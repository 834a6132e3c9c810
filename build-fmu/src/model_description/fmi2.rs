//! FMI 2.0.5 `modelDescription.xml`.

use stickslip::cosim::{Causality, MAX_OUTPUT_DERIVATIVE_ORDER, Variable, VariableType};

use super::common::{Dialect, boolean_start, description, head, real};
use super::facts::{Facts, index};
use super::xml::{Attributes, Document, XmlError};

pub(super) fn write(facts: &Facts<'_>) -> Result<String, XmlError> {
    let dialect = Dialect {
        version: "2.0",
        token: "guid",
        root: |root| root.text("numberOfEventIndicators", "0"),
        capability_flags,
        type_definitions,
        variable: scalar_variable,
        further_variables: aliases,
        model_structure,
    };
    description(facts, &dialect)
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
    let typed = |xml: &mut Document| match variable.variable_type {
        VariableType::Real => xml.leaf("Real", real(Attributes::new(), variable)),
        VariableType::Boolean => xml.leaf(
            "Boolean",
            Attributes::new().optional_text("start", boolean_start(variable.start)),
        ),
    };
    xml.element("ScalarVariable", head(variable), typed)
}

/// Second names as variables that share the value reference; only the first of such a set has a start value.
fn aliases(facts: &Facts<'_>) -> Vec<Variable> {
    let variables = facts.table.variables().iter();
    variables
        .filter_map(|variable| {
            Some(Variable {
                name: variable.alias?.to_owned(),
                causality: Causality::Local,
                initial: None,
                start: None,
                ..variable.clone()
            })
        })
        .collect()
}

fn model_structure(xml: &mut Document, facts: &Facts<'_>) -> Result<(), XmlError> {
    xml.element("ModelStructure", Attributes::new(), |xml| {
        xml.element("Outputs", Attributes::new(), |xml| {
            facts
                .table
                .outputs()
                .try_for_each(|output| unknown(xml, output, &output.dependencies))
        })?;
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
