//! Parts that both standards write the same way.

use stickslip::cosim::{LOG_CATEGORIES, Variable};

use super::facts::{Facts, generation_tool};
use super::quantity::quantity_type;
use super::xml::{Attributes, Document, XmlError};

/// What the standards write each in their own way.
pub(super) struct Dialect {
    /// `fmiVersion`.
    pub(super) version: &'static str,
    /// Name of the root's attribute that holds the token.
    pub(super) token: &'static str,
    /// Further attributes of the root.
    pub(super) root: fn(Attributes, &Facts<'_>) -> Attributes,
    /// Attributes of `ModelExchange`.
    pub(super) model_exchange_flags: fn(&Facts<'_>) -> Attributes,
    /// Attributes of `CoSimulation`.
    pub(super) capability_flags: fn(&Facts<'_>) -> Attributes,
    /// `TypeDefinitions`.
    pub(super) type_definitions: fn(&mut Document, &Facts<'_>) -> Result<(), XmlError>,
    /// Whether a row is among `ModelVariables`.
    pub(super) lists: fn(&Variable) -> bool,
    /// An element of `ModelVariables`.
    pub(super) variable: fn(&mut Document, &Variable) -> Result<(), XmlError>,
    /// `ModelStructure`.
    pub(super) model_structure: fn(&mut Document, &Facts<'_>) -> Result<(), XmlError>,
}

/// The whole description.
pub(super) fn description(facts: &Facts<'_>, dialect: &Dialect) -> Result<String, XmlError> {
    let root = Attributes::new()
        .text("fmiVersion", dialect.version)
        .text("modelName", facts.identity.model_identifier)
        .text(dialect.token, facts.token)
        .text("description", facts.identity.description)
        .text("version", env!("CARGO_PKG_VERSION"))
        .text("license", env!("CARGO_PKG_LICENSE"))
        .text("generationTool", generation_tool())
        .optional_text("generationDateAndTime", facts.generated)
        .text("variableNamingConvention", "structured");
    let mut document = Document::new()?;
    document.element("fmiModelDescription", (dialect.root)(root, facts), |xml| {
        if facts.table.derivatives().next().is_some() {
            xml.leaf("ModelExchange", (dialect.model_exchange_flags)(facts))?;
        }
        xml.leaf("CoSimulation", (dialect.capability_flags)(facts))?;
        unit_definitions(xml, facts)?;
        (dialect.type_definitions)(xml, facts)?;
        log_categories(xml)?;
        default_experiment(xml, facts)?;
        xml.element("ModelVariables", Attributes::new(), |xml| {
            let mut variables = facts
                .table
                .variables()
                .iter()
                .filter(|row| (dialect.lists)(row));
            variables.try_for_each(|row| (dialect.variable)(xml, row))
        })?;
        (dialect.model_structure)(xml, facts)
    })?;
    document.finish()
}

/// What every variable has: name, reference, description, causality, variability and, where the standards do not fix it,
/// initial.
pub(super) fn head(variable: &Variable) -> Attributes {
    Attributes::new()
        .text("name", &variable.name)
        .text("valueReference", variable.value_reference.to_string())
        .text("description", &variable.description)
        .text("causality", variable.causality.xml())
        .text("variability", variable.variability.xml())
        .optional_text("initial", variable.initial.map(|initial| initial.xml()))
}

/// Type, units, limits, nominal and start of a real variable.
pub(super) fn real(attributes: Attributes, variable: &Variable) -> Attributes {
    let declared = variable.unit.as_deref().and_then(quantity_type);
    attributes
        .optional_text("declaredType", declared.map(|quantity| quantity.name))
        .optional_text("unit", variable.unit.as_deref())
        .optional_text("displayUnit", variable.display_unit)
        .optional_number("min", variable.minimum)
        .optional_number("max", variable.maximum)
        .optional_number("nominal", variable.nominal)
        .optional_number("start", variable.start)
}

/// `UnitDefinitions`: SI exponents and display units of every unit that a variable uses.
fn unit_definitions(xml: &mut Document, facts: &Facts<'_>) -> Result<(), XmlError> {
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
fn default_experiment(xml: &mut Document, facts: &Facts<'_>) -> Result<(), XmlError> {
    let experiment = facts.identity.default_experiment;
    let attributes = Attributes::new()
        .number("startTime", experiment.start_time)
        .number("stopTime", experiment.stop_time)
        .number("tolerance", experiment.tolerance)
        .number("stepSize", experiment.step_size);
    xml.leaf("DefaultExperiment", attributes)
}

/// `LogCategories`, names as the library logs them.
fn log_categories(xml: &mut Document) -> Result<(), XmlError> {
    xml.element("LogCategories", Attributes::new(), |xml| {
        LOG_CATEGORIES.iter().try_for_each(|category| {
            let attributes = Attributes::new()
                .text("name", category.name)
                .text("description", category.description);
            xml.leaf("Category", attributes)
        })
    })
}

/// Start value of a Boolean, which the table holds as 0 or 1.
pub(super) fn boolean_start(start: Option<f64>) -> Option<&'static str> {
    start.map(|value| if value == 0.0 { "false" } else { "true" })
}
