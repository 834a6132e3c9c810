//! Taylor coefficients of each operation, order by order.

use super::Program;
use super::program::ExpressionJet;
use crate::series::{RECIPROCAL, Scalar, Series, convolution, cosine_sine, exponential};
use operations::Operation;

impl Program {
    /// Coefficient `k` of the operation at `node`, whose operands have theirs.
    #[inline]
    pub(super) fn expand_operation<S: Scalar>(
        &self,
        node: usize,
        k: usize,
        coordinates: &[S],
        parameters: &[S],
        branches: &[i32],
        jet: &mut ExpressionJet<S>,
    ) {
        let first = k == 0;
        let (x, rest) = jet.values.split_at_mut(node);
        let y = &mut rest[0];
        let other = &mut jet.others[node];
        let at_first = |value: S| if first { value } else { S::ZERO };
        let product = |a: usize, b: usize| match (self.constant[a], self.constant[b]) {
            (true, _) => x[a][0] * x[b][k],
            (_, true) => x[a][k] * x[b][0],
            _ => convolution(&x[a][..=k], &x[b][..=k]),
        };
        y[k] = match self.operations[node] {
            Operation::Number(value) => at_first(S::constant(value)),
            Operation::Parameter(place) => at_first(parameters[place]),
            Operation::Coordinate(place) => coordinates[place],
            Operation::Add(a, b) => x[a][k] + x[b][k],
            Operation::Subtract(a, b) => x[a][k] - x[b][k],
            Operation::Negate(a) => -x[a][k],
            Operation::Multiply(a, b) => product(a, b),
            Operation::Divide(a, b) if self.constant[b] => x[a][k] / x[b][0],
            Operation::Divide(a, b) => quotient(k, &x[a], &x[b], y),
            Operation::Power(a, exponent) => {
                let square = &mut other[0];
                square[k] = convolution(&x[a][..=k], &x[a][..=k]);
                match exponent {
                    2 => square[k],
                    3 => convolution(&square[..=k], &x[a][..=k]),
                    _ => convolution(&square[..=k], &square[..=k]),
                }
            }
            Operation::RealPower(a, b) => {
                // exp(b ln a).
                let [logarithm, weighted] = other;
                logarithm[k] = log_coefficient(k, &x[a], logarithm);
                let exponent = if self.constant[b] {
                    x[b][0] * logarithm[k]
                } else {
                    convolution(&x[b][..=k], &logarithm[..=k])
                };
                exponential_coefficient(k, exponent, weighted, y)
            }
            Operation::Exponential(a) => exponential_coefficient(k, x[a][k], &mut other[0], y),
            Operation::Logarithm(a) => log_coefficient(k, &x[a], y),
            Operation::SquareRoot(a) => {
                if first {
                    x[a][0].sqrt()
                } else {
                    let known = if k > 1 {
                        convolution(&y[1..k], &y[1..k])
                    } else {
                        S::ZERO
                    };
                    (x[a][k] - known) / (y[0] * 2.0)
                }
            }
            Operation::Sine(a) => {
                let [weighted, cosine] = other;
                let (c, s) = turn(k, &x[a], weighted, cosine, y);
                cosine[k] = c;
                s
            }
            Operation::Cosine(a) => {
                let [weighted, sine] = other;
                let (c, s) = turn(k, &x[a], weighted, y, sine);
                sine[k] = s;
                c
            }
            Operation::HyperbolicTangent(a) => {
                // y' = (1 − y²) a'.
                let [weighted, slope] = other;
                weighted[k] = x[a][k] * k as f64;
                let value = if first {
                    hyperbolic_tangent(x[a][0])
                } else {
                    convolution(&weighted[1..=k], &slope[..k]) * RECIPROCAL[k]
                };
                y[k] = value;
                let square = convolution(&y[..=k], &y[..=k]);
                slope[k] = at_first(S::constant(1.0)) - square;
                value
            }
            Operation::Absolute(a, site) => {
                if branches[site] == 0 {
                    x[a][k]
                } else {
                    -x[a][k]
                }
            }
            Operation::Sign(_, site) => {
                at_first(S::constant(if branches[site] == 0 { 1.0 } else { -1.0 }))
            }
            Operation::Minimum(a, b, site) => {
                other[0][k] = x[a][k] - x[b][k];
                x[if branches[site] == 0 { b } else { a }][k]
            }
            Operation::Maximum(a, b, site) => {
                other[0][k] = x[a][k] - x[b][k];
                x[if branches[site] == 0 { a } else { b }][k]
            }
            Operation::Table(a, table, site) => {
                let ([c0, c1, c2, c3], [low, _]) = self.tables[table].piece(branches[site]);
                let [offset, square] = other;
                offset[k] = if first && low.is_finite() {
                    x[a][0] + -low
                } else {
                    x[a][k]
                };
                let mut value = at_first(S::constant(c0)) + offset[k] * c1;
                if c2 != 0.0 || c3 != 0.0 {
                    square[k] = convolution(&offset[..=k], &offset[..=k]);
                    value += square[k] * c2 + convolution(&square[..=k], &offset[..=k]) * c3;
                }
                value
            }
        };
    }
}

fn quotient<S: Scalar>(k: usize, a: &Series<S>, b: &Series<S>, y: &Series<S>) -> S {
    let known = if k > 0 {
        convolution(&b[1..=k], &y[..k])
    } else {
        S::ZERO
    };
    (a[k] - known) / b[0]
}

fn log_coefficient<S: Scalar>(k: usize, a: &Series<S>, y: &Series<S>) -> S {
    if k == 0 {
        return a[0].ln();
    }
    // k a0 y_k = k a_k − Σ j y_j a_{k−j}, 0 < j < k.
    let mut known = S::ZERO;
    for j in 1..k {
        known += y[j] * a[k - j] * j as f64;
    }
    (a[k] - known * RECIPROCAL[k]) / a[0]
}

fn exponential_coefficient<S: Scalar>(
    k: usize,
    exponent: S,
    weighted: &mut Series<S>,
    y: &Series<S>,
) -> S {
    weighted[k] = exponent * k as f64;
    if k == 0 {
        exponent.exp()
    } else {
        exponential(k, weighted, y)
    }
}

fn turn<S: Scalar>(
    k: usize,
    angle: &Series<S>,
    weighted: &mut Series<S>,
    cosine: &Series<S>,
    sine: &Series<S>,
) -> (S, S) {
    weighted[k] = angle[k] * k as f64;
    if k == 0 {
        let (sin, cos) = angle[0].sin_cos();
        (cos, sin)
    } else {
        cosine_sine(k, weighted, cosine, sine)
    }
}

/// tanh, without overflow.
fn hyperbolic_tangent<S: Scalar>(a: S) -> S {
    let one = S::constant(1.0);
    if a.value() < 0.0 {
        return -hyperbolic_tangent(-a);
    }
    let small = (a * -2.0).exp();
    (one - small) / (one + small)
}
