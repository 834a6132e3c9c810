//! An equation as a list of operations, and the branches on which its kinks are.

use super::{Dimension, ExpressionError, Table};
use crate::series::{Scalar, Series, TERMS};
use operations::Operation;

/// Most kinks of all equations of a plant together.
pub const SITES: usize = 12;
/// Most parameters of one equation.
pub const MOST_PARAMETERS: usize = 6;

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
    /// Dimension of every operation.
    pub(super) dimensions: Vec<Dimension>,
}

/// Series of all operations of a program.
#[derive(Clone, Debug)]
pub struct ExpressionJet<S> {
    pub(super) values: Vec<Series<S>>,
    /// What a recurrence needs beside the value: the other of sine and cosine, 1 − tanh², a weighted argument, a watched
    /// difference.
    pub(super) others: Vec<[Series<S>; 2]>,
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
    /// The equation times the coordinate at this place.
    pub(crate) fn times_coordinate(mut self, place: usize) -> Self {
        let root = self.operations.len() - 1;
        self.push(Operation::Coordinate(place));
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
        self.add(operation, 1);
    }

    /// Appends an operation that stands at this column of the text.
    pub(super) fn add(&mut self, operation: Operation, column: usize) {
        // A kink is watched as a series, even one of constants.
        let is_constant = !matches!(operation, Operation::Coordinate(_))
            && operation.site().is_none()
            && operation.operands().all(|operand| self.constant[operand]);
        if !is_constant {
            self.varying.push(self.operations.len());
        }
        self.constant.push(is_constant);
        self.operations.push(operation);
        self.columns.push(column);
    }

    /// Places where the equation is not smooth.
    pub fn sites(&self) -> &[Site] {
        &self.sites
    }

    /// Dimension of what is watched at each of them.
    pub(crate) fn watched_dimensions(&self) -> impl Iterator<Item = Dimension> {
        self.sites.iter().map(|site| {
            let (Site::Sides { node } | Site::Pieces { node, .. }) = *site;
            let watched = self.operations[node].operands().next();
            watched.map_or(Dimension::NONE, |operand| self.dimensions[operand])
        })
    }

    /// Series to work on.
    pub fn new_jet<S: Scalar>(&self) -> ExpressionJet<S> {
        let zero = [S::ZERO; TERMS];
        ExpressionJet {
            values: vec![zero; self.operations.len()],
            others: vec![[zero; 2]; self.operations.len()],
        }
    }

    /// The operations, the equation's value last.
    pub fn operations(&self) -> &[Operation] {
        &self.operations
    }

    /// Whether the equation depends on the coordinate at this place.
    pub fn uses(&self, place: usize) -> bool {
        self.operations.contains(&Operation::Coordinate(place))
    }

    /// The branches on which every site is at these values.
    pub fn branches<S: Scalar>(
        &self,
        coordinates: &[S],
        parameters: &[S],
        branches: &mut [i32],
        jet: &mut ExpressionJet<S>,
    ) {
        for node in 0..self.operations.len() {
            if let Some(site) = self.operations[node].site() {
                branches[site] = self.branch_at(node, jet);
            }
            self.expand_operation(node, 0, coordinates, parameters, branches, jet);
        }
    }

    /// Coefficient `k` of the equation's value; those before it must have been computed on the same jet.
    pub fn expand_order<S: Scalar>(
        &self,
        k: usize,
        coordinates: &[S],
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

    /// The branch beyond that end, where the present values lie on `found`: new inputs may lie many pieces further, and at a knot
    /// rounding decides on which of two pieces a value is.
    pub fn next_branch(&self, site: usize, upwards: bool, branch: i32, found: i32) -> i32 {
        match self.sites[site] {
            Site::Sides { .. } => 1 - branch,
            Site::Pieces { .. } if upwards => branch.saturating_add(1).max(found),
            Site::Pieces { .. } => branch.saturating_sub(1).min(found),
        }
    }
}
