//! Loads a library before it is packed: every symbol of the standard, the version it answers, the token it accepts.
//!
//! Unsafe as the FMUs of `component` are: it calls foreign functions as an importer does.

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::ptr;

use crate::binary_error::BinaryError;
use crate::binary_header;
use crate::library::Library;
use crate::platform::FmiVersion;
use crate::symbols;

/// What an importer will hand to the library.
#[derive(Debug, Clone, Copy)]
pub struct Expectation<'a> {
    /// `modelIdentifier`, the file name of the library inside the FMU.
    pub model_identifier: &'a str,
    /// `guid` (FMI 2) or `instantiationToken` (FMI 3) of the model description.
    pub token: &'a str,
    /// Files below `resources/` by their relative name.
    pub resources: &'a [(String, Vec<u8>)],
}

/// Loads a copy of the library as an importer would and makes it instantiate the model.
///
/// # Errors
/// [`BinaryError`] with what is missing or what the library logged.
pub fn check(
    library: &Library,
    version: FmiVersion,
    expectation: &Expectation<'_>,
) -> Result<(), BinaryError> {
    binary_header::check(&library.content).map_err(|source| BinaryError::Header {
        path: library.path.clone(),
        source,
    })?;
    let folder = tempfile::tempdir().map_err(|source| BinaryError::Copy {
        path: std::env::temp_dir(),
        source,
    })?;
    let file = unpack(folder.path(), library, version, expectation)?;
    // SAFETY: the user named this library to be packed and run; its initialisers run as in any importer.
    let loaded =
        unsafe { libloading::Library::new(&file) }.map_err(|source| BinaryError::Load {
            path: library.path.clone(),
            source,
        })?;
    check_symbols(&loaded, &library.path, version)?;
    check_version(&loaded, &library.path, version)?;
    let resources = folder.path().join("resources");
    let attempt = |token: &str| match version {
        FmiVersion::Fmi2 => {
            instantiate_fmi2(&loaded, expectation.model_identifier, token, &resources)
        }
        FmiVersion::Fmi3 => {
            instantiate_fmi3(&loaded, expectation.model_identifier, token, &resources)
        }
    };
    let load_error = |source| BinaryError::Load {
        path: library.path.clone(),
        source,
    };
    let own = attempt(expectation.token).map_err(load_error)?;
    if !own.instantiated {
        return Err(BinaryError::Instantiate {
            path: library.path.clone(),
            version,
            token: expectation.token.to_owned(),
            messages: own.messages,
        });
    }
    if attempt("{00000000-0000-0000-0000-000000000000}")
        .map_err(load_error)?
        .instantiated
    {
        return Err(BinaryError::AcceptsForeignToken {
            path: library.path.clone(),
            version,
        });
    }
    Ok(())
}

/// What can be known of a library for another machine, which cannot be loaded: complete, all functions exported.
///
/// # Errors
/// [`BinaryError::Header`] or [`BinaryError::Symbols`].
pub fn check_headers(library: &Library, version: FmiVersion) -> Result<(), BinaryError> {
    let file = binary_header::parse(&library.content)
        .and_then(|file| binary_header::complete(&file, &library.content).map(|()| file))
        .map_err(|source| BinaryError::Header {
            path: library.path.clone(),
            source,
        })?;
    let missing = symbols::missing_from(&file, symbols::required(version).to_vec());
    if missing.is_empty() {
        return Ok(());
    }
    Err(BinaryError::Symbols {
        path: library.path.clone(),
        version,
        missing: missing.into_iter().map(str::to_owned).collect(),
    })
}

/// Lays out the parts of the FMU that the library needs at run time; returns the library's file.
fn unpack(
    folder: &Path,
    library: &Library,
    version: FmiVersion,
    expectation: &Expectation<'_>,
) -> Result<PathBuf, BinaryError> {
    let copy_error = |path: &Path| {
        let path = path.to_owned();
        move |source| BinaryError::Copy { path, source }
    };
    let binaries = folder
        .join("binaries")
        .join(library.platform.folder(version));
    let resources = folder.join("resources");
    for directory in [&binaries, &resources] {
        fs::create_dir_all(directory).map_err(copy_error(directory))?;
    }
    let file = binaries
        .join(expectation.model_identifier)
        .with_extension(library.platform.library_extension());
    fs::write(&file, &library.content).map_err(copy_error(&file))?;
    for (name, content) in expectation.resources {
        let Some(place) = below(&resources, name) else {
            continue;
        };
        if let Some(parent) = place.parent() {
            fs::create_dir_all(parent).map_err(copy_error(parent))?;
        }
        fs::write(&place, content).map_err(copy_error(&place))?;
    }
    Ok(file)
}

/// The place of a relative name inside a folder; `None` for a name that leads out of it.
fn below(folder: &Path, name: &str) -> Option<PathBuf> {
    let plain = Path::new(name)
        .components()
        .all(|part| matches!(part, Component::Normal(_)));
    (plain && !name.contains('\\')).then(|| folder.join(name))
}

fn check_symbols(
    loaded: &libloading::Library,
    path: &Path,
    version: FmiVersion,
) -> Result<(), BinaryError> {
    let missing: Vec<String> = symbols::required(version)
        .iter()
        // SAFETY: the symbol is only looked up, never called through this type.
        .filter(|name| unsafe { loaded.get::<*const c_void>(name.as_bytes()) }.is_err())
        .map(|name| (*name).to_owned())
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(BinaryError::Symbols {
        path: path.to_owned(),
        version,
        missing,
    })
}

fn check_version(
    loaded: &libloading::Library,
    path: &Path,
    version: FmiVersion,
) -> Result<(), BinaryError> {
    type GetVersion = unsafe extern "C" fn() -> *const c_char;
    let name: &[u8] = match version {
        FmiVersion::Fmi2 => b"fmi2GetVersion",
        FmiVersion::Fmi3 => b"fmi3GetVersion",
    };
    // SAFETY: signature as in the standard's header; the string is static in the library.
    let found = unsafe {
        let get_version = loaded
            .get::<GetVersion>(name)
            .map_err(|source| BinaryError::Load {
                path: path.to_owned(),
                source,
            })?;
        text(get_version())
    };
    // FMI 3 lets the answer carry a patch level ("3.0.2").
    let matches = match version {
        FmiVersion::Fmi2 => found == version.number(),
        FmiVersion::Fmi3 => found == version.number() || found.starts_with("3.0."),
    };
    if matches {
        return Ok(());
    }
    Err(BinaryError::Version {
        path: path.to_owned(),
        version,
        found,
    })
}

struct Attempt {
    instantiated: bool,
    messages: Vec<String>,
}

type Messages = RefCell<Vec<String>>;

#[repr(C)]
struct Fmi2Callbacks {
    logger: *const c_void,
    allocate_memory: *const c_void,
    free_memory: *const c_void,
    step_finished: *const c_void,
    component_environment: *const c_void,
}

/// The standard's logger takes further arguments for a printf format. Every platform of FMI lets a
/// function with fewer parameters be called that way; the format itself is kept as text.
extern "C" fn log_fmi2(
    environment: *const c_void,
    _instance_name: *const c_char,
    _status: c_int,
    _category: *const c_char,
    message: *const c_char,
) {
    log_fmi3(environment, 0, ptr::null(), message);
}

extern "C" fn log_fmi3(
    environment: *const c_void,
    _status: c_int,
    _category: *const c_char,
    message: *const c_char,
) {
    if environment.is_null() {
        return;
    }
    // SAFETY: the environment is the `Messages` that `instantiate_*` passed and keeps alive.
    let messages = unsafe { &*environment.cast::<Messages>() };
    if let Ok(mut messages) = messages.try_borrow_mut() {
        messages.push(text(message));
    }
}

fn text(string: *const c_char) -> String {
    if string.is_null() {
        return String::new();
    }
    // SAFETY: strings of the standard are NUL-terminated.
    unsafe { CStr::from_ptr(string) }
        .to_string_lossy()
        .into_owned()
}

fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', "")).unwrap_or_default()
}

fn instantiate_fmi2(
    loaded: &libloading::Library,
    name: &str,
    token: &str,
    resources: &Path,
) -> Result<Attempt, libloading::Error> {
    type Instantiate = unsafe extern "C" fn(
        *const c_char,
        c_int,
        *const c_char,
        *const c_char,
        *const Fmi2Callbacks,
        c_int,
        c_int,
    ) -> *mut c_void;
    type FreeInstance = unsafe extern "C" fn(*mut c_void);
    const CO_SIMULATION: c_int = 1;
    let messages = Messages::default();
    let callbacks = Fmi2Callbacks {
        logger: log_fmi2 as *const c_void,
        allocate_memory: ptr::null(),
        free_memory: ptr::null(),
        step_finished: ptr::null(),
        component_environment: (&raw const messages).cast(),
    };
    let (name, token, location) = (
        c_string(name),
        c_string(token),
        c_string(&file_url(resources)),
    );
    // SAFETY: signatures as in fmi2FunctionTypes.h; all pointers outlive the instance.
    let instance = unsafe {
        let instantiate = loaded.get::<Instantiate>(b"fmi2Instantiate")?;
        let free_instance = loaded.get::<FreeInstance>(b"fmi2FreeInstance")?;
        let instance = instantiate(
            name.as_ptr(),
            CO_SIMULATION,
            token.as_ptr(),
            location.as_ptr(),
            &raw const callbacks,
            0,
            1,
        );
        if !instance.is_null() {
            free_instance(instance);
        }
        instance
    };
    Ok(Attempt {
        instantiated: !instance.is_null(),
        messages: messages.into_inner(),
    })
}

fn instantiate_fmi3(
    loaded: &libloading::Library,
    name: &str,
    token: &str,
    resources: &Path,
) -> Result<Attempt, libloading::Error> {
    type Log = extern "C" fn(*const c_void, c_int, *const c_char, *const c_char);
    type Instantiate = unsafe extern "C" fn(
        *const c_char,
        *const c_char,
        *const c_char,
        bool,
        bool,
        bool,
        bool,
        *const u32,
        usize,
        *const c_void,
        Log,
        *const c_void,
    ) -> *mut c_void;
    type FreeInstance = unsafe extern "C" fn(*mut c_void);
    let messages = Messages::default();
    let (name, token) = (c_string(name), c_string(token));
    let path = c_string(&format!(
        "{}{}",
        resources.display(),
        std::path::MAIN_SEPARATOR
    ));
    // SAFETY: signatures as in fmi3FunctionTypes.h; all pointers outlive the instance.
    let instance = unsafe {
        let instantiate = loaded.get::<Instantiate>(b"fmi3InstantiateCoSimulation")?;
        let free_instance = loaded.get::<FreeInstance>(b"fmi3FreeInstance")?;
        let instance = instantiate(
            name.as_ptr(),
            token.as_ptr(),
            path.as_ptr(),
            false,
            true,
            false,
            false,
            ptr::null(),
            0,
            (&raw const messages).cast(),
            log_fmi3,
            ptr::null(),
        );
        if !instance.is_null() {
            free_instance(instance);
        }
        instance
    };
    Ok(Attempt {
        instantiated: !instance.is_null(),
        messages: messages.into_inner(),
    })
}

/// `file:///…` with everything outside the unreserved characters percent-encoded.
fn file_url(path: &Path) -> String {
    let path = path.to_string_lossy().replace('\\', "/");
    let mut url = String::from(if path.starts_with('/') {
        "file://"
    } else {
        "file:///"
    });
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' | b'/' | b':' => {
                url.push(char::from(byte));
            }
            _ => url.push_str(&format!("%{byte:02X}")),
        }
    }
    url
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::Platform;

    fn expectation() -> Expectation<'static> {
        Expectation {
            model_identifier: "ReducedRig",
            token: "{x}",
            resources: &[],
        }
    }

    #[test]
    fn a_file_that_is_no_library_is_refused() {
        let platform = Platform::current().unwrap();
        let library = Library::new(PathBuf::from("notes.txt"), platform, b"no library".to_vec());
        let error = check(&library, FmiVersion::Fmi2, &expectation()).unwrap_err();
        assert!(matches!(error, BinaryError::Header { .. }), "{error}");
        assert!(error.to_string().contains("notes.txt"), "{error}");
    }

    #[test]
    fn a_path_with_blanks_becomes_a_url() {
        assert_eq!(file_url(Path::new("/a b/ü")), "file:///a%20b/%C3%BC");
        assert_eq!(
            file_url(Path::new("C:\\fmu\\resources")),
            "file:///C:/fmu/resources"
        );
    }
}
