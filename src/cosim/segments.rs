//! Runs that go from segment to segment, ahead of the communication points.

use super::model::{ModelError, StepEnd};
use crate::integrator::{IntegrationError, Options};

/// A run of polynomial segments.
pub(super) trait Segments {
    /// Start of the present segment [s].
    fn begin(&self) -> f64;

    /// End of the present segment [s].
    fn end(&self) -> f64;

    /// Goes to the next segment; whether the component began to stick or to slip.
    ///
    /// # Errors
    /// There is none.
    fn next(&mut self) -> Result<bool, IntegrationError>;
}

/// Goes on from `begin` [s] until `run` covers `until`, or with `stop_at_switch` to the first switch after `begin`. `hint` is what
/// people may do where that takes too many segments.
///
/// # Errors
/// It cannot go on.
pub(super) fn advance(
    run: &mut impl Segments,
    begin: f64,
    until: f64,
    stop_at_switch: bool,
    hint: &str,
) -> Result<StepEnd, ModelError> {
    let mut switched = false;
    let mut stop = false;
    let budget = segment_budget(until - begin);
    for _ in 0..budget {
        if run.end() >= until {
            return Ok(StepEnd {
                time: until,
                switched,
            });
        }
        let switch = run.next().map_err(ModelError::from_display)?;
        let now = run.begin();
        switched |= switch;
        stop |= switch && stop_at_switch && now > begin;
        // Several switches may fall on one instant.
        if stop && run.end() > now {
            return Ok(StepEnd {
                time: now,
                switched,
            });
        }
    }
    Err(ModelError(format!(
        "{budget} segments did not reach t = {until} s; now at t = {} s. Take shorter steps, or check \
         {hint}: a time constant is extremely short",
        run.begin()
    )))
}

/// Segments that a communication step of `length` seconds may spend.
///
/// The shipped rigs take some hundred a second, stiff ones some thousand. Without a bound that goes with the
/// length, a parameter that makes a time constant absurdly short would hold the importer's process for minutes in
/// a step of a millisecond.
fn segment_budget(length: f64) -> u64 {
    const BUDGET: f64 = 50_000.0;
    ((BUDGET * (1.0 + length)) as u64).min(Options::default().budget)
}

/// Derivative of this order of a polynomial at `tau`.
pub(super) fn time_derivative(coefficients: &[f64], order: usize, tau: f64) -> f64 {
    (order..coefficients.len()).rev().fold(0.0, |sum, power| {
        let factor: f64 = (power - order + 1..=power)
            .map(|factor| factor as f64)
            .product();
        sum * tau + factor * coefficients[power]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_a_cubic() {
        let cubic = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(time_derivative(&cubic, 1, 2.0), 2.0 + 12.0 + 48.0);
        assert_eq!(time_derivative(&cubic, 2, 2.0), 6.0 + 48.0);
        assert_eq!(time_derivative(&cubic, 4, 2.0), 0.0);
    }
}
