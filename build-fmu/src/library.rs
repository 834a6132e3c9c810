//! Finds the prebuilt library: as named, or beside the running program.

use std::fs;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::platform::Platform;

/// A shared library read whole, so that what is checked is what is packed.
#[derive(Debug, Clone)]
pub struct Library {
    /// Where it was found.
    pub path: PathBuf,
    /// The platform that it runs on.
    pub platform: Platform,
    /// The file's bytes.
    pub content: Vec<u8>,
}

/// Why there is no library to pack.
#[derive(Debug, Error)]
pub enum LibraryError {
    /// FMI has no folder for the machine that this runs on.
    #[error(
        "FMI names no platform folder for {os} on {architecture}; build the FMU on Linux, Windows or macOS, x86-64 or aarch64"
    )]
    Platform {
        /// Operating system.
        os: &'static str,
        /// Processor architecture.
        architecture: &'static str,
    },
    /// No library beside the program.
    #[error(
        "the model's library was not found; looked for {}. Put {file_name} beside this program \
         (`cargo build --release` in the source tree makes it) or name it with --library",
        looked_for.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(" and ")
    )]
    NotFound {
        /// File name of the library on this platform.
        file_name: &'static str,
        /// All places that were tried.
        looked_for: Vec<PathBuf>,
    },
    /// The library is there but cannot be read.
    #[error("library {} could not be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
}

/// Reads the library at `named`, or else the one beside the running program.
///
/// A program in a `deps` or `examples` folder of a build tree (a test, for instance) also finds the library one folder up.
///
/// # Errors
/// [`LibraryError`], naming all the places that were tried.
pub fn find(named: Option<&Path>) -> Result<Library, LibraryError> {
    let platform = Platform::current().ok_or(LibraryError::Platform {
        os: std::env::consts::OS,
        architecture: std::env::consts::ARCH,
    })?;
    let looked_for = match named {
        Some(path) => vec![path.to_owned()],
        None => beside_program(platform.library_file_name()),
    };
    let Some(path) = looked_for.iter().find(|path| path.is_file()).cloned() else {
        return Err(LibraryError::NotFound {
            file_name: platform.library_file_name(),
            looked_for,
        });
    };
    match fs::read(&path) {
        Ok(content) => Ok(Library {
            path,
            platform,
            content,
        }),
        Err(source) => Err(LibraryError::Read { path, source }),
    }
}

fn beside_program(file_name: &str) -> Vec<PathBuf> {
    let Some(folder) = std::env::current_exe()
        .ok()
        .and_then(|program| program.parent().map(Path::to_owned))
    else {
        return vec![PathBuf::from(file_name)];
    };
    let mut places = vec![folder.join(file_name)];
    let in_build_tree = folder
        .file_name()
        .is_some_and(|name| name == "deps" || name == "examples");
    if let (true, Some(parent)) = (in_build_tree, folder.parent()) {
        places.push(parent.join(file_name));
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_library_is_named() {
        let error = find(Some(Path::new("/nowhere/libstickslip.so"))).unwrap_err();
        assert!(
            error.to_string().contains("/nowhere/libstickslip.so"),
            "{error}"
        );
        assert!(error.to_string().contains("--library"), "{error}");
    }
}
