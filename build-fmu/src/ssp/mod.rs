//! System structure archives (SSP 1.0 or 2.0): components with their connections in one file.

mod description;
mod system;

pub use system::{System, SystemError};

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::archive::{Archive, ArchiveError, write_atomically};
use crate::build::BuildError;
use crate::library::Library;
use crate::model_description::XmlError;
use crate::platform::FmiVersion;

/// A version of the standard of archives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SspVersion {
    /// SSP 1.0, which more programs read; it was written for FMI 2.
    One,
    /// SSP 2.0, which knows the types of FMI 3.
    Two,
}

impl SspVersion {
    /// As the files state it.
    pub fn number(self) -> &'static str {
        match self {
            Self::One => "1.0",
            Self::Two => "2.0",
        }
    }
}

/// Why an archive could not be built.
#[derive(Debug, Error)]
pub enum SspError {
    /// A component could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The description could not be written.
    #[error(transparent)]
    Xml(#[from] XmlError),
    /// The archive could not be packed or written.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
}

/// Builds the components of `system`, packs them with its description, and writes the archive into
/// `folder`, whole or not at all; returns its path.
///
/// # Errors
/// [`SspError`] if one of the steps fails.
pub fn build(
    system: &System,
    libraries: &[Library],
    version: FmiVersion,
    ssp: SspVersion,
    folder: &Path,
) -> Result<PathBuf, SspError> {
    let mut archive = Archive::default();
    let description = description::write(system, version, ssp)?;
    archive.add("SystemStructure.ssd", description)?;
    for source in system.components() {
        let name = format!("resources/{}", source.fmu_file_name(version));
        archive.add(&name, source.to_bytes(libraries, version)?)?;
    }
    let path = folder.join(format!("{}.{}.ssp", system.name(), version.tag()));
    write_atomically(&path, &archive.to_bytes()?)?;
    Ok(path)
}
