//! Parts that both standards write the same way.

use stickslip::cosim::{LOG_CATEGORIES, Variable};

use super::facts::Facts;
use super::xml::{Attributes, Document, XmlError};

/// `UnitDefinitions`: SI exponents and display units of every unit that a variable uses.
pub(super) fn unit_definitions(xml: &mut Document, facts: &Facts<'_>) -> Result<(), XmlError> {
    xml.element("UnitDefinitions", Attributes::new(), |xml| {
        facts.table.units().iter().try_for_each(|unit| {
            xml.element("Unit", Attributes::new().text("name", &unit.name), |xml| {
                let exponents = unit
                    .base
                    .attributes()
                    .fold(Attributes::new(), |list, (name, exponent)| {
                        list.text(name, exponent.to_string())
                    });
                xml.leaf("BaseUnit", exponents)?;
                unit.display_units.iter().try_for_each(|display| {
                    let attributes = Attributes::new()
                        .text("name", display.name)
                        .number("factor", display.factor);
                    xml.leaf("DisplayUnit", attributes)
                })
            })
        })
    })
}

/// `DefaultExperiment`: what an importer runs if nobody says otherwise.
pub(super) fn default_experiment(xml: &mut Document, facts: &Facts<'_>) -> Result<(), XmlError> {
    let experiment = facts.identity.default_experiment;
    let attributes = Attributes::new()
        .number("startTime", experiment.start_time)
        .number("stopTime", experiment.stop_time)
        .number("tolerance", experiment.tolerance)
        .number("stepSize", experiment.step_size);
    xml.leaf("DefaultExperiment", attributes)
}

/// `LogCategories`, names as the library logs them.
pub(super) fn log_categories(xml: &mut Document) -> Result<(), XmlError> {
    xml.element("LogCategories", Attributes::new(), |xml| {
        LOG_CATEGORIES.iter().try_for_each(|category| {
            let attributes = Attributes::new()
                .text("name", category.name)
                .text("description", category.description);
            xml.leaf("Category", attributes)
        })
    })
}

/// Causality, variability and initial, where the standards do not fix the latter.
pub(super) fn roles(attributes: Attributes, variable: &Variable) -> Attributes {
    attributes
        .text("causality", variable.causality.xml())
        .text("variability", variable.variability.xml())
        .optional_text("initial", variable.initial.map(|initial| initial.xml()))
}

/// Start value of a Boolean, which the table holds as 0 or 1.
pub(super) fn boolean_start(start: Option<f64>) -> Option<&'static str> {
    start.map(|value| if value == 0.0 { "false" } else { "true" })
}
