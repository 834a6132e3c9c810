//! The variable table of a body.

use crate::body::{Body, CONNECTED, Dimension, FORCE, INPUTS, Kind, VOLTAGE};
use crate::cosim::part::{self, Quantity};
use crate::cosim::rows::{flag, input, parameter_row, row};
use crate::cosim::{Causality, Initial, TableError, Variable, VariableTable};

/// What a body's course computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cosim) enum Signal {
    /// Where it is.
    Position,
    /// Its velocity.
    Velocity,
    /// The friction that acts on it.
    Friction,
    /// Its acceleration.
    Acceleration,
    /// Whether friction holds it.
    Stuck,
}

/// The variable table of a body, and what each row stands for.
///
/// # Errors
/// A unit of a parameter that cannot be expressed in SI base units.
pub(super) fn body_table(body: &Body<f64>) -> Result<part::Rows<Signal>, TableError> {
    let unit = |dimension: Dimension| dimension.unit(body.kind, body.path);
    let mut rows = vec![(
        Quantity::Time,
        row("time", Causality::Independent, "s", "Simulated time"),
    )];
    match body.kind {
        Kind::Drive => {
            let text = "Force or torque that drives it, positive forward";
            let force = input("force", unit(Dimension::Force), 1.0, text);
            rows.push((Quantity::Input(FORCE), force));
        }
        Kind::Joint => {
            let text = "Voltage at the motor's terminals";
            let voltage = input("voltage", "V", 5.0, text);
            rows.push((Quantity::Input(VOLTAGE), voltage));
            let connected = Variable {
                start: Some(1.0),
                minimum: Some(0.0),
                maximum: Some(1.0),
                ..input(
                    "connected",
                    "1",
                    1.0,
                    "1 where the motor's terminals are connected, 0 where they are open",
                )
            };
            rows.push((Quantity::Input(CONNECTED), connected));
        }
        _ => {}
    }
    let of_unit = |name: &str, dimension: Dimension, text: &str| {
        let unit = unit(dimension);
        Variable {
            initial: Some(Initial::Calculated),
            display_unit: match unit {
                "rad/s" => Some("rpm"),
                "rad" => Some("deg"),
                _ => None,
            },
            ..row(name, Causality::Output, unit, text)
        }
    };
    let state = |name: &str, dimension: Dimension, text: &str| Variable {
        initial: Some(Initial::Exact),
        start: Some(0.0),
        ..of_unit(name, dimension, text)
    };
    rows.push((
        Quantity::Signal(Signal::Position),
        state("position", Dimension::Position, "Position"),
    ));
    rows.push((
        Quantity::Signal(Signal::Velocity),
        state("velocity", Dimension::Speed, "Velocity"),
    ));
    let text = "Friction, positive against forward motion; of a body that sticks, the reaction that holds it";
    rows.push((
        Quantity::Signal(Signal::Friction),
        of_unit("friction", Dimension::Force, text),
    ));
    rows.push((
        Quantity::Signal(Signal::Acceleration),
        of_unit("acceleration", Dimension::Acceleration, "Acceleration"),
    ));
    let stuck = Variable {
        causality: Causality::Output,
        ..flag("stuck", "Whether friction holds it")
    };
    rows.push((Quantity::Signal(Signal::Stuck), stuck));
    for (position, parameter) in body.parameters().iter().enumerate() {
        let variable = parameter_row(parameter, body.parameter_at(position));
        rows.push((Quantity::Parameter(position), variable));
    }
    add_dependencies(&mut rows);
    let (quantities, variables) = rows.into_iter().unzip();
    Ok((VariableTable::new(variables)?, quantities))
}

/// Acceleration, friction and with them sticking depend at once on the inputs; at the start on all that may be set.
fn add_dependencies(rows: &mut [(Quantity<Signal>, Variable)]) {
    let places = |wanted: &dyn Fn(&Quantity<Signal>, &Variable) -> bool| -> Vec<u32> {
        (0_u32..)
            .zip(rows.iter())
            .filter(|(_, (quantity, variable))| wanted(quantity, variable))
            .map(|(place, _)| place)
            .collect()
    };
    let at_once =
        places(&|quantity, _| matches!(quantity, Quantity::Input(place) if *place < INPUTS));
    let known_at_start = places(&|_, variable| variable.settable_before_start());
    for (_, variable) in rows {
        if variable.initial == Some(Initial::Calculated) {
            variable.dependencies.clone_from(&at_once);
            variable.initial_dependencies.clone_from(&known_at_start);
        }
    }
}
