//! From the arguments of an instantiation to the settings, the original's library and where its own resources are.

use std::ffi::{CStr, CString};
use std::path::{Path, PathBuf};

use libloading::Library;
use operations::{SETTINGS_FILE, Settings, SettingsError};
use thiserror::Error;

use crate::original::{Original, OriginalError};

/// Why there is no instance.
#[derive(Debug, Error)]
pub enum OpeningError {
    /// An argument is NULL.
    #[error("argument '{0}' is NULL")]
    Null(&'static str),
    /// Another interface than co-simulation is asked for.
    #[error("an FMU around an FMU is for co-simulation alone")]
    Interface,
    /// The resources cannot be found.
    #[error("the resource location {0} names no folder of this machine")]
    Location(String),
    /// The settings cannot be read.
    #[error("{} cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// They are no settings.
    #[error("{} is not of this FMU: {source}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: serde_json::Error,
    },
    /// They cannot run.
    #[error("{}: {source}", path.display())]
    Settings {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: SettingsError,
    },
    /// The token is another's.
    #[error("the token {given} is not {expected}, that of this FMU's modelDescription.xml")]
    Token {
        /// What the importer passed.
        given: String,
        /// What it should be.
        expected: String,
    },
    /// The original.
    #[error(transparent)]
    Original(#[from] OriginalError),
}

/// What an instantiation needs.
pub struct Opening {
    /// Settings.
    pub settings: Settings,
    /// Library of the original.
    pub library: Library,
    /// Token of the original.
    pub token: CString,
    /// Where its resources are, in the spelling of the standard.
    pub resources: CString,
}

/// Finds everything.
///
/// # Errors
/// [`OpeningError`].
pub fn open(
    token: Option<&CStr>,
    location: Option<&CStr>,
    is_three: bool,
) -> Result<Opening, OpeningError> {
    let token = token.ok_or(OpeningError::Null("the token (GUID)"))?;
    let location = location.ok_or(OpeningError::Null("the resource location"))?;
    let location = location.to_string_lossy();
    let folder = if is_three {
        Some(PathBuf::from(&*location))
    } else {
        folder(&location)
    };
    let folder = folder.ok_or_else(|| OpeningError::Location(location.to_string()))?;
    let path = folder.join(SETTINGS_FILE);
    let settings = settings(&path)?;
    if token.to_bytes() != settings.token.as_bytes() {
        return Err(OpeningError::Token {
            given: token.to_string_lossy().into_owned(),
            expected: settings.token,
        });
    }
    let original = folder.join(&settings.original_folder);
    let library = Original::load(&original, &settings.original_identifier, is_three)?;
    let resources = format!(
        "{}/{}/resources{}",
        location.trim_end_matches(['/', '\\']),
        settings.original_folder,
        if is_three { "/" } else { "" }
    );
    let text =
        |text: String| CString::new(text).map_err(|_| OpeningError::Location(location.to_string()));
    Ok(Opening {
        token: text(settings.original_token.clone())?,
        resources: text(resources)?,
        settings,
        library,
    })
}

fn settings(path: &Path) -> Result<Settings, OpeningError> {
    let own = || path.to_owned();
    let text = std::fs::read_to_string(path).map_err(|source| OpeningError::Read {
        path: own(),
        source,
    })?;
    let settings: Settings = serde_json::from_str(&text).map_err(|source| OpeningError::Parse {
        path: own(),
        source,
    })?;
    settings.check().map_err(|source| OpeningError::Settings {
        path: own(),
        source,
    })?;
    Ok(settings)
}

/// The folder that a `file:` address or a plain path names.
fn folder(location: &str) -> Option<PathBuf> {
    let Some(rest) = location.strip_prefix("file:") else {
        return Some(PathBuf::from(location));
    };
    let path = match rest.strip_prefix("//") {
        Some(after) => after.strip_prefix("localhost").unwrap_or(after),
        None => rest,
    };
    let bytes = decoded(path.as_bytes());
    let path = String::from_utf8(bytes).ok()?;
    // file:///C:/x leads to C:/x.
    let has_drive = path.as_bytes().get(2) == Some(&b':') && path.starts_with('/');
    Some(PathBuf::from(if has_drive { &path[1..] } else { &path }))
}

/// Undoes percent encoding; a percent sign that no two hexadecimal digits follow stands for itself.
fn decoded(path: &[u8]) -> Vec<u8> {
    let digit = |byte: u8| char::from(byte).to_digit(16).map(|value| value as u8);
    let mut bytes = Vec::with_capacity(path.len());
    let mut at = 0;
    while at < path.len() {
        let pair = path.get(at + 1).zip(path.get(at + 2));
        let code = pair.and_then(|(high, low)| Some(digit(*high)? << 4 | digit(*low)?));
        match (path[at], code) {
            (b'%', Some(code)) => {
                bytes.push(code);
                at += 3;
            }
            (byte, _) => {
                bytes.push(byte);
                at += 1;
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_lead_to_folders() {
        for (location, wanted) in [
            ("file:///tmp/a%20b/resources", "/tmp/a b/resources"),
            ("file:/tmp/resources", "/tmp/resources"),
            ("file://localhost/tmp/resources", "/tmp/resources"),
            ("/tmp/resources", "/tmp/resources"),
            ("file:///C:/x/resources", "C:/x/resources"),
            ("file:///tmp/100%/resources", "/tmp/100%/resources"),
        ] {
            assert_eq!(folder(location), Some(PathBuf::from(wanted)), "{location}");
        }
    }
}
