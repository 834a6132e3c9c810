//! The inputs of a component as the importer sets them: polynomials in time.
//!
//! A value set at a communication point holds until another is set. Derivatives set at the same
//! communication point, before or after the value, make it a polynomial that goes on beyond the next
//! point until something new is set. Setting a value at a later point drops the old derivatives.

use super::identity::MAX_INPUT_DERIVATIVE_ORDER;
use super::state::{StateError, StateReader, StateWriter};
use crate::series::shifted;

/// Number of coefficients of an input polynomial: value and derivatives.
const TERMS: usize = MAX_INPUT_DERIVATIVE_ORDER as usize + 1;

/// Coefficients of an input, lowest order first.
pub(super) type Polynomial = [f64; TERMS];

/// Values and derivatives of `N` inputs, addressed by their places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct InputSignals<const N: usize> {
    /// Time [s] at which the polynomials are centred.
    pub(super) centre: f64,
    pub(super) polynomials: [Polynomial; N],
    /// Inputs whose derivatives were set since the last step.
    derivatives_are_new: [bool; N],
}

impl<const N: usize> Default for InputSignals<N> {
    fn default() -> Self {
        Self::new(0.0, [[0.0; TERMS]; N])
    }
}

impl<const N: usize> InputSignals<N> {
    /// Signals that are these polynomials about `centre` [s].
    pub(super) fn new(centre: f64, polynomials: [Polynomial; N]) -> Self {
        Self {
            centre,
            polynomials,
            derivatives_are_new: [false; N],
        }
    }

    /// Sets the value of an input at `now` [s].
    pub(super) fn set_value(&mut self, place: usize, value: f64, now: f64) {
        self.recentre(now);
        if !self.derivatives_are_new[place] {
            self.polynomials[place][1..].fill(0.0);
        }
        self.polynomials[place][0] = value;
    }

    /// Sets the derivative of order 1, 2 or 3 of an input at `now` [s].
    pub(super) fn set_derivative(&mut self, place: usize, order: u32, value: f64, now: f64) {
        self.recentre(now);
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
    pub(super) fn value(&self, place: usize, time: f64) -> f64 {
        let tau = time - self.centre;
        self.polynomials[place]
            .iter()
            .rev()
            .fold(0.0, |sum, c| sum * tau + c)
    }

    /// A communication step begins: what is set from now on is set at another point.
    pub(super) fn begin_step(&mut self) {
        self.derivatives_are_new = [false; N];
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

    /// The same signals about `now` [s].
    pub(super) fn centred(&self, now: f64) -> Self {
        let mut signals = *self;
        signals.recentre(now);
        signals
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

#[cfg(test)]
mod tests {
    const FIRST: usize = 0;

    type InputSignals = super::InputSignals<2>;

    #[test]
    fn a_ramp_goes_on_until_a_new_value_is_set() {
        let mut signals = InputSignals::default();
        signals.set_value(FIRST, 1.0, 0.0);
        signals.set_derivative(FIRST, 1, 2.0, 0.0);
        signals.begin_step();
        assert_eq!(signals.value(FIRST, 3.0), 7.0);
        signals.set_value(FIRST, 5.0, 3.0);
        assert_eq!(signals.value(FIRST, 10.0), 5.0);
    }

    #[test]
    fn the_order_of_value_and_derivatives_at_one_point_does_not_matter() {
        let mut first = InputSignals::default();
        first.set_value(FIRST, 1.0, 2.0);
        first.set_derivative(FIRST, 3, 6.0, 2.0);
        let mut second = InputSignals::default();
        second.set_derivative(FIRST, 3, 6.0, 2.0);
        second.set_value(FIRST, 1.0, 2.0);
        assert_eq!(
            first.centred(2.0).polynomials,
            second.centred(2.0).polynomials
        );
        assert_eq!(first.value(FIRST, 4.0), 9.0);
    }

    #[test]
    fn recentring_keeps_a_cubic() {
        let mut signals = InputSignals::default();
        signals.set_value(FIRST, 1.0, 0.0);
        for (order, value) in [(1, 0.5), (2, -1.0), (3, 3.0)] {
            signals.set_derivative(FIRST, order, value, 0.0);
        }
        let before = signals.value(FIRST, 2.0);
        signals.recentre(1.5);
        assert!((signals.value(FIRST, 2.0) - before).abs() < 1e-14);
    }
}
