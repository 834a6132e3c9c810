//! `modelDescription.xml` of both standards and `terminalsAndIcons.xml`, written from the variable table.

mod common;
mod facts;
mod fmi2;
mod fmi3;
mod quantity;
mod terminals;
mod xml;

pub use facts::Facts;
pub use quantity::{QuantityType, quantity_type};
pub use terminals::terminals_and_icons;
pub use xml::XmlError;

use crate::platform::FmiVersion;

/// The model description for one version of the standard, as UTF-8 text that ends with a newline.
///
/// # Errors
/// [`XmlError`] if the XML writer fails.
pub fn model_description(facts: &Facts<'_>, version: FmiVersion) -> Result<String, XmlError> {
    match version {
        FmiVersion::Fmi2 => fmi2::write(facts),
        FmiVersion::Fmi3 => fmi3::write(facts),
    }
}
