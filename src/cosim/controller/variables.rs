//! The variable table of a controller. Inputs and output bear the names of the rig's variables that they
//! are connected to.

use crate::controller::{ControlLaw, Input};
use crate::cosim::part::{self, Quantity};
use crate::cosim::rows::{flag, input, parameter_row, row};
use crate::cosim::{Causality, Initial, TableError, Variable, VariableTable};

/// What a controller's course computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cosim) enum Signal {
    /// The voltage within its limits.
    Voltage,
    /// The integral.
    Integral,
    /// The filtered torque.
    FilteredTorque,
    /// Whether the voltage is at a limit.
    Saturated,
}

/// The variable table of a controller, and what each row stands for.
///
/// # Errors
/// A unit of a parameter that cannot be expressed in SI base units.
pub(super) fn controller_table(law: &ControlLaw<f64>) -> Result<part::Rows<Signal>, TableError> {
    let mut rows = vec![(
        Quantity::Time,
        row("time", Causality::Independent, "s", "Simulated time"),
    )];
    for (place, name, unit, nominal, text) in [
        (
            Input::SpeedReference,
            "omega_ref",
            "rad/s",
            10.0,
            "Wanted speed of the gearbox output",
        ),
        (
            Input::Speed,
            "theta3_dot",
            "rad/s",
            10.0,
            "Measured speed of the gearbox output",
        ),
        (Input::Current, "i", "A", 1.0, "Measured armature current"),
    ] {
        if law.has(place) {
            let variable = Variable {
                display_unit: (unit == "rad/s").then_some("rpm"),
                ..input(name, unit, nominal, text)
            };
            rows.push((Quantity::Input(place as usize), variable));
        }
    }
    let voltage = Variable {
        initial: Some(Initial::Calculated),
        nominal: Some(5.0),
        ..row(
            "u",
            Causality::Output,
            "V",
            "Voltage for the motor, within its limits",
        )
    };
    rows.push((Quantity::Signal(Signal::Voltage), voltage));
    let state = |name, unit, text| Variable {
        initial: Some(Initial::Exact),
        start: Some(0.0),
        ..row(name, Causality::Local, unit, text)
    };
    let text = "Integral part of the voltage";
    rows.push((
        Quantity::Signal(Signal::Integral),
        state("integral", "V", text),
    ));
    if law.has(Input::Current) {
        let text = "Filtered torque of the motor, on the shaft side of the gearbox";
        rows.push((
            Quantity::Signal(Signal::FilteredTorque),
            state("filtered_torque", "N.m", text),
        ));
    }
    let text = "Whether the voltage is at a limit";
    rows.push((Quantity::Signal(Signal::Saturated), flag("saturated", text)));
    for (position, parameter) in law.parameters().iter().enumerate() {
        let variable = parameter_row(parameter, law.parameter_at(position));
        rows.push((Quantity::Parameter(position), variable));
    }
    add_dependencies(law, &mut rows);
    let (quantities, variables) = rows.into_iter().unzip();
    Ok((VariableTable::new(variables)?, quantities))
}

/// The voltage depends at once on the inputs with a direct gain; at the start on all that may be set.
fn add_dependencies(law: &ControlLaw<f64>, rows: &mut [(Quantity<Signal>, Variable)]) {
    let direct = law.gains().direct;
    let places = |wanted: &dyn Fn(&Quantity<Signal>, &Variable) -> bool| -> Vec<u32> {
        (0_u32..)
            .zip(rows.iter())
            .filter(|(_, (quantity, variable))| wanted(quantity, variable))
            .map(|(place, _)| place)
            .collect()
    };
    let at_once =
        places(&|quantity, _| matches!(quantity, Quantity::Input(input) if direct[*input] != 0.0));
    let known_at_start = places(&|_, variable| variable.settable_before_start());
    for (quantity, variable) in rows {
        if *quantity == Quantity::Signal(Signal::Voltage) {
            variable.dependencies.clone_from(&at_once);
        }
        if variable.initial == Some(Initial::Calculated) {
            variable.initial_dependencies.clone_from(&known_at_start);
        }
    }
}
