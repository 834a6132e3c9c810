//! Physical dimensions, carried through an expression. Radians are pure numbers here: a torque times an angle is not another
//! quantity than a torque.

use super::{ExpressionError, Names, Program};
use crate::parameter::units::{BaseUnit, Unit, UnitError};
use operations::Operation;
use std::fmt;

/// Exponents of kilogram, metre, second, ampere and kelvin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension([i32; 5]);

const SYMBOLS: [&str; 5] = ["kg", "m", "s", "A", "K"];

impl Dimension {
    /// A pure number.
    pub const NONE: Self = Self([0; 5]);

    /// Dimension of the unit called `name`, for example `N.m.s/rad`.
    ///
    /// # Errors
    /// The name is no product of SI units.
    pub fn of_unit(name: &str) -> Result<Self, UnitError> {
        let BaseUnit { kg, m, s, a, k, .. } = Unit::parse(name)?.base;
        Ok(Self([kg, m, s, a, k]))
    }

    /// SI value of the unit that these SI values of a mass, a length, a time and a current make.
    #[must_use]
    pub fn scale(self, [mass, length, time, current]: [f64; 4]) -> f64 {
        let [kg, m, s, a, _] = self.0;
        let power = |base: f64, exponent: i32| libm::pow(base, f64::from(exponent));
        power(mass, kg) * power(length, m) * power(time, s) * power(current, a)
    }

    fn times(self, other: Self, power: i32) -> Self {
        Self(std::array::from_fn(|j| {
            self.0[j].saturating_add(other.0[j].saturating_mul(power))
        }))
    }

    fn root(self) -> Option<Self> {
        self.0
            .iter()
            .all(|exponent| exponent % 2 == 0)
            .then(|| Self(self.0.map(|exponent| exponent / 2)))
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<String> = SYMBOLS
            .iter()
            .zip(self.0)
            .filter(|(_, exponent)| *exponent != 0)
            .map(|(symbol, exponent)| match exponent {
                1 => (*symbol).to_owned(),
                _ => format!("{symbol}{exponent}"),
            })
            .collect();
        if parts.is_empty() {
            write!(f, "no unit")
        } else {
            write!(f, "{}", parts.join("."))
        }
    }
}

/// Dimension of every operation of `program`.
///
/// # Errors
/// A sum, a comparison or a function of quantities that do not go together.
pub(super) fn check(
    program: &Program,
    names: &Names<'_>,
) -> Result<Vec<Dimension>, ExpressionError> {
    let mut known: Vec<Dimension> = Vec::with_capacity(program.operations.len());
    for (operation, &column) in program.operations.iter().zip(&program.columns) {
        let of = |node: &usize| known[*node];
        let same = |a: &usize, b: &usize, what: &str| {
            if of(a) == of(b) {
                Ok(of(a))
            } else {
                let reason = format!(
                    "{what} takes two quantities of one unit, not {} and {}",
                    of(a),
                    of(b)
                );
                Err(ExpressionError::new(column, reason))
            }
        };
        let pure = |node: &usize, what: &str| {
            if of(node) == Dimension::NONE {
                Ok(Dimension::NONE)
            } else {
                let reason = format!(
                    "{what} takes a number without unit, not one in {}; divide by a parameter of that unit",
                    of(node)
                );
                Err(ExpressionError::new(column, reason))
            }
        };
        known.push(match operation {
            Operation::Number(_) => Dimension::NONE,
            Operation::Parameter(place) => names.parameters[*place].1,
            Operation::Coordinate(place) => names
                .coordinate(*place)
                .map_or(Dimension::NONE, |own| own.dimension),
            Operation::Add(a, b) => same(a, b, "a sum")?,
            Operation::Subtract(a, b) => same(a, b, "a difference")?,
            Operation::Minimum(a, b, _) => same(a, b, "min")?,
            Operation::Maximum(a, b, _) => same(a, b, "max")?,
            Operation::Multiply(a, b) => of(a).times(of(b), 1),
            Operation::Divide(a, b) => of(a).times(of(b), -1),
            Operation::Negate(a) | Operation::Absolute(a, _) => of(a),
            Operation::Sign(..) => Dimension::NONE,
            Operation::Power(a, exponent) => Dimension::NONE.times(of(a), *exponent as i32),
            Operation::SquareRoot(a) => of(a).root().ok_or_else(|| {
                let reason = format!("the root of a quantity in {} has no unit", of(a));
                ExpressionError::new(column, reason)
            })?,
            Operation::RealPower(a, b) => {
                pure(b, "an exponent")?;
                pure(a, "a power whose exponent is no whole number")?
            }
            Operation::Sine(a) => pure(a, "sin")?,
            Operation::Cosine(a) => pure(a, "cos")?,
            Operation::Exponential(a) => pure(a, "exp")?,
            Operation::Logarithm(a) => pure(a, "log")?,
            Operation::HyperbolicTangent(a) => pure(a, "tanh")?,
            Operation::Table(a, table, _) => {
                let table = &program.tables[*table];
                if of(a) != table.argument {
                    let reason = format!(
                        "table {} is over a quantity in {}, not in {}",
                        table.name,
                        table.argument,
                        of(a)
                    );
                    return Err(ExpressionError::new(column, reason));
                }
                table.value
            }
        });
    }
    Ok(known)
}
