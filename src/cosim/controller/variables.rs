//! The variable table of a controller. Inputs and output bear the names of the rig's variables that they
//! are connected to.

use crate::controller::{ControlLaw, INPUTS, Input, Instant, Mode};
use crate::cosim::part::{self, Quantity};
use crate::cosim::rows::{derivative_row, flag, indicator_row, input, parameter_row, row};
use crate::cosim::{Causality, Initial, TableError, Variable, VariableTable};
use crate::series::Scalar;

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
    /// Time derivative of the integral.
    IntegralRate,
    /// Time derivative of the filtered torque.
    FilteredTorqueRate,
    /// Event indicator at this place.
    Indicator(usize),
}

/// A real signal of an instant at which the controller is in `mode`; `None` for a flag.
pub(super) fn signal_at<S: Scalar>(instant: &Instant<S>, mode: Mode, signal: Signal) -> Option<S> {
    match signal {
        Signal::Voltage => Some(instant.voltage(mode)),
        Signal::Integral => Some(instant.states()[0]),
        Signal::FilteredTorque => Some(instant.states()[1]),
        Signal::IntegralRate => Some(instant.rates(mode)[0]),
        Signal::FilteredTorqueRate => Some(instant.rates(mode)[1]),
        Signal::Indicator(place) => instant.indicators(mode).get(place).copied(),
        Signal::Saturated => None,
    }
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
    for (state, rate) in STATES {
        let of =
            |(quantity, _): &(Quantity<Signal>, Variable)| *quantity == Quantity::Signal(state);
        if let Some(place) = rows.iter().position(of) {
            // A switch sets the integral that rides on a limit.
            rows[place].1.reinit = state == Signal::Integral;
            let derivative = derivative_row(&rows[place].1, place);
            rows.push((Quantity::Signal(rate), derivative));
        }
    }
    for (place, text) in law.gains().indicator_descriptions().enumerate() {
        rows.push((
            Quantity::Signal(Signal::Indicator(place)),
            indicator_row(place, text),
        ));
    }
    add_dependencies(law, &mut rows);
    let (quantities, variables) = rows.into_iter().unzip();
    Ok((VariableTable::new(variables)?, quantities))
}

/// The continuous states of all laws and their derivatives.
const STATES: [(Signal, Signal); 2] = [
    (Signal::Integral, Signal::IntegralRate),
    (Signal::FilteredTorque, Signal::FilteredTorqueRate),
];

/// What an unknown depends on at one instant, the mode held.
fn influences(law: &ControlLaw<f64>, unknown: Signal) -> Vec<Quantity<Signal>> {
    let gains = law.gains();
    let inputs = |gains: [f64; INPUTS]| {
        let acting = (0..INPUTS).filter(move |place| gains[*place] != 0.0);
        acting.map(Quantity::Input)
    };
    let states = STATES.map(|(state, _)| Quantity::Signal(state));
    match unknown {
        Signal::Voltage => inputs(gains.direct).chain(states).collect(),
        // While it rides on a limit, it follows the filtered torque.
        Signal::IntegralRate => (inputs(gains.integral).chain(inputs(gains.filtered)))
            .chain([states[1]])
            .collect(),
        Signal::FilteredTorqueRate => inputs(gains.filtered).chain([states[1]]).collect(),
        Signal::Integral | Signal::FilteredTorque | Signal::Saturated | Signal::Indicator(_) => {
            Vec::new()
        }
    }
}

/// At the start all that may be set counts.
fn add_dependencies(law: &ControlLaw<f64>, rows: &mut [(Quantity<Signal>, Variable)]) {
    let places = |wanted: &dyn Fn(&Quantity<Signal>, &Variable) -> bool| -> Vec<u32> {
        (0_u32..)
            .zip(rows.iter())
            .filter(|(_, (quantity, variable))| wanted(quantity, variable))
            .map(|(place, _)| place)
            .collect()
    };
    let known_at_start = places(&|_, variable| variable.settable_before_start());
    let dependencies: Vec<Vec<u32>> = rows
        .iter()
        .map(|(quantity, _)| match quantity {
            Quantity::Signal(signal) => {
                let known = influences(law, *signal);
                places(&|quantity, _| known.contains(quantity))
            }
            _ => Vec::new(),
        })
        .collect();
    for ((_, variable), dependencies) in rows.iter_mut().zip(dependencies) {
        variable.dependencies = dependencies;
        if variable.initial == Some(Initial::Calculated) {
            variable.initial_dependencies.clone_from(&known_at_start);
        }
    }
}
