//! From the arguments of an instantiation to a live instance, or a reason why not.

use super::guard::panicked;
use super::instance::{INSTANCES, Instance};
use super::log::{Callback, Log};
use super::own_folder;
use super::resource;
use super::status::Status;
use crate::cosim::{CoSimulationModel, MODEL_FILE, ModelError};
use std::ffi::{CStr, CString, c_void};
use std::fs::File;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::ptr;

/// Largest `model.toml` that is read [bytes].
const MODEL_FILE_LIMIT: u64 = 1 << 20;

/// From the text of a model file and its name to the model.
pub(super) type Open = fn(&str, &str) -> Result<Box<dyn CoSimulationModel>, ModelError>;

/// What both standards pass to an instantiation.
pub(super) struct Request<'a> {
    pub(super) function: &'static str,
    pub(super) open: Open,
    pub(super) instance_name: Option<&'a CStr>,
    pub(super) token: Option<&'a CStr>,
    pub(super) resources: Option<&'a CStr>,
    pub(super) logging_on: bool,
    pub(super) environment: *mut c_void,
    pub(super) callback: Callback,
}

/// A handle to a new instance, finished by `configure`; NULL with a line in the log where there can
/// be none.
pub(super) fn instantiate(
    request: &Request<'_>,
    configure: impl FnOnce(&mut Instance) -> Result<(), String>,
) -> *mut c_void {
    let log = || {
        let name = CString::from(request.instance_name.unwrap_or_default());
        Log::new(
            request.callback,
            request.environment,
            name,
            request.logging_on,
        )
    };
    let made = catch_unwind(AssertUnwindSafe(|| {
        let (model, reservation) = model(request)?;
        let mut instance = Instance::new(model, log());
        if let Some(reservation) = reservation {
            let line = format!("{}: {reservation}", request.function);
            instance.log.force(Status::Warning, &line);
        }
        configure(&mut instance)?;
        INSTANCES
            .insert(instance)
            .ok_or_else(|| "there are too many live instances".to_owned())
    }));
    let reason = match made {
        Ok(Ok(handle)) => return handle,
        Ok(Err(reason)) => reason,
        Err(payload) => panicked(payload).message,
    };
    log().force(Status::Error, &format!("{}: {reason}", request.function));
    ptr::null_mut()
}

/// The model that is asked for, and what to say about where it was found.
fn model(request: &Request<'_>) -> Result<(Box<dyn CoSimulationModel>, Option<String>), String> {
    let name = request
        .instance_name
        .ok_or("argument 'instanceName' is NULL; it needs at least one character")?;
    if name.to_bytes().trim_ascii().is_empty() {
        return Err("argument 'instanceName' is empty; it needs at least one character".into());
    }
    let token = request
        .token
        .ok_or("the instantiation token (GUID) is NULL; expected that of modelDescription.xml")?;
    let location = request.resources.ok_or_else(|| {
        format!("the resource location is NULL; the component reads {MODEL_FILE} from there")
    })?;
    let named = resource::folder(location.to_bytes()).map_err(|error| error.to_string());
    let reason = match named {
        Ok(folder) if leads_somewhere(&folder) => {
            return open_model(request, token, &folder).map(|model| (model, None));
        }
        Ok(folder) => match read(&folder.join(MODEL_FILE)) {
            Err(reason) => reason,
            // It appeared between the two looks.
            Ok(_) => return open_model(request, token, &folder).map(|model| (model, None)),
        },
        Err(reason) => reason,
    };
    // Some importers build a wrong location: the library's own FMU is meant if its token is the one asked for.
    let own = own_folder::resources().filter(|folder| leads_somewhere(folder));
    let found = own.and_then(|folder| Some((open_model(request, token, &folder).ok()?, folder)));
    let Some((model, folder)) = found else {
        return Err(reason);
    };
    let reservation = format!(
        "{reason}; {MODEL_FILE} in {}, beside this library, has the token that is asked for and is taken instead",
        folder.display()
    );
    Ok((model, Some(reservation)))
}

fn leads_somewhere(folder: &Path) -> bool {
    folder.join(MODEL_FILE).exists()
}

/// The model that the resource folder describes, if it is the one of the token.
fn open_model(
    request: &Request<'_>,
    token: &CStr,
    folder: &Path,
) -> Result<Box<dyn CoSimulationModel>, String> {
    let file = folder.join(MODEL_FILE);
    let text = read(&file)?;
    let model =
        (request.open)(&text, &file.to_string_lossy()).map_err(|error| error.to_string())?;
    let expected = model.token().to_string();
    if token.to_bytes() != expected.as_bytes() {
        return Err(format!(
            "the token {} does not match {expected}, the token of this library with {}: XML, library and \
             {MODEL_FILE} must come from one run of build-fmu",
            token.to_string_lossy(),
            file.display(),
        ));
    }
    Ok(model)
}

fn read(file: &Path) -> Result<String, String> {
    let fail = |error: std::io::Error| {
        format!(
            "cannot read {}: {error}; it is a text file among the resources of the unpacked FMU",
            file.display()
        )
    };
    let mut text = String::new();
    File::open(file)
        .map_err(fail)?
        .take(MODEL_FILE_LIMIT + 1)
        .read_to_string(&mut text)
        .map_err(fail)?;
    if text.len() as u64 > MODEL_FILE_LIMIT {
        return Err(format!(
            "{} is larger than {MODEL_FILE_LIMIT} bytes",
            file.display()
        ));
    }
    Ok(text)
}
