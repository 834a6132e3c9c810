//! XML of an FMU that anybody may have written: read with limits, linear in its length.

use std::collections::BTreeMap;

use quick_xml::events::BytesStart;

use super::package::Package;

/// Largest file that is read [bytes]: some 50,000 variables.
const LARGEST: usize = 16 << 20;
/// Most attributes of an element. Each is compared with each, so a hundred thousand would take minutes.
const MOST_ATTRIBUTES: usize = 256;

/// Attributes of an element.
pub(super) type Attributes = BTreeMap<String, String>;

/// The text of a file of the FMU.
pub(super) fn text(package: &Package, file: &str) -> Result<String, String> {
    let bytes = package.read(file)?;
    if bytes.len() > LARGEST {
        return Err(format!(
            "has {} bytes; more than {LARGEST} are not read",
            bytes.len()
        ));
    }
    String::from_utf8(bytes).map_err(|error| format!("is not UTF-8: {error}"))
}

/// The attributes of an element, with their entities resolved.
pub(super) fn attributes(element: &BytesStart<'_>) -> Result<Attributes, String> {
    element
        .attributes()
        .enumerate()
        .map(|(place, attribute)| {
            if place == MOST_ATTRIBUTES {
                return Err(format!(
                    "has an element with more than {MOST_ATTRIBUTES} attributes"
                ));
            }
            let attribute = attribute.map_err(|error| format!("is not well-formed: {error}"))?;
            let name = attribute.key.as_ref().to_owned();
            let value = attribute
                .normalized_value(quick_xml::XmlVersion::Implicit1_0)
                .map_err(|error| format!("attribute {name} is not well-formed: {error}"))?;
            Ok((name, value.into_owned()))
        })
        .collect()
}
