//! What model exchange adds to a rig's variable table: derivatives of the states, event indicators, and what depends on what.

use super::variables::{Channel, Friction, Rows, Signal};
use crate::cosim::part::Quantity;
use crate::cosim::rows::{derivative_row, indicator_row};
use crate::plant::{Indicators, Rig, index};

/// What an unknown depends on at one instant, the mode held.
pub(super) fn influences(rig: &Rig<f64>, unknown: Signal) -> Vec<Quantity<Signal>> {
    use index::{
        BRISTLE, BRISTLE1, CURRENT, OMEGA, OMEGA1, OMEGA3, RELAXING_TORQUE, THETA, THETA1, THETA3,
    };
    let effects = &rig.effects;
    let full = rig.disc1.is_some();
    let state = |place: usize| Quantity::Signal(Signal::State(place));
    let input = |channel: Channel| Quantity::Input(channel as usize);
    let mut known = Vec::new();
    let twist = [THETA, OMEGA, THETA3, OMEGA3].map(state);
    let relaxing = effects.shaft_hysteresis.map(|_| state(RELAXING_TORQUE));
    match unknown {
        // Behind a delay, what is seen is not the state.
        Signal::State(THETA | OMEGA) if effects.sensor_delay.is_some() => {}
        Signal::State(place) => known.push(state(place)),
        Signal::Rate(THETA) => known.push(state(OMEGA)),
        Signal::Rate(THETA1) => known.push(state(OMEGA1)),
        Signal::Rate(THETA3) => known.push(state(OMEGA3)),
        Signal::Rate(OMEGA | BRISTLE)
        | Signal::Friction(Friction::Disc)
        | Signal::Stuck(Friction::Disc) => {
            known.extend(twist);
            known.extend(relaxing);
            if full {
                known.extend([THETA1, OMEGA1].map(state));
            }
            known.extend(effects.presliding.map(|_| state(BRISTLE)));
            known.push(input(Channel::NormalForce));
            if effects.friction_wear.is_some() || effects.stochastic_friction.is_some() {
                known.push(Quantity::Time);
            }
        }
        Signal::Rate(OMEGA1 | BRISTLE1)
        | Signal::Friction(Friction::Disc1)
        | Signal::Stuck(Friction::Disc1) => {
            known.extend([THETA1, OMEGA1, THETA, OMEGA].map(state));
            known.extend(effects.presliding.map(|_| state(BRISTLE1)));
            known.push(input(Channel::NormalForce1));
        }
        Signal::Rate(OMEGA3)
        | Signal::Friction(Friction::Motor)
        | Signal::Stuck(Friction::Motor) => {
            known.extend(twist);
            known.extend(relaxing);
            known.push(state(CURRENT));
        }
        Signal::Rate(CURRENT) => {
            known.extend([OMEGA3, CURRENT].map(state));
            known.push(input(Channel::Voltage));
            known.extend(effects.resistance_drift.map(|_| Quantity::Time));
        }
        Signal::Rate(RELAXING_TORQUE) => {
            known.extend([OMEGA, OMEGA3, RELAXING_TORQUE].map(state));
        }
        Signal::CouplingFree => known.extend([THETA, THETA3].map(state)),
        Signal::Rate(_) | Signal::Indicator(_) => {}
    }
    // Equations depend on what is listed at their ports already, and on time.
    let moves = matches!(
        unknown,
        Signal::Rate(OMEGA | OMEGA1 | OMEGA3 | CURRENT | BRISTLE | BRISTLE1)
            | Signal::Friction(_)
            | Signal::Stuck(_)
    );
    if moves && rig.equations.depend_on_time() && !known.contains(&Quantity::Time) {
        known.push(Quantity::Time);
    }
    known
}

impl Rows {
    /// Adds the derivatives of all states and the event indicators.
    pub(super) fn add_exchange(&mut self, rig: &Rig<f64>) {
        for place in rig.state_places() {
            let of = Quantity::Signal(Signal::State(place));
            let Some(state) = self.quantities.iter().position(|quantity| *quantity == of) else {
                continue;
            };
            let variable = &mut self.variables[state];
            // What a switch sets: the velocity of what comes to rest, and bristles that let go.
            variable.reinit = matches!(
                place,
                index::OMEGA | index::OMEGA1 | index::OMEGA3 | index::BRISTLE | index::BRISTLE1
            );
            let derivative = derivative_row(variable, state);
            self.add(Quantity::Signal(Signal::Rate(place)), derivative);
        }
        let texts = Indicators::new(rig).descriptions();
        for (place, text) in texts.iter().enumerate() {
            let indicator = indicator_row(place, text);
            self.add(Quantity::Signal(Signal::Indicator(place)), indicator);
        }
    }
}
