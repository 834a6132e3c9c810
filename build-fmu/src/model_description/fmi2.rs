//! FMI 2.0.5 `modelDescription.xml`.

use stickslip::cosim::{MAX_OUTPUT_DERIVATIVE_ORDER, Variable, VariableType};

use super::common::{boolean_start, default_experiment, log_categories, roles, unit_definitions};
use super::facts::{Facts, generation_tool, index};
use super::quantity::quantity_type;
use super::xml::{Attributes, Document, XmlError};

pub(super) fn write(facts: &Facts<'_>) -> Result<String, XmlError> {
    // No generationDateAndTime: the same model gives the same bytes on every day.
    let root = Attributes::new()
        .text("fmiVersion", "2.0")
        .text("modelName", facts.identity.model_identifier)
        .text("guid", facts.token)
        .text("description", facts.identity.description)
        .text("version", env!("CARGO_PKG_VERSION"))
        .text("license", env!("CARGO_PKG_LICENSE"))
        .text("generationTool", generation_tool())
        .text("variableNamingConvention", "structured")
        .text("numberOfEventIndicators", "0");
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
                .try_for_each(|variable| scalar_variable(xml, variable))
        })?;
        model_structure(xml, facts)
    })?;
    document.finish()
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
    let head = Attributes::new()
        .text("name", &variable.name)
        .text("valueReference", variable.value_reference.to_string())
        .text("description", &variable.description);
    xml.element(
        "ScalarVariable",
        roles(head, variable),
        |xml| match variable.variable_type {
            VariableType::Real => {
                let declared = variable.unit.as_deref().and_then(quantity_type);
                let attributes = Attributes::new()
                    .optional_text("declaredType", declared.map(|quantity| quantity.name))
                    .optional_text("unit", variable.unit.as_deref())
                    .optional_text("displayUnit", variable.display_unit)
                    .optional_number("min", variable.minimum)
                    .optional_number("max", variable.maximum)
                    .optional_number("nominal", variable.nominal)
                    .optional_number("start", variable.start);
                xml.leaf("Real", attributes)
            }
            VariableType::Boolean => xml.leaf(
                "Boolean",
                Attributes::new().optional_text("start", boolean_start(variable.start)),
            ),
        },
    )
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
