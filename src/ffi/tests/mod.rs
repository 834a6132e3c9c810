//! The C interfaces on the test model, called as an importer calls them.

mod fmi2_calls;
mod fmi2_values;
mod fmi3;
mod harness;
mod panics;
