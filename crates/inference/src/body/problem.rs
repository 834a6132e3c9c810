//! What is fitted: residuals of a model on records, in pieces.

use super::known::Known;
use super::model::Model;

/// Residuals of any model of one plant on one set of records.
pub trait Problem: Sync {
    /// Residuals piece by piece, every one in the same unit; a model that cannot run gives non-finite ones.
    ///
    /// Pieces are consecutive stretches, long against the time over which residuals are correlated.
    fn residuals(&self, model: &Model) -> Vec<Vec<f64>>;

    /// Numbers of the model that were known before.
    fn known(&self) -> &[Known] {
        &[]
    }

    /// How the residuals grow with a number, where that is known without another run of the model; `residuals` are those of `model`.
    fn slopes(
        &self,
        _model: &Model,
        _residuals: &[Vec<f64>],
        _place: (usize, usize),
    ) -> Option<Vec<Vec<f64>>> {
        None
    }

    /// A smoother problem of the same plant from which fits of this one start; `None` where they start from themselves.
    fn first_look(&self) -> Option<&dyn Problem> {
        None
    }

    /// Which fold each piece belongs to, 0, 1, …: pieces of one fold are left out together.
    fn folds(&self) -> &[usize];
}

/// Sum of squares over all pieces.
#[must_use]
pub fn square(residuals: &[Vec<f64>]) -> f64 {
    residuals.iter().flatten().map(|r| r * r).sum()
}
