//! Whether a file can be handed to the system's loader at all. The loader maps a library as its headers say; one that
//! is cut off then ends the process with a signal instead of an error.

use object::{Architecture, FileKind, Object, ObjectSegment};
use thiserror::Error;

use crate::platform::Platform;

/// Why a file is not loaded.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum HeaderError {
    /// No library of any system.
    #[error("it is not a shared library: {0}")]
    NotALibrary(String),
    /// A library for another processor.
    #[error("it is for the processor {found:?}; this machine is {needed:?}")]
    OtherProcessor {
        /// Processor of the file.
        found: Architecture,
        /// Processor of this machine.
        needed: Architecture,
    },
    /// A part of it is missing.
    #[error("it is cut off: its headers want {wanted} bytes, it has {present}")]
    CutOff {
        /// Bytes that the headers tell of.
        wanted: u64,
        /// Bytes that are there.
        present: u64,
    },
}

/// The platform that a library is for, if FMI has a folder for it.
///
/// # Errors
/// [`HeaderError::NotALibrary`] for a file that is no library of any platform.
pub fn platform(bytes: &[u8]) -> Result<Option<Platform>, HeaderError> {
    let file = parse(bytes)?;
    Ok(Platform::ALL
        .into_iter()
        .find(|platform| platform.machine() == (file.format(), file.architecture())))
}

/// Looks at the headers of a library that is about to be loaded.
///
/// # Errors
/// [`HeaderError`] with what would go wrong.
pub fn check(bytes: &[u8]) -> Result<(), HeaderError> {
    let kind = FileKind::parse(bytes).map_err(not_a_library)?;
    if matches!(kind, FileKind::MachOFat32 | FileKind::MachOFat64) {
        // Several processors in one file; the loader takes its own part.
        return Ok(());
    }
    let file = parse(bytes)?;
    let needed = match std::env::consts::ARCH {
        "x86_64" => Architecture::X86_64,
        "aarch64" => Architecture::Aarch64,
        _ => file.architecture(),
    };
    if file.architecture() != needed {
        return Err(HeaderError::OtherProcessor {
            found: file.architecture(),
            needed,
        });
    }
    complete(&file, bytes)
}

/// Whether all that the headers of `file` tell of is in `bytes`.
///
/// # Errors
/// [`HeaderError::CutOff`].
pub fn complete(file: &object::File<'_>, bytes: &[u8]) -> Result<(), HeaderError> {
    let present = bytes.len() as u64;
    let wanted = file
        .segments()
        .map(|segment| segment.file_range())
        .map(|(begin, size)| begin.saturating_add(size))
        .max()
        .unwrap_or(0);
    if wanted > present {
        return Err(HeaderError::CutOff { wanted, present });
    }
    Ok(())
}

/// The library's headers.
///
/// # Errors
/// [`HeaderError::NotALibrary`].
pub fn parse(bytes: &[u8]) -> Result<object::File<'_>, HeaderError> {
    object::File::parse(bytes).map_err(not_a_library)
}

fn not_a_library(error: object::Error) -> HeaderError {
    HeaderError::NotALibrary(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_program_passes_and_each_beginning_of_it_is_refused() {
        let whole = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        assert_eq!(check(&whole), Ok(()));
        for length in [0, 3, 60, 4096, whole.len() / 4, whole.len() / 2] {
            assert!(check(&whole[..length]).is_err(), "{length} bytes");
        }
        assert!(matches!(
            check(b"not a library at all"),
            Err(HeaderError::NotALibrary(_))
        ));
    }
}
