//! An FMU as untrusted bytes: read into memory with limits, never unpacked to the disk by its own names.

use std::fs;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

use thiserror::Error;
use zip::ZipArchive;

use super::zip_directory::{self, DirectoryEntry};

/// Entries beyond which an archive is taken for hostile.
const MAX_ENTRIES: usize = 20_000;
/// Size of the archive beyond which it is not read.
const MAX_FILE: u64 = 128 << 20;
/// Uncompressed bytes of all entries beyond which an archive is taken for hostile.
const MAX_TOTAL: u64 = 256 << 20;
/// Uncompressed over compressed size beyond which a large entry is taken for a bomb; deflate itself ends at 1032.
const MAX_RATIO: u64 = 200;
/// Uncompressed size below which the ratio does not matter.
const RATIO_FLOOR: u64 = 16 << 20;

/// Why a file cannot be checked at all.
#[derive(Debug, Error)]
pub enum OpenError {
    /// The file cannot be read.
    #[error("{} could not be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file is not a zip archive.
    #[error("{} is not a zip archive: {reason}", path.display())]
    NotZip {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The archive would grow too large.
    #[error("{} is refused: {reason}", path.display())]
    Bomb {
        /// The file.
        path: PathBuf,
        /// Which limit it breaks.
        reason: String,
    },
}

/// An opened FMU.
#[derive(Debug)]
pub struct Package {
    archive: ZipArchive<Cursor<Vec<u8>>>,
    pub(super) directory: Vec<DirectoryEntry>,
}

impl Package {
    /// Opens an FMU.
    ///
    /// # Errors
    /// [`OpenError`] if the file is no archive or one that is too large to unpack.
    pub fn open(path: &Path) -> Result<Self, OpenError> {
        let unreadable = |source| OpenError::Read {
            path: path.to_owned(),
            source,
        };
        let size = fs::metadata(path).map_err(unreadable)?.len();
        if size > MAX_FILE {
            return Err(OpenError::Bomb {
                path: path.to_owned(),
                reason: format!("{size} bytes, more than {MAX_FILE}"),
            });
        }
        let bytes = fs::read(path).map_err(unreadable)?;
        let not_zip = |reason: String| OpenError::NotZip {
            path: path.to_owned(),
            reason,
        };
        let directory = zip_directory::read(&bytes)
            .ok_or_else(|| not_zip("there is no complete central directory".to_owned()))?;
        if let Some(reason) = bomb(&directory) {
            return Err(OpenError::Bomb {
                path: path.to_owned(),
                reason,
            });
        }
        let archive =
            ZipArchive::new(Cursor::new(bytes)).map_err(|error| not_zip(error.to_string()))?;
        Ok(Self { archive, directory })
    }

    /// Whether there is a file of this name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.directory.iter().any(|entry| entry.name == name)
    }

    /// Names of all files, in the archive's order.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.directory
            .iter()
            .map(|entry| entry.name.as_str())
            .filter(|name| !name.ends_with('/'))
    }

    /// A file's bytes, never more than the directory announced; the reason if they cannot be had.
    pub(super) fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        let mut archive = self.archive.clone();
        let file = archive.by_name(name).map_err(|error| error.to_string())?;
        let announced = file.size();
        let mut bytes = Vec::new();
        file.take(announced + 1)
            .read_to_end(&mut bytes)
            .map_err(|error| error.to_string())?;
        if bytes.len() as u64 != announced {
            return Err(format!(
                "{} bytes announced, {} found",
                announced,
                bytes.len()
            ));
        }
        Ok(bytes)
    }
}

fn bomb(directory: &[DirectoryEntry]) -> Option<String> {
    if directory.len() > MAX_ENTRIES {
        return Some(format!(
            "{} entries, more than {MAX_ENTRIES}",
            directory.len()
        ));
    }
    let total: u64 = directory.iter().map(|entry| entry.size).sum();
    if total > MAX_TOTAL {
        return Some(format!(
            "{total} bytes when unpacked, more than {MAX_TOTAL}"
        ));
    }
    let entry = directory.iter().find(|entry| {
        entry.size > RATIO_FLOOR && entry.size / entry.compressed_size.max(1) > MAX_RATIO
    })?;
    Some(format!(
        "entry {} grows from {} to {} bytes, a ratio above {MAX_RATIO}",
        entry.name, entry.compressed_size, entry.size
    ))
}
