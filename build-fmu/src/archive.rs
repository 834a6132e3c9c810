//! Zip archives as FMI importers accept them everywhere: deflate, version 2.0, fixed timestamps, plain names.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use thiserror::Error;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// Why an archive could not be made or written.
#[derive(Debug, Error)]
pub enum ArchiveError {
    /// An entry name that some unpacker would put elsewhere, or two entries that collide.
    #[error("archive entry `{name}`: {reason}")]
    EntryName {
        /// The name as given.
        name: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// The zip writer refused.
    #[error("archive entry `{name}` could not be packed: {source}")]
    Pack {
        /// Entry at which it happened.
        name: String,
        /// The zip writer's reason.
        source: zip::result::ZipError,
    },
    /// The folder could not be made.
    #[error("the folder {} could not be made: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file could not be written.
    #[error("{} could not be written: {source}", path.display())]
    Write {
        /// File or folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
}

/// A library compressed once, for all archives that it goes into.
#[derive(Debug, Clone)]
pub struct CompressedLibrary {
    /// An archive that has it alone.
    archive: Arc<Vec<u8>>,
}

impl CompressedLibrary {
    /// Compresses a library's bytes.
    ///
    /// # Errors
    /// [`ArchiveError::Pack`] if the zip writer refuses.
    pub fn new(content: &[u8]) -> Result<Self, ArchiveError> {
        let mut alone = Archive::default();
        alone.add(&format!("{BINARIES}library"), content)?;
        Ok(Self {
            archive: Arc::new(alone.to_bytes()?),
        })
    }

    /// Adds it to an archive as the file `name`.
    fn copy(
        &self,
        name: &str,
        writer: &mut ZipWriter<Cursor<Vec<u8>>>,
    ) -> zip::result::ZipResult<()> {
        let mut archive = ZipArchive::new(Cursor::new(self.archive.as_slice()))?;
        writer.raw_copy_file_rename(archive.by_index_raw(0)?, name)
    }
}

/// Folder of the libraries, which may be executed.
const BINARIES: &str = "binaries/";

/// A file of an archive.
#[derive(Debug, Clone)]
enum Content {
    Bytes(Vec<u8>),
    Library(CompressedLibrary),
}

/// Files of an archive by their name inside it, packed in alphabetical order.
#[derive(Debug, Default, Clone)]
pub struct Archive {
    entries: BTreeMap<String, Content>,
}

impl Archive {
    /// Adds a file under a relative name with `/` between folders.
    ///
    /// # Errors
    /// [`ArchiveError::EntryName`] if the name is absolute, holds a backslash, `.` or `..`, or is taken.
    pub fn add(&mut self, name: &str, content: impl Into<Vec<u8>>) -> Result<(), ArchiveError> {
        self.insert(name, Content::Bytes(content.into()))
    }

    /// As [`Archive::add`], a library.
    ///
    /// # Errors
    /// As [`Archive::add`].
    pub fn add_library(
        &mut self,
        name: &str,
        library: CompressedLibrary,
    ) -> Result<(), ArchiveError> {
        self.insert(name, Content::Library(library))
    }

    fn insert(&mut self, name: &str, content: Content) -> Result<(), ArchiveError> {
        let refuse = |reason| ArchiveError::EntryName {
            name: name.to_owned(),
            reason,
        };
        if name.contains(['\\', ':', '\0']) {
            return Err(refuse(
                "backslashes, colons and NUL are not portable; separate folders by `/`",
            ));
        }
        if name.split('/').any(|part| matches!(part, "" | "." | "..")) {
            return Err(refuse("must be a plain relative path"));
        }
        if self
            .entries
            .keys()
            .any(|taken| taken.eq_ignore_ascii_case(name))
        {
            return Err(refuse("is already in the archive"));
        }
        self.entries.insert(name.to_owned(), content);
        Ok(())
    }

    /// The archive as zip bytes; equal content gives equal bytes.
    ///
    /// # Errors
    /// [`ArchiveError::Pack`] if the zip writer refuses an entry.
    pub fn to_bytes(&self) -> Result<Vec<u8>, ArchiveError> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in &self.entries {
            let pack = |source| ArchiveError::Pack {
                name: name.clone(),
                source,
            };
            let content = match content {
                Content::Bytes(bytes) => bytes,
                Content::Library(library) => {
                    library.copy(name, &mut writer).map_err(pack)?;
                    continue;
                }
            };
            let options = SimpleFileOptions::default()
                .compression_method(CompressionMethod::Deflated)
                .compression_level(Some(9))
                .last_modified_time(DateTime::default())
                .unix_permissions(if name.starts_with(BINARIES) {
                    0o755
                } else {
                    0o644
                })
                .large_file(false);
            writer.start_file(name.as_str(), options).map_err(pack)?;
            writer
                .write_all(content)
                .map_err(|error| pack(error.into()))?;
        }
        let cursor = writer.finish().map_err(|source| ArchiveError::Pack {
            name: "central directory".to_owned(),
            source,
        })?;
        Ok(cursor.into_inner())
    }
}

/// Writes a file whole or not at all: into a temporary file beside it, then renamed. Makes the folder if needed.
///
/// # Errors
/// [`ArchiveError::Folder`] or [`ArchiveError::Write`] with the path that failed.
pub fn write_atomically(path: &Path, content: &[u8]) -> Result<(), ArchiveError> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let failed = |at: &Path| {
        let path = at.to_owned();
        move |source| ArchiveError::Write { path, source }
    };
    fs::create_dir_all(folder).map_err(|source| ArchiveError::Folder {
        path: folder.to_owned(),
        source,
    })?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".build-fmu-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o644));
    }
    let mut file = builder.tempfile_in(folder).map_err(failed(folder))?;
    file.write_all(content).map_err(failed(path))?;
    file.as_file().sync_all().map_err(failed(path))?;
    file.persist(path)
        .map_err(|error| failed(path)(error.error))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Archive {
        let mut archive = Archive::default();
        archive.add("modelDescription.xml", "<a/>").unwrap();
        archive
            .add("binaries/linux64/Rig.so", vec![7; 10_000])
            .unwrap();
        archive
    }

    #[test]
    fn same_content_gives_same_bytes_whatever_the_order() {
        let mut other = Archive::default();
        other
            .add("binaries/linux64/Rig.so", vec![7; 10_000])
            .unwrap();
        other.add("modelDescription.xml", "<a/>").unwrap();
        assert_eq!(sample().to_bytes().unwrap(), other.to_bytes().unwrap());
    }

    #[test]
    fn a_library_compressed_before_gives_the_same_bytes() {
        let mut other = Archive::default();
        other.add("modelDescription.xml", "<a/>").unwrap();
        let library = CompressedLibrary::new(&[7; 10_000]).unwrap();
        other
            .add_library("binaries/linux64/Rig.so", library)
            .unwrap();
        assert_eq!(sample().to_bytes().unwrap(), other.to_bytes().unwrap());
    }

    #[test]
    fn version_needed_is_at_most_2_0_and_timestamps_are_fixed() {
        let bytes = sample().to_bytes().unwrap();
        let mut headers = 0;
        for start in 0..bytes.len() - 12 {
            if bytes[start..].starts_with(b"PK\x03\x04") {
                headers += 1;
                let word =
                    |at: usize| u16::from_le_bytes([bytes[start + at], bytes[start + at + 1]]);
                assert!(word(4) <= 20, "version needed {}", word(4));
                assert_eq!((word(10), word(12)), (0, 0x21), "1980-01-01 00:00");
            }
        }
        assert_eq!(headers, 2);
    }

    #[test]
    fn names_that_escape_the_archive_are_refused() {
        for name in [
            "/etc/passwd",
            "../x",
            "a/../b",
            "a\\b",
            "C:/x",
            "a//b",
            "./a",
            "",
        ] {
            assert!(Archive::default().add(name, "").is_err(), "{name}");
        }
        assert!(
            sample().add("MODELDESCRIPTION.XML", "").is_err(),
            "collides on Windows"
        );
    }

    #[test]
    fn a_failed_write_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/out.fmu");
        write_atomically(&path, b"first").unwrap();
        write_atomically(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        let blocked = path.join("below-a-file.fmu");
        let error = write_atomically(&blocked, b"x").unwrap_err();
        assert!(error.to_string().contains("out.fmu"), "{error}");
        assert_eq!(
            fs::read_dir(folder.path().join("new")).unwrap().count(),
            1,
            "no rest of a temporary file"
        );
    }
}
