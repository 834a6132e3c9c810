//! Writing files whole or not at all.
//!
//! Content goes to a hidden neighbour of the target first, is flushed to the disk and only then takes the target's
//! name, so that a reader, a crash or a full disk never meets half a result.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use thiserror::Error;

/// Why a file was not written; the target is as it was before.
#[derive(Debug, Error)]
pub enum WriteError {
    /// The operating system refused a step.
    #[error("{path}: cannot {step}: {source}")]
    Io {
        /// The target that was to be written.
        path: PathBuf,
        /// What was being done.
        step: &'static str,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The target has no file name, such as `/` or `..`.
    #[error("{path}: is not a name that a file could be given")]
    NoName {
        /// The target as given.
        path: PathBuf,
    },
}

/// Writes `content` to the file `path`, replacing what was there in one step. Missing parent directories are made.
///
/// # Errors
/// [`WriteError`] where the operating system refuses; `path` is then unchanged.
pub fn write_file(path: &Path, content: &[u8]) -> Result<(), WriteError> {
    let parent = make_parent(path)?;
    let partial = partial_name(path)?;
    let written = fill_file(path, &partial, content);
    if written.is_err() {
        // The first error is the one to report; a leftover that cannot be removed either adds nothing to it.
        let _ = fs::remove_file(&partial);
    }
    written?;
    flush_directory(&parent);
    Ok(())
}

fn fill_file(path: &Path, partial: &Path, content: &[u8]) -> Result<(), WriteError> {
    let mut file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(partial)
        .map_err(failed(path, "make a file beside it"))?;
    file.write_all(content).map_err(failed(path, "write"))?;
    file.sync_all().map_err(failed(path, "flush to the disk"))?;
    drop(file);
    fs::rename(partial, path).map_err(failed(path, "name the finished file"))
}

fn make_parent(path: &Path) -> Result<PathBuf, WriteError> {
    let parent = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    fs::create_dir_all(&parent).map_err(failed(path, "make the directory above it"))?;
    Ok(parent)
}

/// A name beside `path` that no other thread or process uses.
fn partial_name(path: &Path) -> Result<PathBuf, WriteError> {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let Some(name) = path.file_name() else {
        return Err(WriteError::NoName {
            path: path.to_owned(),
        });
    };
    let mut hidden = std::ffi::OsString::from(".");
    hidden.push(name);
    hidden.push(format!(
        ".{}.{}.partial",
        std::process::id(),
        COUNTER.fetch_add(1, Ordering::Relaxed)
    ));
    Ok(path.with_file_name(hidden))
}

/// Asks that the new name itself survives a power cut. Not every system lets a directory be flushed, and the content is
/// on the disk already, so a refusal is no error.
fn flush_directory(parent: &Path) {
    if let Ok(directory) = File::open(parent) {
        let _ = directory.sync_all();
    }
}

fn failed(path: &Path, step: &'static str) -> impl FnOnce(io::Error) -> WriteError {
    let path = path.to_owned();
    move |source| WriteError::Io { path, step, source }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(directory: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(directory)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_replaced_and_leaves_no_neighbour() {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("deep/result.csv");
        write_file(&target, b"first").unwrap();
        write_file(&target, b"second").unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"second");
        assert_eq!(entries(target.parent().unwrap()), ["result.csv"]);
    }

    #[test]
    fn a_path_without_a_name_is_refused() {
        assert!(matches!(
            write_file(Path::new("/"), b""),
            Err(WriteError::NoName { .. } | WriteError::Io { .. })
        ));
    }
}
