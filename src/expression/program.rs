//! An equation as a list of operations, and its power series.

use super::{Dimension, ExpressionError, Table};
use crate::series::{RECIPROCAL, Scalar, Series, TERMS, convolution, cosine_sine, exponential};

/// Most kinks of all equations of a rig together.
pub const SITES: usize = 12;

/// What an equation may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// Angle of what the effect acts on [rad].
    Angle,
    /// Its velocity [rad/s].
    Velocity,
    /// Twist of the shaft [rad].
    Twist,
    /// Rate of the twist [rad/s].
    TwistRate,
    /// Armature current [A].
    Current,
    /// Voltage at the terminals, as commanded [V].
    Voltage,
    /// Normal force on the pin [N], ≥ 0.
    Load,
    /// Time [s].
    Time,
}

/// Number of [`Coordinate`]s.
pub(crate) const COORDINATES: usize = 8;

impl Coordinate {
    /// All of them.
    pub const ALL: [Self; COORDINATES] = [
        Self::Angle,
        Self::Velocity,
        Self::Twist,
        Self::TwistRate,
        Self::Current,
        Self::Voltage,
        Self::Load,
        Self::Time,
    ];

    /// Name in equations.
    pub fn name(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::Velocity => "velocity",
            Self::Twist => "twist",
            Self::TwistRate => "twist_rate",
            Self::Current => "current",
            Self::Voltage => "voltage",
            Self::Load => "load",
            Self::Time => "time",
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Angle | Self::Twist => "rad",
            Self::Velocity | Self::TwistRate => "rad/s",
            Self::Current => "A",
            Self::Voltage => "V",
            Self::Load => "N",
            Self::Time => "s",
        }
    }

    pub(super) fn dimension(self) -> Dimension {
        Dimension::of_unit(self.unit()).unwrap_or_default()
    }

    /// Whether it is never below zero.
    pub(super) fn is_positive(self) -> bool {
        matches!(self, Self::Load | Self::Time)
    }

    /// Whether a torque changes its rate at once: a jump there is dry friction, which can hold it.
    pub(super) fn is_rate(self) -> bool {
        matches!(self, Self::Velocity | Self::TwistRate | Self::Current)
    }
}

/// One step of a program; operands are places of earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Operation {
    /// A literal.
    Number(f64),
    /// The parameter at this place.
    Parameter(usize),
    /// What the equation depends on.
    Coordinate(Coordinate),
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

/// A place where an equation is not smooth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Site {
    /// Two branches, 0 where a watched quantity is not negative.
    Sides {
        /// The operation.
        node: usize,
    },
    /// As many branches as a table has pieces, in order.
    Pieces {
        /// The operation.
        node: usize,
        /// The table.
        table: usize,
    },
}

/// An equation, ready to run.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    pub(super) operations: Vec<Operation>,
    /// Where each operation stands in the text, for messages.
    pub(super) columns: Vec<usize>,
    /// Whether an operation depends on numbers and parameters alone.
    pub(super) constant: Vec<bool>,
    /// Those that do not.
    pub(super) varying: Vec<usize>,
    pub(super) tables: Vec<Table>,
    pub(super) sites: Vec<Site>,
}

/// Series of all operations of a program.
#[derive(Clone, Debug)]
pub struct ExpressionJet<S> {
    values: Vec<Series<S>>,
    /// What a recurrence needs beside the value: the other of sine and cosine, 1 − tanh², a weighted argument, a watched
    /// difference.
    others: Vec<[Series<S>; 2]>,
}

impl<S> ExpressionJet<S> {
    /// Series of the equation's value.
    pub(crate) fn value(&self) -> &Series<S> {
        &self.values[self.values.len() - 1]
    }
}

impl Site {
    /// Whether it is a table's, which can be left both ways.
    pub(crate) fn has_pieces(&self) -> bool {
        matches!(self, Self::Pieces { .. })
    }
}

impl Program {
    /// The equation times the current.
    pub(crate) fn times_current(mut self) -> Self {
        let root = self.operations.len() - 1;
        self.push(Operation::Coordinate(Coordinate::Current));
        self.push(Operation::Multiply(root, root + 1));
        self
    }

    /// The equation where it is positive, zero elsewhere.
    ///
    /// # Errors
    /// It has as many kinks as it may have already.
    pub(crate) fn not_below_zero(mut self) -> Result<Self, ExpressionError> {
        if self.sites.len() == SITES {
            let reason = format!("a factor of friction has at most {} kinks", SITES - 1);
            return Err(ExpressionError::new(1, reason));
        }
        let root = self.operations.len() - 1;
        self.push(Operation::Number(0.0));
        let (node, site) = (self.operations.len(), self.sites.len());
        self.sites.push(Site::Sides { node });
        self.push(Operation::Maximum(root, root + 1, site));
        Ok(self)
    }

    fn push(&mut self, operation: Operation) {
        let constant = matches!(operation, Operation::Number(_));
        self.add(operation, constant, 1);
    }

    pub(super) fn add(&mut self, operation: Operation, constant: bool, column: usize) {
        if !constant {
            self.varying.push(self.operations.len());
        }
        self.constant.push(constant);
        self.operations.push(operation);
        self.columns.push(column);
    }

    /// Places where the equation is not smooth.
    pub fn sites(&self) -> &[Site] {
        &self.sites
    }

    /// Series to work on.
    pub fn new_jet<S: Scalar>(&self) -> ExpressionJet<S> {
        let zero = [S::ZERO; TERMS];
        ExpressionJet {
            values: vec![zero; self.operations.len()],
            others: vec![[zero; 2]; self.operations.len()],
        }
    }

    /// Whether the equation depends on this coordinate.
    pub fn uses(&self, coordinate: Coordinate) -> bool {
        self.operations.contains(&Operation::Coordinate(coordinate))
    }

    /// The branches on which every site is at these values.
    pub fn branches<S: Scalar>(
        &self,
        coordinates: &[S; COORDINATES],
        parameters: &[S],
        branches: &mut [i32],
        jet: &mut ExpressionJet<S>,
    ) {
        for node in 0..self.operations.len() {
            if let Some(site) = self.site_of(node) {
                branches[site] = self.branch_at(node, jet);
            }
            self.expand_operation(node, 0, coordinates, parameters, branches, jet);
        }
    }

    /// Coefficient `k` of the equation's value; those before it must have been computed on the same jet.
    pub fn expand_order<S: Scalar>(
        &self,
        k: usize,
        coordinates: &[S; COORDINATES],
        parameters: &[S],
        branches: &[i32],
        jet: &mut ExpressionJet<S>,
    ) -> S {
        if k == 0 {
            for node in 0..self.operations.len() {
                self.expand_operation(node, 0, coordinates, parameters, branches, jet);
            }
        } else {
            // What is constant has no further coefficients; they are zero from the start.
            for &node in &self.varying {
                self.expand_operation(node, k, coordinates, parameters, branches, jet);
            }
        }
        jet.values.last().map_or(S::ZERO, |value| value[k])
    }

    fn site_of(&self, node: usize) -> Option<usize> {
        match self.operations[node] {
            Operation::Absolute(_, site)
            | Operation::Sign(_, site)
            | Operation::Minimum(_, _, site)
            | Operation::Maximum(_, _, site)
            | Operation::Table(_, _, site) => Some(site),
            _ => None,
        }
    }

    fn branch_at<S: Scalar>(&self, node: usize, jet: &ExpressionJet<S>) -> i32 {
        let value = |place: usize| jet.values[place][0].value();
        match self.operations[node] {
            Operation::Absolute(a, _) | Operation::Sign(a, _) => i32::from(value(a) < 0.0),
            Operation::Minimum(a, b, _) | Operation::Maximum(a, b, _) => {
                i32::from(value(a) < value(b))
            }
            Operation::Table(a, table, _) => self.tables[table].branch(value(a)),
            _ => 0,
        }
    }

    /// Coefficient `k` of what must stay positive for `site` to stay on its branch: of tables, downwards and upwards.
    pub fn watched<S: Scalar>(
        &self,
        site: usize,
        upwards: bool,
        branch: i32,
        jet: &ExpressionJet<S>,
        k: usize,
    ) -> S {
        match self.sites[site] {
            Site::Sides { node } => {
                let watched = match self.operations[node] {
                    Operation::Absolute(a, _) | Operation::Sign(a, _) => jet.values[a][k],
                    _ => jet.others[node][0][k],
                };
                if branch == 0 { watched } else { -watched }
            }
            Site::Pieces { node, table } => {
                let Operation::Table(a, ..) = self.operations[node] else {
                    return S::ZERO;
                };
                let (_, [low, high]) = self.tables[table].piece(branch);
                let value = jet.values[a][k];
                match (upwards, k) {
                    (true, 0) => -(value + -high),
                    (true, _) => -value,
                    (false, 0) => value + -low,
                    (false, _) => value,
                }
            }
        }
    }

    /// Whether `site` can leave `branch` upwards (`true`) or downwards; two sides are left one way.
    pub fn has_end(&self, site: usize, upwards: bool, branch: i32) -> bool {
        match self.sites[site] {
            Site::Sides { .. } => !upwards,
            Site::Pieces { table, .. } => {
                self.tables[table].piece(branch).1[usize::from(upwards)].is_finite()
            }
        }
    }

    /// The branch beyond that end.
    pub fn next_branch(&self, site: usize, upwards: bool, branch: i32) -> i32 {
        match self.sites[site] {
            Site::Sides { .. } => 1 - branch,
            Site::Pieces { .. } if upwards => branch.saturating_add(1),
            Site::Pieces { .. } => branch.saturating_sub(1),
        }
    }

    #[inline]
    fn expand_operation<S: Scalar>(
        &self,
        node: usize,
        k: usize,
        coordinates: &[S; COORDINATES],
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
            Operation::Coordinate(coordinate) => coordinates[coordinate as usize],
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
