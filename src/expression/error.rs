//! What may be wrong with an equation.

use thiserror::Error;

/// A reason to refuse an equation, and where.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("column {column}: {reason}")]
pub struct ExpressionError {
    /// Position in the text, counted from 1 in characters.
    pub column: usize,
    /// What is wrong and what would be right.
    pub reason: String,
}

impl ExpressionError {
    #[cold]
    pub(super) fn new(column: usize, reason: impl Into<String>) -> Self {
        Self {
            column,
            reason: reason.into(),
        }
    }
}
