//! Operations, their check and their values.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// One step of an equation; operands are places of earlier steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Operation {
    /// A literal.
    Number(f64),
    /// The parameter at this place.
    Parameter(usize),
    /// The coordinate at this place.
    Coordinate(usize),
    /// a + b.
    Add(usize, usize),
    /// a − b.
    Subtract(usize, usize),
    /// a b.
    Multiply(usize, usize),
    /// a/b.
    Divide(usize, usize),
    /// −a.
    Negate(usize),
    /// a to the second, third or fourth power.
    Power(usize, u32),
    /// a^b for a > 0.
    RealPower(usize, usize),
    /// sin a.
    Sine(usize),
    /// cos a.
    Cosine(usize),
    /// exp a.
    Exponential(usize),
    /// ln a.
    Logarithm(usize),
    /// √a.
    SquareRoot(usize),
    /// tanh a.
    HyperbolicTangent(usize),
    /// |a|, with its site.
    Absolute(usize, usize),
    /// 1 for a ≥ 0, else −1, with its site.
    Sign(usize, usize),
    /// The smaller of two, with its site.
    Minimum(usize, usize, usize),
    /// The larger of two, with its site.
    Maximum(usize, usize, usize),
    /// A table's value at a: argument, table, site.
    Table(usize, usize, usize),
}

impl Operation {
    /// Places of the steps that it works on.
    pub fn operands(&self) -> impl Iterator<Item = usize> + use<> {
        let (a, b) = match *self {
            Self::Number(_) | Self::Parameter(_) | Self::Coordinate(_) => (None, None),
            Self::Add(a, b)
            | Self::Subtract(a, b)
            | Self::Multiply(a, b)
            | Self::Divide(a, b)
            | Self::RealPower(a, b)
            | Self::Minimum(a, b, _)
            | Self::Maximum(a, b, _) => (Some(a), Some(b)),
            Self::Negate(a)
            | Self::Power(a, _)
            | Self::Sine(a)
            | Self::Cosine(a)
            | Self::Exponential(a)
            | Self::Logarithm(a)
            | Self::SquareRoot(a)
            | Self::HyperbolicTangent(a)
            | Self::Absolute(a, _)
            | Self::Sign(a, _)
            | Self::Table(a, _, _) => (Some(a), None),
        };
        a.into_iter().chain(b)
    }

    /// Its site, if it is not smooth.
    #[must_use]
    pub fn site(&self) -> Option<usize> {
        match *self {
            Self::Absolute(_, site)
            | Self::Sign(_, site)
            | Self::Minimum(_, _, site)
            | Self::Maximum(_, _, site)
            | Self::Table(_, _, site) => Some(site),
            _ => None,
        }
    }
}

/// What is wrong with a list of operations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Fault {
    /// There are none.
    #[error("it has no operation")]
    Empty,
    /// The operation at this place works on one that is not before it.
    #[error("operation {0} works on one that is not before it")]
    Operand(usize),
    /// The operation at this place wants a parameter, a coordinate or a table that is not there.
    #[error("operation {0} wants a parameter, a coordinate or a table that is not there")]
    Missing(usize),
}

/// Checks that [`value`] can run `operations` with so many parameters and coordinates and without tables.
///
/// # Errors
/// The first fault.
pub fn check(operations: &[Operation], parameters: usize, coordinates: usize) -> Result<(), Fault> {
    if operations.is_empty() {
        return Err(Fault::Empty);
    }
    for (place, operation) in operations.iter().enumerate() {
        if operation.operands().any(|operand| operand >= place) {
            return Err(Fault::Operand(place));
        }
        let is_there = match *operation {
            Operation::Parameter(parameter) => parameter < parameters,
            Operation::Coordinate(coordinate) => coordinate < coordinates,
            Operation::Table(..) => false,
            _ => true,
        };
        if !is_there {
            return Err(Fault::Missing(place));
        }
    }
    Ok(())
}

/// Value of the last of `operations`. `steps` is room for the values of all of them; tables count as zero.
///
/// # Panics
/// Where [`check`] finds a fault, or `steps` has fewer places than there are operations.
pub fn value(
    operations: &[Operation],
    parameters: &[f64],
    coordinates: &[f64],
    steps: &mut [f64],
) -> f64 {
    let (coordinates, _) = coordinates.as_chunks();
    let (steps, _) = steps.as_chunks_mut();
    let [value] = values(operations, parameters, coordinates, steps);
    value
}

/// As [`value`], at `LANES` moments at once: each coordinate and each step has a number for each moment.
///
/// # Panics
/// As [`value`] does.
pub fn values<const LANES: usize>(
    operations: &[Operation],
    parameters: &[f64],
    coordinates: &[[f64; LANES]],
    steps: &mut [[f64; LANES]],
) -> [f64; LANES] {
    let mut last = [0.0; LANES];
    for (place, operation) in operations.iter().enumerate() {
        let x = &*steps;
        last = match *operation {
            Operation::Number(value) => [value; LANES],
            Operation::Parameter(place) => [parameters[place]; LANES],
            Operation::Coordinate(place) => coordinates[place],
            Operation::Add(a, b) => of_two(&x[a], &x[b], |a, b| a + b),
            Operation::Subtract(a, b) => of_two(&x[a], &x[b], |a, b| a - b),
            Operation::Multiply(a, b) => of_two(&x[a], &x[b], |a, b| a * b),
            Operation::Divide(a, b) => of_two(&x[a], &x[b], |a, b| a / b),
            Operation::Negate(a) => of_one(&x[a], |a| -a),
            Operation::Power(a, 2) => of_one(&x[a], |a| a * a),
            Operation::Power(a, 3) => of_one(&x[a], |a| a * a * a),
            Operation::Power(a, _) => of_one(&x[a], |a| (a * a) * (a * a)),
            Operation::RealPower(a, b) => of_two(&x[a], &x[b], libm::pow),
            Operation::Sine(a) => of_one(&x[a], libm::sin),
            Operation::Cosine(a) => of_one(&x[a], libm::cos),
            Operation::Exponential(a) => of_one(&x[a], libm::exp),
            Operation::Logarithm(a) => of_one(&x[a], libm::log),
            Operation::SquareRoot(a) => of_one(&x[a], f64::sqrt),
            Operation::HyperbolicTangent(a) => of_one(&x[a], libm::tanh),
            Operation::Absolute(a, _) => of_one(&x[a], f64::abs),
            Operation::Sign(a, _) => of_one(&x[a], |a| if a < 0.0 { -1.0 } else { 1.0 }),
            Operation::Minimum(a, b, _) => of_two(&x[a], &x[b], f64::min),
            Operation::Maximum(a, b, _) => of_two(&x[a], &x[b], f64::max),
            Operation::Table(..) => [0.0; LANES],
        };
        steps[place] = last;
    }
    last
}

/// A function of the number at each moment; a plain loop, which the compiler vectorises.
#[inline(always)]
fn of_one<const LANES: usize>(a: &[f64; LANES], function: impl Fn(f64) -> f64) -> [f64; LANES] {
    let mut values = *a;
    for value in &mut values {
        *value = function(*value);
    }
    values
}

/// As [`of_one`], of two numbers.
#[inline(always)]
fn of_two<const LANES: usize>(
    a: &[f64; LANES],
    b: &[f64; LANES],
    function: impl Fn(f64, f64) -> f64,
) -> [f64; LANES] {
    let mut values = *a;
    for (value, b) in values.iter_mut().zip(b) {
        *value = function(*value, *b);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_worked_off_in_order() {
        // p0 (x0² − 1).
        let operations = [
            Operation::Parameter(0),
            Operation::Coordinate(0),
            Operation::Power(1, 2),
            Operation::Number(1.0),
            Operation::Subtract(2, 3),
            Operation::Multiply(0, 4),
        ];
        assert_eq!(check(&operations, 1, 1), Ok(()));
        assert_eq!(value(&operations, &[2.0], &[3.0], &mut [0.0; 6]), 16.0);
        assert_eq!(check(&operations, 0, 1), Err(Fault::Missing(0)));
        let moments = [[3.0, -1.0, 0.5]];
        assert_eq!(
            values(&operations, &[2.0], &moments, &mut [[0.0; 3]; 6]),
            [16.0, 0.0, -1.5]
        );
    }

    #[test]
    fn an_operand_stands_before_its_operation() {
        assert_eq!(check(&[Operation::Negate(0)], 0, 0), Err(Fault::Operand(0)));
        assert_eq!(check(&[], 0, 0), Err(Fault::Empty));
    }
}
