//! The C interfaces on the test model, called as an importer calls them.

mod fmi2;
mod fmi3;
mod harness;
