//! Packs the `stickslip` library and a `model.toml` into FMUs that any FMI 2.0 or 3.0 importer takes.
//!
//! The order of things: [`model_description`] writes the XML from the one variable table,
//! [`binary_check`] loads the library and makes it accept the model, [`contents`] lays out the
//! folders, [`archive`] zips them reproducibly, [`build`] does all of it. [`ssp`] packs several connected components. [`lint`] checks any FMU, and
//! [`component`] runs one.

pub mod archive;
pub mod binary_check;
pub mod binary_error;
pub mod binary_header;
pub mod build;
pub mod cli;
pub mod component;
pub mod contents;
pub mod documentation;
pub mod explain;
pub mod icon;
pub mod library;
pub mod lint;
pub mod model_description;
pub mod platform;
pub mod reference;
pub mod ssp;
pub mod symbols;
pub mod zip_directory;
