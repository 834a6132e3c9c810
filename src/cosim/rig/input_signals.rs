//! The inputs of a rig as the importer sets them: polynomials in time.
//!
//! A value set at a communication point holds until another is set. Derivatives set at the same
//! communication point, before or after the value, make it a polynomial that goes on beyond the next
//! point until something new is set. Setting a value at a later point drops the old derivatives.

use super::variables::{CHANNELS, Channel};
use crate::cosim::{StateError, StateReader, StateWriter};
use crate::plant::{INPUT_TERMS, RigInputs};

type Polynomial = [f64; INPUT_TERMS];

/// Values and derivatives of all inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct InputSignals {
    /// Time [s] at which the polynomials are centred.
    centre: f64,
    polynomials: [Polynomial; CHANNELS],
    /// Inputs whose derivatives were set since the last step.
    derivatives_are_new: [bool; CHANNELS],
}

impl InputSignals {
    /// Sets the value of an input at `now` [s].
    pub(super) fn set_value(&mut self, channel: Channel, value: f64, now: f64) {
        self.recentre(now);
        let place = channel as usize;
        if !self.derivatives_are_new[place] {
            self.polynomials[place][1..].fill(0.0);
        }
        self.polynomials[place][0] = value;
    }

    /// Sets the derivative of order 1, 2 or 3 of an input at `now` [s].
    pub(super) fn set_derivative(&mut self, channel: Channel, order: u32, value: f64, now: f64) {
        self.recentre(now);
        let place = channel as usize;
        if !self.derivatives_are_new[place] {
            self.derivatives_are_new[place] = true;
            self.polynomials[place][1..].fill(0.0);
        }
        let factorial = f64::from((1..=order).product::<u32>());
        if let Some(coefficient) = self.polynomials[place].get_mut(order as usize) {
            *coefficient = value / factorial;
        }
    }

    /// Value of an input at `time` [s].
    pub(super) fn value(&self, channel: Channel, time: f64) -> f64 {
        let tau = time - self.centre;
        self.polynomials[channel as usize]
            .iter()
            .rev()
            .fold(0.0, |sum, c| sum * tau + c)
    }

    /// A communication step begins: what is set from now on is set at another point.
    pub(super) fn begin_step(&mut self) {
        self.derivatives_are_new = [false; CHANNELS];
    }

    /// Moves the centre to `now` [s] without changing the signals.
    fn recentre(&mut self, now: f64) {
        if self.centre != now {
            let tau = now - self.centre;
            for polynomial in &mut self.polynomials {
                *polynomial = shifted(polynomial, tau);
            }
            self.centre = now;
        }
    }

    /// The signals from `now` [s] on, for the plant.
    pub(super) fn rig_inputs(&self, now: f64) -> RigInputs<f64> {
        let mut signals = *self;
        signals.recentre(now);
        let [voltage, normal_force, normal_force_1] = signals.polynomials;
        RigInputs {
            time: now,
            voltage,
            normal_force,
            normal_force_1,
            ..RigInputs::held(0.0, 0.0, 0.0)
        }
    }

    /// The signals for the plant about the centre that they have, coefficient by coefficient.
    pub(super) fn uncentred(&self) -> RigInputs<f64> {
        self.rig_inputs(self.centre)
    }

    /// Whether the plant's `inputs` are these signals from `now` [s] on.
    pub(super) fn agree_with(&self, inputs: &RigInputs<f64>, now: f64) -> bool {
        let (ours, theirs) = (self.rig_inputs(now), Self::of(inputs).rig_inputs(now));
        ours == theirs
    }

    /// The signals of the plant's `inputs`.
    pub(super) fn of(inputs: &RigInputs<f64>) -> Self {
        Self {
            centre: inputs.time,
            polynomials: [inputs.voltage, inputs.normal_force, inputs.normal_force_1],
            derivatives_are_new: [false; CHANNELS],
        }
    }

    /// Writes the signals into a state.
    pub(super) fn save(&self, state: &mut StateWriter) {
        state.real(self.centre);
        self.polynomials
            .iter()
            .flatten()
            .for_each(|c| state.real(*c));
        self.derivatives_are_new
            .iter()
            .for_each(|flag| state.flag(*flag));
    }

    /// The opposite of [`save`](Self::save).
    pub(super) fn restore(state: &mut StateReader<'_>) -> Result<Self, StateError> {
        let mut signals = Self {
            centre: state.real()?,
            ..Self::default()
        };
        for coefficient in signals.polynomials.iter_mut().flatten() {
            *coefficient = state.real()?;
        }
        for flag in &mut signals.derivatives_are_new {
            *flag = state.flag()?;
        }
        Ok(signals)
    }
}

/// The polynomial about a centre that lies `tau` later.
fn shifted(polynomial: &Polynomial, tau: f64) -> Polynomial {
    let mut c = *polynomial;
    if c[1..].iter().all(|coefficient| *coefficient == 0.0) {
        return c;
    }
    for first in 0..INPUT_TERMS {
        for k in (first..INPUT_TERMS - 1).rev() {
            c[k] += tau * c[k + 1];
        }
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;
    use Channel::Voltage;

    #[test]
    fn a_ramp_goes_on_until_a_new_value_is_set() {
        let mut signals = InputSignals::default();
        signals.set_value(Voltage, 1.0, 0.0);
        signals.set_derivative(Voltage, 1, 2.0, 0.0);
        signals.begin_step();
        assert_eq!(signals.value(Voltage, 3.0), 7.0);
        signals.set_value(Voltage, 5.0, 3.0);
        assert_eq!(signals.value(Voltage, 10.0), 5.0);
    }

    #[test]
    fn the_order_of_value_and_derivatives_at_one_point_does_not_matter() {
        let mut first = InputSignals::default();
        first.set_value(Voltage, 1.0, 2.0);
        first.set_derivative(Voltage, 3, 6.0, 2.0);
        let mut second = InputSignals::default();
        second.set_derivative(Voltage, 3, 6.0, 2.0);
        second.set_value(Voltage, 1.0, 2.0);
        assert_eq!(first.rig_inputs(2.0), second.rig_inputs(2.0));
        assert_eq!(first.value(Voltage, 4.0), 9.0);
    }

    #[test]
    fn held_inputs_agree_at_any_later_time() {
        let mut signals = InputSignals::default();
        signals.set_value(Voltage, 3.1, 0.0);
        let inputs = signals.rig_inputs(0.0);
        signals.begin_step();
        signals.set_value(Voltage, 3.1, 0.7);
        assert!(signals.agree_with(&inputs, 0.7));
        signals.set_value(Voltage, 3.2, 0.7);
        assert!(!signals.agree_with(&inputs, 0.7));
    }

    #[test]
    fn recentring_keeps_a_cubic() {
        let mut signals = InputSignals::default();
        signals.set_value(Voltage, 1.0, 0.0);
        for (order, value) in [(1, 0.5), (2, -1.0), (3, 3.0)] {
            signals.set_derivative(Voltage, order, value, 0.0);
        }
        let before = signals.value(Voltage, 2.0);
        signals.recentre(1.5);
        assert!((signals.value(Voltage, 2.0) - before).abs() < 1e-14);
    }
}
