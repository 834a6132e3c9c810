//! Why a library must not be packed, as the user reads it.

use std::path::PathBuf;

use thiserror::Error;

use crate::binary_header::HeaderError;
use crate::platform::FmiVersion;

/// Why a library must not be packed.
#[derive(Debug, Error)]
pub enum BinaryError {
    /// The temporary copy that is loaded could not be made.
    #[error("the library could not be copied to {} for its check: {source}", path.display())]
    Copy {
        /// Folder or file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file is not loaded, because of what its headers say.
    #[error("{} cannot be loaded: {source}", path.display())]
    Header {
        /// The library as named by the user.
        path: PathBuf,
        /// What is wrong.
        source: HeaderError,
    },
    /// The system's loader refuses the file.
    #[error("{} is not a library that this system can load: {source}", path.display())]
    Load {
        /// The library as named by the user.
        path: PathBuf,
        /// The loader's reason.
        source: libloading::Error,
    },
    /// Functions of the standard are not exported.
    #[error("{} lacks {} of the functions of {version}: {}", path.display(), missing.len(), missing.join(", "))]
    Symbols {
        /// The library.
        path: PathBuf,
        /// The standard.
        version: FmiVersion,
        /// Names that were not found.
        missing: Vec<String>,
    },
    /// The library answers another version.
    #[error("{} says it is version {found:?} of FMI, {} is needed", path.display(), version.number())]
    Version {
        /// The library.
        path: PathBuf,
        /// The version that was asked for.
        version: FmiVersion,
        /// What the library answered.
        found: String,
    },
    /// The library does not instantiate the model.
    #[error(
        "{} does not instantiate the model for {version} with token {token}: {}", path.display(),
        if messages.is_empty() { "no reason logged".to_owned() } else { messages.join("; ") }
    )]
    Instantiate {
        /// The library.
        path: PathBuf,
        /// The standard.
        version: FmiVersion,
        /// The token of the model description.
        token: String,
        /// What the library logged.
        messages: Vec<String>,
    },
    /// The library takes any token.
    #[error("{} instantiates the model for {version} with a token that is not its own", path.display())]
    AcceptsForeignToken {
        /// The library.
        path: PathBuf,
        /// The standard.
        version: FmiVersion,
    },
}
