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
    let mut last = 0.0;
    for (place, operation) in operations.iter().enumerate() {
        let x = &*steps;
        last = match *operation {
            Operation::Number(value) => value,
            Operation::Parameter(place) => parameters[place],
            Operation::Coordinate(place) => coordinates[place],
            Operation::Add(a, b) => x[a] + x[b],
            Operation::Subtract(a, b) => x[a] - x[b],
            Operation::Multiply(a, b) => x[a] * x[b],
            Operation::Divide(a, b) => x[a] / x[b],
            Operation::Negate(a) => -x[a],
            Operation::Power(a, 2) => x[a] * x[a],
            Operation::Power(a, 3) => x[a] * x[a] * x[a],
            Operation::Power(a, _) => (x[a] * x[a]) * (x[a] * x[a]),
            Operation::RealPower(a, b) => libm::pow(x[a], x[b]),
            Operation::Sine(a) => libm::sin(x[a]),
            Operation::Cosine(a) => libm::cos(x[a]),
            Operation::Exponential(a) => libm::exp(x[a]),
            Operation::Logarithm(a) => libm::log(x[a]),
            Operation::SquareRoot(a) => x[a].sqrt(),
            Operation::HyperbolicTangent(a) => libm::tanh(x[a]),
            Operation::Absolute(a, _) => x[a].abs(),
            Operation::Sign(a, _) if x[a] < 0.0 => -1.0,
            Operation::Sign(..) => 1.0,
            Operation::Minimum(a, b, _) => x[a].min(x[b]),
            Operation::Maximum(a, b, _) => x[a].max(x[b]),
            Operation::Table(..) => 0.0,
        };
        steps[place] = last;
    }
    last
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
    }

    #[test]
    fn an_operand_stands_before_its_operation() {
        assert_eq!(check(&[Operation::Negate(0)], 0, 0), Err(Fault::Operand(0)));
        assert_eq!(check(&[], 0, 0), Err(Fault::Empty));
    }
}
