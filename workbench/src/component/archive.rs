//! The archive of an FMU, taken apart with distrust: an FMU may come from anywhere.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use thiserror::Error;
use zip::ZipArchive;

/// Most entries that an archive may have.
const MOST_ENTRIES: usize = 10_000;
/// Most bytes that an archive may unpack to.
const MOST_BYTES: u64 = 256 << 20;
/// Unpacked over packed size beyond which a large entry is taken for a bomb; binaries and XML stay below 20.
const MOST_RATIO: u64 = 200;
/// Unpacked size below which the ratio does not matter.
const RATIO_FLOOR: u64 = 16 << 20;

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
    #[error("{path}: refused, because it has more than {MOST_ENTRIES} entries or unpacks to more than {} MiB or {MOST_RATIO} times its size", MOST_BYTES >> 20)]
    TooLarge {
        /// The file.
        path: PathBuf,
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
        let not_zip = |error: zip::result::ZipError| ArchiveError::NotZip {
            path: path.to_owned(),
            reason: error.to_string(),
        };
        let file = File::open(path).map_err(failed("be opened"))?;
        let mut archive = ZipArchive::new(io::BufReader::new(file)).map_err(not_zip)?;
        if archive.len() > MOST_ENTRIES {
            return Err(ArchiveError::TooLarge {
                path: path.to_owned(),
            });
        }
        let mut announced = 0_u64;
        for index in 0..archive.len() {
            let entry = archive.by_index_raw(index).map_err(not_zip)?;
            announced = announced.saturating_add(entry.size());
            let bomb = entry.size() > RATIO_FLOOR
                && entry.size() / entry.compressed_size().max(1) > MOST_RATIO;
            if bomb || announced > MOST_BYTES {
                return Err(ArchiveError::TooLarge {
                    path: path.to_owned(),
                });
            }
        }
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
            let limit = left.min(entry.size()) + 1;
            let written =
                io::copy(&mut (&mut entry).take(limit), &mut output).map_err(|error| {
                    ArchiveError::NotZip {
                        path: path.to_owned(),
                        reason: error.to_string(),
                    }
                })?;
            if written > entry.size() {
                return Err(hostile("unpacks to more than it says"));
            }
            left = left
                .checked_sub(written)
                .ok_or_else(|| ArchiveError::TooLarge {
                    path: path.to_owned(),
                })?;
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
