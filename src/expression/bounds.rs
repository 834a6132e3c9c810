//! Intervals of all values that an expression may take: a pole, a logarithm or a root of something that reaches zero is found
//! before it runs.

use super::{ExpressionError, Names, Program};
use operations::Operation;

/// All values between two bounds, which may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Interval {
    low: f64,
    high: f64,
}

impl Interval {
    const ALL: Self = Self {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };

    /// From `low` to `high`; a bound that is no number, as ∞ − ∞ gives, is none.
    fn new(low: f64, high: f64) -> Self {
        let or = |bound: f64, none: f64| if bound.is_nan() { none } else { bound };
        Self {
            low: or(low, f64::NEG_INFINITY),
            high: or(high, f64::INFINITY),
        }
    }

    fn holds_zero(self) -> bool {
        self.low <= 0.0 && self.high >= 0.0
    }

    /// The smallest interval with all of `values`; what is undefined (0 × ∞) is 0, the limit of a bounded factor.
    fn around(values: [f64; 4]) -> Self {
        let values = values.map(|value| if value.is_nan() { 0.0 } else { value });
        Self {
            low: values.iter().copied().fold(f64::INFINITY, f64::min),
            high: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        }
    }

    fn times(self, other: Self) -> Self {
        Self::around([
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ])
    }

    fn absolute(self) -> Self {
        let high = self.low.abs().max(self.high.abs());
        let low = if self.holds_zero() {
            0.0
        } else {
            self.low.abs().min(self.high.abs())
        };
        Self { low, high }
    }

    fn power(self, exponent: u32) -> Self {
        let of = |x: f64| x.powi(exponent as i32);
        if exponent.is_multiple_of(2) {
            let Self { low, high } = self.absolute();
            Self::new(of(low), of(high))
        } else {
            Self::new(of(self.low), of(self.high))
        }
    }
}

/// Refuses divisions, logarithms and roots of what may be zero.
///
/// # Errors
/// The column of the first of them.
pub(super) fn check(program: &Program, names: &Names<'_>) -> Result<(), ExpressionError> {
    let mut known: Vec<Interval> = Vec::with_capacity(program.operations.len());
    for (operation, &column) in program.operations.iter().zip(&program.columns) {
        let of = |node: &usize| known[*node];
        let clear = |node: &usize, what: &str| {
            let Interval { low, high } = of(node);
            // A parameter that must be above zero has an open end there.
            let open = |bound: f64| bound == 0.0 && is_open(program, *node, names);
            if low > 0.0 || high < 0.0 || (low >= 0.0 && open(low)) {
                Ok(of(node))
            } else {
                let reason = format!(
                    "{what} may become zero here, where the expression or its slope has no bound; \
                     keep it away from zero, as 1 + (…)^2 is, or give its parameter range = \"positive\""
                );
                Err(ExpressionError::new(column, reason))
            }
        };
        let positive = |node: &usize, what: &str| {
            let interval = clear(node, what)?;
            if interval.low < 0.0 {
                let reason = format!("{what} may be negative here");
                return Err(ExpressionError::new(column, reason));
            }
            Ok(interval)
        };
        known.push(match operation {
            Operation::Number(value) => Interval::new(*value, *value),
            Operation::Parameter(place) => {
                let range = names.parameters[*place].2;
                Interval::new(
                    range.minimum().unwrap_or(f64::NEG_INFINITY),
                    range.maximum().unwrap_or(f64::INFINITY),
                )
            }
            Operation::Coordinate(place) => {
                if names.coordinate(*place).is_some_and(|own| own.is_positive) {
                    Interval::new(0.0, f64::INFINITY)
                } else {
                    Interval::ALL
                }
            }
            Operation::Add(a, b) => Interval::new(of(a).low + of(b).low, of(a).high + of(b).high),
            Operation::Subtract(a, b) => {
                Interval::new(of(a).low - of(b).high, of(a).high - of(b).low)
            }
            Operation::Multiply(a, b) if a == b => of(a).power(2),
            Operation::Multiply(a, b) => of(a).times(of(b)),
            Operation::Divide(a, b) => {
                let by = clear(b, "the divisor")?;
                of(a).times(Interval::new(1.0 / by.high, 1.0 / by.low))
            }
            Operation::Negate(a) => Interval::new(-of(a).high, -of(a).low),
            Operation::Power(a, exponent) => of(a).power(*exponent),
            Operation::RealPower(a, _) => {
                positive(a, "the base of a power")?;
                Interval::new(0.0, f64::INFINITY)
            }
            Operation::SquareRoot(a) => {
                let inside = positive(a, "the number under the root")?;
                Interval::new(inside.low.sqrt(), inside.high.sqrt())
            }
            Operation::Logarithm(a) => {
                let inside = positive(a, "the argument of log")?;
                Interval::new(inside.low.ln(), inside.high.ln())
            }
            Operation::Exponential(a) => Interval::new(of(a).low.exp(), of(a).high.exp()),
            Operation::HyperbolicTangent(a) => Interval::new(of(a).low.tanh(), of(a).high.tanh()),
            Operation::Sine(_) | Operation::Cosine(_) | Operation::Sign(..) => {
                Interval::new(-1.0, 1.0)
            }
            Operation::Absolute(a, _) => of(a).absolute(),
            Operation::Minimum(a, b, _) => {
                Interval::new(of(a).low.min(of(b).low), of(a).high.min(of(b).high))
            }
            Operation::Maximum(a, b, _) => {
                Interval::new(of(a).low.max(of(b).low), of(a).high.max(of(b).high))
            }
            Operation::Table(..) => Interval::ALL,
        });
    }
    Ok(())
}

/// Whether zero itself is excluded where an interval ends there: a parameter that is above zero, products and quotients of such,
/// exponentials and powers.
fn is_open(program: &Program, node: usize, names: &Names<'_>) -> bool {
    match &program.operations[node] {
        Operation::Parameter(place) => {
            matches!(
                names.parameters[*place].2,
                crate::parameter::Range::Positive
            )
        }
        Operation::Number(value) => *value != 0.0,
        Operation::Multiply(a, b) => is_open(program, *a, names) && is_open(program, *b, names),
        Operation::Power(a, _) | Operation::SquareRoot(a) | Operation::Divide(a, _) => {
            is_open(program, *a, names)
        }
        Operation::Exponential(_) | Operation::RealPower(..) => true,
        _ => false,
    }
}
