//! The archive of an FMU, taken apart with distrust: an FMU may come from anywhere.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::zip_directory::{self, DirectoryError};
use tempfile::TempDir;
use thiserror::Error;
use zip::ZipArchive;

/// Most bytes that an archive may unpack to.
const MOST_BYTES: u64 = 256 << 20;

/// Why an archive was refused. Nothing of it remains on the disk.
#[derive(Debug, Error)]
pub enum ArchiveError {
    /// The file could not be read or a file not be written.
    #[error("{path}: cannot {step}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What was being done.
        step: &'static str,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The file is no sound zip archive.
    #[error("{path}: is not a sound zip archive: {reason}")]
    NotZip {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// An entry's name or type could do harm.
    #[error("{path}: refused, because its entry `{entry}` {problem}")]
    Hostile {
        /// The file.
        path: PathBuf,
        /// Name of the entry.
        entry: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// The archive is larger than any FMU needs to be.
    #[error("{path}: refused, because {reason}")]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Which limit it breaks.
        reason: String,
    },
}

/// An unpacked archive; its directory goes when this goes.
#[derive(Debug)]
pub struct Archive {
    directory: TempDir,
}

impl Archive {
    /// Unpacks `path` into a fresh directory of its own.
    ///
    /// # Errors
    /// [`ArchiveError`] where it is no archive, or where an entry would leave the directory, is a link, appears twice or
    /// makes it too large.
    pub fn unpack(path: &Path) -> Result<Self, ArchiveError> {
        let failed = |step| {
            move |source| ArchiveError::Io {
                path: path.to_owned(),
                step,
                source,
            }
        };
        let unsound = |reason: String| ArchiveError::NotZip {
            path: path.to_owned(),
            reason,
        };
        let too_large = |reason| ArchiveError::TooLarge {
            path: path.to_owned(),
            reason,
        };
        let not_zip = |error: zip::result::ZipError| unsound(error.to_string());
        // A pipe would be waited for, a device be read for ever.
        if !fs::metadata(path).map_err(failed("be opened"))?.is_file() {
            return Err(unsound("it is no file".to_owned()));
        }
        let mut file = File::open(path).map_err(failed("be opened"))?;
        let entries = zip_directory::read(&mut file).map_err(|error| match error {
            DirectoryError::Read(source) => failed("be read")(source),
            DirectoryError::Incomplete => unsound(error.to_string()),
            DirectoryError::TooLarge(reason) => too_large(reason),
        })?;
        if let Some(reason) = zip_directory::excess(&entries, MOST_BYTES) {
            return Err(too_large(reason));
        }
        drop(entries);
        let mut archive = ZipArchive::new(io::BufReader::new(file)).map_err(not_zip)?;
        let directory = TempDir::with_prefix("stickslip-fmu-")
            .map_err(failed("make a directory to unpack it into"))?;
        let mut left = MOST_BYTES;
        for index in 0..archive.len() {
            let mut entry = archive.by_index(index).map_err(not_zip)?;
            let name = entry.name().map_err(not_zip)?.into_owned();
            let hostile = |problem| ArchiveError::Hostile {
                path: path.to_owned(),
                entry: name.clone(),
                problem,
            };
            if let Some(problem) = name_problem(&name) {
                return Err(hostile(problem));
            }
            if !(entry.is_file() || entry.is_dir()) || entry.is_symlink() {
                return Err(hostile("is a link or a special file"));
            }
            let target = directory.path().join(&name);
            if entry.is_dir() {
                fs::create_dir_all(&target).map_err(failed("be unpacked"))?;
                continue;
            }
            if let Some(parent) = target.parent() {
                fs::create_dir_all(parent).map_err(failed("be unpacked"))?;
            }
            let mut output = match OpenOptions::new()
                .write(true)
                .create_new(true)
                .open(&target)
            {
                Ok(output) => output,
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    return Err(hostile("appears twice"));
                }
                Err(error) => return Err(failed("be unpacked")(error)),
            };
            // What the archive says of its sizes may be a lie; what comes out of it is counted.
            let limit = left.min(entry.size()).saturating_add(1);
            let written = io::copy(&mut (&mut entry).take(limit), &mut output)
                .map_err(|error| unsound(error.to_string()))?;
            if written > entry.size() {
                return Err(hostile("unpacks to more than it says"));
            }
            left = left
                .checked_sub(written)
                .ok_or_else(|| too_large(format!("it unpacks to more than {MOST_BYTES} bytes")))?;
        }
        Ok(Self { directory })
    }

    /// Where it was unpacked.
    #[must_use]
    pub fn directory(&self) -> &Path {
        self.directory.path()
    }
}

fn name_problem(name: &str) -> Option<&'static str> {
    if name.starts_with('/') || name.contains(':') {
        Some("has an absolute path")
    } else if name.contains('\\') || name.contains('\0') {
        Some("has a backslash or a null in its name")
    } else if name.split('/').any(|part| part == ".." || part == ".") {
        Some("leads out of the archive")
    } else if name.trim_end_matches('/').is_empty() || name.contains("//") {
        Some("has an empty name")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;
    use zip::write::SimpleFileOptions;

    fn archive(fill: impl FnOnce(&mut zip::ZipWriter<File>)) -> (TempDir, PathBuf) {
        let place = TempDir::new().unwrap();
        let path = place.path().join("test.fmu");
        let mut writer = zip::ZipWriter::new(File::create(&path).unwrap());
        fill(&mut writer);
        writer.finish().unwrap();
        (place, path)
    }

    fn with_entry(name: &str) -> Result<Archive, ArchiveError> {
        let (_place, path) = archive(|writer| {
            writer
                .start_file(name, SimpleFileOptions::default())
                .unwrap();
            writer.write_all(b"content").unwrap();
        });
        Archive::unpack(&path)
    }

    #[test]
    fn an_honest_archive_is_unpacked_and_removed_again() {
        let unpacked = with_entry("resources/model.toml").unwrap();
        let file = unpacked.directory().join("resources/model.toml");
        assert_eq!(fs::read(&file).unwrap(), b"content");
        drop(unpacked);
        assert!(!file.exists());
    }

    #[test]
    fn entries_that_leave_the_directory_are_refused() {
        for name in [
            "../evil",
            "/etc/evil",
            "a/../../evil",
            "C:/evil",
            "a\\..\\evil",
        ] {
            assert!(
                matches!(with_entry(name), Err(ArchiveError::Hostile { .. })),
                "{name}"
            );
        }
    }

    #[test]
    fn links_are_refused() {
        let (_place, path) = archive(|writer| {
            writer
                .add_symlink("binaries", "/usr/lib", SimpleFileOptions::default())
                .unwrap()
        });
        let refused = Archive::unpack(&path).unwrap_err();
        assert!(
            refused.to_string().contains("`binaries` is a link"),
            "{refused}"
        );
    }

    #[test]
    fn a_bomb_is_refused_before_it_fills_the_disk() {
        let (_place, path) = archive(|writer| {
            let zeros = vec![0_u8; 1 << 20];
            for index in 0..(MOST_BYTES >> 20) / 256 + 1 {
                writer
                    .start_file(format!("zeros-{index}"), SimpleFileOptions::default())
                    .unwrap();
                (0..256).for_each(|_| writer.write_all(&zeros).unwrap());
            }
        });
        assert!(matches!(
            Archive::unpack(&path),
            Err(ArchiveError::TooLarge { .. })
        ));
    }

    #[test]
    fn what_is_no_archive_is_said_to_be_none() {
        let place = TempDir::new().unwrap();
        let path = place.path().join("test.fmu");
        fs::write(&path, b"not a zip").unwrap();
        assert!(matches!(
            Archive::unpack(&path),
            Err(ArchiveError::NotZip { .. })
        ));
        assert!(matches!(
            Archive::unpack(&place.path().join("none.fmu")),
            Err(ArchiveError::Io { .. })
        ));
    }
}
