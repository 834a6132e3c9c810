//! `SystemStructure.ssd` of SSP 1.0 and 2.0, which share their namespaces.

use stickslip::cosim::{Causality, Variable, VariableType};

use super::SspVersion;
use super::system::System;
use crate::model_description::{Attributes, Document, XmlError};
use crate::platform::FmiVersion;

const NAMESPACE: &str = "http://ssp-standard.org/SSP1/SystemStructure";
/// Namespace of OMSimulator's own annotations.
const OMS_NAMESPACE: &str =
    "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd";
/// Communication step [s] of connected components: the stiffest loop of ours needs it (docs/closed-loop.md).
const LOOP_STEP: f64 = 0.0005;

/// What depends on the versions of both standards.
#[derive(Clone, Copy)]
struct Versions {
    fmi: FmiVersion,
    ssp: SspVersion,
}

impl Versions {
    /// Name of the elements for real numbers: FMI 3's own type is one of SSP 2.0 only.
    fn real(self) -> &'static str {
        match (self.fmi, self.ssp) {
            (FmiVersion::Fmi3, SspVersion::Two) => "Float64",
            _ => "Real",
        }
    }
}

/// The description of a system whose components are FMUs of this version.
pub(super) fn write(system: &System, fmi: FmiVersion, ssp: SspVersion) -> Result<String, XmlError> {
    let versions = Versions { fmi, ssp };
    let root = Attributes::new()
        .text("xmlns:ssd", format!("{NAMESPACE}Description"))
        .text("xmlns:ssc", format!("{NAMESPACE}Common"))
        .text("xmlns:ssv", format!("{NAMESPACE}ParameterValues"))
        .text("xmlns:oms", OMS_NAMESPACE)
        .text("version", ssp.number())
        .text("name", system.name())
        .text(
            "generationTool",
            concat!("stickslip build-fmu ", env!("CARGO_PKG_VERSION")),
        );
    let mut document = Document::new()?;
    document.element("ssd:SystemStructureDescription", root, |xml| {
        let name = Attributes::new().text("name", "system");
        xml.element("ssd:System", name, |xml| {
            if system.is_exposed() {
                xml.element("ssd:Connectors", Attributes::new(), |xml| {
                    let outputs = system.all(Causality::Output);
                    let mut ends = system.free_inputs().chain(outputs);
                    ends.try_for_each(|(_, variable)| connector(xml, variable, versions))
                })?;
                // Without values of their own, the system's inputs overwrite the components' starts in OMSimulator.
                parameter_bindings(xml, &system.input_starts().collect::<Vec<_>>(), versions)?;
            }
            xml.element("ssd:Elements", Attributes::new(), |xml| {
                (0..system.components().len())
                    .try_for_each(|place| component(xml, system, place, versions))
            })?;
            if system.has_connections() {
                xml.element("ssd:Connections", Attributes::new(), |xml| {
                    connections(xml, system)
                })?;
            }
            master(xml, system)
        })?;
        units(xml, system)?;
        let stop_time = system
            .components()
            .iter()
            .map(|source| source.facts().identity.default_experiment.stop_time)
            .fold(0.0, f64::max);
        let experiment = Attributes::new()
            .number("startTime", 0.0)
            .number("stopTime", stop_time);
        xml.leaf("ssd:DefaultExperiment", experiment)
    })?;
    document.finish()
}

/// Definitions of all units of connectors, each once.
fn units(xml: &mut Document, system: &System) -> Result<(), XmlError> {
    let connectors = || {
        let inputs = system.all(Causality::Input);
        inputs.chain(system.all(Causality::Output))
    };
    let mut written = Vec::new();
    xml.element("ssd:Units", Attributes::new(), |xml| {
        for (place, variable) in connectors() {
            let units = system.table(place).units();
            let used = units
                .iter()
                .find(|unit| Some(&unit.name) == variable.unit.as_ref());
            let Some(unit) = used.filter(|unit| !written.contains(&unit.name)) else {
                continue;
            };
            written.push(unit.name.clone());
            let name = Attributes::new().text("name", &unit.name);
            xml.element("ssc:Unit", name, |xml| {
                let exponents = unit.base.attributes();
                let base = exponents.fold(Attributes::new(), |list, (name, exponent)| {
                    list.text(name, exponent.to_string())
                });
                xml.leaf("ssc:BaseUnit", base)
            })?;
        }
        Ok(())
    })
}

fn connector(xml: &mut Document, variable: &Variable, versions: Versions) -> Result<(), XmlError> {
    let attributes = Attributes::new()
        .text("name", &variable.name)
        .text("kind", variable.causality.xml());
    xml.element("ssd:Connector", attributes, |xml| {
        match variable.variable_type {
            VariableType::Real => {
                let unit = Attributes::new().optional_text("unit", variable.unit.as_deref());
                xml.leaf(&format!("ssc:{}", versions.real()), unit)
            }
            VariableType::Boolean => xml.leaf("ssc:Boolean", Attributes::new()),
        }
    })
}

fn component(
    xml: &mut Document,
    system: &System,
    place: usize,
    versions: Versions,
) -> Result<(), XmlError> {
    let file = system.components()[place].fmu_file_name(versions.fmi);
    let attributes = Attributes::new()
        .text("name", system.component_name(place))
        .text("type", "application/x-fmu-sharedlibrary")
        .text("source", format!("resources/{file}"));
    xml.element("ssd:Component", attributes, |xml| {
        xml.element("ssd:Connectors", Attributes::new(), |xml| {
            let variables = system.table(place).variables().iter();
            variables
                .filter(|v| matches!(v.causality, Causality::Input | Causality::Output))
                .try_for_each(|variable| connector(xml, variable, versions))
        })?;
        parameter_bindings(xml, &system.starts(place).collect::<Vec<_>>(), versions)
    })
}

/// `ParameterBindings` with these values, if there are any.
fn parameter_bindings(
    xml: &mut Document,
    starts: &[(&Variable, f64)],
    versions: Versions,
) -> Result<(), XmlError> {
    if starts.is_empty() {
        return Ok(());
    }
    let set = Attributes::new()
        .text("version", versions.ssp.number())
        .text("name", "start_values");
    let real = format!("ssv:{}", versions.real());
    xml.element("ssd:ParameterBindings", Attributes::new(), |xml| {
        xml.element("ssd:ParameterBinding", Attributes::new(), |xml| {
            xml.element("ssd:ParameterValues", Attributes::new(), |xml| {
                xml.element("ssv:ParameterSet", set, |xml| {
                    xml.element("ssv:Parameters", Attributes::new(), |xml| {
                        starts.iter().try_for_each(|(variable, value)| {
                            let name = Attributes::new().text("name", &variable.name);
                            xml.element("ssv:Parameter", name, |xml| {
                                xml.leaf(&real, Attributes::new().number("value", *value))
                            })
                        })
                    })
                })
            })
        })
    })
}

/// What OMSimulator's command line has to be told by the archive itself: that the system is one of co-simulation, its
/// step and the tolerance that the components are set up with. Others pass over the annotation.
fn master(xml: &mut Document, system: &System) -> Result<(), XmlError> {
    let experiments = || {
        let sources = system.components().iter();
        sources.map(|source| source.facts().identity.default_experiment)
    };
    let single = experiments().nth(1).is_none();
    let own_step = experiments()
        .map(|e| e.step_size)
        .fold(f64::INFINITY, f64::min);
    let tolerance = experiments()
        .map(|e| e.tolerance)
        .fold(f64::INFINITY, f64::min);
    let solver = Attributes::new()
        .text("description", "oms-ma")
        .number(
            "stepSize",
            if single {
                own_step
            } else {
                LOOP_STEP.min(own_step)
            },
        )
        .number("relativeTolerance", tolerance);
    let vendor = Attributes::new().text("type", "org.openmodelica");
    xml.element("ssd:Annotations", Attributes::new(), |xml| {
        xml.element("ssc:Annotation", vendor, |xml| {
            xml.element("oms:SimulationInformation", Attributes::new(), |xml| {
                xml.leaf("oms:FixedStepMaster", solver)
            })
        })
    })
}

fn connections(xml: &mut Document, system: &System) -> Result<(), XmlError> {
    for connection in system.connections() {
        let attributes = Attributes::new()
            .text("startElement", system.component_name(connection.from))
            .text("startConnector", &connection.variable)
            .text("endElement", system.component_name(connection.to))
            .text("endConnector", &connection.variable);
        xml.leaf("ssd:Connection", attributes)?;
    }
    if !system.is_exposed() {
        return Ok(());
    }
    for (place, input) in system.free_inputs() {
        let attributes = Attributes::new()
            .text("startConnector", &input.name)
            .text("endElement", system.component_name(place))
            .text("endConnector", &input.name);
        xml.leaf("ssd:Connection", attributes)?;
    }
    for (place, output) in system.all(Causality::Output) {
        let attributes = Attributes::new()
            .text("startElement", system.component_name(place))
            .text("startConnector", &output.name)
            .text("endConnector", &output.name);
        xml.leaf("ssd:Connection", attributes)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::Source;

    const RIG: &str = include_str!("../../../modelDescription/reduced-rig.toml");

    fn written(fmi: FmiVersion, ssp: SspVersion) -> String {
        let source = Source::from_text(RIG.to_owned(), "rig.toml").unwrap();
        let mut system = System::new(vec![source]).unwrap();
        system.start("N2", 50.0).unwrap();
        system.expose();
        write(&system, fmi, ssp).unwrap()
    }

    #[test]
    fn version_2_differs_in_its_number_and_in_the_reals_of_fmi_3() {
        for fmi in FmiVersion::ALL {
            let newer = written(fmi, SspVersion::Two);
            let numbers = newer.matches(" version=\"2.0\"").count();
            assert_eq!(numbers, 3, "the description and two sets of parameters");
            let reals = newer.matches("Float64").count();
            assert_eq!(reals > 0, fmi == FmiVersion::Fmi3);
            let older = newer
                .replace(" version=\"2.0\"", " version=\"1.0\"")
                .replace(":Float64", ":Real");
            assert_eq!(older, written(fmi, SspVersion::One));
        }
    }
}
