//! What effects by equation add to the rig's torques, voltage and loads, order by order, and on which branches they begin.

use super::bodies::Bodies;
use super::equation::{EquationJet, coordinates};
use super::index::{CURRENT, OMEGA, OMEGA1, OMEGA3, THETA, THETA1, THETA3};
use super::jet::{PinJet, RigJet};
use super::{Contact, Port, Rig, RigInputs, RigMode, RigState, STATES};
use crate::expression::{COORDINATES, Coordinate, SITES};
use crate::series::{Scalar, Series};

/// Where in a series, and when, and on which branches.
pub(super) struct At<'a, S> {
    pub k: usize,
    pub time: S,
    pub branches: &'a [i32; SITES],
}

impl<S: Scalar> At<'_, S> {
    /// Coefficient of the time.
    fn time(&self) -> S {
        match self.k {
            0 => self.time,
            1 => S::constant(1.0),
            _ => S::ZERO,
        }
    }
}

/// What is added on the way from the supply to D2.
pub(super) struct Added<S> {
    pub shaft: S,
    pub disc: S,
    /// On the shaft side of the gearbox.
    pub motor: S,
    pub voltage: S,
}

/// Coefficients of the coordinates of each port.
struct Coordinates<'a, S> {
    k: usize,
    time: S,
    ratio: S,
    x: &'a [Series<S>; STATES],
    twist: (S, S),
    voltage: S,
    loads: [S; 2],
}

impl<S: Scalar> Coordinates<'_, S> {
    fn at(&self, port: Port) -> [S; COORDINATES] {
        let k = self.k;
        let x = |place: usize| self.x[place][k];
        let time = (Coordinate::Time, self.time);
        let disc = |angle: usize, velocity: usize, load: S| {
            coordinates([
                (Coordinate::Angle, x(angle)),
                (Coordinate::Velocity, x(velocity)),
                (Coordinate::Load, load),
                time,
            ])
        };
        let shaft = |twist: S, rate: S| {
            coordinates([
                (Coordinate::Twist, twist),
                (Coordinate::TwistRate, rate),
                time,
            ])
        };
        match port {
            Port::DiscTorque | Port::DiscFriction => disc(THETA, OMEGA, self.loads[0]),
            Port::Disc1Torque | Port::Disc1Friction => disc(THETA1, OMEGA1, self.loads[1]),
            Port::ShaftTorque => shaft(self.twist.0, self.twist.1),
            Port::Shaft1Torque => shaft(x(THETA1) - x(THETA), x(OMEGA1) - x(OMEGA)),
            Port::MotorTorque | Port::MotorVoltage | Port::MotorResistance => coordinates([
                (Coordinate::Angle, self.ratio * x(THETA3)),
                (Coordinate::Velocity, self.ratio * x(OMEGA3)),
                (Coordinate::Current, x(CURRENT)),
                (Coordinate::Voltage, self.voltage),
                time,
            ]),
        }
    }
}

/// The ports at which any of `rig`'s equations act, as a bit each.
pub(super) fn ports<S: Scalar>(rig: &Rig<S>) -> u16 {
    let ports = rig
        .equations
        .active()
        .map(|effect| effect.definition.port());
    ports.fold(0, |bits, port| bits | 1 << port as u16)
}

impl<S: Scalar> Bodies<'_, S> {
    /// Coordinates where neither the shaft nor the voltage matters.
    fn on_discs<'x>(
        &self,
        at: &At<'_, S>,
        x: &'x [Series<S>; STATES],
        work: &EquationJet<S>,
    ) -> Coordinates<'x, S> {
        Coordinates {
            k: at.k,
            time: at.time(),
            ratio: self.ratio,
            x,
            twist: (S::ZERO, S::ZERO),
            voltage: S::ZERO,
            loads: work.loads.map(|load| load[at.k]),
        }
    }

    fn acts_at(&self, port: Port) -> bool {
        self.ports & (1 << port as u16) != 0
    }

    /// Coefficient of all that equations add but factors of friction and what acts on D1.
    pub fn by_equation(
        &self,
        at: &At<'_, S>,
        twist: (S, S),
        x: &[Series<S>; STATES],
        voltage: S,
        work: &mut EquationJet<S>,
    ) -> Added<S> {
        let known = Coordinates {
            twist,
            voltage,
            ..self.on_discs(at, x, work)
        };
        let mut sum = |port: Port| {
            if self.acts_at(port) {
                self.rig
                    .equations
                    .sum(port, at.k, known.at(port), at.branches, work)
            } else {
                S::ZERO
            }
        };
        Added {
            shaft: sum(Port::ShaftTorque),
            disc: sum(Port::DiscTorque),
            motor: self.ratio * sum(Port::MotorTorque),
            voltage: sum(Port::MotorVoltage) - sum(Port::MotorResistance),
        }
    }

    /// Coefficients of the torque on D1 and of the further torque of its shaft.
    pub fn disc1_by_equation(
        &self,
        at: &At<'_, S>,
        x: &[Series<S>; STATES],
        work: &mut EquationJet<S>,
    ) -> (S, S) {
        let known = self.on_discs(at, x, work);
        let mut sum = |port: Port| {
            self.rig
                .equations
                .sum(port, at.k, known.at(port), at.branches, work)
        };
        (sum(Port::Disc1Torque), sum(Port::Shaft1Torque))
    }

    /// Coefficient of the load of a pin under the factors that equations give.
    pub fn equation_load(
        &self,
        contact: Contact,
        at: &At<'_, S>,
        x: &[Series<S>; STATES],
        pin: &PinJet<S>,
        work: &mut EquationJet<S>,
    ) -> S {
        let port = match contact {
            Contact::Disc1 => Port::Disc1Friction,
            _ => Port::DiscFriction,
        };
        let load = pin.load[at.k];
        if !self.acts_at(port) {
            return load;
        }
        let known = self.on_discs(at, x, work);
        let equations = &self.rig.equations;
        equations.varied_load(port, at.k, load, known.at(port), at.branches, work)
    }
}

impl<S: Scalar> Rig<S> {
    /// Puts every kink of the equations on the branch where `state` is, in a mode whose coupling is known.
    pub(super) fn find_branches(
        &self,
        mode: &mut RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        jet: &mut RigJet<S>,
    ) {
        if self.equations.active().next().is_none() {
            return;
        }
        self.start_series(time, state, inputs, 0, jet);
        let bodies = Bodies::new(self, mode, inputs);
        let twist = bodies.elastic_twist(mode.coupling, state[THETA] - state[THETA3]);
        let Some(work) = jet
            .effects
            .as_mut()
            .and_then(|work| work.equations.as_mut())
        else {
            return;
        };
        let at = At {
            k: 0,
            time,
            branches: &[0; SITES],
        };
        let known = Coordinates {
            twist: (twist, state[OMEGA] - state[OMEGA3]),
            voltage: jet.voltage[0],
            ..bodies.on_discs(&at, &jet.states, work)
        };
        for port in Port::ALL {
            let branches = &mut mode.branches;
            self.equations
                .find_branches(port, known.at(port), branches, work);
        }
    }
}
