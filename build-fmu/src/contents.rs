//! What is in an FMU and where: the folders of both standards.

use stickslip::cosim::MODEL_FILE;
use thiserror::Error;

use crate::archive::{Archive, ArchiveError};
use crate::documentation;
use crate::icon::{self, IconError};
use crate::library::Library;
use crate::model_description::{Facts, XmlError, model_description, terminals_and_icons};
use crate::platform::FmiVersion;

const LICENSE_MIT: &str = include_str!("../../docs/licences/MIT.txt");
const LICENSE_APACHE: &str = include_str!("../../docs/licences/Apache-2.0.txt");
const LICENSE_ENTRY: &str = "stickslip is licensed under either of\n\n\
    * the MIT License (LICENSE-MIT)\n* the Apache License, Version 2.0 (LICENSE-APACHE)\n\nat your option.\n";
const LICENSE_SPDX: &str = "SPDXVersion: SPDX-2.3\nDataLicense: CC0-1.0\nPackageName: stickslip\n\
    PackageLicenseDeclared: MIT OR Apache-2.0\n";

/// What the library is made of, in CycloneDX; `tests/dependencies` keeps it that of Cargo.lock.
const BILL_OF_MATERIALS: &str = include_str!("../assets/sbom.cdx.json");

/// Why an FMU's content could not be put together.
#[derive(Debug, Error)]
pub enum ContentsError {
    /// The XML could not be written.
    #[error(transparent)]
    Xml(#[from] XmlError),
    /// The icon could not be drawn.
    #[error(transparent)]
    Icon(#[from] IconError),
    /// A file could not be added.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
}

/// All files of the FMU, `model_toml` being the resource as text, `model` the same parsed and `references` the files of the
/// reference run.
///
/// # Errors
/// [`ContentsError`] if one of the files cannot be made.
pub fn contents(
    facts: &Facts<'_>,
    version: FmiVersion,
    libraries: &[Library],
    model_toml: &str,
    model: &toml::Table,
    references: &[(String, String)],
) -> Result<Archive, ContentsError> {
    let mut archive = Archive::default();
    archive.add("modelDescription.xml", model_description(facts, version)?)?;
    archive.add(&format!("resources/{MODEL_FILE}"), model_toml)?;
    archive.add(
        "documentation/index.html",
        documentation::page(facts, model, references),
    )?;
    archive.add("documentation/sbom.cdx.json", BILL_OF_MATERIALS)?;
    for (name, content) in references {
        archive.add(name, content.as_str())?;
    }
    for library in libraries {
        let binary = format!(
            "binaries/{}/{}.{}",
            library.platform.folder(version),
            facts.identity.model_identifier,
            library.platform.library_extension()
        );
        archive.add_library(&binary, library.compressed()?)?;
    }
    let icon = icon::png()?;
    let licenses = match version {
        FmiVersion::Fmi2 => {
            archive.add("model.png", icon)?;
            "licenses"
        }
        FmiVersion::Fmi3 => {
            archive.add("terminalsAndIcons/icon.png", icon)?;
            archive.add(
                "terminalsAndIcons/terminalsAndIcons.xml",
                terminals_and_icons(facts)?,
            )?;
            "documentation/licenses"
        }
    };
    archive.add(&format!("{licenses}/license.txt"), LICENSE_ENTRY)?;
    archive.add(&format!("{licenses}/license.spdx"), LICENSE_SPDX)?;
    archive.add(&format!("{licenses}/LICENSE-MIT"), LICENSE_MIT)?;
    archive.add(&format!("{licenses}/LICENSE-APACHE"), LICENSE_APACHE)?;
    Ok(archive)
}
