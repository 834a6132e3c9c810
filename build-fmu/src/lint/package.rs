//! An FMU as an untrusted file: read with limits, never unpacked to the disk by its own names.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use thiserror::Error;
use zip::ZipArchive;

use crate::zip_directory::{self, DirectoryEntry, DirectoryError};

/// Unpacked bytes of all entries beyond which an archive is taken for hostile; some of them are held in memory.
const MOST_BYTES: u64 = 128 << 20;

/// Why a file cannot be checked at all.
#[derive(Debug, Error)]
pub enum OpenError {
    /// The file cannot be read.
    #[error("{} could not be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
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
    path: PathBuf,
    archive: ZipArchive<Arc<File>>,
    pub(super) directory: Vec<DirectoryEntry>,
    files: BTreeSet<String>,
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
        let not_zip = |reason: String| OpenError::NotZip {
            path: path.to_owned(),
            reason,
        };
        let bomb = |reason| OpenError::Bomb {
            path: path.to_owned(),
            reason,
        };
        // A pipe would be waited for, a device be read for ever.
        if !fs::metadata(path).map_err(unreadable)?.is_file() {
            return Err(not_zip("it is no file".to_owned()));
        }
        let mut file = Arc::new(File::open(path).map_err(unreadable)?);
        let directory = zip_directory::read(&mut file).map_err(|error| match error {
            DirectoryError::Read(source) => unreadable(source),
            DirectoryError::Incomplete => not_zip(error.to_string()),
            DirectoryError::TooLarge(reason) => bomb(reason),
        })?;
        if let Some(reason) = zip_directory::excess(&directory, MOST_BYTES) {
            return Err(bomb(reason));
        }
        let archive = ZipArchive::new(file).map_err(|error| not_zip(error.to_string()))?;
        let files = directory
            .iter()
            .map(|entry| entry.name.clone())
            .filter(|name| !name.ends_with('/'))
            .collect();
        Ok(Self {
            path: path.to_owned(),
            archive,
            directory,
            files,
        })
    }

    /// Where the FMU lies.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether there is a file of this name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.files.contains(name)
    }

    /// Names of all files, each once, in alphabetical order.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(String::as_str)
    }

    /// A file's bytes, never more than the directory announced; the reason if they cannot be had.
    pub(super) fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        let mut bytes = Vec::new();
        self.unpack(name, &mut bytes)?;
        Ok(bytes)
    }

    /// Unpacks a file and keeps nothing; the reason if that cannot be done.
    pub(super) fn test(&self, name: &str) -> Result<(), String> {
        self.unpack(name, &mut io::sink())
    }

    fn unpack(&self, name: &str, target: &mut impl io::Write) -> Result<(), String> {
        let mut archive = self.archive.clone();
        let file = archive.by_name(name).map_err(|error| error.to_string())?;
        let announced = file.size();
        let found = io::copy(&mut file.take(announced.saturating_add(1)), target)
            .map_err(|error| error.to_string())?;
        if found != announced {
            return Err(format!("{announced} bytes announced, {found} found"));
        }
        Ok(())
    }
}
