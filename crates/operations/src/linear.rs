//! Which parameters an equation is linear in.

use crate::operation::Operation;

/// Places of parameters in which the equation is linear, all of them together: its value is a sum of a part without them and of one in
/// proportion to each. Those of the lowest places come first; a parameter that multiplies one of them is not among them.
#[must_use]
pub fn linear(operations: &[Operation], parameters: usize) -> Vec<usize> {
    let mut known = Vec::new();
    for parameter in 0..parameters {
        known.push(parameter);
        if !is_linear(operations, &known) {
            known.pop();
        }
    }
    known
}

/// Whether no step multiplies two of these parameters, and the value is no other function of one.
fn is_linear(operations: &[Operation], parameters: &[usize]) -> bool {
    // The degree of each step in the parameters; more than 1 of anything else than a sum of products.
    let mut degrees: Vec<usize> = Vec::with_capacity(operations.len());
    for operation in operations {
        let degree = match *operation {
            Operation::Parameter(own) => usize::from(parameters.contains(&own)),
            Operation::Add(a, b) | Operation::Subtract(a, b) => degrees[a].max(degrees[b]),
            Operation::Multiply(a, b) => degrees[a] + degrees[b],
            Operation::Divide(a, b) if degrees[b] == 0 => degrees[a],
            Operation::Negate(a) => degrees[a],
            _ => match operation.operands().all(|own| degrees[own] == 0) {
                true => 0,
                false => 2,
            },
        };
        degrees.push(degree);
    }
    degrees.last().is_some_and(|degree| *degree <= 1)
}

#[cfg(test)]
mod tests {
    use super::linear;
    use crate::operation::Operation::{
        Add, Coordinate, Divide, Exponential, Multiply, Negate, Parameter,
    };

    #[test]
    fn amplitudes_are_linear_and_widths_are_not() {
        // a exp(−v/b) + c v
        let operations = [
            Parameter(0),
            Coordinate(0),
            Parameter(1),
            Divide(1, 2),
            Negate(3),
            Exponential(4),
            Multiply(0, 5),
            Parameter(2),
            Multiply(7, 1),
            Add(6, 8),
        ];
        assert_eq!(linear(&operations, 3), [0, 2]);
    }

    #[test]
    fn of_two_factors_one_is_linear() {
        let operations = [
            Parameter(0),
            Parameter(1),
            Multiply(0, 1),
            Coordinate(0),
            Multiply(2, 3),
        ];
        assert_eq!(linear(&operations, 2), [0]);
    }
}
