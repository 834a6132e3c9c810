//! The variable table of a rig.

use super::exchange_rows::influences;
use crate::cosim::part::{self, Part, Quantity};
use crate::cosim::rows::{flag, input, parameter_row, row};
use crate::cosim::{Causality, Initial, TableError, Variable, VariableTable};
use crate::plant::{Rig, RigKind, index};

/// What a rig's course computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cosim) enum Signal {
    /// Component of the rig's state.
    State(usize),
    /// Friction torque on a disc or in the motor.
    Friction(Friction),
    /// Whether a contact sticks.
    Stuck(Friction),
    /// Whether the coupling is within its dead band.
    CouplingFree,
    /// Time derivative of a component of the rig's state.
    Rate(usize),
    /// Event indicator at this place.
    Indicator(usize),
}

/// The rig's inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channel {
    Voltage = 0,
    NormalForce = 1,
    NormalForce1 = 2,
}

/// Number of [`Channel`]s.
pub(super) const CHANNELS: usize = 3;

/// Where friction acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cosim) enum Friction {
    Disc,
    Disc1,
    Motor,
}

/// The variable table of `rig`, and what each row stands for.
///
/// # Errors
/// A unit of a parameter that cannot be expressed in SI base units.
pub(super) fn rig_table(rig: &Rig<f64>) -> Result<part::Rows<Signal>, TableError> {
    let full = rig.kind() == RigKind::Full;
    let mut rows = Rows::default();
    rows.add(
        Quantity::Time,
        row("time", Causality::Independent, "s", "Simulated time"),
    );

    let u = "Voltage at the motor's terminals";
    rows.add(
        Quantity::Input(Channel::Voltage as usize),
        input("u", "V", 5.0, u),
    );
    let n2 = "Normal force of the pin on disc D2, as its load cell gives it; negative acts as zero";
    rows.add(
        Quantity::Input(Channel::NormalForce as usize),
        input("N2", "N", 50.0, n2),
    );
    if full {
        let n1 = "Normal force of the pin on disc D1; negative acts as zero";
        rows.add(
            Quantity::Input(Channel::NormalForce1 as usize),
            input("N1", "N", 50.0, n1),
        );
    }

    rows.state(index::THETA, "theta", "Angle of disc D2");
    rows.state(index::OMEGA, "theta_dot", "Angular velocity of disc D2");
    rows.friction(
        Friction::Disc,
        "T_f",
        "Friction torque on disc D2, positive against forward slip",
    );
    rows.state(index::THETA3, "theta3", "Angle of the gearbox output");
    rows.state(
        index::OMEGA3,
        "theta3_dot",
        "Angular velocity of the gearbox output",
    );
    rows.state(index::CURRENT, "i", "Armature current");
    if full {
        rows.state(index::THETA1, "theta1", "Angle of disc D1");
        rows.state(index::OMEGA1, "theta1_dot", "Angular velocity of disc D1");
        let text = "Friction torque on disc D1, positive against forward slip";
        rows.friction(Friction::Disc1, "T_f1", text);
    }

    rows.output_flag(
        Signal::Stuck(Friction::Disc),
        "stuck",
        "Whether disc D2 sticks to its pin",
    );
    if full {
        rows.output_flag(
            Signal::Stuck(Friction::Disc1),
            "stuck1",
            "Whether disc D1 sticks to its pin",
        );
    }
    let text = "Whether the motor's own Coulomb friction holds it";
    rows.flag(Signal::Stuck(Friction::Motor), "motor_stuck", text);
    let text = "Friction torque inside the motor, on the shaft side of the gearbox";
    let torque = Variable {
        initial: Some(Initial::Calculated),
        ..row("motor_friction_torque", Causality::Local, "N.m", text)
    };
    rows.add(Quantity::Signal(Signal::Friction(Friction::Motor)), torque);
    if rig.effects.backlash.is_some() {
        let text = "Whether the coupling is within its play and passes no torque";
        rows.flag(Signal::CouplingFree, "coupling_free", text);
    }
    if rig.effects.shaft_hysteresis.is_some() {
        let text = "Torque of the shaft's relaxing part";
        let torque = Variable {
            initial: Some(Initial::Exact),
            start: Some(0.0),
            ..row("shaft_hysteresis_torque", Causality::Local, "N.m", text)
        };
        rows.add(
            Quantity::Signal(Signal::State(index::RELAXING_TORQUE)),
            torque,
        );
    }
    if rig.effects.presliding.is_some() {
        rows.bristle(
            index::BRISTLE,
            "presliding_deflection",
            "Deflection of the bristles between disc D2 and its pin, zero while the disc slides; from zero, a disc that moves slides",
        );
        if full {
            rows.bristle(
                index::BRISTLE1,
                "presliding_deflection1",
                "Deflection of the bristles between disc D1 and its pin, zero while the disc slides; from zero, a disc that moves slides",
            );
        }
    }
    for (position, parameter) in rig.parameters().iter().enumerate() {
        let start = rig.parameter_at(position);
        rows.add(
            Quantity::Parameter(position),
            parameter_row(parameter, start),
        );
    }
    rows.add_second_names();
    if rig.co_simulation_only().is_none() {
        rows.add_exchange(rig);
    }
    rows.finish(rig)
}

/// The dissertation numbers disc D2's quantities too; here those without a number are meant. Not the friction torque: FMPy's
/// validator wants an alias of a calculated output among the unknowns, where the standard has value references.
fn second_name(name: &str) -> Option<&'static str> {
    match name {
        "theta" => Some("theta2"),
        "theta_dot" => Some("theta2_dot"),
        _ => None,
    }
}

#[derive(Default)]
pub(super) struct Rows {
    pub(super) variables: Vec<Variable>,
    pub(super) quantities: Vec<Quantity<Signal>>,
}

impl Rows {
    pub(super) fn add(&mut self, quantity: Quantity<Signal>, variable: Variable) {
        self.variables.push(variable);
        self.quantities.push(quantity);
    }

    fn state(&mut self, position: usize, name: &str, description: &str) {
        let (unit, nominal) = match position {
            index::CURRENT => ("A", 1.0),
            index::OMEGA | index::OMEGA1 | index::OMEGA3 => ("rad/s", 10.0),
            _ => ("rad", 10.0),
        };
        let variable = Variable {
            initial: Some(Initial::Exact),
            start: Some(0.0),
            nominal: Some(nominal),
            display_unit: match unit {
                "rad/s" => Some("rpm"),
                "rad" => Some("deg"),
                _ => None,
            },
            ..row(name, Causality::Output, unit, description)
        };
        self.add(Quantity::Signal(Signal::State(position)), variable);
    }

    fn friction(&mut self, friction: Friction, name: &str, description: &str) {
        let variable = Variable {
            initial: Some(Initial::Calculated),
            ..row(name, Causality::Output, "N.m", description)
        };
        self.add(Quantity::Signal(Signal::Friction(friction)), variable);
    }

    fn bristle(&mut self, position: usize, name: &str, description: &str) {
        let variable = Variable {
            initial: Some(Initial::Exact),
            start: Some(0.0),
            display_unit: Some("deg"),
            ..row(name, Causality::Local, "rad", description)
        };
        self.add(Quantity::Signal(Signal::State(position)), variable);
    }

    fn flag(&mut self, signal: Signal, name: &str, description: &str) {
        self.add(Quantity::Signal(signal), flag(name, description));
    }

    /// A flag that others may be connected to.
    fn output_flag(&mut self, signal: Signal, name: &str, description: &str) {
        let variable = Variable {
            causality: Causality::Output,
            ..flag(name, description)
        };
        self.add(Quantity::Signal(signal), variable);
    }

    /// Variables under the names that the dissertation has for them.
    fn add_second_names(&mut self) {
        for place in 0..self.variables.len() {
            let variable = &self.variables[place];
            if let Some(name) = second_name(&variable.name) {
                let again = Variable {
                    name: name.to_owned(),
                    causality: Causality::Local,
                    initial: Some(Initial::Calculated),
                    start: None,
                    alias_of: Some(place as u32),
                    ..variable.clone()
                };
                self.add(self.quantities[place], again);
            }
        }
    }

    /// Adds the dependencies, which need the places of the rows, and makes the table.
    fn finish(mut self, rig: &Rig<f64>) -> Result<part::Rows<Signal>, TableError> {
        let place = |wanted: Quantity<Signal>| {
            self.quantities
                .iter()
                .position(|q| *q == wanted)
                .map(|place| place as u32)
        };
        let known_at_start: Vec<u32> = (0_u32..)
            .zip(&self.variables)
            .filter(|(_, variable)| variable.settable_before_start())
            .map(|(place, _)| place)
            .collect();
        for (quantity, variable) in self.quantities.iter().zip(&mut self.variables) {
            if let Quantity::Signal(signal) = quantity {
                let known = influences(rig, *signal).into_iter();
                variable.dependencies = known.filter_map(place).collect();
                variable.dependencies.sort_unstable();
            }
            if variable.initial == Some(Initial::Calculated) {
                variable.initial_dependencies.clone_from(&known_at_start);
            }
        }
        Ok((VariableTable::new(self.variables)?, self.quantities))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cosim::Variability;

    fn names(file: &str, causality: Causality) -> Vec<String> {
        let rig = Rig::from_toml(file, "test").unwrap();
        let (table, _) = rig_table(&rig).unwrap();
        let rows = table.variables().iter();
        rows.filter(|v| v.causality == causality)
            .map(|v| v.name.clone())
            .collect()
    }

    const REDUCED: &str = include_str!("../../../modelDescription/reduced-rig.toml");
    const FULL: &str = include_str!("../../../modelDescription/full-rig.toml");

    #[test]
    fn outputs_come_in_the_order_that_users_were_promised() {
        let rig = ["theta", "theta_dot", "T_f", "theta3", "theta3_dot", "i"];
        let reduced = [&rig[..], &["stuck"]].concat();
        assert_eq!(names(REDUCED, Causality::Output), reduced);
        let full = [
            &rig[..],
            &["theta1", "theta1_dot", "T_f1", "stuck", "stuck1"],
        ]
        .concat();
        assert_eq!(names(FULL, Causality::Output), full);
    }

    #[test]
    fn only_the_full_rig_takes_a_second_force() {
        assert_eq!(names(REDUCED, Causality::Input), ["u", "N2"]);
        assert_eq!(names(FULL, Causality::Input), ["u", "N2", "N1"]);
    }

    #[test]
    fn every_parameter_starts_within_its_limits() {
        for file in [REDUCED, FULL] {
            let (table, _) = rig_table(&Rig::from_toml(file, "test").unwrap()).unwrap();
            for variable in table.variables() {
                if let Some(start) = variable.start {
                    assert!(variable.allows(start), "{variable:?}");
                }
            }
            assert_eq!(
                table.find("disc.inertia").unwrap().variability,
                Variability::Fixed
            );
            assert_eq!(
                table.find("contact.mu_s").unwrap().variability,
                Variability::Tunable
            );
        }
    }

    #[test]
    fn what_is_built_in_stays_fixed() {
        let effects = "[backlash]\ngap = 0.01\n[gear_ripple]\ntorque = 0.01\norder = 3\nphase = 0.0\n\
            [stochastic_friction]\nstandard_deviation = 0.01\ncorrelation_time = 0.1\nseed = 3\n\
            [sensor_delay]\ndelay = 0.01\n";
        let rig = Rig::from_toml(&format!("{FULL}\n{effects}"), "test").unwrap();
        let (table, _) = rig_table(&rig).unwrap();
        let rows = table.variables().iter();
        let fixed: Vec<&str> = rows
            .filter(|row| row.variability == Variability::Fixed)
            .map(|row| row.name.as_str())
            .collect();
        let expected = [
            "disc.inertia",
            "gearbox.ratio",
            "motor.inertia",
            "motor.inductance",
            "contact.radius",
            "disc1.inertia",
            "contact1.radius",
            "backlash.gap",
            "gear_ripple.order",
            "stochastic_friction.seed",
            "sensor_delay.delay",
        ];
        assert_eq!(fixed, expected);
    }
}
