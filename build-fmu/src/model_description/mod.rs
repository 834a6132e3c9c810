//! `modelDescription.xml` of both standards and `terminalsAndIcons.xml`, written from the variable table.

mod common;
mod date;
mod facts;
mod fmi2;
mod fmi3;
mod quantity;
mod terminals;
mod xml;

pub use date::{DateError, SOURCE_DATE_EPOCH, generation_date};
pub use facts::Facts;
pub use quantity::{QuantityType, quantity_type};
pub use terminals::terminals_and_icons;
pub use xml::XmlError;
pub(crate) use xml::{Attributes, Document, number};

use crate::platform::FmiVersion;

/// The model description for one version of the standard, as UTF-8 text that ends with a newline.
///
/// # Errors
/// [`XmlError`] if the XML writer fails.
pub fn model_description(facts: &Facts<'_>, version: FmiVersion) -> Result<String, XmlError> {
    match version {
        FmiVersion::Fmi2 => fmi2::write(facts),
        FmiVersion::Fmi3 => fmi3::write(facts),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::cosim::{
        Causality, DefaultExperiment, Identity, Initial, Variability, Variable, VariableTable,
        VariableType,
    };

    const IDENTITY: Identity = Identity {
        model_identifier: "Sample",
        description: "Friction < stiction & \"slip\"",
        default_experiment: DefaultExperiment {
            start_time: 0.0,
            stop_time: 60.0,
            tolerance: 1e-9,
            step_size: 0.01,
        },
    };

    fn variable(name: &str, causality: Causality, variability: Variability) -> Variable {
        Variable {
            value_reference: 0,
            name: name.to_owned(),
            variable_type: VariableType::Real,
            causality,
            variability,
            initial: None,
            unit: None,
            display_unit: None,
            start: None,
            minimum: None,
            above_minimum: false,
            maximum: None,
            nominal: None,
            description: format!("{name} of the sample"),
            alias_of: None,
            derivative_of: None,
            reinit: false,
            event_indicator: false,
            dependencies: Vec::new(),
            initial_dependencies: Vec::new(),
        }
    }

    fn sample() -> VariableTable {
        let unit = |name: &str| Some(name.to_owned());
        VariableTable::new(vec![
            Variable {
                unit: unit("s"),
                ..variable("time", Causality::Independent, Variability::Continuous)
            },
            Variable {
                unit: unit("N"),
                start: Some(50.0),
                ..variable("N2", Causality::Input, Variability::Continuous)
            },
            Variable {
                unit: unit("rad/s"),
                display_unit: Some("rpm"),
                initial: Some(Initial::Exact),
                start: Some(0.0),
                ..variable("theta_dot", Causality::Output, Variability::Continuous)
            },
            Variable {
                unit: unit("N.m"),
                initial: Some(Initial::Calculated),
                dependencies: vec![1],
                initial_dependencies: vec![1, 2],
                ..variable("T_f", Causality::Output, Variability::Continuous)
            },
            Variable {
                variable_type: VariableType::Boolean,
                initial: Some(Initial::Calculated),
                initial_dependencies: vec![1, 2],
                ..variable("stuck", Causality::Local, Variability::Discrete)
            },
        ])
        .unwrap()
    }

    fn written(version: FmiVersion) -> String {
        let table = sample();
        let facts = Facts {
            identity: &IDENTITY,
            token: "{1}",
            table: &table,
            generated: None,
        };
        model_description(&facts, version).unwrap()
    }

    #[test]
    fn fmi2_counts_variables_from_1_and_lists_no_locals_among_the_unknowns() {
        let xml = written(FmiVersion::Fmi2);
        let structure = &xml[xml.find("<ModelStructure>").unwrap()..];
        assert_eq!(
            structure,
            "<ModelStructure>\n    <Outputs>\n      <Unknown index=\"3\" dependencies=\"\"/>\n      \
             <Unknown index=\"4\" dependencies=\"2\"/>\n    </Outputs>\n    <InitialUnknowns>\n      \
             <Unknown index=\"4\" dependencies=\"2 3\"/>\n    </InitialUnknowns>\n  </ModelStructure>\n\
             </fmiModelDescription>\n"
        );
    }

    #[test]
    fn fmi3_uses_value_references() {
        let xml = written(FmiVersion::Fmi3);
        let structure = &xml[xml.find("<ModelStructure>").unwrap()..];
        assert_eq!(
            structure,
            "<ModelStructure>\n    <Output valueReference=\"2\" dependencies=\"\"/>\n    \
             <Output valueReference=\"3\" dependencies=\"1\"/>\n    \
             <InitialUnknown valueReference=\"3\" dependencies=\"1 2\"/>\n  </ModelStructure>\n\
             </fmiModelDescription>\n"
        );
    }

    #[test]
    fn units_types_and_text_are_written() {
        for version in FmiVersion::ALL {
            let xml = written(version);
            assert!(
                xml.contains("description=\"Friction &lt; stiction &amp; &quot;slip&quot;\""),
                "{xml}"
            );
            assert!(
                xml.contains("<BaseUnit kg=\"1\" m=\"2\" s=\"-2\"/>"),
                "{xml}"
            );
            assert!(
                xml.contains("<DisplayUnit name=\"rpm\" factor=\"9.549296585513721\"/>"),
                "{xml}"
            );
            assert!(xml.contains("declaredType=\"AngularVelocity\""), "{xml}");
            assert!(!xml.contains("generationDateAndTime"), "{xml}");
        }
    }

    #[test]
    fn a_date_is_written_if_there_is_one() {
        let table = sample();
        let facts = Facts {
            identity: &IDENTITY,
            token: "{1}",
            table: &table,
            generated: Some("2026-11-24T23:59:59Z"),
        };
        for version in FmiVersion::ALL {
            let xml = model_description(&facts, version).unwrap();
            let date = "generationDateAndTime=\"2026-11-24T23:59:59Z\"";
            assert!(xml.contains(date), "{xml}");
        }
    }

    #[test]
    fn terminals_hold_only_variables_of_the_model() {
        let table = sample();
        let facts = Facts {
            identity: &IDENTITY,
            token: "{1}",
            table: &table,
            generated: None,
        };
        let xml = terminals_and_icons(&facts).unwrap();
        assert!(xml.contains("<Terminal name=\"disc\"") && xml.contains("variableName=\"T_f\""));
        assert!(
            !xml.contains("armature") && !xml.contains("theta3"),
            "{xml}"
        );
    }
}
