//! Finds the prebuilt libraries: as named, or beside the running program, or where its host says.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use thiserror::Error;

use crate::archive::{ArchiveError, CompressedLibrary};
use crate::binary_header::{self, HeaderError};
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
    compressed: Arc<Mutex<Option<CompressedLibrary>>>,
}

impl Library {
    /// A library with these bytes.
    #[must_use]
    pub fn new(path: PathBuf, platform: Platform, content: Vec<u8>) -> Self {
        Self {
            path,
            platform,
            content,
            compressed: Arc::default(),
        }
    }

    /// The library as archives take it, compressed when it is first asked for; threads that ask meanwhile wait.
    ///
    /// # Errors
    /// As [`CompressedLibrary::new`].
    pub fn compressed(&self) -> Result<CompressedLibrary, ArchiveError> {
        let kept = self.compressed.lock();
        let mut kept = kept.unwrap_or_else(PoisonError::into_inner);
        let compressed = match kept.take() {
            Some(compressed) => compressed,
            None => CompressedLibrary::new(&self.content)?,
        };
        Ok(kept.insert(compressed).clone())
    }
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
    /// No library where it should be.
    #[error(
        "no library for {platform} was found; looked for {}. {}",
        looked_for.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(" and "),
        remedy(*platform, looked_for)
    )]
    NotFound {
        /// What it was wanted for.
        platform: Platform,
        /// All places that were tried.
        looked_for: Vec<PathBuf>,
    },
    /// The library is for no platform that FMI names.
    #[error("{} cannot be packed: it is for no platform that FMI names; known: {}", path.display(), Platform::ALL.map(Platform::name).join(", "))]
    OtherPlatform {
        /// The file.
        path: PathBuf,
    },
    /// The file is no library.
    #[error("{} cannot be loaded: {source}", path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: HeaderError,
    },
    /// Two libraries for one folder.
    #[error("{} and {} are both for {platform}; name one", first.display(), second.display())]
    Twice {
        /// The platform of both.
        platform: Platform,
        /// One file.
        first: PathBuf,
        /// The other.
        second: PathBuf,
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

fn remedy(platform: Platform, looked_for: &[PathBuf]) -> String {
    let file_name = looked_for
        .first()
        .and_then(|path| path.file_name())
        .unwrap_or_default()
        .to_string_lossy();
    if Platform::current() == Some(platform) {
        return format!(
            "Put {file_name} beside this program (`cargo build --release` in the source tree makes it) or name it \
             with --library"
        );
    }
    format!(
        "In the source tree `build-fmu/platforms/build {platform}` makes it, after `build-fmu/platforms/setup {platform}` has \
         installed what that needs; one built elsewhere is named with --library"
    )
}

/// Library of rigs and controllers, as the build calls it.
const PLANT: &str = "stickslip";
/// Library of an FMU around an FMU.
const WRAPPER: &str = "stickslip_wrapper";

/// Where the libraries lie if the running program is not what they lie beside.
static HOME: OnceLock<PathBuf> = OnceLock::new();

/// Looks for libraries in `folder` instead of beside the running program, for the rest of the process: for programs, such as
/// an interpreter, that load this crate from elsewhere. The first call counts.
pub fn look_in(folder: PathBuf) {
    HOME.get_or_init(|| folder);
}

/// Reads the library at `named`, or else the one for this machine beside the running program.
///
/// A program in a `deps` or `examples` folder of a build tree (a test, for instance) also finds the library one folder up.
///
/// # Errors
/// [`LibraryError`], naming all the places that were tried.
pub fn find(named: Option<&Path>) -> Result<Library, LibraryError> {
    match named {
        Some(path) => read(path),
        None => beside(PLANT),
    }
}

/// The libraries to pack: those `named`, and for each further one of `platforms` the prebuilt one; without either the
/// one for this machine and every prebuilt one that is there. In the order of [`Platform`].
///
/// A prebuilt library lies in `platforms/NAME/` beside the running program, or, for this machine, beside it.
///
/// # Errors
/// [`LibraryError`] if one is missing or for another platform, or if two are for the same.
pub fn select(platforms: &[Platform], named: &[PathBuf]) -> Result<Vec<Library>, LibraryError> {
    let mut libraries = select_called(PLANT, platforms, named)?;
    if platforms.is_empty() && named.is_empty() {
        for platform in Platform::ALL {
            match prebuilt(platform, PLANT) {
                Ok(library) if libraries.iter().all(|other| other.platform != platform) => {
                    libraries.push(library);
                }
                Ok(_) | Err(LibraryError::NotFound { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        libraries.sort_by_key(|library| library.platform);
    }
    Ok(libraries)
}

/// The same for the libraries of an FMU around an FMU, which has no other platforms than the one inside: without names, the one for
/// this machine only.
///
/// # Errors
/// As [`select`].
pub fn select_wrappers(
    platforms: &[Platform],
    named: &[PathBuf],
) -> Result<Vec<Library>, LibraryError> {
    select_called(WRAPPER, platforms, named)
}

fn select_called(
    stem: &str,
    platforms: &[Platform],
    named: &[PathBuf],
) -> Result<Vec<Library>, LibraryError> {
    if platforms.is_empty() && named.is_empty() {
        return Ok(vec![beside(stem)?]);
    }
    let mut libraries: BTreeMap<Platform, Library> = BTreeMap::new();
    for path in named {
        let library = read(path)?;
        let (platform, second) = (library.platform, library.path.clone());
        if let Some(first) = libraries.insert(platform, library) {
            return Err(LibraryError::Twice {
                platform,
                first: first.path,
                second,
            });
        }
    }
    for platform in platforms {
        if let Entry::Vacant(place) = libraries.entry(*platform) {
            place.insert(prebuilt(*platform, stem)?);
        }
    }
    Ok(libraries.into_values().collect())
}

/// The library for this machine beside the running program.
fn beside(stem: &str) -> Result<Library, LibraryError> {
    let platform = this_platform()?;
    let file_name = platform.library_file_name(stem);
    let places = beside_program().into_iter();
    first_of(
        platform,
        places.map(|folder| folder.join(&file_name)).collect(),
    )
}

fn this_platform() -> Result<Platform, LibraryError> {
    Platform::current().ok_or(LibraryError::Platform {
        os: std::env::consts::OS,
        architecture: std::env::consts::ARCH,
    })
}

fn prebuilt(platform: Platform, stem: &str) -> Result<Library, LibraryError> {
    let file_name = platform.library_file_name(stem);
    let mut looked_for = Vec::new();
    for folder in beside_program() {
        looked_for.push(
            folder
                .join("platforms")
                .join(platform.name())
                .join(&file_name),
        );
        if Platform::current() == Some(platform) {
            looked_for.push(folder.join(&file_name));
        }
    }
    first_of(platform, looked_for)
}

fn first_of(platform: Platform, looked_for: Vec<PathBuf>) -> Result<Library, LibraryError> {
    match looked_for.iter().find(|path| path.is_file()) {
        Some(path) => read(path),
        None => Err(LibraryError::NotFound {
            platform,
            looked_for,
        }),
    }
}

fn read(path: &Path) -> Result<Library, LibraryError> {
    let path = path.to_owned();
    let content = match fs::read(&path) {
        Ok(content) => content,
        Err(source) => return Err(LibraryError::Read { path, source }),
    };
    match binary_header::platform(&content) {
        Ok(Some(platform)) => Ok(Library::new(path, platform, content)),
        Ok(None) => Err(LibraryError::OtherPlatform { path }),
        Err(source) => Err(LibraryError::Header { path, source }),
    }
}

fn beside_program() -> Vec<PathBuf> {
    if let Some(folder) = HOME.get() {
        return vec![folder.clone()];
    }
    let Some(folder) = std::env::current_exe()
        .ok()
        .and_then(|program| program.parent().map(Path::to_owned))
    else {
        return vec![PathBuf::new()];
    };
    let in_build_tree = folder
        .file_name()
        .is_some_and(|name| name == "deps" || name == "examples");
    let above = folder
        .parent()
        .filter(|_| in_build_tree)
        .map(Path::to_owned);
    std::iter::once(folder).chain(above).collect()
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
    }

    #[test]
    fn a_missing_platform_is_named_with_what_makes_it() {
        let error = select(&[Platform::Windows64], &[]).unwrap_err();
        let message = error.to_string();
        assert!(
            message.contains("platforms/win64/stickslip.dll")
                && message.contains("build-fmu/platforms/setup win64"),
            "{message}"
        );
    }

    #[test]
    fn two_libraries_for_one_platform_are_refused() {
        let program = std::env::current_exe().unwrap();
        let error = select(&[], &[program.clone(), program]).unwrap_err();
        assert!(matches!(error, LibraryError::Twice { .. }), "{error}");
    }
}
