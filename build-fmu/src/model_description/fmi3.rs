//! FMI 3.0.2 `modelDescription.xml`.

use stickslip::cosim::{Causality, MAX_OUTPUT_DERIVATIVE_ORDER, Variable, VariableType};

use super::common::{Dialect, boolean_start, description, head, real};
use super::facts::Facts;
use super::xml::{Attributes, Document, XmlError};

pub(super) fn write(facts: &Facts<'_>) -> Result<String, XmlError> {
    let dialect = Dialect {
        version: "3.0",
        token: "instantiationToken",
        root: |root, _| root,
        model_exchange_flags,
        capability_flags,
        type_definitions,
        lists: |_| true,
        variable,
        model_structure,
    };
    description(facts, &dialect)
}

fn model_exchange_flags(facts: &Facts<'_>) -> Attributes {
    Attributes::new()
        .text("modelIdentifier", facts.identity.model_identifier)
        // Where a law has several branches, which one is followed is remembered from step to step.
        .flag("needsCompletedIntegratorStep", true)
        .flag("canGetAndSetFMUState", true)
        .flag("canSerializeFMUState", true)
        .flag("providesDirectionalDerivatives", true)
        .flag("providesAdjointDerivatives", true)
}

fn capability_flags(facts: &Facts<'_>) -> Attributes {
    Attributes::new()
        .text("modelIdentifier", facts.identity.model_identifier)
        .flag("canGetAndSetFMUState", true)
        .flag("canSerializeFMUState", true)
        .flag("providesDirectionalDerivatives", true)
        .flag("providesAdjointDerivatives", true)
        .flag("canHandleVariableCommunicationStepSize", true)
        .text(
            "maxOutputDerivativeOrder",
            MAX_OUTPUT_DERIVATIVE_ORDER.to_string(),
        )
        .flag("providesIntermediateUpdate", true)
        .flag("mightReturnEarlyFromDoStep", true)
        .flag("canReturnEarlyAfterIntermediateUpdate", true)
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
    let readable_within_steps = variable.causality == Causality::Output;
    let head = head(variable).optional_text(
        "intermediateUpdate",
        readable_within_steps.then_some("true"),
    );
    match variable.variable_type {
        VariableType::Real => {
            let derivative = variable.derivative_of.map(|state| state.to_string());
            let attributes =
                real(head, variable).optional_text("derivative", derivative.as_deref());
            let reinit = variable.reinit.then_some("true");
            xml.leaf("Float64", attributes.optional_text("reinit", reinit))
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
        facts.table.derivatives().try_for_each(|variable| {
            let element = "ContinuousStateDerivative";
            unknown(xml, element, variable, &variable.dependencies)
        })?;
        facts.initial_unknowns().try_for_each(|variable| {
            unknown(
                xml,
                "InitialUnknown",
                variable,
                &variable.initial_dependencies,
            )
        })?;
        facts.table.event_indicators().try_for_each(|variable| {
            let reference = variable.value_reference.to_string();
            xml.leaf(
                "EventIndicator",
                Attributes::new().text("valueReference", reference),
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
