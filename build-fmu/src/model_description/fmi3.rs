//! FMI 3.0.2 `modelDescription.xml`.

use stickslip::cosim::{MAX_OUTPUT_DERIVATIVE_ORDER, Variable, VariableType};

use super::common::{boolean_start, default_experiment, log_categories, roles, unit_definitions};
use super::facts::{Facts, generation_tool};
use super::quantity::quantity_type;
use super::xml::{Attributes, Document, XmlError};

pub(super) fn write(facts: &Facts<'_>) -> Result<String, XmlError> {
    // No generationDateAndTime: the same model gives the same bytes on every day.
    let root = Attributes::new()
        .text("fmiVersion", "3.0")
        .text("modelName", facts.identity.model_identifier)
        .text("instantiationToken", facts.token)
        .text("description", facts.identity.description)
        .text("version", env!("CARGO_PKG_VERSION"))
        .text("license", env!("CARGO_PKG_LICENSE"))
        .text("generationTool", generation_tool())
        .text("variableNamingConvention", "structured");
    let mut document = Document::new()?;
    document.element("fmiModelDescription", root, |xml| {
        xml.leaf("CoSimulation", capability_flags(facts))?;
        unit_definitions(xml, facts)?;
        type_definitions(xml, facts)?;
        log_categories(xml)?;
        default_experiment(xml, facts)?;
        xml.element("ModelVariables", Attributes::new(), |xml| {
            facts
                .table
                .variables()
                .iter()
                .try_for_each(|row| variable(xml, row))
        })?;
        model_structure(xml, facts)
    })?;
    document.finish()
}

fn capability_flags(facts: &Facts<'_>) -> Attributes {
    Attributes::new()
        .text("modelIdentifier", facts.identity.model_identifier)
        .flag("canGetAndSetFMUState", true)
        .flag("canSerializeFMUState", true)
        .flag("providesDirectionalDerivatives", true)
        .flag("canHandleVariableCommunicationStepSize", true)
        .text(
            "maxOutputDerivativeOrder",
            MAX_OUTPUT_DERIVATIVE_ORDER.to_string(),
        )
        .flag("mightReturnEarlyFromDoStep", true)
        .flag("hasEventMode", true)
}

fn type_definitions(xml: &mut Document, facts: &Facts<'_>) -> Result<(), XmlError> {
    xml.element("TypeDefinitions", Attributes::new(), |xml| {
        facts.types().iter().try_for_each(|(unit, quantity)| {
            let attributes = Attributes::new()
                .text("name", quantity.name)
                .text("description", quantity.description)
                .text("quantity", quantity.quantity)
                .text("unit", *unit);
            xml.leaf("Float64Type", attributes)
        })
    })
}

fn variable(xml: &mut Document, variable: &Variable) -> Result<(), XmlError> {
    let head = Attributes::new()
        .text("name", &variable.name)
        .text("valueReference", variable.value_reference.to_string())
        .text("description", &variable.description);
    let head = roles(head, variable);
    match variable.variable_type {
        VariableType::Real => {
            let declared = variable.unit.as_deref().and_then(quantity_type);
            let attributes = head
                .optional_text("declaredType", declared.map(|quantity| quantity.name))
                .optional_text("unit", variable.unit.as_deref())
                .optional_text("displayUnit", variable.display_unit)
                .optional_number("min", variable.minimum)
                .optional_number("max", variable.maximum)
                .optional_number("nominal", variable.nominal)
                .optional_number("start", variable.start);
            xml.leaf("Float64", attributes)
        }
        VariableType::Boolean => xml.leaf(
            "Boolean",
            head.optional_text("start", boolean_start(variable.start)),
        ),
    }
}

fn model_structure(xml: &mut Document, facts: &Facts<'_>) -> Result<(), XmlError> {
    xml.element("ModelStructure", Attributes::new(), |xml| {
        facts
            .table
            .outputs()
            .try_for_each(|output| unknown(xml, "Output", output, &output.dependencies))?;
        facts.initial_unknowns().try_for_each(|variable| {
            unknown(
                xml,
                "InitialUnknown",
                variable,
                &variable.initial_dependencies,
            )
        })
    })
}

fn unknown(
    xml: &mut Document,
    element: &str,
    variable: &Variable,
    dependencies: &[u32],
) -> Result<(), XmlError> {
    let attributes = Attributes::new()
        .text("valueReference", variable.value_reference.to_string())
        .list("dependencies", dependencies.iter().copied());
    xml.leaf(element, attributes)
}
