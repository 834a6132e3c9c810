//! `terminalsAndIcons.xml` of FMI 3: where the icon is and which variables belong to which connector.

use super::facts::Facts;
use super::xml::{Attributes, Document, XmlError};
use crate::icon::ICON_SIZE;

/// A connector: name, what it is, and its members as (variable, member) pairs.
struct Terminal {
    name: &'static str,
    description: &'static str,
    members: &'static [(&'static str, &'static str)],
}

const TERMINALS: [Terminal; 4] = [
    Terminal {
        name: "armature",
        description: "Electrical: voltage and current of the motor",
        members: &[("u", "voltage"), ("i", "current")],
    },
    Terminal {
        name: "gearbox_output",
        description: "Mechanical flange at the gearbox output",
        members: &[("theta3", "angle"), ("theta3_dot", "angular_velocity")],
    },
    Terminal {
        name: "disc",
        description: "Mechanical flange on disc D2 with its friction contact",
        members: &[
            ("theta", "angle"),
            ("theta_dot", "angular_velocity"),
            ("T_f", "friction_torque"),
            ("N2", "normal_force"),
        ],
    },
    Terminal {
        name: "disc1",
        description: "Mechanical flange on disc D1 with its friction contact",
        members: &[
            ("theta1", "angle"),
            ("theta1_dot", "angular_velocity"),
            ("T_f1", "friction_torque"),
            ("N1", "normal_force"),
        ],
    },
];

/// The file for a model; terminals without any of the model's variables are left out.
///
/// # Errors
/// [`XmlError`] if the XML writer fails.
pub fn terminals_and_icons(facts: &Facts<'_>) -> Result<String, XmlError> {
    let mut document = Document::new()?;
    let size = f64::from(ICON_SIZE);
    let corners = |attributes: Attributes| {
        attributes
            .number("x1", 0.0)
            .number("y1", 0.0)
            .number("x2", size)
            .number("y2", size)
    };
    let root = Attributes::new().text("fmiVersion", "3.0");
    document.element("fmiTerminalsAndIcons", root, |xml| {
        xml.element("GraphicalRepresentation", Attributes::new(), |xml| {
            let system = corners(Attributes::new()).number("suggestedScalingFactorTo_mm", 0.1);
            xml.leaf("CoordinateSystem", system)?;
            xml.leaf("Icon", corners(Attributes::new()))
        })?;
        xml.element("Terminals", Attributes::new(), |xml| {
            TERMINALS
                .iter()
                .try_for_each(|terminal| write_terminal(xml, facts, terminal))
        })
    })?;
    document.finish()
}

fn write_terminal(
    xml: &mut Document,
    facts: &Facts<'_>,
    terminal: &Terminal,
) -> Result<(), XmlError> {
    let mut members = terminal
        .members
        .iter()
        .filter(|(name, _)| facts.table.find(name).is_some())
        .peekable();
    if members.peek().is_none() {
        return Ok(());
    }
    let attributes = Attributes::new()
        .text("name", terminal.name)
        .text("matchingRule", "bus")
        .text("description", terminal.description);
    xml.element("Terminal", attributes, |xml| {
        members.try_for_each(|(variable, member)| {
            let attributes = Attributes::new()
                .text("variableName", *variable)
                .text("memberName", *member)
                .text("variableKind", "signal");
            xml.leaf("TerminalMemberVariable", attributes)
        })
    })
}
