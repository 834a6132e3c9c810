//! The built FMUs: against the kept copies of their descriptions and, in a Rust importer, against the native
//! model; spoiled, in the check.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail by panicking, like the tests"
)]

mod component;
mod exchange_importer;
mod exchange_mutations;
mod importer;
mod kept_copies;
mod mutations;
mod reference_mutations;
mod references;
mod spoiled;
