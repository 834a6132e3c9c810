//! Where things are, and writing them whole or not at all.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// Folder of this crate's sources.
#[must_use]
pub fn crate_folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Folder for what the benchmark builds: `target/benchmarks` of the workspace.
///
/// # Errors
/// When it cannot be made.
pub fn build_folder() -> Result<PathBuf> {
    let folder = crate_folder().join("../../target/benchmarks");
    fs::create_dir_all(&folder).with_context(|| format!("making {}", folder.display()))?;
    Ok(folder)
}

/// Writes a file through a temporary one beside it, so that no reader ever sees half of it.
///
/// # Errors
/// When the folder cannot be made or the file not written.
pub fn write_atomically(path: &Path, content: &str) -> Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).with_context(|| format!("making {}", folder.display()))?;
    }
    let temporary = path.with_extension("partial");
    fs::write(&temporary, content).with_context(|| format!("writing {}", temporary.display()))?;
    fs::rename(&temporary, path).with_context(|| format!("putting {} in place", path.display()))
}
