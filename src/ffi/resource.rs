//! Where the resources are: what importers pass as resource location, turned into a folder.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The folder that `location` names: a `file:` URI in any of the spellings that importers use, or an
/// absolute native path.
///
/// # Errors
/// Another scheme, a host, or a relative path.
pub(super) fn folder(location: &[u8]) -> Result<PathBuf, LocationError> {
    let shown = || String::from_utf8_lossy(location).into_owned();
    let path = match scheme(location) {
        Some((scheme, rest)) if scheme.eq_ignore_ascii_case(b"file") => native(&decode(
            path_of_uri(rest).ok_or_else(|| LocationError::Host(shown()))?,
        )),
        Some((scheme, _)) => {
            let scheme = String::from_utf8_lossy(scheme).into_owned();
            return Err(LocationError::Scheme {
                scheme,
                location: shown(),
            });
        }
        None => native(location),
    };
    let path = path.ok_or_else(|| LocationError::Encoding(shown()))?;
    if path.is_absolute() {
        Ok(path)
    } else {
        Err(LocationError::Relative(shown()))
    }
}

/// Splits `scheme:rest`. One letter before the colon is a Windows drive, not a scheme.
fn scheme(location: &[u8]) -> Option<(&[u8], &[u8])> {
    let colon = location.iter().position(|byte| *byte == b':')?;
    let (scheme, rest) = (&location[..colon], &location[colon + 1..]);
    let valid = scheme.len() > 1
        && scheme[0].is_ascii_alphabetic()
        && scheme
            .iter()
            .all(|byte| byte.is_ascii_alphanumeric() || b"+-.".contains(byte));
    valid.then_some((scheme, rest))
}

/// The path of a `file:` URI after its scheme: `/x`, `///x`, `////x`, `//localhost/x`; `None` where it
/// names another host.
fn path_of_uri(rest: &[u8]) -> Option<&[u8]> {
    let Some(after) = rest.strip_prefix(b"//") else {
        return Some(rest);
    };
    let end = after
        .iter()
        .position(|byte| *byte == b'/')
        .unwrap_or(after.len());
    let (host, mut path) = after.split_at(end);
    if host.is_empty() || host.eq_ignore_ascii_case(b"localhost") {
        while path.starts_with(b"//") {
            path = &path[1..];
        }
        return Some(path);
    }
    // file://C:/x: a drive where the host should be.
    (host.len() == 2 && host[1] == b':').then_some(after)
}

/// Undoes percent encoding. A percent sign that no two hexadecimal digits follow stands for itself:
/// some importers do not encode at all.
fn decode(path: &[u8]) -> Cow<'_, [u8]> {
    if !path.contains(&b'%') {
        return Cow::Borrowed(path);
    }
    let digit = |byte: u8| char::from(byte).to_digit(16).map(|value| value as u8);
    let mut decoded = Vec::with_capacity(path.len());
    let mut rest = path;
    while let [first, tail @ ..] = rest {
        rest = tail;
        match (first, tail) {
            (b'%', [high, low, after @ ..]) => match (digit(*high), digit(*low)) {
                (Some(high), Some(low)) => {
                    decoded.push(high << 4 | low);
                    rest = after;
                }
                _ => decoded.push(b'%'),
            },
            _ => decoded.push(*first),
        }
    }
    Cow::Owned(decoded)
}

#[cfg(unix)]
fn native(path: &[u8]) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStrExt;
    Some(Path::new(std::ffi::OsStr::from_bytes(path)).to_path_buf())
}

#[cfg(not(unix))]
fn native(path: &[u8]) -> Option<PathBuf> {
    let text = std::str::from_utf8(path).ok()?;
    let bytes = text.as_bytes();
    // /C:/x, the path of file:///C:/x
    let drive = bytes.len() > 2 && bytes[0] == b'/' && bytes[2] == b':';
    Some(Path::new(if drive { &text[1..] } else { text }).to_path_buf())
}

/// A resource location that names no folder of this machine.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub(super) enum LocationError {
    #[error(
        "the resource location \"{location}\" has the scheme {scheme}; only file: URIs and absolute paths can be read"
    )]
    Scheme { scheme: String, location: String },
    #[error(
        "the resource location \"{0}\" names another host; expected file:///path or file:/path"
    )]
    Host(String),
    #[error("the resource location \"{0}\" is a relative path; it must be absolute")]
    Relative(String),
    #[error("the resource location \"{0}\" is not UTF-8")]
    Encoding(String),
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn every_spelling_that_importers_use() {
        for (location, expected) in [
            ("file:///x/resources", "/x/resources"),
            ("file:///x/resources/", "/x/resources"),
            ("file:/x/resources", "/x/resources"),
            ("file:////x/resources", "/x/resources"),
            ("file://localhost/x/resources", "/x/resources"),
            ("FILE:///x/resources", "/x/resources"),
            ("file:///x%20y/%C3%A9", "/x y/é"),
            ("file:///x y/100%", "/x y/100%"),
            ("file:///x%2", "/x%2"),
            ("/x/resources", "/x/resources"),
            ("/x%20y/resources/", "/x%20y/resources"),
            ("/x:y", "/x:y"),
        ] {
            assert_eq!(
                folder(location.as_bytes()),
                Ok(PathBuf::from(expected)),
                "{location}"
            );
        }
    }

    #[test]
    fn what_cannot_be_a_folder_here_is_refused_with_its_reason() {
        assert!(matches!(
            folder(b"http://x/resources"),
            Err(LocationError::Scheme { .. })
        ));
        assert!(matches!(
            folder(b"file://server/x"),
            Err(LocationError::Host(_))
        ));
        assert!(matches!(
            folder(b"resources"),
            Err(LocationError::Relative(_))
        ));
        assert!(matches!(
            folder(b"file:resources"),
            Err(LocationError::Relative(_))
        ));
        assert!(matches!(folder(b""), Err(LocationError::Relative(_))));
    }
}
