//! Signals of a controller between two events: a polynomial and a decaying exponential.

use crate::series::{Series, TERMS, first_loss_of_sign};

/// Coefficients of the polynomial: inputs have four, their integral five.
pub(super) const POLYNOMIAL: usize = 5;

/// Length of a window in which the exponential is carried as a power series, in time constants: its
/// last term is then below 1e-29.
const WINDOW: f64 = 0.5;
/// Windows after which the exponential is below rounding: exp(−50) = 2e-22.
const WINDOWS: u32 = 100;
/// Length of the first window of a signal without exponential [s].
const PLAIN_WINDOW: f64 = 1.0;
/// Leading terms below this share of the largest count as zero at the start.
const NEGLIGIBLE: f64 = 1e-12;

/// Σ p\[j\] τ^j + A exp(−τ `rate`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Signal {
    pub(super) polynomial: [f64; POLYNOMIAL],
    /// A.
    pub(super) amplitude: f64,
    /// Reciprocal of the time constant [1/s]; 0 without exponential.
    pub(super) rate: f64,
}

impl Signal {
    /// A polynomial beside an exponential of this `rate` [1/s] in other signals.
    pub(super) fn polynomial(coefficients: &[f64], rate: f64) -> Self {
        let mut polynomial = [0.0; POLYNOMIAL];
        for (place, coefficient) in polynomial.iter_mut().zip(coefficients) {
            *place = *coefficient;
        }
        Self {
            polynomial,
            amplitude: 0.0,
            rate,
        }
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        for (a, b) in sum.polynomial.iter_mut().zip(other.polynomial) {
            *a += b;
        }
        sum.amplitude += other.amplitude;
        sum
    }

    pub(super) fn plus_constant(mut self, constant: f64) -> Self {
        self.polynomial[0] += constant;
        self
    }

    pub(super) fn times(mut self, factor: f64) -> Self {
        self.polynomial.iter_mut().for_each(|c| *c *= factor);
        self.amplitude *= factor;
        self
    }

    /// Value at `tau` [s].
    pub(super) fn value(&self, tau: f64) -> f64 {
        let sum = self
            .polynomial
            .iter()
            .rev()
            .fold(0.0, |sum, c| sum * tau + c);
        if self.amplitude == 0.0 {
            sum
        } else {
            sum + self.amplitude * libm::exp(-self.rate * tau)
        }
    }

    pub(super) fn derivative(&self) -> Self {
        let mut polynomial = [0.0; POLYNOMIAL];
        for j in 1..POLYNOMIAL {
            polynomial[j - 1] = j as f64 * self.polynomial[j];
        }
        Self {
            polynomial,
            amplitude: -self.rate * self.amplitude,
            rate: self.rate,
        }
    }

    /// Integral from 0 on of the polynomial part, which must be of degree 3 and all there is.
    pub(super) fn integral_of_polynomial(&self) -> Self {
        let mut polynomial = [0.0; POLYNOMIAL];
        for j in 1..POLYNOMIAL {
            polynomial[j] = self.polynomial[j - 1] / j as f64;
        }
        Self {
            polynomial,
            amplitude: 0.0,
            rate: self.rate,
        }
    }

    /// Power series about `tau` [s].
    fn series(&self, tau: f64) -> Series<f64> {
        let mut series = [0.0; TERMS];
        series[..POLYNOMIAL].copy_from_slice(&self.polynomial);
        if tau != 0.0 {
            for first in 0..POLYNOMIAL {
                for k in (first..POLYNOMIAL - 1).rev() {
                    series[k] += tau * series[k + 1];
                }
            }
        }
        if self.amplitude != 0.0 {
            let mut term = self.amplitude * libm::exp(-self.rate * tau);
            for (k, coefficient) in series.iter_mut().enumerate() {
                *coefficient += term;
                term *= -self.rate / (k + 1) as f64;
            }
        }
        series
    }

    /// Start and length [s] of search window number `number`: fixed, so that what is found does not
    /// depend on how far one looks.
    pub(super) fn window(rate: f64, number: u32) -> (f64, f64) {
        let (width, equal) = if rate > 0.0 {
            (WINDOW / rate, WINDOWS)
        } else {
            (PLAIN_WINDOW, 1)
        };
        if number < equal {
            return (f64::from(number) * width, width);
        }
        let start = width * f64::from(equal) * libm::exp2(f64::from(number - equal));
        (start, start)
    }

    /// Where in window number `number` a signal that starts at zero or above falls below zero [s].
    ///
    /// At the very start, leading terms that are rounding are left out: a signal that has just been
    /// at zero is judged by how it goes on. `floor` is a size below which all of it is zero.
    pub(super) fn loss_in_window(&self, number: u32, floor: f64) -> Option<f64> {
        let (start, width) = Self::window(self.rate, number);
        let faded = self.rate > 0.0 && number >= WINDOWS;
        let signal = if faded {
            Self {
                amplitude: 0.0,
                ..*self
            }
        } else {
            *self
        };
        let series = signal.series(start);
        let terms = if number == 0 {
            significant(&series, width, floor)?
        } else {
            &series
        };
        first_loss_of_sign(terms, width).map(|tau| start + tau)
    }

    /// Sign with which the signal starts: of its first term that is not rounding; 0 if all are.
    pub(super) fn starting_sign(&self, floor: f64) -> f64 {
        let (_, width) = Self::window(self.rate, 0);
        let series = self.series(0.0);
        significant(&series, width, floor).map_or(0.0, |terms| terms[0].signum())
    }
}

/// The terms from the first that is not rounding over `width` on; none if all are.
fn significant(series: &Series<f64>, width: f64, floor: f64) -> Option<&[f64]> {
    let mut sizes = [0.0; TERMS];
    let mut power = 1.0;
    for (size, coefficient) in sizes.iter_mut().zip(series) {
        *size = coefficient.abs() * power;
        power *= width;
    }
    let largest = sizes
        .iter()
        .fold(0.0_f64, |largest, size| largest.max(*size));
    let least = floor.max(NEGLIGIBLE * largest);
    let first = sizes.iter().position(|size| *size > least)?;
    Some(&series[first..])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decaying() -> Signal {
        Signal {
            amplitude: 2.0,
            ..Signal::polynomial(&[-0.5], 20.0)
        }
    }

    #[test]
    fn an_exponential_crosses_zero_where_its_logarithm_says() {
        let signal = decaying();
        let found = (0..10).find_map(|number| signal.loss_in_window(number, 0.0));
        let expected = libm::log(4.0) / 20.0;
        assert!((found.unwrap() - expected).abs() < 1e-15);
    }

    #[test]
    fn windows_cover_the_time_axis_without_gaps() {
        for rate in [0.0, 20.0] {
            let mut end = 0.0;
            for number in 0..140 {
                let (start, width) = Signal::window(rate, number);
                assert_eq!(start, end, "rate {rate}, window {number}");
                end = Signal::window(rate, number + 1).0;
                assert!((start + width - end).abs() <= 1e-12 * end);
            }
            assert!(end > 1e9);
        }
    }

    #[test]
    fn a_signal_that_leaves_zero_upward_is_not_lost_at_once() {
        let rising = Signal::polynomial(&[-1e-17, 1.0], 0.0);
        assert_eq!(rising.loss_in_window(0, 0.0), None);
        assert_eq!(rising.starting_sign(0.0), 1.0);
        let falling = Signal::polynomial(&[1e-17, -1.0], 0.0);
        assert_eq!(falling.loss_in_window(0, 0.0), Some(0.0));
        let nothing = Signal::polynomial(&[1e-16], 0.0);
        assert_eq!(nothing.starting_sign(1e-14), 0.0);
    }

    #[test]
    fn derivative_and_integral_undo_each_other() {
        let signal = Signal::polynomial(&[3.0, -2.0, 0.5, 4.0], 20.0);
        assert_eq!(signal.integral_of_polynomial().derivative(), signal);
        let slope = decaying().derivative();
        let difference = (decaying().value(0.1001) - decaying().value(0.0999)) / 2e-4;
        assert!((slope.value(0.1) - difference).abs() < 1e-4);
    }
}
