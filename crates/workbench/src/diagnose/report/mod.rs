//! `report.html`: one self-contained page with the answer on top, light, dark and printable.

mod candidates;
pub(super) mod figures;
pub(super) mod markup;
pub(super) mod page;
mod residuals;

use crate::diagnose::case::Case;
use crate::diagnose::finding::Finding;
use crate::diagnose::made::Made;
use crate::diagnose::residual_torque::ResidualTorque;
use crate::diagnose::show::Comparison;

/// Name of the page in the output directory.
pub const FILE: &str = "report.html";

/// What the page is made of.
pub struct Report<'a> {
    /// The case.
    pub case: &'a Case,
    /// What it was made of.
    pub made: &'a Made,
    /// What was found.
    pub finding: &'a Finding,
    /// Before and after on the held-out record.
    pub comparison: &'a Comparison,
    /// Residual torques of the analyst's model on the records learned from.
    pub residuals_before: &'a [ResidualTorque],
    /// Residual torques of the amended model there.
    pub residuals_after: &'a [ResidualTorque],
    /// Residual torques of the amended model on the held-out record.
    pub residuals_held_out: &'a [ResidualTorque],
}

impl Report<'_> {
    /// The page as HTML that is well-formed XML too.
    #[must_use]
    pub fn to_html(&self) -> String {
        page::page(self)
    }
}
